//! Isotropic remesh: split, collapse, flip, relax along the skin, project onto the field (after Botsch & Kobbelt 2004).

use super::polish::polish;
use super::soup::Soup;
use super::topology::Topology;
use crate::flesh::Flesh;
use rayon::prelude::*;
use thenar_surface::Vec3;

/// Rounds until the figures of `quality.rs` no longer improve; they hold from 7 on.
const ROUNDS: usize = 10;
/// Edges longer or shorter than these shares of the wanted length are edited (Botsch & Kobbelt).
const LONG: f64 = 4.0 / 3.0;
const SHORT: f64 = 4.0 / 5.0;
const RELAXATION: f64 = 0.7;

/// The wanted edge length at a point, mm.
pub(crate) type Spacing<'a> = &'a (dyn Fn(Vec3) -> f64 + Sync);

/// Remeshes a closed soup to the wanted spacing; `None` if it is not closed.
pub(crate) fn remesh(flesh: &Flesh, spacing: Spacing, soup: Soup) -> Option<Soup> {
    let mut skin = Topology::new(soup)?;
    for round in 0..ROUNDS {
        let mut wanted: Vec<f64> = skin.positions.par_iter().map(|&p| spacing(p)).collect();
        split_long(&mut skin, &mut wanted);
        collapse_short(&mut skin, &wanted);
        even_out_valence(&mut skin);
        let is_last = round + 1 == ROUNDS;
        relax(&mut skin, flesh, &wanted, if is_last { 3 } else { 1 });
        if round == 0 {
            // The extraction has several times the vertices wanted; drop the deleted ones.
            skin = Topology::new(skin.into_soup())?;
        }
    }
    polish(&mut skin, flesh);
    Some(skin.into_soup())
}

fn wanted_length(skin: &Topology, wanted: &[f64], h: u32) -> f64 {
    0.5 * (wanted[skin.start(h) as usize] + wanted[skin.end(h) as usize])
}

fn split_long(skin: &mut Topology, wanted: &mut Vec<f64>) {
    for h in 0..skin.twins.len() as u32 {
        if !skin.is_alive(h) || h > skin.twin(h) {
            continue;
        }
        let length = wanted_length(skin, wanted, h);
        if skin.length(h) > LONG * length {
            let middle = 0.5 * (skin.position(skin.start(h)) + skin.position(skin.end(h)));
            skin.split(h, middle);
            wanted.push(length);
        }
    }
}

/// Shortest first within each sweep, so that the result does not depend on how the extraction numbered its vertices.
fn collapse_short(skin: &mut Topology, wanted: &[f64]) {
    for _ in 0..3 {
        let mut short: Vec<(f64, u32)> = Vec::new();
        for h in 0..skin.twins.len() as u32 {
            if skin.is_alive(h) && h < skin.twin(h) {
                let share = skin.length(h) / wanted_length(skin, wanted, h);
                if share < SHORT {
                    short.push((share, h));
                }
            }
        }
        short.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let before = short.len();
        let mut done = 0;
        for (_, h) in short {
            if skin.is_alive(h) && skin.length(h) < SHORT * wanted_length(skin, wanted, h) {
                let middle = 0.5 * (skin.position(skin.start(h)) + skin.position(skin.end(h)));
                let longest = 1.6 * wanted_length(skin, wanted, h);
                done += usize::from(skin.collapse(h, middle, longest));
            }
        }
        if done * 50 < before {
            return;
        }
    }
}

fn even_out_valence(skin: &mut Topology) {
    for h in 0..skin.twins.len() as u32 {
        if !skin.is_alive(h) || h > skin.twin(h) {
            continue;
        }
        let o = skin.twin(h);
        let corners = [
            skin.start(h),
            skin.end(h),
            skin.end(super::topology::next(h)),
            skin.end(super::topology::next(o)),
        ];
        let excess = corners.map(|v| skin.valence(v) as i64 - 6);
        let change = [-1, -1, 1, 1];
        let now: i64 = excess.iter().map(|e| e * e).sum();
        let then: i64 = (0..4).map(|k| (excess[k] + change[k]).pow(2)).sum();
        if then < now {
            skin.flip(h);
        }
    }
}

/// Moves every vertex towards the middle of its triangles, along the skin, and back onto the field.
fn relax(skin: &mut Topology, flesh: &Flesh, wanted: &[f64], steps: usize) {
    let moved: Vec<Vec3> = (0..skin.positions.len())
        .into_par_iter()
        .map(|v| {
            let p = skin.positions[v];
            if skin.leaving[v] == super::topology::GONE {
                return p;
            }
            let (target, normal) = middle(skin, wanted, v as u32);
            let pull = target - p;
            flesh.project(p + (pull - normal * normal.dot(&pull)) * RELAXATION, steps)
        })
        .collect();
    skin.positions = moved;
}

/// Middle of the triangles around `v`, weighted by area in wanted lengths, and the mean normal.
fn middle(skin: &Topology, wanted: &[f64], v: u32) -> (Vec3, Vec3) {
    let p = skin.position(v);
    let (mut sum, mut total, mut normal) = (Vec3::zeros(), 0.0, Vec3::zeros());
    for s in skin.spokes(v) {
        let (b, c) = (skin.end(s), skin.end(super::topology::next(s)));
        let (q, r) = (skin.position(b), skin.position(c));
        let cross = (q - p).cross(&(r - p));
        let length = wanted[v as usize] + wanted[b as usize] + wanted[c as usize];
        let weight = cross.norm() / (length * length);
        sum += (p + q + r) * (weight / 3.0);
        total += weight;
        normal += cross;
    }
    (sum / total.max(1e-12), normal.normalize())
}
