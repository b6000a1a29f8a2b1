//! Table of measures and sentence of a handprint.

use nalgebra::Vector3;
use thenar_recordings::handprint::TOUCHED_FROM;

use crate::comparison::quantities::Measure;
use crate::prints::paper_pose::areas;
use crate::prints::printed::Printed;
use thenar_inference::number_format::{number, percent};
use thenar_inference::observe::measured::Mat;

/// Areas, centers and overlap; `before` is the share of every cell where the fit began, the paper as it is said to lie.
pub fn table(mat: &Mat, printed: &Printed, before: &[f64]) -> Vec<Measure> {
    let found = |shares: &[f64]| areas(&mat.areas, &printed.recorded, shares);
    let recorded = found(before).recorded;
    let center = center(mat, &printed.recorded);
    let row = |name, label, unit, measured: f64, of: &dyn Fn(&[f64]) -> f64| Measure {
        name,
        label,
        unit,
        of: "print",
        measured,
        before: of(before),
        after: of(&printed.simulated),
        noise: f64::NAN,
    };
    let nan = f64::NAN;
    vec![
        row("area_mm2", "Contact area", "mm²", recorded, &|shares| {
            found(shares).simulated
        }),
        row(
            "center_distance_mm",
            "Distance of the centers of contact",
            "mm",
            nan,
            &|shares| (self::center(mat, shares) - center).norm(),
        ),
        row(
            "overlap",
            "Overlap of the contact areas (both / either)",
            "",
            nan,
            &|shares| found(shares).overlap(),
        ),
        row(
            "overlap_of_measured",
            "Share of the inked area that is simulated too",
            "",
            nan,
            &|shares| found(shares).both / recorded,
        ),
        row(
            "overlap_of_simulated",
            "Share of the simulated area that is inked too",
            "",
            nan,
            &|shares| found(shares).both / found(shares).simulated,
        ),
    ]
}

/// Middle of the cells in contact, where they are said to lie.
fn center(mat: &Mat, shares: &[f64]) -> Vector3<f64> {
    let (mut sum, mut all) = (Vector3::zeros(), 0.0);
    for (k, _) in shares
        .iter()
        .enumerate()
        .filter(|(_, share)| **share >= TOUCHED_FROM)
    {
        sum += mat.centers[k] * mat.areas[k];
        all += mat.areas[k];
    }
    sum / all
}

/// What a designer reads first of a print.
pub fn sentence(printed: &Printed, table: &[Measure]) -> String {
    let find = |name: &str| table.iter().find(|row| row.name == name);
    let (Some(area), Some(overlap)) = (find("area_mm2"), find("overlap")) else {
        return "Nothing of it can be compared.".into();
    };
    let mut text = format!(
        "Inked and simulated contact overlap by {} (both over either): {} mm\u{b2} are inked and {} mm\u{b2} touch in simulation, {} of the ink among them.",
        percent(overlap.after),
        number(area.measured),
        number(area.after),
        find("overlap_of_measured").map_or_else(String::new, |row| percent(row.after)),
    );
    let [x, y, turn] = printed.pose;
    let half = |part: crate::prints::printed::PosePart, unit: f64| {
        number(unit * 0.5 * (part.high - part.low))
    };
    let degree = 180.0 / std::f64::consts::PI;
    text += &format!(
        " The paper fits best {} \u{b1} {} mm along its columns, {} \u{b1} {} mm along its rows and {} \u{b1} {} degrees from where it is said to lie.",
        number(x.value),
        half(x, 1.0),
        number(y.value),
        half(y, 1.0),
        number(degree * turn.value),
        half(turn, degree)
    );
    if printed.is_at_end {
        text += " That is the end of what was sought: place the paper nearer to where it lay, or give a larger position_mm.";
    }
    if printed.is_mirrored {
        text += &format!(
            " Turned about it would overlap by {}: the image seems to show the print from behind; set mirrored if it does.",
            percent(printed.mirrored_overlap)
        );
    }
    text
}
