//! A candidate model: base plus mechanisms, with its parameters and their values by what they belong to.

use crate::forward::surrogate::mechanism::{HIGHEST, Law, MEDIANS_S, Mechanism, RANGES};
use crate::forward::surrogate::relaxation_spectrum::Spectrum;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::forward::tables::form_ways::WAYS;
use crate::parameters::priors::SHARED;
use crate::parameters::surrogate_parameter::{Coordinate, Kind};

/// A model that is screened: what is added to the base.
pub struct Model<'a> {
    /// Mechanisms.
    pub mechanisms: &'a [Mechanism],
    /// All free numbers: the shared ones, then those of the mechanisms.
    pub coordinates: Vec<Coordinate>,
}

impl<'a> Model<'a> {
    /// The base with `mechanisms`.
    pub fn new(surrogate: &Surrogate<'_>, mechanisms: &'a [Mechanism]) -> Model<'a> {
        let mut coordinates = surrogate.shared.clone();
        for (number, mechanism) in mechanisms.iter().enumerate() {
            for k in 0..mechanism.count() {
                let (start, low, high) = range(surrogate, mechanism, k);
                coordinates.push(Coordinate {
                    kind: Kind::Of(number, k),
                    start,
                    bounds: (low, high),
                    prior: None,
                    step: 1e-3 * (high - low).min(1.0),
                });
            }
        }
        Model {
            mechanisms,
            coordinates,
        }
    }

    /// The numbers by what they belong to.
    pub fn setting(&self, surrogate: &Surrogate<'_>, at: &[f64]) -> Setting {
        let (places, courses) = (surrogate.elastic.places.len(), surrogate.courses.len());
        let mut set = Setting {
            first: 0.0,
            limit: 0.0,
            scale: vec![0.0; places],
            touch: vec![0.0; places],
            zero: vec![0.0; courses],
            gain: vec![0.0; courses],
            force_zero: vec![0.0; courses],
            stand: vec![Vec::new(); courses],
            form: vec![[0.0; WAYS]; places],
            shared_form: vec![[0.0; SHARED]; places],
            of: vec![Vec::new(); self.mechanisms.len()],
        };
        for (coordinate, value) in self.coordinates.iter().zip(at) {
            match coordinate.kind {
                Kind::First => set.first = libm::exp(*value),
                Kind::Limit => set.limit = libm::exp(*value),
                Kind::Scale(place) => set.scale[place] = *value,
                Kind::Touch(place) => set.touch[place] = *value,
                Kind::Zero(course) => set.zero[course] = *value,
                Kind::Gain(course) => set.gain[course] = *value,
                Kind::ForceZero(course) => set.force_zero[course] = *value,
                Kind::Stand(course, _) => set.stand[course].push(*value),
                Kind::Form(place, mode) => set.form[place][mode] = *value,
                Kind::SharedForm(site, form) => set.shared_form[site][form] = *value,
                Kind::Of(mechanism, _) => set.of[mechanism].push(*value),
            }
        }
        set
    }
}

/// The free numbers of a model by what they belong to.
#[derive(Clone)]
pub struct Setting {
    /// Modulus at first touch, MPa.
    pub first: f64,
    /// Modulus where it stops growing, MPa.
    pub limit: f64,
    /// Logarithm of a factor on all loads, by place.
    pub scale: Vec<f64>,
    /// First touch by place, mm.
    pub touch: Vec<f64>,
    /// First touch about that by course, mm.
    pub zero: Vec<f64>,
    /// Logarithm of the gain by course.
    pub gain: Vec<f64>,
    /// Zero of the force by course, N.
    pub force_zero: Vec<f64>,
    /// What the depths of its stands are off by, by course, mm; none where depths are not rounded.
    pub stand: Vec<Vec<f64>>,
    /// What the model's form is off by, by place.
    pub form: Vec<[f64; WAYS]>,
    /// Sizes of the forms that tools share, by site.
    pub shared_form: Vec<[f64; SHARED]>,
    /// By mechanism.
    pub of: Vec<Vec<f64>>,
}

/// Range of a grip at which a fit begins, over the largest depth.
const RANGE: f64 = 0.1;

/// Start and bounds of a mechanism's number.
fn range(surrogate: &Surrogate<'_>, mechanism: &Mechanism, number: usize) -> (f64, f64, f64) {
    let (force, depth) = surrogate.most;
    match &mechanism.law {
        Law::Relaxation {
            spectrum: Spectrum::Smooth { widths },
            ..
        } if number > 0 => match number {
            1 => (0.0, libm::log(MEDIANS_S.0), libm::log(MEDIANS_S.1)),
            _ => (1.0, widths.0, widths.1),
        },
        Law::Relaxation {
            spectrum: Spectrum::Beside { widths, at },
            ..
        } if number > 0 => match number {
            1 => {
                let off = at * widths.1;
                let (low, high) = (libm::log(MEDIANS_S.0), libm::log(MEDIANS_S.1));
                (0.0, low + off.min(0.0), high + off.max(0.0))
            }
            _ => (1.0, widths.0, widths.1),
        },
        Law::Relaxation {
            spectrum: Spectrum::Portions(_),
            ..
        } => match number {
            0 => (0.03, 0.0, 0.99),
            _ => (0.5, 0.0, 1.0),
        },
        Law::Relaxation { .. } => (0.03, 0.0, 0.6),
        Law::Softening { .. } => (0.1, 0.0, 0.9),
        Law::Adhesion { .. } if number > 0 => {
            (libm::log(RANGE), libm::log(RANGES.0), libm::log(RANGES.1))
        }
        Law::Adhesion { .. } => (0.01, 0.0, 0.6),
        Law::Tabulated(form) => match surrogate.elastic.variant(mechanism.effect, *form) {
            Some(v) => {
                let (low, high) = (v.knots[0], v.knots[v.knots.len() - 1]);
                (0.1 * high, low, high)
            }
            None => (0.0, 0.0, 0.0),
        },
        Law::Stiffening(..) => (0.1, 0.0, 4.0),
        Law::GainStep { .. } | Law::DepthCurve { .. } => (0.0, -0.7, 0.7),
        Law::Offset => (0.0, -0.3 * force, 0.3 * force),
        Law::Drift { .. } => (0.0, -0.3 * force, 0.3 * force),
        Law::Saturation(_) => (-0.1, -2.0, HIGHEST),
        Law::Floor(_) => (
            f64::max(0.1, 1.5 * surrogate.least_floor),
            surrogate.least_floor,
            0.9,
        ),
        Law::Compliance => (0.02 * depth / force, 0.0, 0.8 * depth / force),
        Law::Delay => (0.02, -0.5, 0.5),
    }
}
