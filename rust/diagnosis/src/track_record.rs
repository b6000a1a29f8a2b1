//! Track record: how often findings of a kind were right on studies whose truth is known, and what a posterior is worth by it.
//!
//! The counts stand in `track_record.csv`, by world. `tests/trial/worlds/track_record.py` makes it from calibration studies; no scored study is in it.

/// The counts: lines `kind,posterior_from,world,right,stated`; lines that begin with `#` say what made them.
const COUNTS: &str = include_str!("track_record.csv");
/// Fewest findings of which a frequency is given.
const FEWEST: u32 = 10;
/// One-sided 95 % bound, standard deviations.
const Z: f64 = 1.645;

/// What a finding was found in: findings of one kind share a track record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// One effect of the skin, from force over depth; whether the form of the model is known (flat skin, half space).
    Skin(Form),
    /// One fault of the instrument, from force over depth.
    Instrument(Form),
    /// One of two, from force over depth.
    OneOfTwo(Form),
    /// A place that maps show.
    Place,
    /// Friction, from slides.
    Slide,
    /// A ceiling at which the cells of a mat clip.
    MatCeiling,
    /// A gain of a mat, from its sum against the load cell.
    MatGain,
    /// A cause in the skin, from a grasp.
    GraspSkin,
    /// A fault of mat or force sensor, from a grasp.
    GraspInstrument,
}

/// Whether the form of the model is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// On flat skin and on a half space.
    Known,
    /// On round skin over bone: as far as it was measured.
    Measured,
}

impl Kind {
    /// The word of the table and of findings.json.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Skin(Form::Known) => "skin_form_known",
            Kind::Skin(Form::Measured) => "skin_form_measured",
            Kind::Instrument(Form::Known) => "instrument_form_known",
            Kind::Instrument(Form::Measured) => "instrument_form_measured",
            Kind::OneOfTwo(Form::Known) => "one_of_two_form_known",
            Kind::OneOfTwo(Form::Measured) => "one_of_two_form_measured",
            Kind::Place => "place",
            Kind::Slide => "slide",
            Kind::MatCeiling => "mat_ceiling",
            Kind::MatGain => "mat_gain",
            Kind::GraspSkin => "grasp_skin",
            Kind::GraspInstrument => "grasp_instrument",
        }
    }
}

/// How sure a finding is: a posterior under the model's assumptions, and what such posteriors were worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence {
    /// Probability under the model, 0 to 1.
    pub posterior: f64,
    /// Kind of finding.
    pub kind: Kind,
    /// Findings of this kind with such a posterior; None: too few for a frequency.
    pub record: Option<Record>,
}

/// Findings of one kind and range of posteriors on studies of known truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// Those that were right.
    pub right: u32,
    /// All.
    pub stated: u32,
    /// Share that is right, at least: the lower bound of all worlds together, and no more than the share in the worst world.
    pub at_least: f64,
}

impl Confidence {
    /// Looks up what a posterior is worth for findings of this kind.
    pub fn new(posterior: f64, kind: Kind) -> Confidence {
        Confidence {
            posterior,
            kind,
            record: record(COUNTS, kind.word(), posterior),
        }
    }

    /// Frequency with which such findings are right, at least, and no more than the posterior; None where it was not measured.
    pub fn frequency(&self) -> Option<f64> {
        self.record
            .map(|record| record.at_least.min(self.posterior))
    }

    /// In words.
    pub fn in_words(&self) -> String {
        match self.frequency() {
            Some(share) => format!("at least {:.0} % of such findings are right", 100.0 * share),
            None => "confidence not measured".to_owned(),
        }
    }
}

