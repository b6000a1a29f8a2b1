//! Sentences for the user about a press: where the model was stretched, and what could not be right.

use thenar_surface::{Mesh, Product, Vec3};

use crate::Model;
use crate::simulate::Pressed;
use crate::skin::Skin;
use crate::zone::{KERNEL_LIMIT, limits};

/// Depth of parts without skin in the product that is worth a word, mm.
const BARE_DEPTH: f64 = 0.5;
/// Product edges longer than this many hand edges smear the pressure map.
const COARSE_RATIO: f64 = 4.0;
/// Sizes outside these are no hand in millimeters.
const CREDIBLE_SIZE: (f64, f64) = (2.0, 2000.0);

/// Everything there is to say about a press.
pub fn remarks(skin: &Skin, posed: &Mesh, product: &Product, pressed: &Pressed) -> Vec<String> {
    let mut said: Vec<String> = skin.warnings().to_vec();
    said.extend(product.warnings().iter().cloned());
    said.extend(size(posed));
    for (index, depth) in pressed.detection.max_penetration.iter().enumerate() {
        said.extend(region(skin, index, *depth));
    }
    said.extend(bare(skin, pressed));
    if pressed.solved.force.iter().all(|f| *f <= 0.0) {
        said.push(no_contact(posed, product));
    } else {
        said.extend(coarse(skin, product, pressed));
    }
    if !pressed.clinging.is_settled {
        said.push(
            "adhesion is about to make the skin leap and did not settle: take smaller steps there"
                .to_owned(),
        );
    }
    if !pressed.solved.convergence.has_converged {
        said.push(format!(
            "the written surface still penetrates the product by {:.3} mm after {} passes; the product may have folds \
             smaller than the hand's vertex spacing of {:.1} mm",
            pressed.solved.penetration, pressed.solved.convergence.passes, skin.spacing
        ));
    }
    said
}

fn region(skin: &Skin, index: usize, depth: f64) -> Vec<String> {
    let material = &skin.tissue.materials[index];
    let (title, mut said) = (skin.region_title(index), Vec::new());
    let laws = &skin.tissue.laws;
    let is_line = !laws.iter().any(|law| law.acts_on(index as u32));
    if is_line && depth > material.d_lim_mm && material.g_lim_mpa != material.g0_mpa {
        said.push(format!(
            "{title} is pressed {depth:.2} mm deep, beyond its dlim of {:.2} mm: its modulus is held at Glim",
            material.d_lim_mm
        ));
    }
    if skin.model == Model::Layer && depth > material.thickness_mm {
        said.push(format!(
            "{title} is pressed {depth:.2} mm deep, more than its {:.2} mm of soft tissue: forces there are not \
             to be trusted",
            material.thickness_mm
        ));
    } else if skin.model == Model::Layer && depth > KERNEL_LIMIT * material.thickness_mm {
        said.push(format!(
            "{title} is pressed {depth:.2} mm deep, over half its {:.2} mm of soft tissue: its stiffness is taken \
             as that of {:.2} mm, since small-strain theory ends there",
            material.thickness_mm,
            depth / KERNEL_LIMIT
        ));
    }
    said
}

fn size(posed: &Mesh) -> Option<String> {
    let mut low = Vec3::repeat(f64::INFINITY);
    let mut high = Vec3::repeat(f64::NEG_INFINITY);
    for &vertex in posed.triangles().iter().flatten() {
        let p = &posed.positions()[vertex as usize];
        (low, high) = (low.inf(p), high.sup(p));
    }
    let size = (high - low).max();
    (size < CREDIBLE_SIZE.0 || size > CREDIBLE_SIZE.1).then(|| {
        format!(
            "the hand measures {size:.4} mm: if its coordinates are not in mm, convert them first"
        )
    })
}

/// Nails and the back of the hand do not yield: say so if they are in the product.
fn bare(skin: &Skin, pressed: &Pressed) -> Option<String> {
    let mut deepest = (0.0, 0);
    let distances = &pressed.detection.distances;
    for (&source, distance) in skin.welded.source.iter().zip(distances) {
        let depth = -distance;
        if depth > deepest.0 && skin.regions[source as usize] < 0 {
            deepest = (depth, source);
        }
    }
    (deepest.0 > BARE_DEPTH).then(|| {
        format!(
            "parts without skin (no region) lie up to {:.1} mm inside the product, at vertex {}: they bear no force and \
             are not moved",
            deepest.0, deepest.1
        )
    })
}

fn no_contact(posed: &Mesh, product: &Product) -> String {
    let hand = Product::new(posed.clone()).ok().filter(Product::is_closed);
    let inside = hand.and_then(|hand| {
        let corner = product.mesh().positions()[product.mesh().triangles()[0][0] as usize];
        hand.gap(corner, None, limits())
            .filter(|g| g.distance < 0.0)
    });
    if inside.is_some() {
        return "the product lies inside the hand and touches no skin: move it out".to_owned();
    }
    "no skin touches the product: there is no pressure; move them together or ask for a force"
        .to_owned()
}

fn coarse(skin: &Skin, product: &Product, pressed: &Pressed) -> Option<String> {
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
    (longest > COARSE_RATIO * skin.spacing).then(|| {
        format!(
            "the product's triangles are up to {longest:.1} mm long where it is touched, the hand's {:.1} mm: its pressure \
             map is smeared; subdivide the product for a map (forces on the hand are not affected)",
            skin.spacing
        )
    })
}
