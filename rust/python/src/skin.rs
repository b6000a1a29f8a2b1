//! `thenar.Skin`: a hand prepared once and pressed in any posture, from any thread.

use crate::arrays::{Argument, column};
use crate::contact::Contact;
use crate::effects::{Effect, effects_of};
use crate::errors::Failure;
use crate::material::Material;
use crate::product::Surface;
use crate::protocol::{Course, protocol_of};
use crate::requests::{
    Followed, Request, Target, drag_of, force_of, keep_named, model_named, table_of, target_of,
};
use crate::running::{Hooks, run};
use crate::walk::Walk;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};
use thenar_contact::{ContactError, Control, Model, Press, Run, SkinInput, Start, Unsolved};
use thenar_surface::Mesh;

/// A skin prepared for presses. Safe to use from several threads: presses of one skin wait for each other.
///
/// `vertices_mm` (n, 3) rest positions; `triangles` (m, 3); `regions` (n,) with -1 for "no skin", None: all region 0;
/// `materials`: one `Material`, a list by region, or a dict by number, name or "default", None: the model's preset for a
/// fingertip, in every region, with a warning in every result; `model` "layer" or "paper"; `region_names`: one text per region,
/// used in the result table, in warnings and in errors; `effects`: a list of `Effect`, model layer only.
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

pub(crate) struct Inner {
    skin: Mutex<thenar_contact::Skin>,
    /// The product of the last press from arrays: pressing it again needs no new tree.
    last_product: Mutex<Option<Arc<thenar_surface::Product>>>,
}

