//! Stage 4: the contact problem and its solvers.

pub mod row_runs;

mod directional;
mod block_pivoting;
mod conjugate_gradient;
mod dense;
mod packed;
mod submatrix;
mod mprgp;

pub use block_pivoting::{Accuracy, Solution, solve_contact};
pub use dense::solve_dense;
pub use directional::{Along, Axes, Part};
pub use packed::{Compliance, Preconditioner, Symmetric};
pub use submatrix::Kept;
