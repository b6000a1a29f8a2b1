//! `thenar.reference_press`: soft tissue as a solid at finite strain.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use thenar_reference::{
    ReferenceContact, RestHand, Segment, Settings, Tissue, bone_points as points_of_bone, press,
};
use thenar_surface::{Mesh, Vec3};

use crate::conversion::arrays::{Argument, column, owned_rows, triple};
use crate::conversion::errors::{Failure, Topic};
use crate::conversion::record::record;
use crate::conversion::running::{Hooks, run};
use crate::press::product::Surface;
use crate::press::requests::{Target, target_of};

/// Presses soft tissue, meshed from the skin to the bone, against a rigid and smooth product: the reference of model "layer".
///
/// `posed_vertices_mm` (n, 3) and `triangles` (m, 3) of the skin where it is pressed; `bone_mm` (n, 3): the point of the bone under every
/// vertex; `shear_modulus_mpa` (n,) at small strain; `held` (n,) bool: vertices whose tissue does not move; `can_touch`
/// (n,) bool: vertices that the product can touch, all where it is not given; product as in `Skin.press`;
/// `stiffening` (n,): b of `W = G / (2 b) (exp(b (I1 - 3)) - 1)` at constant volume, 0 (the default): neo-Hookean; `layers` of prisms between bone and skin;
/// `bulk_ratio`: bulk over shear modulus.
///
/// Returns a record: `displacement_mm` and `force_n` (n, 3) of the product on the skin, `pressure_mpa` (n,), `total_force_n` (3,) of the skin on the product,
/// `normal_force_n`,
/// `contact_area_mm2`, `patch_peak_mpa` (largest mean over 24 mm2), `penetration_mm` of vertices, `cut_mm` (how deep the product lies in the skin between
/// vertices, where contact is not tested), `cut_share` (of the overlap that stays there; cuts beyond 0.5 mm with more than 0.1,
/// and beyond 0.1 mm with more than 0.5, are refused), `sideways_share` (of the force that pushes skin along itself, as
/// a tool does that is thinner than twice its depth), `dilatation` (smallest and largest change of volume), `unbalanced` (residual over contact
/// force), `steps`, `folded` (vertices at whose triangles tissue could not be meshed). Raises `MeshError`, `SolveError`, `Cancelled`.
#[pyfunction]
#[pyo3(signature = (posed_vertices_mm, triangles, bone_mm, shear_modulus_mpa, product_vertices_mm, product_triangles=None, *, held=None, can_touch=None, stiffening=None, layers=3, bulk_ratio=100.0, cancel=None, progress=None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keywords of the public interface"
)]
pub fn reference_press(
    py: Python<'_>,
    posed_vertices_mm: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    bone_mm: &Bound<'_, PyAny>,
    shear_modulus_mpa: &Bound<'_, PyAny>,
    product_vertices_mm: &Bound<'_, PyAny>,
    product_triangles: Option<&Bound<'_, PyAny>>,
    held: Option<Vec<bool>>,
    can_touch: Option<Vec<bool>>,
    stiffening: Option<Bound<'_, PyAny>>,
    layers: i64,
    bulk_ratio: f64,
    cancel: Option<Bound<'_, PyAny>>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let skin = Surface::new(
        Argument::mesh("posed_vertices_mm", posed_vertices_mm),
        Argument::mesh("triangles", triangles),
    )?;
    let count = skin.vertices.len();
    let tissue = Tissue {
        bone: Argument::mesh("bone_mm", bone_mm).points()?,
        is_held: held.unwrap_or_else(|| vec![false; count]),
        can_touch: can_touch.unwrap_or_else(|| vec![true; count]),
        shear_modulus_mpa: Argument::material("shear_modulus_mpa", shear_modulus_mpa)
            .numbers_of(count)?,
        skin: skin.vertices,
        triangles: skin.triangles,
        stiffening: match stiffening {
            None => vec![0.0; count],
            Some(given) => Argument::material("stiffening", &given).numbers_of(count)?,
        },
    };
    let target = target_of(product_vertices_mm, product_triangles)?;
    let settings = Settings {
        layers: usize::try_from(layers)
            .map_err(|_| Topic::Mesh.error(format!("layers: found {layers}; give 1 to 8")))?,
        bulk_ratio,
        ..Settings::default()
    };
    let found = run(py, &Hooks::new(cancel, progress)?, move |control| {
        let product = match target {
            Target::Prepared(product) => product,
            Target::Surface(surface) => surface.into_product()?,
        };
        let progress = |share: f64| control.step("solving", share).is_ok();
        press(&tissue, &product, settings, &progress).map_err(Failure::Reference)
    })?;
    as_record(py, found)
}

