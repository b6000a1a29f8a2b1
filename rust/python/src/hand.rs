//! `thenar.hand`: a parametric hand as arrays, with regions and bones.

use crate::conversion::arrays::{Argument, column, rows, table};
use crate::conversion::errors::{Failure, Topic};
use crate::conversion::record::record;
use crate::conversion::running::{Hooks, run};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use thenar_hand::{Bone, Hand, HandShape, RegionKind, Sex, Side, VertexWeights};
use thenar_surface::Vec3;

/// A hand made from published measurements, at rest: flat, origin in the wrist crease, +y to the fingers, +z out of
/// the palm, mm.
///
/// `length_mm`, `breadth_mm`: a person's own, None: from `percentile` (1 to 99) and `sex` ("male", "female");
/// `side` "right" or "left"; `spacing_mm`: edge length aimed at.
/// Returns a record: `vertices_mm` (n, 3), `triangles` (m, 3) int32, `regions` (n,) int32 with -1 for nails and back,
/// `region_names`, `kind` ("finger" or "palm") and `thickness_mm` per region, `bones` (records, parents first),
/// `weights` (n, bones) float32, `nails` (n,) bool. Raises `MeshError` for a hand that nobody has, `Cancelled`.
#[pyfunction]
#[pyo3(signature = (length_mm=None, breadth_mm=None, percentile=None, sex="male", side="right", spacing_mm=None, *, cancel=None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keywords of the public interface"
)]
pub fn hand(
    py: Python<'_>,
    length_mm: Option<&Bound<'_, PyAny>>,
    breadth_mm: Option<&Bound<'_, PyAny>>,
    percentile: Option<&Bound<'_, PyAny>>,
    sex: &str,
    side: &str,
    spacing_mm: Option<&Bound<'_, PyAny>>,
    cancel: Option<Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let number = |name: &str, value: Option<&Bound<'_, PyAny>>| {
        value
            .map(|value| Argument::mesh(name, value).number())
            .transpose()
    };
    let usual = HandShape::default();
    let shape = HandShape {
        length_mm: number("length_mm", length_mm)?,
        breadth_mm: number("breadth_mm", breadth_mm)?,
        percentile: number("percentile", percentile)?.unwrap_or(usual.percentile),
        spacing_mm: number("spacing_mm", spacing_mm)?.unwrap_or(usual.spacing_mm),
        sex: one_of("sex", sex, [("male", Sex::Male), ("female", Sex::Female)])?,
        side: one_of("side", side, [("right", Side::Right), ("left", Side::Left)])?,
    };
    let hand = run(py, &Hooks::new(cancel, None)?, move |_| {
        shape.build().map_err(Failure::Hand)
    })?;
    as_record(py, hand)
}

fn one_of<T: Copy>(name: &str, given: &str, choices: [(&str, T); 2]) -> PyResult<T> {
    let found = choices.iter().find(|(word, _)| *word == given);
    found.map(|(_, choice)| *choice).ok_or_else(|| {
        let words = choices.map(|(word, _)| format!("\"{word}\""));
        Topic::Mesh.error(format!(
            "{name}: there is no {given:?}; choose {}",
            words.join(" or ")
        ))
    })
}

fn as_record(py: Python<'_>, hand: Hand) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let corners = hand
        .mesh
        .triangles()
        .iter()
        .flatten()
        .map(|index| *index as i32)
        .collect();
    entries.set_item("vertices_mm", rows(py, hand.mesh.positions())?)?;
    entries.set_item("triangles", table(py, corners, 3)?)?;
    entries.set_item("regions", column(py, hand.regions))?;
    entries.set_item("region_names", hand.region_names.to_vec())?;
    let kind = |kind: &RegionKind| match kind {
        RegionKind::Finger => "finger",
        RegionKind::Palm => "palm",
    };
    entries.set_item("kind", hand.kinds.iter().map(kind).collect::<Vec<_>>())?;
    entries.set_item("thickness_mm", column(py, hand.thickness_mm.to_vec()))?;
    let bones: Vec<_> = hand
        .bones
        .iter()
        .map(|bone| bone_record(py, bone, &hand.bones))
        .collect::<PyResult<_>>()?;
    entries.set_item("bones", PyList::new(py, bones)?)?;
    entries.set_item(
        "weights",
        table(py, dense(&hand.weights, hand.bones.len()), hand.bones.len())?,
    )?;
    entries.set_item("nails", column(py, hand.nails))?;
    record(entries)
}

fn bone_record(py: Python<'_>, bone: &Bone, all: &[Bone]) -> PyResult<Py<PyAny>> {
    let triple = |vector: Vec3| (vector.x, vector.y, vector.z);
    let degrees = |(low, high): (f64, f64)| (low.to_degrees(), high.to_degrees());
    let limits = PyDict::new(py);
    limits.set_item("flexion", degrees(bone.limits.flexion))?;
    limits.set_item("abduction", degrees(bone.limits.abduction))?;
    let entries = PyDict::new(py);
    entries.set_item("name", &bone.name)?;
    entries.set_item(
        "parent",
        bone.parent
            .and_then(|parent| all.get(parent))
            .map(|parent| &parent.name),
    )?;
    entries.set_item("head_mm", triple(bone.head))?;
    entries.set_item("tail_mm", triple(bone.tail))?;
    entries.set_item("flexion_axis", triple(bone.flexion_axis))?;
    entries.set_item("abduction_axis", triple(bone.abduction_axis))?;
    entries.set_item("palmar", triple(bone.palmar))?;
    entries.set_item("rest_flexion_deg", bone.rest_flexion.to_degrees())?;
    entries.set_item("limits_deg", record(limits)?)?;
    record(entries)
}

/// One row per vertex, one column per bone.
fn dense(weights: &[VertexWeights], bones: usize) -> Vec<f32> {
    let mut dense = vec![0.0; weights.len() * bones];
    for (row, weights) in dense.chunks_exact_mut(bones).zip(weights) {
        for (bone, share) in weights.bones.iter().zip(weights.shares) {
            row[*bone as usize] += share as f32;
        }
    }
    dense
}
