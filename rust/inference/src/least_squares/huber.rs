//! Huber's loss.

/// Residuals beyond this many standard deviations, or of the bulk's spread if that is wider, pull with a constant force.
pub const HUBER: f64 = 3.0;

/// Huber's function: the square, and beyond the threshold a straight line.
pub fn huber(residual: f64, threshold: f64) -> f64 {
    let size = residual.abs();
    match size <= threshold {
        true => size * size,
        false => threshold * (2.0 * size - threshold),
    }
}
