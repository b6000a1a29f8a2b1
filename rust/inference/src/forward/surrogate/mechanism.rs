//! Mechanisms that the surrogate can add to its base model: laws, parameter counts, starts and null values.

use thenar_contact::effects::Effect;

use crate::forward::surrogate::relaxation_spectrum::Spectrum;

/// A mechanism as the surrogate models it; its free numbers stand in the vector of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// Name in the catalogue.
    pub effect: Effect,
    /// How it acts.
    pub law: Law,
}

/// How a mechanism acts on the force.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// Load that fades by a clock.
    Relaxation {
        /// What drives it.
        clock: Clock,
        /// Branches, and what of them is free.
        spectrum: Spectrum,
    },
    /// Stiffness lost with loading travel (mm) and regained in rest (s); the share is free.
    Softening {
        /// Travel after which 63 % is lost, mm.
        travel_mm: f64,
        /// Time without load after which 63 % has come back, s.
        recovery_s: f64,
        /// What a recording begins with.
        start: UseAtStart,
    },
    /// Skin that clings takes off a force in proportion to the area that was touched, as gaps open where it touched, and until it lets
    /// go; the force on the largest contact is free, over the study's largest force, and the logarithm of the grip's range over the
    /// largest depth.
    Adhesion {
        /// Depth at which it lets go of the largest tool, over the largest depth; negative: above the skin.
        lets_go: f64,
    },
    /// A tabulated change of the response, by the number of its table; its coordinate is free.
    Tabulated(usize),
    /// The modulus grows with this measure by this law; its rate is free.
    Stiffening(DeformationMeasure, Growth),
    /// A free curve over depth: the logarithm of the stiffness at one of its knots; no candidate, but what candidates are held against.
    DepthCurve {
        /// From 0, at even depths as far as the study's largest.
        knot: usize,
    },
    /// Later recordings of the session read more or less by a factor; its logarithm is free.
    GainStep {
        /// First recording of the session that reads otherwise.
        from: usize,
    },
    /// One force more or less everywhere, N.
    Offset,
    /// A force that creeps from each recording's start as log(1 + t / time); its size is free, N.
    Drift {
        /// s.
        time_s: f64,
    },
    /// Readings bend over below a ceiling; its logarithm is free.
    Saturation(Stage),
    /// Readings below a floor are none; the floor over the smallest peak is free.
    Floor(Stage),
    /// The stage travels further than the tool, by this much per newton.
    Compliance,
    /// The force is stamped late, s.
    Delay,
}

/// Where in the chain a ceiling or a floor stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// After all that differs in gain from recording to recording: the same reading in all.
    Last,
    /// Before it, as in a sensor whose amplifier is set anew for each recording: the same force in all.
    First,
}

impl Stage {
    /// A limit as it reads in a recording of this gain.
    pub fn reads(self, limit: f64, gain: f64) -> f64 {
        match self {
            Stage::Last => limit,
            Stage::First => limit * gain,
        }
    }
}

/// What makes a load fade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clock {
    /// Time.
    Time,
    /// Time over the contact radius squared; periods are those at this radius, mm.
    Area {
        /// mm.
        reference_mm: f64,
    },
    /// Travel, mm.
    Travel,
}

/// What use has left behind where a recording begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UseAtStart {
    /// Nothing: the tissue has rested.
    Rested,
    /// The loading travel of the protocols before; repeats of a protocol begin alike.
    AfterProtocols,
    /// The loading travel of all recordings before.
    AfterRecordings,
}

/// Knots of a free curve over depth; neither first touch nor the largest depth is one, which parameters take up.
pub(crate) const KNOTS: usize = 7;

/// With what a modulus grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeformationMeasure {
    /// Depth over the study's largest.
    Depth,
    /// Contact radius over the largest that a tool of the study reaches, per tool radius: the strain a/R, over its largest.
    Strain,
}

/// How a modulus grows with its measure x, of the laws of the effect `stiffening_law`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Growth {
    /// `exp(rate x)`.
    Exponential,
    /// `1 + rate x^2`: the first terms of an exponential of the strain's energy, as Fung has it.
    Square,
}

impl Growth {
    /// Its name among the laws of the effect.
    pub fn law(self) -> &'static str {
        match self {
            Growth::Exponential => "exponential",
            Growth::Square => "power",
        }
    }

    /// Logarithm of the modulus over that at x = 0.
    pub fn log(self, rate: f64, x: f64) -> f64 {
        match self {
            Growth::Exponential => rate * x,
            Growth::Square => libm::log1p(rate * x * x),
        }
    }

    /// The x that the effect's law takes for 1 (its reference); the power law's exponent is the catalogue's own, 2.
    pub fn reference(self, rate: f64) -> f64 {
        let way = match self {
            Growth::Exponential => rate,
            Growth::Square => rate.max(0.0).sqrt(),
        };
        1.0 / way.max(0.01)
    }
}

