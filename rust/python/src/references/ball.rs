//! A ball on a flat layer, with or without a stiff skin: the closed problem beside which meshes are held.

use pyo3::prelude::*;
use thenar_contact::ball::{Ball, SHALLOWEST, StiffSkin};

use crate::conversion::arrays::{Argument, column};
use crate::conversion::ending;
use crate::conversion::errors::Topic;

/// Sizes that a press can have, mm, and the deepest depth over the radius at least.
const SIZES_MM: [f64; 2] = [1e-3, 1e5];
const FLATTEST: f64 = 1e-6;
/// Largest modulus of a skin over that of what is below.
const STIFFEST: f64 = 1e5;

/// Forces of a ball on a flat layer over bone, over the layer's shear modulus G: (n,), mm2.
///
/// `depths_mm` (n,), each deeper than the one before, from a 250th of the deepest, down to the ball's radius at most; `thickness_mm` of
/// the layer, which may be infinite: then Sneddon's sphere (1965). With `skin_mm` the layer's uppermost part is a skin of `skin_ratio`
/// times the modulus, which gives way through its thickness and stretches by its own deflection (von Karman; Timoshenko &
/// Woinowsky-Krieger 1959, 96). Raises SolveError for numbers that are none of a press.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "Python names them, with defaults"
)]
#[pyo3(signature = (radius_mm, depths_mm, thickness_mm, poisson_ratio = 0.5, *, skin_mm = 0.0, skin_ratio = 1.0))]
pub fn press_ball(
    py: Python<'_>,
    radius_mm: f64,
    depths_mm: &Bound<'_, PyAny>,
    thickness_mm: f64,
    poisson_ratio: f64,
    skin_mm: f64,
    skin_ratio: f64,
) -> PyResult<Py<PyAny>> {
    let refuse = |what: &str| Topic::Solve.error(format!("press_ball: {what}"));
    let depths = Argument::solve("depths_mm", depths_mm).list()?;
    let skin = (skin_mm != 0.0).then_some(StiffSkin {
        thickness_mm: skin_mm,
        ratio: skin_ratio,
    });
    check(radius_mm, &depths, (thickness_mm, poisson_ratio), skin).map_err(refuse)?;
    let deepest = depths.last().copied().unwrap_or(radius_mm);
    let found = ending::call(py, || {
        Ball::new((thickness_mm, poisson_ratio), radius_mm, deepest).forces(skin, &depths)
    });
    let unsettled = "the skin's tension does not settle; take a smaller skin_mm or skin_ratio";
    Ok(column(py, found.ok_or_else(|| refuse(unsettled))?))
}

/// What is wrong with the numbers of a press.
fn check(
    radius: f64,
    depths: &[f64],
    (thickness, poisson_ratio): (f64, f64),
    skin: Option<StiffSkin>,
) -> Result<(), &'static str> {
    let [least, most] = SIZES_MM;
    if !(least..=most).contains(&radius) {
        return Err("radius_mm must lie between 1e-3 and 1e5");
    }
    let rise = depths.is_sorted_by(|a, b| a < b);
    let deepest = depths.last().copied().unwrap_or(0.0);
    let is_within = (FLATTEST * radius..=radius).contains(&deepest);
    if !rise || !is_within || depths[0] < SHALLOWEST * deepest {
        return Err(
            "depths_mm must rise, from a 250th of the deepest, and end between 1e-6 of radius_mm and radius_mm",
        );
    }
    if !(thickness >= least && (thickness <= most || thickness.is_infinite())) {
        return Err("thickness_mm must lie between 1e-3 and 1e5, or be math.inf: a half space");
    }
    if !(0.0..=0.5).contains(&poisson_ratio) {
        return Err("poisson_ratio must lie between 0 and 0.5");
    }
    match skin {
        Some(skin) if !(1e-3 * least..thickness).contains(&skin.thickness_mm) => {
            Err("skin_mm must be 0, for no skin, or between 1e-6 and thickness_mm")
        }
        Some(skin) if !(1.0..=STIFFEST).contains(&skin.ratio) => {
            Err("skin_ratio must lie between 1 and 1e5")
        }
        _ => Ok(()),
    }
}
