//! Areas of recorded, of simulated and of common contact, and their overlap.

/// Contact that was recorded, that is simulated, and that is both, mm2.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Areas {
    pub recorded: f64,
    pub simulated: f64,
    pub both: f64,
}

impl Areas {
    pub fn add(&mut self, area: f64, [is_recorded, is_simulated]: [bool; 2]) {
        let of = |is: bool| if is { area } else { 0.0 };
        self.recorded += of(is_recorded);
        self.simulated += of(is_simulated);
        self.both += of(is_recorded && is_simulated);
    }

    /// Both over either; NaN where neither is.
    pub fn overlap(&self) -> f64 {
        self.both / (self.recorded + self.simulated - self.both)
    }
}

/// 1 where ink is alone, -1 where simulated contact is alone, 0 where both are or neither.
pub(crate) fn residual([is_recorded, is_simulated]: [bool; 2]) -> f64 {
    f64::from(i8::from(is_recorded) - i8::from(is_simulated))
}
