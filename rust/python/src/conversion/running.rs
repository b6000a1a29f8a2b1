//! Long calls: work in a thread of its own without the interpreter's lock, while the caller watches signals and hooks.

use crate::conversion::ending;
use crate::conversion::errors::{Failure, SolveError};
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use thenar_contact::Control;

/// How often signals, `cancel` and `progress` are served.
const TICK: Duration = Duration::from_millis(50);
/// How long a cancelled thread is waited for before it is left to end by itself.
const GRACE: Duration = Duration::from_millis(80);
/// Stack of the working thread, bytes.
const STACK: usize = 16 << 20;
/// Reports kept between two ticks.
const MOST_REPORTS: usize = 64;

/// What the user asked to be told and asked.
pub struct Hooks {
    cancel: Option<Py<PyAny>>,
    progress: Option<Py<PyAny>>,
}

type Outcome<T> = Result<Result<T, Failure>, Box<dyn Any + Send>>;

/// What worker and caller share.
struct Shared<T> {
    cancelled: AtomicBool,
    state: Mutex<State<T>>,
    done: Condvar,
}

struct State<T> {
    reports: Vec<(String, f64)>,
    outcome: Option<Outcome<T>>,
}

impl Hooks {
    /// Asks and tells nobody.
    pub fn none() -> Hooks {
        Hooks {
            cancel: None,
            progress: None,
        }
    }

    /// `cancel` is a callable that answers or an object with `is_set()`; `progress` a callable of stage and fraction.
    ///
    /// # Errors
    /// `SolveError` if one is neither None nor usable.
    pub fn new(
        cancel: Option<Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Hooks> {
        let _inside = ending::enter()?;
        let ask = |hook: Bound<'_, PyAny>| {
            match hook.getattr("is_set") {
                Ok(is_set) if is_set.is_callable() => return Ok(is_set.unbind()),
                _ if hook.is_callable() => return Ok(hook.unbind()),
                _ => {}
            }
            Err(SolveError::new_err(
                "cancel: expected a callable that returns a bool, or an object with is_set()",
            ))
        };
        if progress.as_ref().is_some_and(|hook| !hook.is_callable()) {
            return Err(SolveError::new_err(
                "progress: expected a callable of stage and fraction",
            ));
        }
        Ok(Hooks {
            cancel: cancel.map(ask).transpose()?,
            progress: progress.map(Bound::unbind),
        })
    }

    fn wants_to_stop(&self, py: Python<'_>) -> PyResult<bool> {
        match &self.cancel {
            None => Ok(false),
            Some(ask) => ask.bind(py).call0()?.is_truthy(),
        }
    }

    fn tell(&self, py: Python<'_>, reports: Vec<(String, f64)>) -> PyResult<()> {
        let Some(progress) = &self.progress else {
            return Ok(());
        };
        reports
            .into_iter()
            .try_for_each(|report| progress.bind(py).call1(report).map(drop))
    }
}

impl<T> Shared<T> {
    fn new() -> Shared<T> {
        let state = State {
            reports: Vec::new(),
            outcome: None,
        };
        Shared {
            cancelled: AtomicBool::new(false),
            state: Mutex::new(state),
            done: Condvar::new(),
        }
    }

