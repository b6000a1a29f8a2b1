//! Adhesive attraction of a press: the pull at each site, sum and moment.

use thenar_surface::Vec3;

/// Solves in which attraction turns with the product's normal; then it turns ever less, since facets make it flicker.
const SEEKING_SOLVES: usize = 8;
/// Solves after which it turns no more.
const TURNING_SOLVES: usize = 40;

/// Attraction of one site.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// The site.
    pub site: u32,
    /// Product's outward normal there.
    pub normal: Vec3,
    /// Closest point of the product, mm.
    pub closest: Vec3,
    /// Attraction towards the product, N, >= 0.
    pub newton: f64,
}

impl Pull {
    /// Load on the skin, N.
    pub fn load(&self) -> Vec3 {
        -self.normal * self.newton
    }
}

/// Keeps the normals of `after` near those of the solve before, the longer the nearer: where they flicker their mean is left.
pub fn steady(before: &[Pull], after: &mut [Pull], solve: usize) {
    let share = match solve {
        0..=SEEKING_SOLVES => return,
        TURNING_SOLVES.. => 0.0,
        _ => 1.0 / (solve - SEEKING_SOLVES + 1) as f64,
    };
    let mut known = before.iter().peekable();
    for pull in after {
        while known.next_if(|known| known.site < pull.site).is_some() {}
        if let Some(known) = known.next_if(|known| known.site == pull.site) {
            let mean = known.normal + (pull.normal - known.normal) * share;
            pull.normal = mean.try_normalize(0.0).unwrap_or(known.normal);
        }
    }
}

/// The attraction of a press.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Adhesion {
    /// By site, ascending.
    pub pulls: Vec<Pull>,
    /// True if it was found to the tolerance.
    pub is_settled: bool,
}

impl Adhesion {
    /// No attraction.
    pub fn none() -> Adhesion {
        Adhesion {
            pulls: Vec::new(),
            is_settled: true,
        }
    }

    /// Sum of the attraction on the skin, N.
    pub fn force(&self) -> Vec3 {
        self.pulls.iter().map(|p| -p.normal * p.newton).sum()
    }

    /// Moment about the origin of the attraction on the product, moved by `shift` (mm), N mm.
    pub fn moment(&self, shift: Vec3) -> Vec3 {
        let one = |p: &Pull| (p.closest + shift).cross(&p.normal) * p.newton;
        self.pulls.iter().map(one).sum()
    }
}
