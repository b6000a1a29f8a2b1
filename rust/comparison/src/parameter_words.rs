//! Parameters of a fit in words: what they are called, what they belong to, and which lie on a bound.

use thenar_inference::parameters::estimate::Estimate;
use thenar_inference::parameters::target::Target;

/// What a parameter belongs to, for people: `region "pad"`, a recording by its name, `the instrument`.
pub fn of_what(target: &Target) -> String {
    match target {
        Target::Region(name) => format!("region \u{201c}{name}\u{201d}"),
        Target::Recording(name) => format!("\u{201c}{name}\u{201d}"),
        Target::Instrument => "the instrument".to_string(),
    }
}

/// Said of the parameters that lie on a bound: each name once, with all that it belongs to. Empty if none does.
pub(crate) fn at_bounds(estimates: &[Estimate]) -> String {
    let bound: Vec<_> = estimates.iter().filter(|one| one.is_at_bound).collect();
    let mut names: Vec<&str> = bound.iter().map(|one| in_words(&one.name)).collect();
    names.sort_unstable();
    names.dedup();
    let group = |name: &&str| {
        let owners = bound.iter().filter(|one| in_words(&one.name) == *name);
        let mut owners: Vec<_> = owners.map(|one| of_what(&one.target)).collect();
        owners.dedup();
        format!("{name} of {}", listed(&owners))
    };
    let groups: Vec<_> = names.iter().map(group).collect();
    match bound.len() {
        0 => String::new(),
        1 => format!(" At the end of what is admissible lies the {}.", groups[0]),
        _ => format!(
            " At the end of what is admissible lie the {}.",
            groups.join("; the ")
        ),
    }
}

/// "A", "A and B", or "A, B and 9 more".
fn listed(owners: &[String]) -> String {
    match owners {
        [] => String::new(),
        [one] => one.clone(),
        [one, two] => format!("{one} and {two}"),
        [one, two, rest @ ..] => format!("{one}, {two} and {} more", rest.len()),
    }
}

/// A parameter's name in words; one that has none keeps its name with the unit.
fn in_words(name: &str) -> &str {
    match name {
        "contact_zero_mm" => "depth at which contact begins",
        "repeat_gain" | "gain" => "gain",
        "force_zero_n" => "force at rest",
        "counts_per_kpa" => "counts per kPa",
        "pose_x_mm" | "pose_y_mm" | "pose_turn_rad" => "mat's place",
        "scan_x_mm" | "scan_y_mm" | "scan_z_mm" => "scan's place",
        "scan_turn_x_rad" | "scan_turn_y_rad" | "scan_turn_z_rad" => "scan's turn",
        name => name,
    }
}
