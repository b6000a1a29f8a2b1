//! Placement error of a mat: shift along itself and rotation about its middle, flat or wrapped.

use thenar_surface::Vec3;

use super::layout::SensorGrid;

/// How a mat lies otherwise than it should.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// Shift of the mat in its two directions, mm.
    pub shift_mm: [f64; 2],
    /// Turn about its middle, from the first direction to the second, rad; before the shift.
    pub turn_rad: f64,
}

/// A place on the mat: the sensel nearest to it, and how far it is from there along the mat's two directions, mm.
#[derive(Debug, Clone, Copy)]
pub struct Spot {
    /// Number of the sensel.
    pub sensel: usize,
    /// mm along the two directions.
    pub at: [f64; 2],
}

impl Placement {
    /// True if the mat lies as it should.
    pub fn is_none(&self) -> bool {
        *self == Placement::default()
    }

    /// Where a load lies as the misplaced mat sees it.
    pub(super) fn moved(&self, (lie, centers): (&SensorGrid, &[Vec3]), spot: Spot) -> Spot {
        let flat = lie.flat[spot.sensel];
        let [x, y] = [0, 1].map(|axis| flat[axis] + spot.at[axis]);
        let (sin, cos) = self.turn_rad.sin_cos();
        let [a, b] = [x - self.shift_mm[0], y - self.shift_mm[1]];
        let step = [cos * a + sin * b - x, cos * b - sin * a - y];
        settled(
            (lie, centers),
            Spot {
                at: [0, 1].map(|axis| spot.at[axis] + step[axis]),
                ..spot
            },
        )
    }
}

/// The same place seen from the sensel nearest to it, reached from neighbor to neighbor.
fn settled((lie, centers): (&SensorGrid, &[Vec3]), mut spot: Spot) -> Spot {
    let far = |at: [f64; 2]| at[0].hypot(at[1]);
    loop {
        let seen = lie.neighbors(spot.sensel).map(|sensel| {
            let apart = lie.apart(centers, (spot.sensel, sensel));
            let at = [0, 1].map(|axis| spot.at[axis] - apart[axis]);
            Spot { sensel, at }
        });
        let nearest = seen.min_by(|a, b| far(a.at).total_cmp(&far(b.at)));
        match nearest {
            Some(next) if far(next.at) < far(spot.at) => spot = next,
            _ => return spot,
        }
    }
}
