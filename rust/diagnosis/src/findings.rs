//! Types of a diagnosis: verdict, findings with numbers, place and time, rivals, and the suggested recording.

use crate::track_record::Confidence;
use crate::unlisted_finding::Unlisted;
use thenar_comparison::Comparison;
use thenar_inference::number_format::number;
use thenar_inference::selection::cross_validation::Gain;

/// The answer in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The study's own parameters explain the recordings.
    NothingMissing,
    /// Other parameters do.
    Parameters,
    /// The instrument is off.
    Instrument,
    /// Physics is missing.
    MissingPhysics,
    /// Several names explain the recordings alike.
    CannotTell,
    /// Something is missing that no listed name explains.
    Unlisted,
    /// Too little was recorded.
    InsufficientData,
}

impl Verdict {
    /// The word of findings.json.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::NothingMissing => "nothing_missing",
            Verdict::Parameters => "parameters",
            Verdict::Instrument => "instrument",
            Verdict::MissingPhysics => "missing_physics",
            Verdict::CannotTell => "cannot_tell",
            Verdict::Unlisted => "unlisted",
            Verdict::InsufficientData => "insufficient_data",
        }
    }
}

/// A number with its 90 % interval, by the profile likelihood or, of the outer time constants, the standard error.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// Name in the catalogue, with its unit.
    pub name: &'static str,
    /// Value with which the effect is switched on; where the interval is open no estimate.
    pub value: f64,
    /// Ends of the interval; infinite where the recordings do not bound the number on that side.
    pub interval: (f64, f64),
    /// Unit.
    pub unit: &'static str,
}

impl Number {
    /// Whether recordings bound it on both sides.
    pub fn is_bounded(&self) -> bool {
        self.interval.0.is_finite() && self.interval.1.is_finite()
    }

    /// The value, or a dash where it is no estimate; the interval or the bound; and the unit if it has one.
    pub fn in_words(&self) -> (String, String, &'static str) {
        let (low, high) = self.interval;
        let between = match (low.is_finite(), high.is_finite()) {
            (true, true) if low < high => format!("{} to {}", number(low), number(high)),
            (true, true) => "not fitted".to_owned(),
            (true, false) => format!("at least {}", number(low)),
            (false, true) => format!("at most {}", number(high)),
            (false, false) => "not determined".to_owned(),
        };
        let value = match self.is_bounded() {
            true => number(self.value),
            false => "\u{2013}".to_owned(),
        };
        let is_known = low.is_finite() || high.is_finite();
        let has_unit = is_known && self.unit != "1";
        (value, between, if has_unit { self.unit } else { "" })
    }
}

/// Where a finding is.
#[derive(Debug, Clone, PartialEq)]
pub struct Where {
    /// Name of the site.
    pub site: String,
    /// Name of the skin's region, where the study has regions.
    pub region: Option<String>,
    /// Point of the skin, mm.
    pub center_mm: Option<[f64; 3]>,
    /// mm.
    pub radius_mm: Option<f64>,
    /// Area of the sensels that hold the center with a probability of 90 %, mm2; of places that a mat found.
    pub area_90_mm2: Option<f64>,
    /// Vertices of the skin.
    pub vertices: Vec<u32>,
}

/// When a finding shows most.
#[derive(Debug, Clone, PartialEq)]
pub struct When {
    /// Recordings in which it shows, the clearest first.
    pub recordings: Vec<String>,
    /// Phase in which most of its evidence stands: load, hold, unload, slide or rest.
    pub phase: &'static str,
    /// s.
    pub time_s: [f64; 2],
    /// mm.
    pub depth_mm: [f64; 2],
    /// From 0.
    pub cycles: [u32; 2],
}

/// One effect that is named.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name in the catalogue.
    pub effect: &'static str,
    /// "tissue" or "instrument".
    pub kind: &'static str,
    /// What it was found in: "force" over depth, "tangential_force" or "map".
    pub channel: &'static str,
    /// How often such findings are right.
    pub confidence: Confidence,
    /// Its numbers.
    pub numbers: Vec<Number>,
    /// Where.
    pub place: Option<Where>,
    /// When.
    pub when: Option<When>,
    /// What it depends on.
    pub depends_on: Vec<&'static str>,
    /// Signs that must show in the recordings if it is there, and whether they do.
    pub consequences: Vec<(String, bool)>,
}

