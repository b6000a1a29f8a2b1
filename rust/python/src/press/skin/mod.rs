//! `thenar.Skin`: a hand prepared once and pressed in any posture, from any thread.

pub mod elastomer;
mod shared;

use crate::conversion::arrays::{Argument, column};
use crate::conversion::running::{Hooks, run};
use crate::press::contact::Contact;
use crate::press::effects::{Effect, effects_of};
use crate::press::material::Material;
use crate::press::product::Surface;
use crate::press::protocol::{Course, protocol_of};
use crate::press::requests::{
    Followed, Request, drag_of, force_of, keep_named, model_named, table_of, target_of,
};
use crate::press::walk::Walk;
use elastomer::grip_of;
use pyo3::prelude::*;
use pyo3::types::PyDict;
pub(crate) use shared::{Inner, PressedGrip};
use std::sync::Arc;
use thenar_contact::{ContactError, Model, SkinInput, Start, Unsolved};
use thenar_surface::Mesh;

/// A skin prepared for presses. Several threads may press one skin at once, and each gets the bits that it gets alone.
///
/// What a press writes is in a workspace of its own, never in the skin. Two that are idle are kept for the next presses; more
/// are there only while more presses run.
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
            if let Some(note) = assumed {
                skin = skin.with_note(note);
            }
            if !effects.is_empty() {
                skin = skin.with_effects(effects, control)?;
            }
            Ok(skin)
        })?;
        Ok(Skin {
            inner: Arc::new(Inner::new(skin)),
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
    /// at the last result of this skin, that of the press that ended last before this one began, faster and equal within the
    /// tolerances, else the result depends on the arguments alone, bit for bit; `live`: the same for what moves before the eye, skin away from what
    /// moved keeps its forces until it is off by 0.5 % of the deepest penetration, and no residual is above that;
    /// `keep_unsolved`: a contact that misses its tolerances is returned, graded "do not use", in place of a `SolveError` whose
    /// `vertices` say where, the worst first; `grip`: an `Elastomer` that covers the product, or a list of them and in
    /// `grip_of_vertex` (k,) the number of each vertex of the product, -1 where it is rigid: skin and grip yield to one pressure,
    /// and the product's surface as it is pressed is in the result. Returns a `Contact`. Raises `MeshError`, `SolveError`, `Cancelled`.
    #[pyo3(signature = (product_vertices_mm, product_triangles=None, posed_vertices_mm=None, force_n=None, direction=None, cancel=None, progress=None, *, slide_mm=None, twist_rad=None, drag_n=None, warm_start=false, live=false, keep_unsolved=false, grip=None, grip_of_vertex=None))]
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
        grip: Option<&Bound<'_, PyAny>>,
        grip_of_vertex: Option<&Bound<'_, PyAny>>,
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
        let grip = grip_of(grip, grip_of_vertex, target.vertices())?;
        let request = Request {
            target,
            posed,
            force,
            drag,
            start,
            unsolved: Unsolved::kept_if(keep_unsolved),
            grip,
        };
        let inner = Arc::clone(&self.inner);
        let (contact, grip) = run(py, &hooks, move |control| inner.press(request, control))?;
        Ok(Contact::new(contact, Arc::clone(&self.region_names)).with_grip(grip))
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
        let (product, state) = run(py, &Hooks::none(), move |_| {
            let product = inner.product(target)?;
            Ok((
                product,
                thenar_contact::Walk::new(&inner.skin(), direction)?,
            ))
        })?;
        let place = (Arc::clone(&self.inner), product);
        Ok(Walk::new(place, state, Arc::clone(&self.region_names)))
    }

    /// Switches effects on, in place of those before; the response is prepared again only where they change it. Presses that
    /// run meanwhile end with those they began with.
    ///
    /// Raises `SolveError` for numbers that are not admissible; the skin then stays as it was.
    fn set_effects(&self, py: Python<'_>, effects: Vec<PyRef<'_, Effect>>) -> PyResult<()> {
        let (inner, effects) = (Arc::clone(&self.inner), effects_of(Some(effects)));
        run(py, &Hooks::none(), move |control| {
            inner.change(inner.skin().with_effects(effects, control)?);
            Ok(())
        })
    }

    /// Another skin of the same hand with these effects: it shares all that is prepared, and the response where the effects
    /// leave it as it is. Its warm starts are its own, and neither skin changes with the other's effects.
    ///
    /// Raises `SolveError` for numbers that are not admissible.
    fn with_effects(&self, py: Python<'_>, effects: Vec<PyRef<'_, Effect>>) -> PyResult<Skin> {
        let (inner, effects) = (Arc::clone(&self.inner), effects_of(Some(effects)));
        let skin = run(py, &Hooks::none(), move |control| {
            Ok(inner.skin().with_effects(effects, control)?)
        })?;
        Ok(Skin {
            inner: Arc::new(Inner::new(skin)),
            materials: self.materials.clone(),
            region_names: Arc::clone(&self.region_names),
            ..*self
        })
    }

    /// Effects switched on.
    #[getter]
    fn effects(&self) -> Vec<Effect> {
        let skin = self.inner.skin();
        skin.effects().iter().cloned().map(Effect).collect()
    }

    /// (n,), mm, soft tissue over bone under every vertex, with the effects that are switched on; infinite where the
    /// material knows no bone, NaN away from the skin.
    #[getter]
    fn thickness_mm(&self, py: Python<'_>) -> Py<PyAny> {
        column(py, self.inner.skin().thickness())
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
