//! `thenar.Walk`: a protocol followed row by row, for animations and live sessions.

use crate::conversion::arrays::{Argument, triple};
use crate::conversion::errors::{Failure, SolveError};
use crate::conversion::running::{Hooks, run};
use crate::press::contact::Contact;
use crate::press::skin::Inner;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;
use thenar_contact::{Control, Demand, Motion, Row, Stand, Step, Workspace};
use thenar_surface::Vec3;

/// How far a motion may be from rigid.
const RIGID: f64 = 1e-5;

/// A protocol followed one row at a time, begun by `Skin.start`: posture and product may move between rows, and the tissue
/// remembers. It has a workspace of its own, which it shares with its copies: their rows wait for each other, and other presses
/// of the skin may run at the same time.
#[pyclass(frozen, module = "thenar")]
pub struct Walk {
    followed: Followed,
    region_names: Arc<Vec<String>>,
}

/// What a row goes on from.
#[derive(Clone)]
struct Followed {
    inner: Arc<Inner>,
    product: Arc<thenar_surface::Product>,
    workspace: Arc<Mutex<Workspace>>,
    state: Arc<Mutex<thenar_contact::Walk>>,
}

/// One row as it came from Python.
struct Asked {
    posed: Option<Vec<Vec3>>,
    motion: Option<Motion>,
    row: Row,
}

#[pymethods]
impl Walk {
    /// Takes the next row and returns the `Contact` at its end, in the frame of the posed positions.
    ///
    /// `time_s` grows from row to row; the first row is reached at once. `posed_vertices_mm` (n, 3): the hand's posture now,
    /// None: the rest pose; `product_motion` (4, 4): rigid motion (rotation and translation in mm, no scale) that takes the
    /// product from the vertices it was started with to where it is now, None: it has not moved. At most one of
    /// `offset_mm` (the product moves this far along the direction besides), `depth_mm` (this far beyond first touch) and
    /// `force_n` (the product moves until this normal force is reached, 0 takes it off the skin); none: the product is
    /// pressed where it stands. `slide_mm` (3,): motion of the product along the skin besides. Direction, offset and slide
    /// are in the product's own frame. Hand and product that move together feel nothing of it; where they move against each
    /// other friction drags the skin along.
    ///
    /// Raises `MeshError`, `SolveError`, `Cancelled`; the walk then stands where it stood and may go on.
    #[pyo3(signature = (time_s, posed_vertices_mm=None, product_motion=None, *, offset_mm=None, depth_mm=None, force_n=None, slide_mm=None, cancel=None, progress=None))]
    #[expect(
        clippy::too_many_arguments,
        reason = "keywords of the public interface"
    )]
    fn advance(
        &self,
        py: Python<'_>,
        time_s: &Bound<'_, PyAny>,
        posed_vertices_mm: Option<&Bound<'_, PyAny>>,
        product_motion: Option<&Bound<'_, PyAny>>,
        offset_mm: Option<&Bound<'_, PyAny>>,
        depth_mm: Option<&Bound<'_, PyAny>>,
        force_n: Option<&Bound<'_, PyAny>>,
        slide_mm: Option<&Bound<'_, PyAny>>,
        cancel: Option<Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Contact> {
        let hooks = Hooks::new(cancel, progress)?;
        let asked = Asked {
            posed: posed_vertices_mm
                .map(|posed| Argument::mesh("posed_vertices_mm", posed).points())
                .transpose()?,
            motion: product_motion.map(motion_of).transpose()?,
            row: Row {
                time_s: Argument::solve("time_s", time_s).number()?,
                demand: demand_of([
                    ("offset_mm", offset_mm),
                    ("depth_mm", depth_mm),
                    ("force_n", force_n),
                ])?,
                slide: match slide_mm {
                    Some(slide) => Argument::solve("slide_mm", slide).vector()?,
                    None => Vec3::zeros(),
                },
            },
        };
        let followed = self.followed.clone();
        let contact = run(py, &hooks, move |control| followed.take(&asked, control))?;
        Ok(Contact::new(contact, Arc::clone(&self.region_names)))
    }

    /// Rows taken.
    #[getter]
    fn rows(&self) -> usize {
        self.state().rows()
    }

    /// Time of the last row, s; nan before the first.
    #[getter]
    fn time_s(&self) -> f64 {
        self.of_step(|step| step.time_s)
    }

    /// Travel of the product along the direction at the last row, mm; nan before the first.
    #[getter]
    fn offset_mm(&self) -> f64 {
        self.of_step(|step| step.offset)
    }

    /// Energy lost to slip since the first row, mJ; nan before the first.
    #[getter]
    fn slip_loss_mj(&self) -> f64 {
        self.of_step(|step| step.slip_loss)
    }

    /// Work that offset and slide have done on the skin since the first row, mJ; nan before the first. What a posture that
    /// moves by itself does is not in it.
    #[getter]
    fn work_mj(&self) -> f64 {
        self.of_step(|step| step.work)
    }

    /// (3,) unit direction in which the product presses, in its own frame; zero until it is known.
    #[getter]
    fn direction(&self, py: Python<'_>) -> Py<PyAny> {
        triple(py, self.state().direction())
    }

    /// A walk of its own from where this one stands: to try rows and go back.
    fn copy(&self) -> Walk {
        Walk {
            followed: Followed {
                state: Arc::new(Mutex::new(self.state())),
                ..self.followed.clone()
            },
            region_names: Arc::clone(&self.region_names),
        }
    }

    fn __repr__(&self) -> String {
        let state = self.state();
        let time = state.step().map_or(f64::NAN, |step| step.time_s);
        format!("<thenar.Walk: {} rows, at {time} s>", state.rows())
    }
}

