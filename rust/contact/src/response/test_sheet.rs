//! Test fixture: a bent sheet of skin with its quantized response rows.

use super::near_field::NearField;
use super::quantized_rows::QuantizedRows;
use crate::skin::prepare::Skin;
use crate::{Control, Material, Model, SkinInput, Workspace};
use thenar_surface::{Mesh, Vec3};

/// The sheet, of 28 by 28 vertices, a workspace, and a zone of two thirds of its sites, which has its rows.
pub fn sheet() -> (Skin, Workspace, Vec<u32>) {
    let side = 28;
    let place = |k: u32| {
        let (x, y) = (1.3 * f64::from(k % side), 1.4 * f64::from(k / side));
        Vec3::new(x, y, 0.01 * (x * x + y * x))
    };
    let corners = |k: u32| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]];
    let cells = (0..side * (side - 1)).filter(|k| k % side != side - 1);
    let mesh = Mesh::new(
        (0..side * side).map(place).collect(),
        cells.flat_map(corners).collect(),
    );
    let input = SkinInput {
        mesh: mesh.unwrap(),
        regions: Vec::new(),
        materials: vec![Material::finger_layer()],
        model: Model::Layer,
    };
    let control = Control::none();
    let skin = Skin::prepare(input, &control).unwrap();
    let zone = (0..skin.sites.len() as u32).filter(|site| site % 3 != 1);
    let zone: Vec<u32> = zone.collect();
    let (ground, mut workspace) = ((&*skin.response, &*skin.sites), Workspace::default());
    let pressing = workspace.on(&skin);
    let rows = &mut pressing.workspace.quantized;
    rows.make(zone.iter().copied(), ground);
    (skin, workspace, zone)
}

/// The coupling of a zone within a range, mm.
pub fn near((skin, rows): (&Skin, &QuantizedRows), zone: &[u32], range: f64) -> NearField {
    let mut near = NearField::default();
    near.update((zone, zone), rows, (&skin.response, &skin.sites), range);
    near
}

/// How far a product with `x` may be off: three and a half times the deviation that rounding every entry makes.
pub fn most_off(near: &NearField, x: &[f64]) -> f64 {
    let unit = near.units.iter().fold(0.0, |m, u| f64::max(m, *u));
    unit * x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Loads that turn from site to site, with as much of one direction in all.
pub fn loads(count: usize) -> Vec<Vec3> {
    let load = |k: usize| Vec3::new((k as f64).sin(), (0.7 * k as f64).cos(), 1.0);
    (0..count).map(load).collect()
}