/// An explanation that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Rival {
    /// Names.
    pub effects: Vec<&'static str>,
    /// Logarithm of its evidence over that of the base, nats.
    pub evidence: f64,
    /// Probability among all that was tried.
    pub probability: f64,
    /// Part of the misfit that repeats share which it leaves.
    pub left: f64,
    /// Fall of the deviance by phase: load, hold, unload, rest.
    pub ledger: [f64; 4],
}

/// A recording that would settle what cannot be told.
#[derive(Debug, Clone, PartialEq)]
pub struct Suggestion {
    /// In words.
    pub text: String,
    /// Name of the indenter in the study, if it is one of them.
    pub indenter: Option<String>,
    /// Its radius, mm.
    pub radius_mm: Option<f64>,
    /// Name of an indenter in use that is pressed in turn with it in the same way, as often.
    pub in_turn_with: Option<String>,
    /// Name of the site.
    pub site: String,
    /// mm/s.
    pub speed_mm_s: f64,
    /// s.
    pub hold_s: f64,
    /// Loadings.
    pub cycles: u32,
    /// Largest depth, mm.
    pub depth_mm: f64,
    /// How often each press is to be made.
    pub presses: u32,
    /// The names it settles between.
    pub settles: Vec<&'static str>,
    /// How often it would settle the matter, as the two explanations predict it; None where they do not.
    pub probability: Option<f64>,
    /// Time that all its presses take, with the rest before each, minutes.
    pub minutes: f64,
}

impl Suggestion {
    /// How often it would settle the matter, and how long it takes, in words.
    pub fn outlook(&self) -> String {
        let chance = self.probability.map_or(String::new(), |p| {
            format!("settles it in {:.0} % of cases, ", 100.0 * p)
        });
        format!("{chance}takes about {:.0} minutes", self.minutes)
    }
}

/// A curve before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the recording.
    pub recording: String,
    /// s.
    pub time_s: Vec<f64>,
    /// mm.
    pub depth_mm: Vec<f64>,
    /// N, measured.
    pub measured_n: Vec<f64>,
    /// N, with parameters alone.
    pub before_n: Vec<f64>,
    /// N, with what was found.
    pub after_n: Vec<f64>,
}

/// An effect as the model takes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Switched {
    /// Name.
    pub name: &'static str,
    /// Amplitude.
    pub amplitude: f64,
    /// Shape numbers by name.
    pub numbers: Vec<(&'static str, f64)>,
    /// Choices by name.
    pub choices: Vec<(&'static str, &'static str)>,
}

impl Diagnosis {
    /// What an effect that was found is to be switched on with: choices by name.
    pub fn choices(&self, effect: &str) -> &[(&'static str, &'static str)] {
        let own = self.effects.iter().find(|e| e.name == effect);
        own.map_or(&[], |e| &e.choices)
    }
}

/// All that a diagnosis says.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The comparison with parameters alone.
    pub comparison: Comparison,
    /// The verdict.
    pub verdict: Verdict,
    /// What a designer reads first.
    pub sentence: String,
    /// What is named.
    pub findings: Vec<Finding>,
    /// What is known of something that has no name; None where nothing is missing or it has one.
    pub unlisted: Option<Unlisted>,
    /// Sets of names kept at 90 %.
    pub names_90: Vec<Vec<&'static str>>,
    /// Effects that are suspected and not named: they explain more than noise would, and a gate refused them. With insufficient data the noise
    /// is not known and no gate was asked: what one would look at first. Friction of a single slide passes no gate either.
    pub suspected: Vec<&'static str>,
    /// Whether recordings differ by more than their noise although nothing is named; always so of what is unlisted or cannot be distinguished.
    pub is_more_than_noise: bool,
    /// Pairs that cannot be told apart.
    pub cannot_tell: Vec<[&'static str; 2]>,
    /// Predictions of what was held out; None where nothing is named.
    pub gain: Option<Gain>,
    /// Smallest size of each effect that would have been seen: name, value (None: none that can be), unit.
    pub smallest_seen: Vec<(&'static str, Option<f64>, &'static str)>,
    /// What to record next.
    pub record_next: Vec<Suggestion>,
    /// Fitted moduli: region, G0 and Glim in MPa.
    pub materials: Vec<(String, f64, f64)>,
    /// Effects as the model takes them.
    pub effects: Vec<Switched>,
    /// What was tried, best first.
    pub rivals: Vec<Rival>,
    /// Before and after.
    pub curves: Vec<Curve>,
    /// Numbers behind the verdict: name and value.
    pub evidence: Vec<(&'static str, f64)>,
    /// What a reader should be told besides.
    pub notes: Vec<String>,
}
