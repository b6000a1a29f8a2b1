//! Sentences of a located mismatch.

use crate::location::mismatch::{Carrier, Mismatch, Place, When};
use thenar_inference::observe::measured::Phase;

/// Most recordings that a sentence names.
const NAMED: usize = 3;

/// A mismatch in a sentence.
pub(crate) fn of_mismatch(found: &Mismatch) -> String {
    let unit = found.shown.unit();
    let (what, side) = (
        found.shown.words(),
        if found.size > 0.0 { "more" } else { "less" },
    );
    let [small, large] = if found.size > 0.0 {
        [found.low, found.high]
    } else {
        [-found.high, -found.low]
    };
    let size = format!(
        "{} {unit} ({} to {}) {side} {what} than the simulation",
        figure(found.size.abs()),
        figure(small),
        figure(large)
    );
    let place = found.place.as_ref().map_or(String::new(), of_place);
    let bound = found.place.as_ref().map_or(String::new(), of_limits);
    let when = of_when(&found.when);
    format!("{place}{when} {size} (p = {}){bound}.", figure(found.p))
}

fn of_place(place: &Place) -> String {
    let at = place.on_skin_mm.unwrap_or(place.center_mm);
    let cell = place.row_column.map_or(String::new(), |[row, column]| {
        format!(" (row {row}, column {column} of the mat)")
    });
    format!(
        "Around ({:.1}, {:.1}, {:.1}) mm{cell}, within {:.1} mm, ",
        at.x, at.y, at.z, place.radius_mm
    )
}

fn of_limits(place: &Place) -> String {
    let stays = match place.carrier {
        Carrier::Skin => "it stays with the skin when the mat is moved",
        Carrier::Sensor => "it stays with the mat's sensels when the mat is moved",
        Carrier::CannotTell => {
            "whether it stays with the skin or with the mat cannot be decided from these poses"
        }
    };
    format!(
        "; the place is known to {:.1} mm, and {stays}",
        place.resolution_mm
    )
}

fn of_when(when: &When) -> String {
    let names = &when.recordings;
    let who = match names.len() {
        1..=NAMED => quoted(names),
        count => format!("{} and {} more recordings", quoted(&names[..1]), count - 1),
    };
    let phases: Vec<&str> = when.phases.iter().map(|phase| word(*phase)).collect();
    let shows = if names.len() == 1 { "shows" } else { "show" };
    let depth = match when.depth_mm {
        Some([from, to]) if to - from > 1e-6 => format!(" at depths of {from:.2} to {to:.2} mm"),
        Some([at, _]) => format!(" at a depth of {at:.2} mm"),
        None => String::new(),
    };
    let time = match when.time_s {
        Some([from, to]) if to - from > 1e-9 => format!(" from {from:.2} to {to:.2} s"),
        Some([at, _]) => format!(" at {at:.2} s"),
        None => String::new(),
    };
    format!("{who}, {}{depth}{time}, {shows}", phases.join(" and "))
}

fn quoted(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    quoted.join(", ")
}

fn word(phase: Phase) -> &'static str {
    match phase {
        Phase::Apart => "apart",
        Phase::Load => "loading",
        Phase::Hold => "holding",
        Phase::Unload => "unloading",
        Phase::Slide => "sliding",
    }
}

/// Three digits.
pub(crate) fn figure(value: f64) -> String {
    let size = value.abs();
    let places = if size >= 100.0 || size == 0.0 {
        0
    } else {
        (2.0 - size.log10().floor()).clamp(0.0, 9.0) as usize
    };
    let text = format!("{value:.places$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
