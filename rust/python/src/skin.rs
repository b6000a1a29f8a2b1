//! `thenar.Skin`: a hand prepared once and pressed in any posture, from any thread.

use crate::arrays::Argument;
use crate::contact::Contact;
use crate::errors::{Failure, MeshError, SolveError};
use crate::material::{Material, Regions};
use crate::product::{Product, Surface};
use crate::running::{Hooks, run};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};
use thenar_contact::{ContactError, Control, Drag, ForceTarget, Model, Press, SkinInput, Start};
use thenar_surface::{Mesh, Vec3};

/// A skin prepared for presses. Safe to use from several threads: presses of one skin wait for each other.
///
/// `vertices_mm` (n, 3) rest positions; `triangles` (m, 3); `regions` (n,) with -1 for "no skin", None: all region 0;
/// `materials`: one `Material`, a list by region, or a dict by number, name or "default", None: the model's preset;
/// `model` "layer" or "paper"; `region_names`: texts for the result table.
///
/// Raises `MeshError`, `MaterialError`, `SolveError`, `Cancelled`.
#[pyclass(frozen, module = "thenar")]
pub struct Skin {
    inner: Arc<Inner>,
    materials: Vec<thenar_contact::Material>,
    region_names: Arc<Vec<String>>,
    model: Model,
    vertex_count: usize,
}

struct Inner {
    skin: Mutex<thenar_contact::Skin>,
    /// The product of the last press from arrays: pressing it again needs no new tree.
    last_product: Mutex<Option<Arc<thenar_surface::Product>>>,
}

/// One press as it came from Python.
struct Request {
    target: Target,
    posed: Option<Vec<Vec3>>,
    force: Option<ForceTarget>,
    drag: Option<Drag>,
    start: Start,
}

/// What to press.
enum Target {
    Prepared(Arc<thenar_surface::Product>),
    Surface(Surface),
}

#[pymethods]
impl Skin {
    #[new]
    #[pyo3(signature = (vertices_mm, triangles, regions=None, materials=None, model="layer", *, region_names=None, cancel=None, progress=None))]
    #[expect(
        clippy::too_many_arguments,
        reason = "keywords of the public interface"
    )]
    fn new(
        py: Python<'_>,
        vertices_mm: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        regions: Option<&Bound<'_, PyAny>>,
        materials: Option<&Bound<'_, PyAny>>,
        model: &str,
        region_names: Option<Vec<String>>,
        cancel: Option<Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Skin> {
        let surface = Surface::new(
            Argument::mesh("vertices_mm", vertices_mm),
            Argument::mesh("triangles", triangles),
        )?;
        let vertex_count = surface.vertices.len();
        let regions = match regions {
            Some(regions) => Argument::mesh("regions", regions).regions(vertex_count)?,
            None => vec![0; vertex_count],
        };
        let model = model_named(model)?;
        let names = region_names.unwrap_or_default();
        let materials = table_of(&regions, &names, model)?.materials(materials)?;
        let prepared = materials.clone();
        let skin = run(py, &Hooks::new(cancel, progress)?, move |control| {
            let mesh =
                Mesh::new(surface.vertices, surface.triangles).map_err(ContactError::Hand)?;
            let input = SkinInput {
                mesh,
                regions,
                materials: prepared,
                model,
            };
            Ok(thenar_contact::Skin::prepare(input, control)?)
        })?;
        let inner = Arc::new(Inner {
            skin: Mutex::new(skin),
            last_product: Mutex::new(None),
        });
        Ok(Skin {
            inner,
            materials,
            region_names: Arc::new(names),
            model,
            vertex_count,
        })
    }

    /// Presses the skin against a product.
    ///
    /// `product_vertices_mm` (k, 3) and `product_triangles` (l, 3), or a `Product` and None; `posed_vertices_mm` (n, 3),
    /// None: the rest pose; `force_n`: move the product until the normal force along `direction` (3,) is that;
    /// `cancel`: a callable that returns a bool or an object with `is_set()`; `progress`: a callable of stage and
    /// fraction; with the effect friction, the product, where it stands, came there by `slide_mm` (3,) along the skin and
    /// `twist_rad` (3,) about the center of the contact, or was dragged by the force `drag_n` (3,); `warm_start`: begin at the last result of this skin, faster and equal within the tolerances, else the
    /// result depends on the arguments alone, bit for bit. Returns a `Contact`. Raises `MeshError`, `SolveError`, `Cancelled`.
    #[pyo3(signature = (product_vertices_mm, product_triangles=None, posed_vertices_mm=None, force_n=None, direction=None, cancel=None, progress=None, *, slide_mm=None, twist_rad=None, drag_n=None, warm_start=false))]
    #[expect(
        clippy::too_many_arguments,
        reason = "keywords of the public interface"
    )]
    fn press(
        &self,
        py: Python<'_>,
        product_vertices_mm: &Bound<'_, PyAny>,
        product_triangles: Option<&Bound<'_, PyAny>>,
        posed_vertices_mm: Option<&Bound<'_, PyAny>>,
        force_n: Option<&Bound<'_, PyAny>>,
        direction: Option<&Bound<'_, PyAny>>,
        cancel: Option<Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
        slide_mm: Option<&Bound<'_, PyAny>>,
        twist_rad: Option<&Bound<'_, PyAny>>,
        drag_n: Option<&Bound<'_, PyAny>>,
        warm_start: bool,
    ) -> PyResult<Contact> {
        let hooks = Hooks::new(cancel, progress)?;
        let target = target_of(product_vertices_mm, product_triangles)?;
        let posed = posed_vertices_mm
            .map(|posed| Argument::mesh("posed_vertices_mm", posed).points())
            .transpose()?;
        let force = force_of(force_n, direction)?;
        let drag = drag_of(slide_mm, twist_rad, drag_n)?;
        let start = if warm_start {
            Start::Warm
        } else {
            Start::Fresh
        };
        let request = Request {
            target,
            posed,
            force,
            drag,
            start,
        };
        let inner = Arc::clone(&self.inner);
        let contact = run(py, &hooks, move |control| inner.press(request, control))?;
        Contact::new(py, contact, &self.region_names)
    }

    /// "layer" or "paper".
    #[getter]
    fn model(&self) -> &'static str {
        match self.model {
            Model::Layer => "layer",
            Model::Paper => "paper",
        }
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// One per region.
    #[getter]
    fn materials(&self) -> Vec<Material> {
        self.materials.iter().copied().map(Material).collect()
    }

    /// As given; empty if none were.
    #[getter]
    fn region_names(&self) -> Vec<String> {
        self.region_names.to_vec()
    }

    fn __repr__(&self) -> String {
        format!(
            "<thenar.Skin: {} vertices, {} regions, model {}>",
            self.vertex_count,
            self.materials.len(),
            self.model()
        )
    }
}

