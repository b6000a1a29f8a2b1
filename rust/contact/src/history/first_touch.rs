//! First touch: the travel along a direction at which the product reaches the skin.

use thenar_surface::{GapLimits, Mesh, Product, Vec3, vertex_normals};

use crate::ContactError;
use crate::detection::gaps::limits;
use crate::press::force_control::MOST_TRAVEL;
use crate::skin::prepare::Skin;

/// Gap at which the product counts as touching, mm.
const TOUCH: f64 = 1e-6;
/// Most steps of the approach to first touch.
const MOST_APPROACHES: usize = 200;

/// Travel along `direction` at which the product first touches the skin, mm.
///
/// # Errors
/// [`ContactError::OutOfReach`] if the product passes the skin by.
pub fn first_touch(
    skin: &Skin,
    (posed, product): (&Mesh, &Product),
    direction: Vec3,
) -> Result<f64, ContactError> {
    let normals = vertex_normals(posed);
    let reach = GapLimits {
        cut_off_mm: MOST_TRAVEL,
        ..limits()
    };
    let vertices = (0..skin.sites.len())
        .filter(|&s| skin.sites.is_skin(s))
        .map(|s| skin.sites.vertex[s] as usize);
    let vertices: Vec<usize> = vertices.collect();
    let facing: Vec<Vec3> = vertices.iter().map(|&v| normals[v]).collect();
    let (mut offset, mut least) = (0.0f64, f64::INFINITY);
    for _ in 0..MOST_APPROACHES {
        let points: Vec<Vec3> = vertices
            .iter()
            .map(|&v| posed.positions()[v] - direction * offset)
            .collect();
        let gaps = product.gaps(&points, Some(&facing), reach);
        least = gaps
            .iter()
            .flatten()
            .map(|g| g.distance)
            .fold(f64::INFINITY, f64::min);
        if least.abs() < TOUCH || offset.abs() > MOST_TRAVEL || least.is_infinite() {
            break;
        }
        offset += least;
    }
    if least.abs() < 1e3 * TOUCH {
        Ok(offset)
    } else {
        Err(ContactError::OutOfReach {
            cut_off_mm: MOST_TRAVEL,
        })
    }
}
