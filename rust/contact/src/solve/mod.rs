//! Stage 4: the linear contact problem and its solvers.

pub mod row_runs;

mod directional;
mod block_pivoting;
mod conjugate_gradient;
mod dense;
mod lcp;
mod packed;
mod submatrix;
mod symmetric;
mod tolerances;
mod mprgp;

pub use block_pivoting::solve_contact;
pub use dense::solve_dense;
pub use directional::{Axes, DirectionalCompliance, Part};
pub use lcp::Compliance;
pub use lcp::{Accuracy, Solution};
pub use submatrix::Submatrix;
pub use symmetric::{Preconditioner, Symmetric};
