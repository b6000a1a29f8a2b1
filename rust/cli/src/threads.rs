//! How many threads the work may take.

use crate::fault::Fault;

/// Sets the number of threads of the process; all if none is asked for.
///
/// # Errors
/// If they cannot be started.
pub fn use_only(threads: Option<u16>) -> Result<(), Fault> {
    let Some(threads) = threads else {
        return Ok(());
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build_global();
    pool.map_err(|error| {
        Fault::Other(format!(
            "{threads} threads cannot be started ({error}); give fewer"
        ))
    })
}
