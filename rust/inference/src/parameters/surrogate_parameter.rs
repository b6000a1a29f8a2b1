//! What the free numbers of the surrogate model are.

use crate::parameters::parameter::Parameter;

/// A free number of the candidate model.
pub type Coordinate = Parameter<Kind>;

/// By recording its own number of that kind; 0 where it has none.
pub fn by_recording(
    (coordinates, at): (&[Coordinate], &[f64]),
    recordings: usize,
    kind: fn(usize) -> Kind,
) -> Vec<f64> {
    let of = |course: usize| {
        let place = coordinates.iter().position(|c| c.kind == kind(course));
        place.map_or(0.0, |k| at[k])
    };
    (0..recordings).map(of).collect()
}

/// What a free number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Logarithm of the modulus at first touch.
    First,
    /// Logarithm of the modulus at the depth where it stops growing.
    Limit,
    /// Logarithm of a factor on all loads of a tool at its site.
    Scale(usize),
    /// First touch that a tool has in all its recordings, mm.
    Touch(usize),
    /// First touch of one recording about that, mm (number of the course).
    Zero(usize),
    /// Logarithm of one recording's gain.
    Gain(usize),
    /// Zero of one recording's force, N (number of the course).
    ForceZero(usize),
    /// What the depth of a stand is off by, mm: of a recording (number of the course) whose depths are rounded, number of the stand in it.
    Stand(usize, usize),
    /// Logarithm of the factor by which the model's form is off, by tool and way.
    Form(usize, usize),
    /// Size of a form that all tools at a site share, in standard deviations: by site and form (`priors::SHARED_FORM`).
    SharedForm(usize, usize),
    /// A number of a mechanism: which of the model's, which number.
    Of(usize, usize),
}

impl Kind {
    /// The recording (number of the course) that it is of alone.
    pub(crate) fn course(self) -> Option<usize> {
        match self {
            Kind::Zero(c) | Kind::Gain(c) | Kind::ForceZero(c) | Kind::Stand(c, _) => Some(c),
            _ => None,
        }
    }
}
