//! Words for effects, variables and phases of a protocol, as findings name them.

use thenar_inference::observe::measured::Phase;

/// Words for an effect.
pub fn effect_in_words(effect: &str) -> String {
    match effect {
        "bone" => "a thicker or thinner tissue over the bone".into(),
        "stiff_skin" => "a stiff skin over soft pulp".into(),
        "stiffening_law" => "tissue that stiffens in another way than given".into(),
        "inclusion" => "a place that is stiffer or softer".into(),
        "compressibility" => "tissue that gives up volume".into(),
        "drift" => "drift of the sensor".into(),
        "offset" => "a zero error of the sensor".into(),
        "gain" => "a step in the sensor's gain".into(),
        "saturation" => "a sensor that saturates".into(),
        "threshold" => "a sensor that is blind to small forces".into(),
        "timing" => "a clock that is late".into(),
        "relaxation" => "relaxation of the tissue".into(),
        "drainage" => "drainage of fluid from the tissue".into(),
        "rate_independent_loss" => "an energy loss that does not depend on speed".into(),
        "cycle_softening" => "softening by repeated presses".into(),
        "adhesion" => "adhesion of the skin to the tool".into(),
        "fixture_compliance" => "compliance of the fixture".into(),
        "dead_cells" => "dead cells of the mat".into(),
        other => other.replace('_', " "),
    }
}

/// A phase as a person would say it.
pub fn phase_in_words(phase: &str) -> &str {
    match phase {
        "load" => "while pressing in",
        "hold" => "while holding",
        "slide" => "while sliding",
        "unload" => "while letting go",
        _ => "at rest",
    }
}

/// A phase's name in findings.json.
pub fn phase_name(of: Phase) -> &'static str {
    PHASES[phase_number(of)]
}

pub(crate) fn phase_number(phase: Phase) -> usize {
    match phase {
        Phase::Load => 0,
        Phase::Hold | Phase::Slide => 1,
        Phase::Unload => 2,
        Phase::Apart => 3,
    }
}

pub(crate) const PHASES: [&str; 4] = ["load", "hold", "unload", "rest"];

/// A variable as a person would say it.
pub fn variable_in_words(variable: &str) -> &str {
    match variable {
        "contact_radius" => "the size of the contact",
        "time" => "time in contact",
        "cycle" => "the count of presses",
        "rate" => "speed",
        _ => variable,
    }
}