    fn state(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps the latest report of every stage until the next tick.
    fn report(&self, stage: &str, fraction: f64) {
        let reports = &mut self.state().reports;
        let is_full = reports.len() == MOST_REPORTS;
        match reports.last_mut() {
            Some(last) if last.0 == stage || is_full => *last = (stage.to_owned(), fraction),
            _ => reports.push((stage.to_owned(), fraction)),
        }
    }

    /// Waits for the end, at most `time`; takes what there is.
    fn wait(&self, time: Duration) -> (Vec<(String, f64)>, Option<Outcome<T>>) {
        let waited = self
            .done
            .wait_timeout_while(self.state(), time, |state| state.outcome.is_none());
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        (std::mem::take(&mut state.reports), state.outcome.take())
    }
}

/// Runs `work` in a thread of its own while this one serves signals and hooks.
///
/// A cancelled thread that does not end within [`GRACE`] is left behind: it owns all it touches and ends by itself.
///
/// # Errors
/// What `work` returns; `Cancelled`; `SystemExit` where Python is about to end; whatever a hook or a signal handler raises; `SolveError` for a panic.
pub fn run<T, W>(py: Python<'_>, hooks: &Hooks, work: W) -> PyResult<T>
where
    T: Send + 'static,
    W: FnOnce(&Control) -> Result<T, Failure> + Send + 'static,
{
    let _inside = ending::enter()?;
    if hooks.wants_to_stop(py)? {
        return Err(Failure::Cancelled.into());
    }
    let shared = Arc::new(Shared::new());
    let worker = Arc::clone(&shared);
    let body = move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| controlled(&worker, work)));
        worker.state().outcome = Some(outcome);
        worker.done.notify_all();
    };
    let thread = std::thread::Builder::new()
        .name("thenar".into())
        .stack_size(STACK)
        .spawn(body);
    thread.map_err(|error| {
        SolveError::new_err(format!(
            "no thread could be started ({error}); close other programs"
        ))
    })?;
    match watch(py, hooks, &shared) {
        Ok(Ok(result)) => result.map_err(PyErr::from),
        Ok(Err(panic)) => Err(internal_error(panic.as_ref())),
        Err(error) => {
            shared.cancelled.store(true, Ordering::Relaxed);
            ending::detach(py, || shared.wait(GRACE));
            Err(error)
        }
    }
}

fn watch<T: Send>(py: Python<'_>, hooks: &Hooks, shared: &Shared<T>) -> PyResult<Outcome<T>> {
    loop {
        let (reports, outcome) = ending::detach(py, || shared.wait(TICK));
        hooks.tell(py, reports)?;
        if let Some(outcome) = outcome {
            return Ok(outcome);
        }
        py.check_signals()?;
        if ending::is_near() {
            return Err(ending::torn_out());
        }
        if hooks.wants_to_stop(py)? {
            return Err(Failure::Cancelled.into());
        }
    }
}

/// `work` under the control of `shared`, its fraction never decreasing and 1 at the end.
fn controlled<T, R, W>(shared: &Shared<R>, work: W) -> Result<T, Failure>
where
    T: Send,
    R: Send,
    W: FnOnce(&Control) -> Result<T, Failure> + Send,
{
    let highest = Mutex::new(0.0_f64);
    let progress = |stage: &str, fraction: f64| {
        let mut highest = highest.lock().unwrap_or_else(PoisonError::into_inner);
        *highest = highest.max(fraction.min(1.0));
        shared.report(stage, *highest);
    };
    let cancelled = || shared.cancelled.load(Ordering::Relaxed);
    let control = Control {
        cancelled: &cancelled,
        progress: &progress,
    };
    let result = with_living_threads(|| work(&control))?;
    progress("done", 1.0);
    Ok(result)
}

/// Runs `work` where rayon has threads: those of the process survive no fork, so a child gets its own.
fn with_living_threads<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static HOME: AtomicU32 = AtomicU32::new(0);
    let here = std::process::id();
    let home = HOME
        .compare_exchange(0, here, Ordering::Relaxed, Ordering::Relaxed)
        .unwrap_or_else(|home| home);
    if home == 0 || home == here {
        return work();
    }
    match rayon::ThreadPoolBuilder::new().build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

/// Panics in a thread of the pool, on purpose: the tests see how an error inside is told.
#[pyfunction]
pub fn _panic(py: Python<'_>) -> PyResult<()> {
    run(py, &Hooks::none(), |_| {
        rayon::join(|| panic!("on purpose"), || ());
        Ok(())
    })
}

static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

/// Remembers where a panic happened instead of printing it; [`run`] turns it into an exception.
pub fn keep_panics_off_the_terminal() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or_else(String::new, |place| {
            format!(" at {}:{}", place.file(), place.line())
        });
        *LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner) = place;
    }));
}

fn internal_error(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    let place = std::mem::take(&mut *LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner));
    let text = text.unwrap_or("no message");
    SolveError::new_err(format!(
        "an error inside thenar stopped the work ({text}{place}); please report it with the meshes that caused it"
    ))
}