fn record(counts: &str, kind: &str, posterior: f64) -> Option<Record> {
    let lines: Vec<(f64, u32, u32)> = counts
        .lines()
        .filter_map(|line| line_of(line, kind))
        .collect();
    let of = |line: &&(f64, u32, u32)| line.0 <= posterior;
    let from = lines
        .iter()
        .filter(of)
        .map(|line| line.0)
        .reduce(f64::max)?;
    let worlds = || lines.iter().filter(|line| line.0 == from);
    let (right, stated) = worlds().fold((0, 0), |sum, line| (sum.0 + line.1, sum.1 + line.2));
    if stated < FEWEST {
        return None;
    }
    let judged = worlds().filter(|line| line.2 >= FEWEST);
    let worst = judged.map(|line| f64::from(line.1) / f64::from(line.2));
    let at_least = worst.fold(lower_bound(right, stated), f64::min);
    Some(Record {
        right,
        stated,
        at_least,
    })
}

/// `posterior_from`, right and stated of a line of this kind.
fn line_of(line: &str, kind: &str) -> Option<(f64, u32, u32)> {
    let mut fields = line.split(',');
    if fields.next()? != kind {
        return None;
    }
    let from = fields.next()?.parse().ok()?;
    let _world = fields.next()?;
    Some((
        from,
        fields.next()?.parse().ok()?,
        fields.next()?.parse().ok()?,
    ))
}

/// One-sided 95 % lower bound of a share (Wilson 1927).
fn lower_bound(right: u32, stated: u32) -> f64 {
    let (n, share) = (f64::from(stated), f64::from(right) / f64::from(stated));
    let middle = share + Z * Z / (2.0 * n);
    let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    ((middle - half) / (1.0 + Z * Z / n)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MADE: &str =
        "# made\nskin,0,a,3,9\nskin,0.9,a,40,40\nskin,0.9,b,18,20\nother,0.9,a,2,3\n";

    #[test]
    fn a_frequency_is_that_of_its_range_and_no_more_than_the_worst_world_has() {
        let high = record(MADE, "skin", 0.99).expect("60 findings");
        assert_eq!((high.right, high.stated), (58, 60));
        // Wilson's bound of 58 of 60 is 0.904; the second world has 0.9.
        assert!((high.at_least - 0.9).abs() < 1e-12);
        // 9 findings with a lower posterior, 3 of another kind, none of a third.
        assert_eq!(record(MADE, "skin", 0.7), None);
        assert_eq!(record(MADE, "other", 0.95), None);
        assert_eq!(record(MADE, "third", 0.95), None);
    }

    #[test]
    fn bound_is_where_the_score_test_rejects() {
        for (right, stated) in [(10, 10), (58, 60), (5, 20)] {
            let (low, n) = (lower_bound(right, stated), f64::from(stated));
            let z = (f64::from(right) / n - low) / (low * (1.0 - low) / n).sqrt();
            assert!((z - Z).abs() < 1e-9, "{right} of {stated}: {z}");
        }
    }

    #[test]
    fn what_is_shown_is_capped_by_the_posterior_and_said_in_words_where_nothing_is_known() {
        let of = |posterior, at_least| Confidence {
            posterior,
            kind: Kind::Place,
            record: Some(Record {
                right: 49,
                stated: 50,
                at_least,
            }),
        };
        assert_eq!(of(0.6, 0.9).frequency(), Some(0.6));
        assert_eq!(of(0.99, 0.9).frequency(), Some(0.9));
        let unknown = Confidence {
            record: None,
            ..of(0.99, 0.9)
        };
        assert!(unknown.frequency().is_none() && !unknown.in_words().contains('%'));
    }

    #[test]
    fn every_line_of_the_counts_is_read() {
        let lines: Vec<&str> = COUNTS.lines().filter(|l| !l.starts_with('#')).collect();
        for line in &lines {
            let kind = line.split(',').next().unwrap();
            let (from, right, stated) = line_of(line, kind).expect(line);
            assert!(
                (0.0..1.0).contains(&from) && right <= stated && stated > 0,
                "{line}"
            );
        }
        assert!(!lines.is_empty());
    }
}
