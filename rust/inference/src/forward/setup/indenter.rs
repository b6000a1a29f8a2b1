//! Indenters of a study as closed surfaces, placed in first touch at a site.

use nalgebra::Vector3;
use thenar_recordings::study::{Indenter, Shape, Site};
use thenar_surface::{Mesh, Product, Vec3};

use crate::errors::InferenceError;
use crate::number_format::number;

/// Sectors around a round tool: a chord of a cylinder of radius R lies R (pi / 512)^2 / 2 = 2e-5 R under the arc.
const SECTORS: u32 = 512;
/// Rings of a sphere's half that touches and of its other half, and sectors around it: an edge of R / 40 lies 8e-5 R under the arc.
const SPHERE: (u32, u32, u32) = (64, 8, 160);
/// Smallest angle between a cylinder's axis and the travel.
const LEAST_ANGLE: f64 = 1e-3;

/// The tool at first touch in the site's direction; `reach`, mm, is the extent of the skin, beyond which plates and rods end.
///
/// # Errors
/// [`InferenceError::Indenter`] for a mesh that cannot be pressed with, [`InferenceError::Placing`] for a cylinder along the travel.
pub fn tool(indenter: &Indenter, site: &Site, reach: f64) -> Result<Product, InferenceError> {
    let frame = Frame::of(site);
    let mesh = match &indenter.shape {
        Shape::Plane => plate(&frame, reach),
        Shape::Cylinder { radius_mm, axis } => {
            let axis = Vector3::from(*axis);
            let along = axis - frame.travel * frame.travel.dot(&axis);
            if along.norm() < LEAST_ANGLE {
                return Err(InferenceError::Placing {
                    indenter: indenter.name.clone(),
                    site: site.name.clone(),
                    problem: "the cylinder's axis lies along the travel; give the axis across it, or shape = \"punch\"".into(),
                });
            }
            // The side's lowest line touches; the axis keeps its slant.
            rod(&frame, axis, *radius_mm, reach)
        }
        Shape::Sphere { radius_mm } => sphere(&frame, *radius_mm),
        Shape::Punch { radius_mm } => punch(&frame, *radius_mm, reach),
        Shape::Mesh(file) => (file.positions.clone(), file.triangles.clone()),
    };
    let refused = |source| InferenceError::Indenter {
        indenter: indenter.name.clone(),
        source,
    };
    let mesh = Mesh::new(mesh.0, mesh.1).map_err(refused)?;
    Product::new(mesh).map_err(refused)
}

/// Radius, mm, of a tool that is a ball.
pub fn ball(indenter: &Indenter) -> Option<f64> {
    match indenter.shape {
        Shape::Sphere { radius_mm } => Some(radius_mm),
        _ => None,
    }
}

/// Depth, in radii of a ball, from which its simulated force is too low. Against Hertz' force, which it follows within 7 % up to there, a ball of
/// 2 or 4 mm on a half space has 84 % at 0.82 radii and 63 % at 0.96, and 73 to 82 % beyond; on 12 mm of tissue it falls by the same parts.
const TOO_DEEP: f64 = 0.7;

/// What a reader should know of a ball that is pressed `deepest` mm; None where its force holds.
pub(crate) fn too_deep(indenter: &Indenter, deepest: f64) -> Option<String> {
    let radius_mm = ball(indenter)?;
    (deepest > TOO_DEEP * radius_mm).then(|| {
        format!(
            "the sphere '{}' is pressed {} mm deep and has a radius of {} mm: the model's skin gives way along its own normal and does not close \
             around a sphere, so from {} mm on its force is too low, by about a third near one radius, and falls where it should rise",
            indenter.name,
            number(deepest),
            number(radius_mm),
            number(TOO_DEEP * radius_mm)
        )
    })
}

type Surface = (Vec<Vec3>, Vec<[u32; 3]>);

/// Point of first touch, and axes about the travel.
struct Frame {
    touch: Vec3,
    /// Unit vector into the skin.
    travel: Vec3,
    u: Vec3,
    v: Vec3,
}

impl Frame {
    fn of(site: &Site) -> Frame {
        let travel = Vector3::from(site.direction).normalize();
        let least = travel.iamin();
        let u = travel.cross(&Vector3::ith(least, 1.0)).normalize();
        Frame {
            touch: site.point_mm.into(),
            travel,
            u,
            v: travel.cross(&u),
        }
    }

    /// The point `x`, `y` across the travel and `up` against it.
    fn at(&self, x: f64, y: f64, up: f64) -> Vec3 {
        self.touch + self.u * x + self.v * y - self.travel * up
    }
}

fn plate(frame: &Frame, reach: f64) -> Surface {
    let corner = |k: u32| {
        let side = |bit: u32| if k & bit == 0 { -reach } else { reach };
        frame.at(side(1), side(2), if k & 4 == 0 { 0.0 } else { reach })
    };
    let positions = (0..8).map(corner).collect();
    let quads = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    (
        positions,
        quads
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .collect(),
    )
}

