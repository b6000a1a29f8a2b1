//! Rounded cones and ellipsoids, and how they melt into one another.

use thenar_surface::Vec3;

/// Smooth minimum with a cubic blend of width `k` mm; equals the plain minimum where the two differ by more than `k` (Quilez).
pub(super) fn soft_min(a: f64, b: f64, k: f64) -> f64 {
    if (a - b).abs() >= k {
        return a.min(b);
    }
    let h = (k - (a - b).abs()) / k;
    a.min(b) - h * h * h * k / 6.0
}

/// Smooth maximum, the mirror of [`soft_min`].
pub(super) fn soft_max(a: f64, b: f64, k: f64) -> f64 {
    -soft_min(-a, -b, k)
}

/// A right-handed frame: x across, y along, z towards the palm.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub origin: Vec3,
    pub x: Vec3,
    pub y: Vec3,
    pub z: Vec3,
}

impl Frame {
    /// The frame at `origin` with y along `along` and z as near to `palmar` as that allows.
    pub fn new(origin: Vec3, along: Vec3, palmar: Vec3) -> Frame {
        let y = along.normalize();
        let z = (palmar - y * y.dot(&palmar)).normalize();
        Frame {
            origin,
            x: y.cross(&z),
            y,
            z,
        }
    }

    /// A point in this frame's coordinates.
    pub fn local(&self, p: Vec3) -> Vec3 {
        let q = p - self.origin;
        Vec3::new(q.dot(&self.x), q.dot(&self.y), q.dot(&self.z))
    }
}

/// One piece of flesh.
pub(super) enum Solid {
    /// A cone with round ends; radii are half depths, aspects breadth over depth, both at start and end.
    Cone {
        frame: Frame,
        length: f64,
        radius: [f64; 2],
        aspect: [f64; 2],
    },
    /// An ellipsoid with semi-axes in its frame.
    Ellipsoid { frame: Frame, half: Vec3 },
}

impl Solid {
    /// A rounded cone from `a` to `b` whose depth is measured along `palmar`.
    pub fn cone((a, b): (Vec3, Vec3), palmar: Vec3, radius: [f64; 2], aspect: [f64; 2]) -> Solid {
        Solid::Cone {
            frame: Frame::new(a, b - a, palmar),
            length: (b - a).norm(),
            radius,
            aspect,
        }
    }

    /// An ellipsoid.
    pub fn ellipsoid(frame: Frame, half: Vec3) -> Solid {
        Solid::Ellipsoid { frame, half }
    }

    fn value(&self, p: Vec3) -> f64 {
        match self {
            Solid::Cone {
                frame,
                length,
                radius,
                aspect,
            } => cone_value(frame.local(p), *length, *radius, *aspect),
            Solid::Ellipsoid { frame, half } => ellipsoid_value(frame.local(p), *half),
        }
    }

    /// A capsule that holds the solid.
    fn hull(&self) -> Capsule {
        match self {
            Solid::Cone {
                frame,
                length,
                radius,
                aspect,
            } => Capsule {
                start: frame.origin,
                edge: frame.y * *length,
                radius: radius[0].max(radius[1]) * aspect[0].max(aspect[1]).max(1.0),
            },
            Solid::Ellipsoid { frame, half } => {
                let radius = half.x.max(half.z);
                let reach = (half.y - radius).max(0.0);
                Capsule {
                    start: frame.origin - frame.y * reach,
                    edge: frame.y * (2.0 * reach),
                    radius,
                }
            }
        }
    }
}

/// All points within `radius` of a segment.
pub(super) struct Capsule {
    pub start: Vec3,
    pub edge: Vec3,
    pub radius: f64,
}

impl Capsule {
    /// Distance to the capsule, mm, negative inside.
    pub fn distance(&self, p: Vec3) -> f64 {
        let offset = p - self.start;
        let share = (offset.dot(&self.edge) / self.edge.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (offset - self.edge * share).norm() - self.radius
    }

    /// Corners of a box that holds the capsule.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let (a, b) = (self.start, self.start + self.edge);
        (
            a.inf(&b).add_scalar(-self.radius),
            a.sup(&b).add_scalar(self.radius),
        )
    }
}

fn cone_value(q: Vec3, length: f64, [start, end]: [f64; 2], aspect: [f64; 2]) -> f64 {
    let t = (q.y / length).clamp(0.0, 1.0);
    let x = q.x / (aspect[0] + (aspect[1] - aspect[0]) * t);
    let r = x.hypot(q.z);
    let slope = (start - end) / length;
    let cosine = (1.0 - slope * slope).max(1e-6).sqrt();
    let foot = q.y - r * slope / cosine;
    if foot < 0.0 {
        r.hypot(q.y) - start
    } else if foot > length {
        r.hypot(q.y - length) - end
    } else {
        r * cosine + q.y * slope - start
    }
}

/// First-order distance to an ellipsoid: its implicit function over the length of its gradient.
/// Good near the surface. At the middle it has no limit: it tends to minus the semi-axis in the direction from which the middle is reached.
pub(super) fn ellipsoid_value(q: Vec3, half: Vec3) -> f64 {
    let scaled = q.component_div(&half);
    let norm = scaled.norm();
    norm * (norm - 1.0) / (scaled.component_div(&half).norm() + 1e-9)
}

/// Solids melted one after another, and then carved.
pub(super) struct Chain {
    joined: Vec<Link>,
    carved: Vec<Link>,
}

struct Link {
    solid: Solid,
    blend: f64,
    hull: Capsule,
}

/// Outside a solid's hull its value is at least this share of the distance to the hull (anisotropic sections shorten it).
pub(super) const FAR_SHARE: f64 = 0.5;

impl Chain {
    /// An empty chain.
    pub fn new() -> Chain {
        Chain {
            joined: Vec::new(),
            carved: Vec::new(),
        }
    }

    /// Joins a solid to what is there, over `blend` mm.
    pub fn join(&mut self, blend: f64, solid: Solid) {
        self.joined.push(Link::new(solid, blend));
    }

    /// Carves a solid out of what is there, over `blend` mm.
    pub fn cut(&mut self, blend: f64, solid: Solid) {
        self.carved.push(Link::new(solid, blend));
    }

    /// Field of the joined solids together with `others`.
    pub fn value(&self, p: Vec3, others: f64) -> f64 {
        let mut value = others;
        for link in &self.joined {
            if FAR_SHARE * link.hull.distance(p) <= value + link.blend {
                value = soft_min(value, link.solid.value(p), link.blend);
            }
        }
        value
    }

    /// `value` with the carved solids taken out.
    pub fn carve(&self, p: Vec3, value: f64) -> f64 {
        self.carved.iter().fold(value, |value, link| {
            soft_max(value, -link.solid.value(p), link.blend)
        })
    }

    /// Corners of a box that holds the joined solids.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = -low;
        for link in &self.joined {
            let corners = link.hull.bounds();
            low = low.inf(&corners.0);
            high = high.sup(&corners.1);
        }
        (low, high)
    }
}

impl Link {
    fn new(solid: Solid, blend: f64) -> Link {
        let hull = solid.hull();
        Link { solid, blend, hull }
    }
}