impl Walk {
    /// A walk that stands where `state` does, on the skin of now.
    pub(crate) fn new(
        (inner, product): (Arc<Inner>, Arc<thenar_surface::Product>),
        state: thenar_contact::Walk,
        region_names: Arc<Vec<String>>,
    ) -> Walk {
        let followed = Followed {
            inner,
            product,
            workspace: Arc::new(Mutex::new(Workspace::default())),
            state: Arc::new(Mutex::new(state)),
        };
        Walk {
            followed,
            region_names,
        }
    }

    fn state(&self) -> thenar_contact::Walk {
        self.followed.state().clone()
    }

    fn of_step(&self, value: impl Fn(&Step) -> f64) -> f64 {
        self.state().step().map_or(f64::NAN, value)
    }
}

impl Followed {
    fn take(&self, asked: &Asked, control: &Control) -> Result<thenar_contact::Contact, Failure> {
        let mut workspace = once_free(&self.workspace, control)?;
        let skin = self.inner.skin();
        let stand = Stand {
            product: &self.product,
            posed: asked.posed.as_deref(),
            motion: asked.motion,
        };
        // A copy goes ahead: what is cancelled or panics leaves the walk where it stood.
        let mut walk = self.state().clone();
        let row = (&stand, &asked.row);
        workspace.on(&skin).advance(&mut walk, row, control)?;
        let contact = walk.contact(&skin, &stand)?;
        *self.state() = walk;
        Ok(contact)
    }

    fn state(&self) -> MutexGuard<'_, thenar_contact::Walk> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The workspace once no other row uses it; can be cancelled while waiting.
fn once_free<'a>(
    workspace: &'a Mutex<Workspace>,
    control: &Control,
) -> Result<MutexGuard<'a, Workspace>, Failure> {
    loop {
        match workspace.try_lock() {
            Ok(free) => return Ok(free),
            Err(TryLockError::Poisoned(half_changed)) => {
                let mut free = half_changed.into_inner();
                *free = Workspace::default();
                workspace.clear_poison();
                return Ok(free);
            }
            Err(TryLockError::WouldBlock) => control.check()?,
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn demand_of(given: [(&str, Option<&Bound<'_, PyAny>>); 3]) -> PyResult<Demand> {
    let mut demand = None;
    for (name, value) in given {
        let Some(value) = value else { continue };
        let value = Argument::solve(name, value).number()?;
        if demand.is_some() {
            return Err(SolveError::new_err(
                "more than one of offset_mm, depth_mm and force_n is given; leave one",
            ));
        }
        demand = Some(match name {
            "offset_mm" => Demand::Offset(value),
            "depth_mm" => Demand::Depth(value),
            _ => Demand::Force(value),
        });
    }
    Ok(demand.unwrap_or(Demand::Offset(0.0)))
}

/// A rigid motion from a (4, 4) matrix.
fn motion_of(value: &Bound<'_, PyAny>) -> PyResult<Motion> {
    let argument = Argument::solve("product_motion", value);
    let given = argument.square()?;
    if given.len() != 16 {
        return Err(argument.fault("expected a (4, 4) matrix; give rotation and translation"));
    }
    let matrix = nalgebra::Matrix4::from_row_slice(&given);
    let turn = matrix.fixed_view::<3, 3>(0, 0).into_owned();
    let is_affine = matrix
        .row(3)
        .iter()
        .zip([0.0, 0.0, 0.0, 1.0])
        .all(|(a, b)| (a - b).abs() <= RIGID);
    let skew = (turn * turn.transpose() - nalgebra::Matrix3::identity()).amax();
    if !(is_affine
        && skew <= RIGID
        && turn.determinant() > 0.0
        && matrix.iter().all(|c| c.is_finite()))
    {
        return Err(argument.fault(
            "it is not a rotation with a translation; apply scale and shear to the product's vertices",
        ));
    }
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(turn);
    let shift = Vec3::new(matrix[(0, 3)], matrix[(1, 3)], matrix[(2, 3)]);
    let rotation = nalgebra::UnitQuaternion::from_rotation_matrix(&rotation);
    Ok(Motion::from_parts(shift.into(), rotation))
}