impl Mechanism {
    /// Number of free numbers.
    pub fn count(&self) -> usize {
        match &self.law {
            Law::Relaxation { spectrum, .. } => spectrum.count(),
            Law::Adhesion { .. } => 2,
            _ => 1,
        }
    }

    /// Where else a fit begins: that of a smooth spectrum or of a stiff skin may end in a hollow of its own, 1 to 6 nats above the
    /// deepest, a ceiling that no reading meets does not tell where it is, and a floor is told only by the readings beside it, of which
    /// `least` is the least that stands out of the noise, over the smallest peak.
    pub fn starts(&self, least: f64) -> Vec<Vec<f64>> {
        let fixed: &[&[f64]] = match &self.law {
            Law::Relaxation {
                spectrum: Spectrum::Smooth { .. },
                ..
            } => &STARTS,
            Law::Saturation(_) => &CEILINGS,
            Law::Floor(_) => return FLOORS.map(|part| vec![part * least]).to_vec(),
            Law::Tabulated(_) if self.effect == Effect::StiffSkin => &SKINS,
            _ => &[],
        };
        fixed.iter().map(|start| start.to_vec()).collect()
    }

    /// The number with which it does nothing, where it has but one and there is such a number; a ceiling so high that nothing meets it.
    pub fn nothing(&self) -> Option<f64> {
        match self.law {
            Law::Floor(_) | Law::Relaxation { .. } | Law::Adhesion { .. } => None,
            Law::Saturation(_) => Some(HIGHEST),
            _ => Some(0.0),
        }
    }

    /// Numbers that a fit can make use of: shares of neighboring branches stand for each other, and none is below 0.
    pub fn effective_parameters(&self) -> usize {
        self.count().min(3)
    }

    /// True for what a single loading at one speed can show: there, time and depth grow together.
    pub(crate) fn shows_in_loading(&self) -> bool {
        matches!(
            self.law,
            Law::Tabulated(_)
                | Law::Stiffening(..)
                | Law::Offset
                | Law::Saturation(_)
                | Law::Floor(_)
                | Law::Compliance
        )
    }

    /// True for what belongs to the instrument.
    pub fn is_instrument(&self) -> bool {
        self.effect.entry().is_instrument()
    }

    /// True where a recording's gain is a factor on all that is read of it.
    pub(crate) fn is_read_in_proportion(&self) -> bool {
        !self.is_instrument() || matches!(self.law, Law::GainStep { .. })
    }
}

/// What the scales of a study are, from which variants are chosen.
#[derive(Debug, Clone, Copy)]
pub struct Scales {
    /// Largest depth, mm.
    pub deepest: f64,
    /// Contact radius between those that the tools reach (their geometric mean), mm.
    pub radius: f64,
    /// Smallest peak force and largest, N.
    pub forces: (f64, f64),
    /// Whether the response can be tabulated with another thickness.
    pub has_bone: bool,
    /// Whether some tools are spheres, so that strain means something.
    pub has_strain: bool,
    /// Whether use may be carried from recording to recording (`force_recording::carries_use`).
    pub carries_use: bool,
}

/// Smallest and largest median period of a spectrum in time, s: what recordings show, and a little beyond.
pub(crate) const MEDIANS_S: (f64, f64) = (0.02, 40.0);
/// Widths of a spectrum in time, in nats of the period: of tissue, and of what drains; the smallest is hardly more than a single time.
///
/// A half-space drains as Hu et al. (2010) give it, whose curve such a spectrum of width 1.2 meets within 2.5 % of the drop; a layer
/// bounds the way of what leaves, and with it the slow part.
pub(crate) const WIDTHS: [(f64, f64); 2] = [(0.05, 3.0), (0.05, 1.2)];
/// Further starts of a smooth spectrum's numbers: narrow and fast, narrow and slow, broad.
const STARTS: [&[f64]; 3] = [&[0.1, -1.5, 0.5], &[0.1, 1.0, 0.5], &[0.1, 1.0, 2.5]];
/// Largest logarithm of a ceiling over the largest force.
pub(crate) const HIGHEST: f64 = 0.7;
/// Further starts of the logarithm of a ceiling over the largest force.
const CEILINGS: [&[f64]; 3] = [&[-0.03], &[-0.3], &[-0.8]];
/// Further starts of a floor, over the least reading that stands out of the noise, which may be noise itself.
const FLOORS: [f64; 5] = [0.75, 0.87, 1.0, 1.15, 1.32];
/// Further starts of a stiff skin's coordinate.
const SKINS: [&[f64]; 2] = [&[2.0], &[3.5]];

