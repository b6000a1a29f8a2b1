//! What a press or a protocol was asked, as it came from Python.

use crate::conversion::arrays::Argument;
use crate::conversion::errors::{MeshError, SolveError};
use crate::press::material::Regions;
use crate::press::product::{Product, Surface};
use pyo3::prelude::*;
use std::sync::Arc;
use thenar_contact::{
    ActiveEffect, Drag, ForceTarget, Keep, Model, Protocol, SoftGrip, Start, Unsolved,
};
use thenar_surface::Vec3;

/// One press as it came from Python.
pub struct Request {
    pub target: Target,
    pub posed: Option<Vec<Vec3>>,
    pub force: Option<ForceTarget>,
    pub drag: Option<Drag>,
    pub start: Start,
    pub unsolved: Unsolved,
    pub grip: Option<SoftGrip>,
}

/// One protocol as it came from Python.
pub struct Followed {
    pub target: Target,
    pub posed: Option<Vec<Vec3>>,
    pub protocol: Protocol,
    pub effects: Option<Vec<ActiveEffect>>,
    pub keep: Keep,
}

/// What to press.
pub enum Target {
    Prepared(Arc<thenar_surface::Product>),
    Surface(Surface),
}

impl Target {
    /// Vertices of the product.
    pub fn vertices(&self) -> usize {
        match self {
            Target::Prepared(product) => product.mesh().positions().len(),
            Target::Surface(surface) => surface.vertices.len(),
        }
    }
}

pub fn keep_named(name: &str) -> PyResult<Keep> {
    match name {
        "totals" => Ok(Keep::Totals),
        "pressure" => Ok(Keep::Pressure),
        "loads" => Ok(Keep::Loads),
        _ => Err(SolveError::new_err(format!(
            "keep: there is no {name:?}; choose \"totals\", \"pressure\" or \"loads\""
        ))),
    }
}

pub fn model_named(name: &str) -> PyResult<Model> {
    match name {
        "layer" => Ok(Model::Layer),
        "paper" => Ok(Model::Paper),
        _ => Err(SolveError::new_err(format!(
            "model: there is no {name:?}; choose \"layer\" or \"paper\""
        ))),
    }
}

pub fn table_of<'a>(regions: &[i32], names: &'a [String], model: Model) -> PyResult<Regions<'a>> {
    let last = regions.iter().copied().max().unwrap_or(-1);
    let used = usize::try_from(last + 1).unwrap_or(0);
    if !names.is_empty() && names.len() < used {
        let found = names.len();
        return Err(MeshError::new_err(format!(
            "region_names: {found} names for regions 0 to {last}; give one per region"
        )));
    }
    let count = used.max(names.len()).max(1);
    let mut is_used = vec![false; count];
    for region in regions
        .iter()
        .filter_map(|region| usize::try_from(*region).ok())
    {
        is_used[region] = true;
    }
    Ok(Regions {
        count,
        is_used,
        names,
        model,
    })
}

pub fn target_of(
    vertices: &Bound<'_, PyAny>,
    triangles: Option<&Bound<'_, PyAny>>,
) -> PyResult<Target> {
    match (vertices.cast::<Product>(), triangles) {
        (Ok(product), None) => Ok(Target::Prepared(Arc::clone(&product.get().0))),
        (Ok(_), Some(_)) => Err(MeshError::new_err(
            "product_triangles: a thenar.Product has its own; leave them out",
        )),
        (Err(_), None) => Err(MeshError::new_err(
            "product_triangles: missing; give them, or a thenar.Product instead of vertices",
        )),
        (Err(_), Some(triangles)) => {
            let vertices = Argument::mesh("product_vertices_mm", vertices);
            Ok(Target::Surface(Surface::new(
                vertices,
                Argument::mesh("product_triangles", triangles),
            )?))
        }
    }
}

pub fn force_of(
    force: Option<&Bound<'_, PyAny>>,
    direction: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<ForceTarget>> {
    let direction = direction
        .map(|direction| Argument::solve("direction", direction).vector())
        .transpose()?;
    let newton = force
        .map(|force| Argument::solve("force_n", force).number())
        .transpose()?;
    match (newton, direction) {
        (Some(newton), direction) => Ok(Some(ForceTarget { newton, direction })),
        (None, Some(_)) => Err(SolveError::new_err(
            "direction: it is used with force_n only; give a force or leave it out",
        )),
        (None, None) => Ok(None),
    }
}

pub fn drag_of(
    slide: Option<&Bound<'_, PyAny>>,
    twist: Option<&Bound<'_, PyAny>>,
    force: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Drag>> {
    let vector = |name: &str, value: Option<&Bound<'_, PyAny>>| {
        value
            .map(|value| Argument::solve(name, value).vector())
            .transpose()
    };
    let travel = vector("slide_mm", slide)?;
    let turn = vector("twist_rad", twist)?;
    match (travel, turn, vector("drag_n", force)?) {
        (None, None, None) => Ok(None),
        (None, None, Some(force)) => Ok(Some(Drag::Force(force))),
        (travel, turn, None) => Ok(Some(Drag::Motion {
            travel: travel.unwrap_or_else(Vec3::zeros),
            turn: turn.unwrap_or_else(Vec3::zeros),
        })),
        _ => Err(SolveError::new_err(
            "drag_n: the product is dragged by a force or by slide_mm and twist_rad; leave one out",
        )),
    }
}