fn as_record(py: Python<'_>, found: ReferenceContact) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("displacement_mm", owned_rows(py, found.displacement_mm)?)?;
    entries.set_item("force_n", owned_rows(py, found.force_n)?)?;
    entries.set_item("pressure_mpa", column(py, found.pressure_mpa))?;
    entries.set_item("total_force_n", triple(py, found.total_force_n))?;
    entries.set_item("normal_force_n", found.normal_force_n)?;
    entries.set_item("contact_area_mm2", found.contact_area_mm2)?;
    entries.set_item("patch_peak_mpa", found.patch_peak_mpa)?;
    entries.set_item("penetration_mm", found.penetration_mm)?;
    entries.set_item("cut_mm", found.cut_mm)?;
    entries.set_item("cut_share", found.cut_share)?;
    entries.set_item("sideways_share", found.sideways_share)?;
    entries.set_item("dilatation", (found.dilatation[0], found.dilatation[1]))?;
    entries.set_item("unbalanced", found.unbalanced)?;
    entries.set_item("steps", found.steps)?;
    entries.set_item("folded", column(py, found.folded))?;
    record(entries)
}

/// Point of the bone under every vertex of a hand at rest (n, 3), mm, as `reference_press` needs it.
///
/// `vertices_mm` (n, 3) and `triangles` (m, 3) at rest; `thickness_mm` (n,) of soft tissue, 0 where it is not known (3 mm is taken);
/// bones: `heads_mm` and `tails_mm` (b, 3), `palmar` (b, 3): unit direction toward the palm for a phalanx, zero for other bones,
/// `is_last` (b,) bool: the last of a finger; `weights` (n, b): share of every bone in every vertex. A phalanx is a round bar, moved toward
/// the back so that the tissue on its palm side has its thickness; elsewhere, and without bones, bone lies at the thickness against the
/// skin's smoothed normal. To pose it, move it as the skin is moved. Raises `MeshError`.
#[pyfunction]
#[pyo3(signature = (vertices_mm, triangles, thickness_mm, heads_mm=None, tails_mm=None, palmar=None, is_last=None, weights=None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keywords of the public interface"
)]
pub fn bone_points(
    py: Python<'_>,
    vertices_mm: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    thickness_mm: &Bound<'_, PyAny>,
    heads_mm: Option<&Bound<'_, PyAny>>,
    tails_mm: Option<&Bound<'_, PyAny>>,
    palmar: Option<&Bound<'_, PyAny>>,
    is_last: Option<Vec<bool>>,
    weights: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let skin = Surface::new(
        Argument::mesh("vertices_mm", vertices_mm),
        Argument::mesh("triangles", triangles),
    )?;
    let count = skin.vertices.len();
    let thickness = Argument::mesh("thickness_mm", thickness_mm).numbers_of(count)?;
    let vectors = |name: &str, given: Option<&Bound<'_, PyAny>>| {
        let found = given.map(|given| Argument::mesh(name, given).points());
        found.transpose().map(Option::unwrap_or_default)
    };
    let (heads, tails) = (
        vectors("heads_mm", heads_mm)?,
        vectors("tails_mm", tails_mm)?,
    );
    let (palmar, is_last) = (vectors("palmar", palmar)?, is_last.unwrap_or_default());
    if [tails.len(), palmar.len(), is_last.len()] != [heads.len(); 3] {
        let found = format!(
            "{}, {}, {} and {}",
            heads.len(),
            tails.len(),
            palmar.len(),
            is_last.len()
        );
        return Err(Topic::Mesh.error(format!(
            "heads_mm, tails_mm, palmar and is_last: {found} values; give one of each for every bone"
        )));
    }
    let segment = |k: usize| Segment {
        ends: [heads[k], tails[k]],
        palmar: Some(palmar[k]).filter(|direction| *direction != Vec3::zeros()),
        is_last: is_last[k],
    };
    let segments: Vec<Segment> = (0..heads.len()).map(segment).collect();
    let weights = match weights {
        Some(weights) => Argument::mesh("weights", weights).table_of(count, segments.len())?,
        None => Vec::new(),
    };
    let found = run(py, &Hooks::none(), move |_| {
        let mesh = Mesh::new(skin.vertices, skin.triangles)?;
        let hand = RestHand {
            mesh: &mesh,
            thickness_mm: &thickness,
            segments: &segments,
            weights: &weights,
        };
        points_of_bone(hand).map_err(Failure::Reference)
    })?;
    owned_rows(py, found)
}
