//! What the layer on bone without end lacks where tissue is pressed deep: narrow bones, and stiffening by strain.
//!
//! The numbers are fitted to solids of pads over bone (`tests/proof/deep_pads/deep_tissue.py`, the reference solve) and held against
//! other pads by another program (`tests/proof/deep_pads/test_deep_pads.py`, FElupe).

use crate::Material;

/// Penetration over thickness from which tissue stiffens no more: farther, no solid says how.
const LARGEST_STRAIN: f64 = 0.5;
/// Bone half-width over thickness, and by how much a layer is too stiff over a short bone of that width.
const ACROSS: [(f64, f64); 10] = [
    (0.4, 0.40),
    (0.6, 0.38),
    (0.9, 0.34),
    (1.15, 0.30),
    (1.38, 0.26),
    (1.55, 0.19),
    (1.95, 0.08),
    (3.0, 0.045),
    (4.4, 0.035),
    (10.0, 0.0),
];
/// Bone half-length over thickness, and what is left of that over a longer bone.
const ALONG: [(f64, f64); 2] = [(2.0, 1.0), (2.6, 0.68)];
/// Contact radius over thickness at which 1 - 1/e of the give at the sides acts: a smaller contact feels less of the bone.
const FELT_FROM: f64 = 0.5;
/// Growth of the exponent of stiffening with contact radius over thickness, from 1.1 to 3.1: wide contacts confine the tissue.
const CONFINEMENT: f64 = 0.11;

/// True if the material departs from a layer of constant modulus by region.
pub fn is_deep(material: &Material) -> bool {
    material.stiffening > 0.0 || material.bone_half_width_mm.is_finite()
}

/// Factor of the modulus of a region with this `thickness` (mm), pressed to `depth` (mm) with this `volume` (mm3) in the product.
pub fn factor(material: &Material, thickness: f64, (depth, volume): (&f64, f64)) -> f64 {
    if *depth <= 0.0 || thickness.is_infinite() {
        return 1.0;
    }
    // A paraboloid's overlap of this depth and volume has this radius.
    let radius = (2.0 * volume / (std::f64::consts::PI * depth)).sqrt() / thickness;
    let give = interpolated(&ACROSS, material.bone_half_width_mm / thickness)
        * interpolated(&ALONG, material.bone_half_length_mm / thickness);
    let escape = 1.0 + give * (1.0 - (-(radius / FELT_FROM).powi(2)).exp());
    let confined = CONFINEMENT * (radius - 1.1).clamp(0.0, 2.0);
    growth(confined * material.stiffening, depth / thickness) / escape
}

/// Growth of the modulus of tissue of this `stiffening` where it is pressed to this `strain` (depth over thickness):
/// exp(b (I1 - 3)) of uniform compression to the stretch `1 - strain` at constant volume.
pub fn growth(stiffening: f64, strain: f64) -> f64 {
    let stretch = 1.0 - strain.min(LARGEST_STRAIN);
    (stiffening * (stretch * stretch + 2.0 / stretch - 3.0)).exp()
}

/// Value of a table of (x, y) at `x`, straight in the logarithm of x; held beyond its ends.
fn interpolated(table: &[(f64, f64)], x: f64) -> f64 {
    let after = table.partition_point(|(at, _)| *at < x);
    let last = table.len() - 1;
    if after == 0 || after > last {
        return table[after.min(last)].1;
    }
    let ((x0, y0), (x1, y1)) = (table[after - 1], table[after]);
    y0 + (y1 - y0) * (x / x0).ln() / (x1 / x0).ln()
}
