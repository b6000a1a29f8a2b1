//! The table of priors: bounds and standard deviations of everything that a fit of the mesh model or of the surrogate may change.

use crate::forward::tables::form_ways::WAYS;
use crate::parameters::parameter::{Kind, Parameter};

/// Credible shear moduli of skin and what lies under it, MPa: from 0.4 kPa (hypodermis as C10 of 0.42 kPa gives 0.84; half of it) to 0.74 MPa
/// (subcutaneous Young's modulus of 2.2 MPa at 30 N over 3, Isogai 2022).
pub const MODULUS: (f64, f64) = (4e-4, 0.74);

/// A study that starts outside of them is not of skin: its bounds reach this factor beyond the start.
pub const BEYOND_START: f64 = 20.0;

/// Credible depths at which the modulus stops growing, mm, about the published 4 and 7 (Xie Eq. 3).
pub const LIMIT_DEPTH: (f64, f64) = (1.0, 15.0);

/// Credible thickness of soft tissue over bone in a hand, mm.
pub const THICKNESS: (f64, f64) = (1.0, 40.0);

/// Bounds of a modulus of the surrogate against the study's own, as logarithms.
pub const LOG_MODULUS: f64 = 3.0;

/// Standard deviation of the depth of first touch as an operator judges it, mm: a sphere-like pad of radius 8 mm and 8 kPa bears
/// 5 mN, a common trigger, at 0.1 mm (Hertz). A trigger is always late, an operator's eye or a tool's measured length may be early.
pub const TOUCH: f64 = 0.1;

/// Standard deviations of the noise from which there is a force at depth 0 already, so that first touch was judged late.
pub const CLEAR_AT_ZERO: f64 = 4.0;

/// Part of a recording's depth that first touch may be off by where it is read from the force.
pub const UNKNOWN_TOUCH: f64 = 0.15;

/// Part of a recording's depth by which first touch as it was judged may be off at most, in standard deviations.
pub const DEEPEST_TOUCH: f64 = 0.25;

/// First touch, and numbers of the surrogate, may lie this many standard deviations off.
pub const MOST: f64 = 6.0;

/// Gains, and the form of the mesh model, may lie this many standard deviations off.
pub const MOST_GAIN: f64 = 5.0;

/// Prior of a gain about 1, of the instrument or of one recording: the standard deviation `sd`, a part of 1, is the data sheet's, or what
/// repeats scatter by in proportion ([`crate::noise`]).
pub(crate) fn gain(kind: Kind, sd: f64) -> Parameter {
    Parameter::about(kind, (sd, MOST_GAIN), 1e-4)
}

/// Standard deviation of where a mat lies, mm, where the data sheet does not say; of where a scan lies that was laid on the skin.
pub const POSITION: f64 = 1.0;

/// Standard deviation of how a mat is turned, rad: 2 degrees, as mats that are taped on by hand; of a scan that was laid on the skin.
pub const TURN: f64 = 0.035;

/// A mat, a scan or the zero of a load cell may lie this many standard deviations off.
pub const MOST_POSITION: f64 = 4.0;

/// Standard deviation of a load cell's zero as a part of the largest force, where the recording itself had to tell it.
pub const FORCE_ZERO: f64 = 0.01;

/// Bounds of counts per kPa as logarithms.
pub const COUNTS: f64 = 12.0;

/// Standard deviation of the factor by which the model's form may be off, for each tool at each site, by way (`form_ways`): of a ball
/// on flat skin (`forward::tables::sphere`), of another tool there, over bone whose width is stated, and on round skin where it is not.
///
/// Against the finite elements of the calibration's flat pads without effects balls are off by 0.4 % in the whole, by 0.3 % in their tilt and
/// by 0.1 % in their bend, once the moduli took what all tools share (`python -m trial.finite_elements.against_ball`); tables from the mesh by more; on the
/// round fingertip of `tests/proof` the layer is off by up to 9 %.
pub const FORM_ERROR: [[f64; WAYS]; 4] = [
    [0.006, 0.006, 0.003, 0.02, 0.0, 0.0, 0.0],
    [0.01, 0.01, 0.004, 0.02, 0.0, 0.0, 0.0],
    [0.03, 0.03, 0.03, 0.05, 0.0, 0.0, 0.0],
    [0.05, 0.05, 0.03, 0.05, 0.0, 0.0, 0.0],
];

/// The same for each tool at a site alone, against which a name is held in the end (`selection::form_check`). On seven solids of pads over bone, stated
/// or not, plate, cylinder and sphere depart from their mean by 2 to 4 % (rms) in the whole and tilt, 2.8 % in their bend, 2, 1.6 and 0.8 % in the third to
/// fifth order, of which a part is the solids' own roughness under the sphere (`tests/proof/deep_pads/form_error.py`; not the pads of any trial).
pub const MEASURED_FORM: [f64; WAYS] = [0.05, 0.05, 0.03, 0.05, 0.015, 0.01, 0.005];

/// Number of forms that all tools at a site share.
pub const SHARED: usize = 3;

/// Part of the tissue's thickness to which those forms were measured.
pub const SHARED_DEPTH: f64 = 0.4;

/// Forms, of one standard deviation each, by which all tools at a site may be off alike: by way, over bone whose width is stated, and on round skin
/// where it is not. They round the main components of what was measured as [`MEASURED_FORM`] was; the whole is the moduli's. A narrow bone lets tissue go to the
/// sides, so that force grows less at first and more when deep: the first form where the bone is not stated.
pub const SHARED_FORM: [[[f64; WAYS]; SHARED]; 2] = [
    [
        [0.0, 0.03, 0.03, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.02, -0.012, 0.005],
        [0.0; WAYS],
    ],
    [
        [0.0, -0.1, 0.063, 0.0, -0.012, 0.004, 0.0],
        [0.0, 0.03, 0.03, 0.0, -0.008, 0.004, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.012, -0.008, 0.003],
    ],
];
