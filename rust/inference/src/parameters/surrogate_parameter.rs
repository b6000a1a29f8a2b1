//! A parameter of the surrogate model: what it is, where a fit begins, its bounds and its prior.

/// A free number of the candidate model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// What it is.
    pub kind: Kind,
    /// Where a fit begins.
    pub start: f64,
    /// Smallest and largest value.
    pub bounds: (f64, f64),
    /// Standard deviation about 0 before data are seen; None: anything within the bounds.
    pub prior: Option<f64>,
    /// Step of a finite difference.
    pub step: f64,
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
    /// Logarithm of the factor by which the model's form is off, by tool and way.
    Form(usize, usize),
    /// A number of a mechanism: which of the model's, which number.
    Of(usize, usize),
}