impl Inner {
    fn press(
        &self,
        request: Request,
        control: &Control,
    ) -> Result<thenar_contact::Contact, Failure> {
        let started = Instant::now();
        (control.progress)("product", 0.0);
        let product = match request.target {
            Target::Prepared(product) => product,
            Target::Surface(surface) => self.product_of(surface)?,
        };
        let prepared_in = started.elapsed().as_secs_f64();
        let posed = request.posed.as_deref();
        let press = Press {
            product: &product,
            posed,
            force: request.force,
            drag: request.drag,
            start: request.start,
        };
        let mut contact = self.skin(control)?.press(&press, control)?;
        contact.seconds.insert(0, ("product", prepared_in));
        Ok(contact)
    }

    fn product_of(&self, surface: Surface) -> Result<Arc<thenar_surface::Product>, Failure> {
        let last = || {
            self.last_product
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
        };
        let known = last().clone();
        if let Some(product) = known.filter(|product| {
            product.mesh().triangles() == surface.triangles
                && product.mesh().positions() == surface.vertices
        }) {
            return Ok(product);
        }
        let product = surface.into_product().map_err(ContactError::Product)?;
        *last() = Some(Arc::clone(&product));
        Ok(product)
    }

    /// The skin once no other press uses it; can be cancelled while waiting.
    fn skin(&self, control: &Control) -> Result<MutexGuard<'_, thenar_contact::Skin>, Failure> {
        loop {
            match self.skin.try_lock() {
                Ok(skin) => return Ok(skin),
                Err(TryLockError::Poisoned(_)) => return Err(Failure::Spoiled),
                Err(TryLockError::WouldBlock) => control.check()?,
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

fn model_named(name: &str) -> PyResult<Model> {
    match name {
        "layer" => Ok(Model::Layer),
        "paper" => Ok(Model::Paper),
        _ => Err(SolveError::new_err(format!(
            "model: there is no {name:?}; choose \"layer\" or \"paper\""
        ))),
    }
}

fn table_of<'a>(regions: &[i32], names: &'a [String], model: Model) -> PyResult<Regions<'a>> {
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

fn target_of(
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

fn force_of(
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

fn drag_of(
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
