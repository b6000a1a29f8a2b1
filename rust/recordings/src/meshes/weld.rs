//! One vertex for equal corners, in order of first appearance.

use nalgebra::Vector3;
use std::collections::HashMap;

/// Gives equal positions the same number. Equal means the same bits, with -0 taken as 0.
#[derive(Default)]
pub(super) struct Weld {
    pub positions: Vec<Vector3<f64>>,
    numbers: HashMap<[u64; 3], u32>,
}

impl Weld {
    /// Number of `position`; `None` once there are more than a `u32` counts.
    pub fn number(&mut self, position: Vector3<f64>) -> Option<u32> {
        let key = [0, 1, 2].map(|axis| (position[axis] + 0.0).to_bits());
        let next = u32::try_from(self.positions.len()).ok()?;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.positions.push(position);
        }
        Some(number)
    }
}
