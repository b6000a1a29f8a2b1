//! Contact area, with the contact's border located between vertices.
//!
//! Near the edge of a smooth contact pressure falls as the square root of the distance inside, and the gap opens as
//! its 3/2 power outside, with one common factor: `p = k sqrt(x)`, `s = 4 k / (3 E*) y^(3/2)` (Johnson, Contact Mechanics 4.2,
//! 5.1). A vertex inside and its neighbor outside therefore tell where between them the edge lies.

use thenar_surface::Vec3;

/// What is known of the contact at the vertices of a mesh.
#[derive(Clone, Copy)]
pub struct EdgeData<'a> {
    /// Posed positions, mm.
    pub posed: &'a [Vec3],
    /// Displacement from there, mm.
    pub displacement: &'a [Vec3],
    /// Pressure, MPa; positive in the contact.
    pub pressure: &'a [f64],
    /// Slack outside the contact, mm, >= 0; NaN where it is not known.
    pub slack: &'a [f64],
    /// Contact modulus E* = 2 G / (1 - nu), MPa.
    pub contact_modulus: &'a [f64],
}

impl EdgeData<'_> {
    fn position(&self, vertex: usize) -> Vec3 {
        self.posed[vertex] + self.displacement[vertex]
    }
}

/// Contact area of every triangle's share, given to the three corners in equal parts: area by vertex, mm2.
pub fn contact_areas(triangles: &[[u32; 3]], data: EdgeData<'_>) -> Vec<f64> {
    let mut areas = vec![0.0; data.posed.len()];
    // Of bytes, so that most triangles, which are free, are passed quickly.
    let is_pressed: Vec<u8> = data.pressure.iter().map(|p| u8::from(*p > 0.0)).collect();
    for triangle in triangles {
        let inside = triangle.map(|v| is_pressed[v as usize]);
        let count = inside[0] + inside[1] + inside[2];
        if count == 0 {
            continue;
        }
        let inside = inside.map(|i| i > 0);
        let [a, b, c] = triangle.map(|v| data.position(v as usize));
        let whole = 0.5 * (b - a).cross(&(c - a)).norm();
        let covered = whole * share(*triangle, inside, data);
        for (corner, is_inside) in triangle.iter().zip(inside) {
            if is_inside {
                areas[*corner as usize] += covered / f64::from(count);
            }
        }
    }
    areas
}

fn share(triangle: [u32; 3], inside: [bool; 3], data: EdgeData<'_>) -> f64 {
    let reach = |i: usize, o: usize| edge_share(triangle[i] as usize, triangle[o] as usize, data);
    match inside {
        [true, true, true] => 1.0,
        [true, false, false] => reach(0, 1) * reach(0, 2),
        [false, true, false] => reach(1, 0) * reach(1, 2),
        [false, false, true] => reach(2, 0) * reach(2, 1),
        [true, true, false] => 1.0 - (1.0 - reach(0, 2)) * (1.0 - reach(1, 2)),
        [true, false, true] => 1.0 - (1.0 - reach(0, 1)) * (1.0 - reach(2, 1)),
        [false, true, true] => 1.0 - (1.0 - reach(1, 0)) * (1.0 - reach(2, 0)),
        [false, false, false] => 0.0,
    }
}

/// Share of the edge from vertex `i` (pressed) to `o` (free) that is in contact.
fn edge_share(i: usize, o: usize, data: EdgeData<'_>) -> f64 {
    let length = (data.position(o) - data.position(i)).norm();
    let slack = data.slack[o];
    if !slack.is_finite() || slack < 0.0 {
        return 0.5; // bare parts may lie inside the product: there the edge is not known either
    }
    // x = p^2 / k^2 and y = (3 E* s / 4 k)^(2/3) with x + y = length; x = t^3 length makes of that t^3 + a t = 1.
    if data.pressure[i] <= 0.0 {
        return 0.0;
    }
    let opens = (0.75 * data.contact_modulus[i] * slack / (data.pressure[i] * length)).cbrt();
    let root = cubic_root(opens * opens);
    root * root * root
}

/// The t from 0 to 1 with `t^3 + a t = 1`, for `a` >= 0; 0 where `a` is infinite or no number.
fn cubic_root(a: f64) -> f64 {
    // Off by 6.5 % at most, so that two steps of Halley's reach rounding.
    let mut t = (3.0 + a) / (3.0 + a * (2.0 + a));
    for _ in 0..2 {
        let (value, slope) = (t * (t * t + a) - 1.0, 3.0 * t * t + a);
        t -= value * slope / (slope * slope - 3.0 * t * value);
    }
    if t > 0.0 { t.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_neighbor_inside_the_product_leaves_the_area_a_number() {
        let positions = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        let data = EdgeData {
            posed: &positions,
            displacement: &[Vec3::zeros(); 3],
            pressure: &[1.0, 0.0, 0.0],
            slack: &[0.0, -3.0, f64::NAN],
            contact_modulus: &[1.0, 1.0, 1.0],
        };
        assert_eq!(contact_areas(&[[0, 1, 2]], data), [0.125, 0.0, 0.0]);
    }

    #[test]
    fn the_root_of_the_cubic_is_exact_to_rounding() {
        for k in -60..60 {
            let a = 1.7f64.powi(k);
            let t = cubic_root(a);
            let left = t * t * t + a * t - 1.0;
            assert!(left.abs() <= 4e-16 * (3.0 + a * t), "{a}: {t} {left}");
        }
        let odd = [0.0, f64::INFINITY, f64::NAN];
        assert_eq!(odd.map(cubic_root), [1.0, 0.0, 0.0]);
    }

    #[test]
    fn the_edge_of_a_hertz_contact_is_found_between_vertices() {
        // Sphere of radius 10 on a half space of E* = 1, a = 3: Johnson 4.2, Eqs. 4.22 to 4.24.
        let (radius, a): (f64, f64) = (10.0, 3.0);
        let p = |r: f64| {
            2.0 * a / (std::f64::consts::PI * radius) * (1.0 - (r / a).powi(2)).max(0.0).sqrt()
        };
        let s = |r: f64| {
            if r <= a {
                return 0.0;
            }
            let sag = (2.0 * a * a - r * r) * (a / r).asin() + a * (r * r - a * a).sqrt();
            sag / (std::f64::consts::PI * radius) + r * r / (2.0 * radius) - a * a / radius
        };
        for inner in [2.5, 2.7, 2.9, 2.99] {
            let outer = inner + 0.5;
            let data = EdgeData {
                posed: &[Vec3::x() * inner, Vec3::x() * inner],
                displacement: &[Vec3::zeros(), Vec3::x() * 0.5],
                pressure: &[p(inner), 0.0],
                slack: &[0.0, s(outer)],
                contact_modulus: &[1.0, 1.0],
            };
            let edge = inner + 0.5 * edge_share(0, 1, data);
            assert!((edge - a).abs() < 0.03, "{inner}: {edge}");
        }
    }
}
