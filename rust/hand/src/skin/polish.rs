//! The last touch: raises the smallest angles by flips and by moving single vertices.

use super::topology::{GONE, Topology, next};
use crate::flesh::Flesh;
use thenar_surface::Vec3;

/// Vertices whose smallest angle is below this are moved, degrees.
const WANTED_ANGLE: f64 = 30.0;
const ROUNDS: usize = 12;

/// Flips and moves until no angle below [`WANTED_ANGLE`] can be raised.
pub(super) fn polish(skin: &mut Topology, flesh: &Flesh) {
    for round in 0..ROUNDS {
        flip_for_angle(skin);
        let moved = move_worst(skin, flesh, round);
        if moved == 0 {
            return;
        }
    }
}

/// Cosine of the largest-cosine (smallest) angle of a triangle.
fn sharpest(a: Vec3, b: Vec3, c: Vec3) -> f64 {
    let cosine = |p: Vec3, q: Vec3, r: Vec3| {
        let (u, v) = (q - p, r - p);
        u.dot(&v) / (u.norm() * v.norm()).max(1e-300)
    };
    cosine(a, b, c).max(cosine(b, c, a)).max(cosine(c, a, b))
}

fn flip_for_angle(skin: &mut Topology) {
    for h in 0..skin.twins.len() as u32 {
        if !skin.is_alive(h) || h > skin.twin(h) {
            continue;
        }
        let corners = [
            skin.start(h),
            skin.end(h),
            skin.end(next(h)),
            skin.end(next(skin.twin(h))),
        ];
        let [a, b, c, d] = corners.map(|v| skin.position(v));
        let now = sharpest(a, b, c).max(sharpest(b, a, d));
        let then = sharpest(c, d, b).max(sharpest(d, c, a));
        if then < now - 0.01 && now > 0.8 {
            skin.flip(h);
        }
    }
}

fn sharpest_around(skin: &Topology, v: u32, at: Vec3) -> f64 {
    skin.spokes(v)
        .map(|s| {
            sharpest(
                at,
                skin.position(skin.end(s)),
                skin.position(skin.end(next(s))),
            )
        })
        .fold(-1.0, f64::max)
}

fn move_worst(skin: &mut Topology, flesh: &Flesh, round: usize) -> usize {
    let limit = WANTED_ANGLE.to_radians().cos();
    let mut moved = 0;
    for v in 0..skin.positions.len() as u32 {
        if skin.leaving[v as usize] == GONE {
            continue;
        }
        let p = skin.position(v);
        let now = sharpest_around(skin, v, p);
        if now <= limit {
            continue;
        }
        let normal = skin.spokes(v).fold(Vec3::zeros(), |sum, s| {
            sum + (skin.position(skin.end(s)) - p).cross(&(skin.position(skin.end(next(s))) - p))
        });
        let first = skin.position(skin.end(skin.leaving[v as usize])) - p;
        let across = normal.cross(&first).normalize();
        let along = across.cross(&normal).normalize();
        let reach = 0.25 * first.norm() * 0.8_f64.powi(round as i32 / 2);
        let best = (0..8)
            .map(|k| {
                let angle = (k as f64 + 0.5 * (round % 2) as f64) * std::f64::consts::FRAC_PI_4;
                p + (along * angle.cos() + across * angle.sin()) * reach
            })
            .map(|to| (sharpest_around(skin, v, to), to))
            .fold(
                (now, p),
                |best, trial| if trial.0 < best.0 - 1e-4 { trial } else { best },
            );
        let landed = flesh.project(best.1, 2);
        if best.0 < now && sharpest_around(skin, v, landed) < now - 1e-4 {
            skin.positions[v as usize] = landed;
            moved += 1;
        }
    }
    moved
}
