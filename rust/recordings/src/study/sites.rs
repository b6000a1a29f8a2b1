//! Places on the skin where a tool first touches it.

use super::indenters::unit_vector;
use super::skin::StudySkin;
use super::toml_tree::Section;
use crate::fault::Fault;
use nalgebra::Vector3;
use thenar_surface::closest_point;

/// Farthest that a site may lie from the surface, mm: the thickness of skin that a scan may miss.
const FARTHEST: f64 = 1.0;

/// A place of first touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Site {
    /// Name that recordings use.
    pub name: String,
    /// Point of first touch, mm, skin coordinates.
    pub point_mm: [f64; 3],
    /// Unit vector of travel, into the skin.
    pub direction: [f64; 3],
    /// Distance of the point to the skin's surface, mm.
    pub distance_mm: f64,
}

pub(super) fn read(root: &mut Section, skin: &StudySkin) -> Result<Vec<Site>, Fault> {
    let Some(all) = root.section("sites")? else {
        return Ok(Vec::new());
    };
    let mut sites = Vec::new();
    for (name, mut section) in all.sections()? {
        let Some(point_mm) = section.vector("point_mm")? else {
            return Err(section.needs("point_mm", "give the point of first touch as [x, y, z]"));
        };
        let direction = unit_vector(&mut section, "direction")?;
        let (distance_mm, nearest, corners) = to_skin(skin, point_mm);
        if distance_mm > FARTHEST {
            let [x, y, z] = nearest;
            let problem = format!(
                "{} lies {distance_mm:.1} mm off the skin, whose nearest point is [{x:.2}, {y:.2}, {z:.2}]",
                section.name
            );
            return Err(section.fault(
                problem,
                "give a point on the mesh, in its coordinates and in mm",
            ));
        }
        if corners.iter().all(|&vertex| skin.is_bare(vertex)) {
            let problem = format!(
                "{} lies where the skin has no region, which counts as no skin: vertices {}, {} and {}",
                section.name, corners[0], corners[1], corners[2]
            );
            return Err(section.fault(
                problem,
                "give a point within a region, or give these vertices one in the file of regions",
            ));
        }
        section.finish()?;
        sites.push(Site {
            name,
            point_mm,
            direction,
            distance_mm,
        });
    }
    Ok(sites)
}

/// Distance to the surface, mm, the nearest point of it, and the vertices of its triangle.
fn to_skin(skin: &StudySkin, point: [f64; 3]) -> (f64, [f64; 3], [u32; 3]) {
    let (point, mut best) = (Vector3::from(point), (f64::INFINITY, [0.0; 3], [0; 3]));
    for triangle in &skin.mesh.triangles {
        let corners = triangle.map(|index| skin.mesh.positions[index as usize]);
        let on = closest_point(corners, point).point;
        let distance = (on - point).norm();
        if distance < best.0 {
            best = (distance, on.into(), *triangle);
        }
    }
    best
}
