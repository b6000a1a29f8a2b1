//! Stage 4: the contact problem and its solvers.

pub mod operator;

mod along;
mod block_pivoting;
mod conjugate_gradient;
mod dense;
mod half;
mod kept;
mod projection;

pub use along::{Along, Axes, Part};
pub use block_pivoting::{Accuracy, Solution, solve_contact};
pub use dense::solve_dense;
pub use half::{Compliance, Preconditioner, Symmetric};
pub use kept::Kept;