/// A round bar from `start` to `end`, closed by fans.
fn bar(start: Vec3, end: Vec3, radius: f64, first: Vec3) -> Surface {
    let along = (end - start).normalize();
    let x = (first - along * along.dot(&first)).normalize();
    let y = along.cross(&x);
    let mut positions = Vec::new();
    for center in [start, end] {
        for k in 0..SECTORS {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(SECTORS);
            positions.push(center + (x * angle.cos() + y * angle.sin()) * radius);
        }
    }
    positions.extend([start, end]);
    let mut triangles = Vec::new();
    for k in 0..SECTORS {
        let (a, b) = (k, (k + 1) % SECTORS);
        let (c, d) = (a + SECTORS, b + SECTORS);
        triangles.extend([
            [a, b, d],
            [a, d, c],
            [2 * SECTORS, b, a],
            [2 * SECTORS + 1, c, d],
        ]);
    }
    (positions, triangles)
}

fn rod(frame: &Frame, axis: Vec3, radius: f64, reach: f64) -> Surface {
    let axis = axis.normalize();
    let slant = frame.travel.dot(&axis);
    // From the line that touches to the axis: against the travel, across the axis.
    let up = (axis * slant - frame.travel) / (1.0 - slant * slant).sqrt();
    let middle = frame.touch + up * radius;
    bar(middle - axis * reach, middle + axis * reach, radius, -up)
}

fn punch(frame: &Frame, radius: f64, reach: f64) -> Surface {
    bar(frame.at(0.0, 0.0, reach), frame.touch, radius, frame.u)
}

fn sphere(frame: &Frame, radius: f64) -> Surface {
    let (near, far, sectors) = SPHERE;
    let (rings, right) = (near + far, std::f64::consts::FRAC_PI_2);
    let mut positions = vec![frame.touch];
    for ring in 1..rings {
        let polar = match ring <= near {
            true => right * f64::from(ring) / f64::from(near),
            false => right * (1.0 + f64::from(ring - near) / f64::from(far)),
        };
        for k in 0..sectors {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(sectors);
            let across = radius * polar.sin();
            let up = radius * (1.0 - polar.cos());
            positions.push(frame.at(across * angle.cos(), across * angle.sin(), up));
        }
    }
    positions.push(frame.at(0.0, 0.0, 2.0 * radius));
    let at = |ring: u32, k: u32| 1 + (ring - 1) * sectors + k % sectors;
    let last = positions.len() as u32 - 1;
    let mut triangles = Vec::new();
    for k in 0..sectors {
        triangles.push([0, at(1, k), at(1, k + 1)]);
        triangles.push([last, at(rings - 1, k + 1), at(rings - 1, k)]);
        for ring in 1..rings - 1 {
            let (a, b, c, d) = (
                at(ring, k),
                at(ring, k + 1),
                at(ring + 1, k),
                at(ring + 1, k + 1),
            );
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    (positions, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use thenar_surface::GapLimits;

    #[test]
    fn sphere_pressed_beyond_its_radius_is_noted() {
        let tool = |shape| Indenter {
            name: "probe".into(),
            shape,
        };
        let ball = tool(Shape::Sphere { radius_mm: 2.0 });
        assert!(too_deep(&ball, 1.39).is_none());
        let told = too_deep(&ball, 3.07).unwrap();
        let start = "the sphere 'probe' is pressed 3.07 mm deep and has a radius of 2 mm";
        assert!(
            told.starts_with(start) && told.contains("from 1.4 mm on"),
            "{told}"
        );
        assert!(too_deep(&tool(Shape::Punch { radius_mm: 2.0 }), 5.0).is_none());
    }

    #[test]
    fn tools_touch_at_the_site_and_have_their_shape() {
        let site = Site {
            name: "pad".into(),
            point_mm: [1.0, 2.0, 3.0],
            direction: [0.0, 0.6, -0.8],
            distance_mm: 0.0,
        };
        let travel = Vector3::from(site.direction);
        let axis = [1.0, 0.0, 0.0];
        let shapes = [
            (Shape::Plane, f64::INFINITY),
            (
                Shape::Cylinder {
                    radius_mm: 5.0,
                    axis,
                },
                5.0,
            ),
            (Shape::Sphere { radius_mm: 5.0 }, 5.0),
            (Shape::Punch { radius_mm: 5.0 }, f64::INFINITY),
        ];
        let limits = GapLimits {
            cut_off_mm: f64::INFINITY,
            max_depth_mm: 100.0,
        };
        for (shape, radius) in shapes {
            let indenter = Indenter {
                name: "tool".into(),
                shape,
            };
            let tool = tool(&indenter, &site, 40.0).unwrap();
            assert!(
                tool.is_closed() && tool.warnings().is_empty(),
                "{indenter:?}"
            );
            let touch = Vector3::from(site.point_mm);
            // Where a step of 2 mm across the travel and the axis meets the tool.
            let across = travel.cross(&Vector3::from(axis)).normalize();
            let sag = if radius.is_finite() {
                radius - (radius * radius - 4.0f64).sqrt()
            } else {
                0.0
            };
            for (point, depth) in [
                (touch, 0.0),
                (touch + across * 2.0 - travel * sag, 0.0),
                (touch - travel, -1.0),
            ] {
                let gap = tool.gap(point, None, limits).unwrap().distance;
                assert!(
                    (gap - depth).abs() < 2e-3,
                    "{indenter:?}: {gap} for {depth}"
                );
            }
        }
    }
}