/// Smallest and largest range of a grip, over the largest depth.
pub(crate) const RANGES: (f64, f64) = (0.01, 0.5);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::candidate_model::Model;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::least_squares::surrogate_fit::refit;
    use crate::observe::measured::Phase;
    use crate::selection::candidates::singles;

    /// As `thenar_contact::effects::stiffening_law` has its laws: `exp(x / r)` and `1 + (x / r)^2`, r its reference.
    #[test]
    fn stiffening_equals_the_law_of_the_contact_model() {
        for (rate, x) in [(0.3, 0.5), (1.7, 0.9)] {
            let square = Growth::Square;
            let wanted = 1.0 + (x / square.reference(rate)).powi(2);
            assert!((libm::exp(square.log(rate, x)) / wanted - 1.0).abs() < 1e-12);
            let plain = Growth::Exponential;
            assert!((plain.log(rate, x) - x / plain.reference(rate)).abs() < 1e-12);
        }
        let laws = &Effect::StiffeningLaw.entry().choices[0];
        for growth in [Growth::Exponential, Growth::Square] {
            assert!(laws.options.contains(&growth.law()));
        }
    }

    /// A start has a number for each that is free; a stiff skin is sought among soft ones, as a fit by itself does, and stiff ones.
    #[test]
    fn starts_match_the_parameter_count_and_spread_for_stiff_skin() {
        let tried = singles(Scales {
            deepest: 1.0,
            radius: 1.0,
            forces: (1.0, 1.0),
            has_bone: true,
            has_strain: true,
            carries_use: true,
        });
        for mechanism in &tried {
            let count = mechanism.count();
            assert!(mechanism.starts(0.1).iter().all(|s| s.len() == count));
        }
        let skin = tried
            .iter()
            .find(|m| m.effect == Effect::StiffSkin)
            .unwrap();
        let stretches: Vec<usize> = skin.starts(0.1).iter().map(|s| s[0] as usize).collect();
        assert_eq!(stretches, [2, 3], "a fit by itself begins in the first");
    }

    /// Load that fades by travel on a spring, loaded and unloaded: `x' = d' - x |d'| / length`, in closed form.
    fn rubbed(deepest: f64, length: f64, share: f64) -> Vec<Reading> {
        let way = (0..=160).map(|k| f64::from(k) / 80.0 * deepest);
        let read = |way: f64| {
            let up = (way - deepest).max(0.0);
            let depth = way - 2.0 * up;
            let last = length * (1.0 - libm::exp(-way.min(deepest) / length));
            let left = (last + length) * libm::exp(-up / length) - length;
            let left = if up > 0.0 { left } else { last };
            let force = 10.0 * (depth - share * (depth - left)).max(0.0);
            let phase = if up > 0.0 { Phase::Unload } else { Phase::Load };
            (way, depth, phase, force)
        };
        way.map(read).collect()
    }

    /// Lengths between those that are modeled, and beyond, from a twentieth of the largest depth to five times as much.
    #[test]
    fn travel_spectrum_fits_any_friction_length() {
        let deepest = 2.0;
        for over in [0.05, 0.08, 0.2, 0.4, 0.8, 1.3, 2.0, 3.0, 5.0] {
            let readings = rubbed(deepest, over * deepest, 0.4);
            let most = readings.iter().fold(0.0, |m, r| f64::max(m, r.3));
            let punch = tool(deepest, |depth| 10.0 * depth, |_| 1.0);
            let (ready, _) = ready(vec![punch], &[(0, readings.clone())], 1e-3 * most);
            let surrogate = ready.surrogate();
            let mut all = singles(ready.scales);
            all.retain(|m| m.effect == Effect::RateIndependentLoss);
            let found = refit(&surrogate, &Model::new(&surrogate, &all), &[]);
            let pairs = found.simulated.iter().zip(&readings);
            let squares: f64 = pairs.map(|(s, r)| (s - r.3).powi(2)).sum();
            let rms = (squares / readings.len() as f64).sqrt();
            assert!(rms < 4e-3 * most, "{over}: {rms} N of {most} N");
        }
    }
}
