//! The conditions under which a press gets each warning, and their thresholds.

use thenar_surface::{Mesh, Product, Vec3};

use super::between_vertices::product_between;
use super::warnings::Warning;
use crate::Model;
use crate::detection::gaps::limits;
use crate::press::effective_modulus::{KERNEL_LIMIT, pressed_thickness};
use crate::press::pressed::Pressed;
use crate::skin::prepare::Skin;

/// Depth of parts without skin in the product that is worth a word, mm.
const BARE_DEPTH: f64 = 0.5;
/// Product edges longer than this many hand edges smear the pressure map.
const COARSE_RATIO: f64 = 4.0;
/// Sizes outside these are no hand in millimeters.
const CREDIBLE_SIZE: (f64, f64) = (2.0, 2000.0);
/// Penetration of the written skin that spoils a result, mm.
pub(crate) const MOST_PENETRATION: f64 = 0.05;
/// Displacement beyond the deepest overlap from which skin counts as run away, mm: beside a contact skin moves by its bulge only.
const MOST_BEYOND: f64 = 3.0;
/// Pressure over a sensel that only an edge causes, MPa: pain begins at 0.3 to 0.7 MPa on a palm.
const MOST_PATCH: f64 = 1.0;
/// Posed over rest area below which a vertex lies in a crease.
const CREASED: f64 = 0.35;
/// Vertices in contact below which a contact is not resolved.
const FEW: usize = 6;
/// Share of opposing force from which a product counts as held, and share of net force from which it is out of balance.
const HELD_SHARE: f64 = 0.1;
const BALANCED_SHARE: f64 = 0.25;

/// Fields that the rules read, by merged vertex.
pub struct CheckedFields<'a> {
    /// mm.
    pub displacement: &'a [Vec3],
    /// N.
    pub force: &'a [f64],
    /// MPa.
    pub pressure: &'a [f64],
    /// MPa, over a sensel.
    pub patch_peak: f64,
}

/// All warnings of a press.
pub fn warnings_of(
    skin: &Skin,
    (posed, product): (&Mesh, &Product),
    pressed: &Pressed,
    figures: &CheckedFields<'_>,
) -> Vec<Warning> {
    let of_meshes = skin.warnings().iter().chain(product.warnings());
    let mut said: Vec<Warning> = of_meshes.cloned().map(Warning::Note).collect();
    said.extend(size(skin, posed));
    let thickness = pressed_thickness(skin, &pressed.detection);
    let reached = pressed.detection.max_penetration.iter().zip(thickness);
    for (index, (depth, thickness)) in reached.enumerate() {
        said.extend(region(skin, index, (*depth, thickness)));
    }
    said.extend(bare(skin, pressed));
    let between = product_between(skin, product, pressed, figures.displacement);
    if pressed.solved.force.iter().all(|f| *f <= 0.0) {
        said.push(between.unwrap_or_else(|| no_contact(posed, product)));
    } else {
        said.extend(coarse(skin, product, pressed));
        said.extend(few(skin, figures));
        said.extend(between);
        said.extend(edge(figures));
        said.extend(crease(skin, pressed, figures));
        said.extend(balance(pressed));
    }
    if !pressed.adhesion.is_settled {
        said.push(Warning::AdhesionUnsettled);
    }
    if !pressed.solved.convergence.has_converged {
        said.push(Warning::Unsolved {
            penetration: pressed.solved.penetration,
            passes: pressed.solved.convergence.passes,
            spacing: skin.spacing,
        });
    } else if pressed.solved.penetration > MOST_PENETRATION {
        said.push(Warning::Penetration {
            depth: pressed.solved.penetration,
        });
    }
    said.extend(runaway(skin, pressed, figures));
    said
}

fn region(skin: &Skin, index: usize, (depth, thickness): (f64, f64)) -> Vec<Warning> {
    let material = &skin.tissue.materials[index];
    let (title, mut said) = (skin.region_title(index), Vec::new());
    let laws = &skin.tissue.laws;
    let is_line = !laws.iter().any(|law| law.acts_on(index as u32));
    if is_line && depth > material.d_lim_mm && material.g_lim_mpa != material.g0_mpa {
        said.push(Warning::BeyondStiffening {
            region: index,
            title: title.clone(),
            depth,
            limit: material.d_lim_mm,
        });
    }
    if skin.model == Model::Layer && depth > thickness {
        said.push(Warning::BeyondTissue {
            region: index,
            title,
            depth,
            thickness,
        });
    } else if skin.model == Model::Layer && depth > KERNEL_LIMIT * thickness {
        said.push(Warning::BeyondTheory {
            region: index,
            title,
            depth,
            thickness,
        });
    }
    said
}

fn size(skin: &Skin, posed: &Mesh) -> Option<Warning> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (vertex, p) in posed.positions().iter().enumerate() {
        if !skin.adjacency.neighbors(vertex).is_empty() {
            for axis in 0..3 {
                (low[axis], high[axis]) = (low[axis].min(p[axis]), high[axis].max(p[axis]));
            }
        }
    }
    let extents = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let extent = extents.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (extent < CREDIBLE_SIZE.0 || extent > CREDIBLE_SIZE.1).then_some(Warning::HandSize { extent })
}

