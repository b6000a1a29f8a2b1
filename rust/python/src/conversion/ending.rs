//! The end of the process: every call that is still inside the library leaves it before Python goes.
//!
//! Python up to 3.13 ends a daemon thread that asks for the interpreter's lock too late by unwinding it, and to unwind
//! a frame of Rust so is a crash. Therefore `atexit` asks the calls to leave and waits for them.

use pyo3::exceptions::PySystemExit;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Longest wait for the calls of other threads. A cancelled call takes 0.13 s; only a hook that blocks takes longer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Between two looks at whether they left.
const LOOK: Duration = Duration::from_millis(1);

/// Python is about to end.
static NEAR: AtomicBool = AtomicBool::new(false);
/// Python may be gone: who is without its lock must not ask for it.
static GONE: AtomicBool = AtomicBool::new(false);
/// Calls inside, of all threads.
static INSIDE: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Calls of this thread inside: a hook may call again.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
    /// Whether this thread ends Python: nobody ends it while it is inside.
    static ENDS_PYTHON: Cell<bool> = const { Cell::new(false) };
}

/// A call that is inside the library, until it is dropped; it stays in its thread.
pub struct Inside(PhantomData<*const ()>);

impl Drop for Inside {
    fn drop(&mut self) {
        DEPTH.set(DEPTH.get() - 1);
        INSIDE.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Counts a call; the lock of the interpreter must be held.
///
/// # Errors
/// `SystemExit`, which ends a thread without a word, where Python is about to end.
pub fn enter() -> PyResult<Inside> {
    if is_near() {
        return Err(torn_out());
    }
    Ok(count())
}

/// Whether this thread must leave the library because Python is about to end.
pub fn is_near() -> bool {
    NEAR.load(Ordering::SeqCst) && !ENDS_PYTHON.get()
}

/// What is raised in a thread that must leave.
pub fn torn_out() -> PyErr {
    PySystemExit::new_err("Python ends")
}

/// `work` without the interpreter's lock, as part of a call that is counted.
pub fn detach<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| {
        let result = work();
        while GONE.load(Ordering::SeqCst) && !ENDS_PYTHON.get() {
            std::thread::park(); // the process takes this thread along when it ends
        }
        result
    })
}

/// A whole call without the interpreter's lock that cannot be cancelled.
pub fn call<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    if is_near() {
        return work(); // with the lock, which nobody takes back from it
    }
    let _inside = count();
    detach(py, work)
}

/// Has Python call [`_end`] when it ends and [`_forked`] in its children.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let end = wrap_pyfunction!(_end, module)?;
    py.import("atexit")?.call_method1("register", (end,))?;
    let os = py.import("os")?;
    if os.hasattr("register_at_fork")? {
        let options = PyDict::new(py);
        options.set_item("after_in_child", wrap_pyfunction!(_forked, module)?)?;
        os.call_method("register_at_fork", (), Some(&options))?;
    }
    Ok(())
}

/// Waits until all other threads left the library.
#[pyfunction]
fn _end(py: Python<'_>) {
    ENDS_PYTHON.set(true);
    NEAR.store(true, Ordering::SeqCst);
    let until = Instant::now() + PATIENCE;
    py.detach(|| {
        while INSIDE.load(Ordering::SeqCst) > DEPTH.get() && Instant::now() < until {
            std::thread::sleep(LOOK);
        }
    });
    GONE.store(true, Ordering::SeqCst);
}

/// Forgets the calls of threads that a forked child does not have.
#[pyfunction]
fn _forked() {
    INSIDE.store(DEPTH.get(), Ordering::SeqCst);
}

fn count() -> Inside {
    DEPTH.set(DEPTH.get() + 1);
    INSIDE.fetch_add(1, Ordering::SeqCst);
    Inside(PhantomData)
}