#[pymethods]
impl Skin {
    #[new]
    #[pyo3(signature = (vertices_mm, triangles, regions=None, materials=None, model="layer", *, region_names=None, effects=None, cancel=None, progress=None))]
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
        effects: Option<Vec<PyRef<'_, Effect>>>,
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
        let assumed = materials.is_none().then(|| model.preset_note());
        let materials = table_of(&regions, &names, model)?.materials(materials)?;
        let (prepared, titles) = (materials.clone(), names.clone());
        let effects = effects_of(effects);
        let skin = run(py, &Hooks::new(cancel, progress)?, move |control| {
            let mesh =
                Mesh::new(surface.vertices, surface.triangles).map_err(ContactError::Hand)?;
            let input = SkinInput {
                mesh,
                regions,
                materials: prepared,
                model,
            };
            let mut skin = thenar_contact::Skin::prepare_named(input, titles, control)?;
            assumed.into_iter().for_each(|note| skin.note(note));
            if !effects.is_empty() {
                skin.set_effects(effects, control)?;
            }
            Ok(skin)
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
    /// `twist_rad` (3,) about the center of the contact, or was dragged by the force `drag_n` (3,); `warm_start`: begin
    /// at the last result of this skin, faster and equal within the tolerances, else the
    /// result depends on the arguments alone, bit for bit; `live`: the same for what moves before the eye, skin away from what
    /// moved keeps its forces until it is off by 0.5 % of the deepest penetration, and no residual is above that;
    /// `keep_unsolved`: a contact that misses its tolerances is returned, graded "do not use", in place of a `SolveError` whose
    /// `vertices` say where, the worst first. Returns a `Contact`. Raises `MeshError`, `SolveError`, `Cancelled`.
    #[pyo3(signature = (product_vertices_mm, product_triangles=None, posed_vertices_mm=None, force_n=None, direction=None, cancel=None, progress=None, *, slide_mm=None, twist_rad=None, drag_n=None, warm_start=false, live=false, keep_unsolved=false))]
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
        live: bool,
        keep_unsolved: bool,
    ) -> PyResult<Contact> {
        let hooks = Hooks::new(cancel, progress)?;
        let target = target_of(product_vertices_mm, product_triangles)?;
        let posed = posed_vertices_mm
            .map(|posed| Argument::mesh("posed_vertices_mm", posed).points())
            .transpose()?;
        let force = force_of(force_n, direction)?;
        let drag = drag_of(slide_mm, twist_rad, drag_n)?;
        let start = match (live, warm_start) {
            (true, _) => Start::Live,
            (false, true) => Start::Warm,
            (false, false) => Start::Fresh,
        };
        let request = Request {
            target,
            posed,
            force,
            drag,
            start,
            unsolved: Unsolved::kept_if(keep_unsolved),
        };
        let inner = Arc::clone(&self.inner);
        let contact = run(py, &hooks, move |control| inner.press(request, control))?;
        Ok(Contact::new(contact, Arc::clone(&self.region_names)))
    }

    /// Follows a protocol from rest; the tissue remembers from row to row what its effects let it.
    ///
    /// `protocol`: a dict of columns, `time_s` (s,) and one of `depth_mm` (beyond first touch), `offset_mm` (from where the
    /// product was given) and `force_n` per row, NaN where another column counts, and `slide_mm` (s, 3) if the product
    /// moves besides; product and posture as for `press`; `direction` (3,): where the product moves, None: mean normal;
    /// `effects`: a list of `Effect` for this run in place of the skin's; `keep`: "totals", "pressure" for the pressure of every
    /// vertex at every row, or "loads" for what presses on the product, as a `Mat` reads it. Returns a `Course`. Raises `MeshError`, `SolveError`, `Cancelled`.
    #[pyo3(signature = (protocol, product_vertices_mm, product_triangles=None, posed_vertices_mm=None, direction=None, effects=None, cancel=None, progress=None, *, keep="totals"))]
    #[expect(
        clippy::too_many_arguments,
        reason = "keywords of the public interface"
    )]
    fn run(
        &self,
        py: Python<'_>,
        protocol: &Bound<'_, PyDict>,
        product_vertices_mm: &Bound<'_, PyAny>,
        product_triangles: Option<&Bound<'_, PyAny>>,
        posed_vertices_mm: Option<&Bound<'_, PyAny>>,
        direction: Option<&Bound<'_, PyAny>>,
        effects: Option<Vec<PyRef<'_, Effect>>>,
        cancel: Option<Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
        keep: &str,
    ) -> PyResult<Course> {
        let hooks = Hooks::new(cancel, progress)?;
        let direction = direction
            .map(|direction| Argument::solve("direction", direction).vector())
            .transpose()?;
        let posed = posed_vertices_mm
            .map(|posed| Argument::mesh("posed_vertices_mm", posed).points())
            .transpose()?;
        let request = Followed {
            target: target_of(product_vertices_mm, product_triangles)?,
            posed,
            protocol: protocol_of(protocol, direction)?,
            effects: effects.map(|effects| effects_of(Some(effects))),
            keep: keep_named(keep)?,
        };
        let kept = (request.keep, self.vertex_count);
        let inner = Arc::clone(&self.inner);
        let course = run(py, &hooks, move |control| inner.follow(request, control))?;
        Course::new(py, course, (Arc::clone(&self.region_names), kept))
    }

    /// Begins a protocol that is followed row by row: the posture may change from row to row, and the product may move.
    ///
    /// Product as for `press`; `direction` (3,), in the frame of the product's vertices as given: where the product moves to
    /// press, None: mean normal of the first row's posture. The effects are those of the skin, which must not change on the
    /// way. Returns a `Walk`, whose `advance` takes a row. Raises `MeshError`, `SolveError`.
    #[pyo3(signature = (product_vertices_mm, product_triangles=None, direction=None))]
    fn start(
        &self,
        py: Python<'_>,
        product_vertices_mm: &Bound<'_, PyAny>,
        product_triangles: Option<&Bound<'_, PyAny>>,
        direction: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Walk> {
        let target = target_of(product_vertices_mm, product_triangles)?;
        let direction = direction
            .map(|direction| Argument::solve("direction", direction).vector())
            .transpose()?;
        let inner = Arc::clone(&self.inner);
        let (product, state) = run(py, &Hooks::none(), move |control| {
            let product = match target {
                Target::Prepared(product) => product,
                Target::Surface(surface) => inner.product_of(surface)?,
            };
            let skin = inner.skin(control)?;
            Ok((product, thenar_contact::Walk::new(&skin, direction)?))
        })?;
        Ok(Walk {
            inner: Arc::clone(&self.inner),
            region_names: Arc::clone(&self.region_names),
            product,
            state: Arc::new(Mutex::new(state)),
        })
    }

    /// Switches effects on, in place of those before; the skin is prepared again only where they change it.
    ///
    /// Raises `SolveError` for numbers that are not admissible; the skin then stays as it was.
    fn set_effects(&self, py: Python<'_>, effects: Vec<PyRef<'_, Effect>>) -> PyResult<()> {
        let (inner, effects) = (Arc::clone(&self.inner), effects_of(Some(effects)));
        run(py, &Hooks::new(None, None)?, move |control| {
            Ok(inner.skin(control)?.set_effects(effects, control)?)
        })
    }

    /// Effects switched on.
    #[getter]
    fn effects(&self, py: Python<'_>) -> PyResult<Vec<Effect>> {
        let inner = Arc::clone(&self.inner);
        let effects = run(py, &Hooks::new(None, None)?, move |control| {
            Ok(inner.skin(control)?.effects().to_vec())
        })?;
        Ok(effects.into_iter().map(Effect).collect())
    }

    /// (n,), mm, soft tissue over bone under every vertex, with the effects that are switched on; infinite where the
    /// material knows no bone, NaN away from the skin.
    #[getter]
    fn thickness_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let inner = Arc::clone(&self.inner);
        let values = run(py, &Hooks::new(None, None)?, move |control| {
            Ok(inner.skin(control)?.thickness())
        })?;
        Ok(column(py, values))
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
            unsolved: request.unsolved,
        };
        let mut contact = self.skin(control)?.press(&press, control)?;
        contact.seconds.insert(0, ("product", prepared_in));
        Ok(contact)
    }

    fn follow(
        &self,
        request: Followed,
        control: &Control,
    ) -> Result<thenar_contact::Course, Failure> {
        (control.progress)("product", 0.0);
        let product = match request.target {
            Target::Prepared(product) => product,
            Target::Surface(surface) => self.product_of(surface)?,
        };
        let walk = Run {
            product: &product,
            posed: request.posed.as_deref(),
            protocol: &request.protocol,
            keep: request.keep,
        };
        let mut skin = self.skin(control)?;
        let Some(effects) = request.effects else {
            return Ok(skin.run(&walk, control)?);
        };
        let before = skin.effects().to_vec();
        skin.set_effects(effects, control)?;
        let course = skin.run(&walk, control);
        skin.set_effects(before, &Control::none())?;
        Ok(course?)
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
    pub(crate) fn skin(
        &self,
        control: &Control,
    ) -> Result<MutexGuard<'_, thenar_contact::Skin>, Failure> {
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