fn few(skin: &Skin, figures: &CheckedFields<'_>) -> Option<Warning> {
    let vertices = figures.force.iter().filter(|f| **f > 0.0).count();
    (vertices < FEW).then_some(Warning::FewVertices {
        vertices,
        spacing: skin.spacing,
    })
}

fn edge(figures: &CheckedFields<'_>) -> Option<Warning> {
    let patch_peak = figures.patch_peak;
    (patch_peak > MOST_PATCH).then_some(Warning::Edge { patch_peak })
}

/// The peak on skin that the posture has folded together, where force over posed area says little.
fn crease(skin: &Skin, pressed: &Pressed, figures: &CheckedFields<'_>) -> Option<Warning> {
    let by_pressure = |a: &usize, b: &usize| figures.pressure[*a].total_cmp(&figures.pressure[*b]);
    let peak = (0..figures.pressure.len()).max_by(by_pressure)?;
    let share = pressed.detection.areas[peak] / skin.rest_area[peak];
    (share < CREASED).then(|| Warning::Crease {
        vertex: skin.merged.source[peak] as usize,
        share,
    })
}

/// Whether the forces on a product that is held from several sides leave a sum.
fn balance(pressed: &Pressed) -> Option<Warning> {
    let forces = || pressed.solved.force.iter().zip(&pressed.solved.touch);
    let sum: f64 = pressed.solved.force.iter().sum();
    let net: Vec3 = forces().map(|(f, touch)| touch.normal * *f).sum();
    let along = net.try_normalize(0.0)?;
    let against = forces().filter(|(_, touch)| touch.normal.dot(&along) < 0.0);
    let against: f64 = against.map(|(f, _)| *f).sum();
    let is_held = against > HELD_SHARE * sum;
    let net = net.norm();
    (is_held && net > BALANCED_SHARE * sum).then_some(Warning::OffBalance { net, sum })
}

/// Skin that moved farther than anything overlapped, unless the tissue's memory, a drag or attraction moves it as well.
fn runaway(skin: &Skin, pressed: &Pressed, figures: &CheckedFields<'_>) -> Option<Warning> {
    let is_moved =
        pressed.shear.is_some() || pressed.recalled.is_some() || !pressed.adhesion.pulls.is_empty();
    let squared = |(v, u): (usize, &Vec3)| (v, u.norm_squared());
    let moved = figures.displacement.iter().enumerate().map(squared);
    let (vertex, moved) = moved.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let moved = moved.sqrt();
    let overlap = pressed.detection.deepest();
    (!is_moved && moved > overlap + MOST_BEYOND).then(|| Warning::Runaway {
        vertex: skin.merged.source[vertex] as usize,
        moved,
        overlap,
    })
}

/// Nails and the back of the hand do not yield: say so if they are in the product.
fn bare(skin: &Skin, pressed: &Pressed) -> Option<Warning> {
    let mut deepest = (0.0, 0);
    let distances = &pressed.detection.distances;
    for (&source, distance) in skin.merged.source.iter().zip(distances) {
        let depth = -distance;
        if depth > deepest.0 && skin.regions[source as usize] < 0 {
            deepest = (depth, source);
        }
    }
    (deepest.0 > BARE_DEPTH).then_some(Warning::Bare {
        depth: deepest.0,
        vertex: deepest.1 as usize,
    })
}

fn no_contact(posed: &Mesh, product: &Product) -> Warning {
    let hand = Product::new(posed.clone()).ok().filter(Product::is_closed);
    let inside = hand.and_then(|hand| {
        let corner = product.mesh().positions()[product.mesh().triangles()[0][0] as usize];
        hand.gap(corner, None, limits())
            .filter(|g| g.distance < 0.0)
    });
    if inside.is_some() {
        return Warning::ProductInside;
    }
    Warning::NoContact
}

fn coarse(skin: &Skin, product: &Product, pressed: &Pressed) -> Option<Warning> {
    let mesh = product.mesh();
    let longest_squared = |triangle: u32| {
        let [a, b, c] = mesh.triangles()[triangle as usize].map(|v| mesh.positions()[v as usize]);
        let sides = [b - a, c - b, a - c].map(|side| side.norm_squared());
        sides[0].max(sides[1]).max(sides[2])
    };
    let touched = pressed
        .solved
        .force
        .iter()
        .zip(&pressed.solved.touch)
        .filter(|(f, _)| **f > 0.0);
    let longest = touched
        .map(|(_, g)| longest_squared(g.triangle))
        .fold(0.0, f64::max)
        .sqrt();
    (longest > COARSE_RATIO * skin.spacing).then_some(Warning::CoarseProduct {
        longest,
        spacing: skin.spacing,
    })
}
