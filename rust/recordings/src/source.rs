//! The instrument of a recording.

/// Who made a recording and with what; never for whom, nor where it was kept.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Source {
    /// Maker of the instrument.
    pub maker: &'static str,
    /// Instrument or program.
    pub product: String,
    /// Sensor model or serial number, empty if the file does not say.
    pub sensor: String,
}

impl Source {
    pub(crate) fn of(maker: &'static str, product: &str) -> Source {
        Source {
            maker,
            product: product.to_string(),
            sensor: String::new(),
        }
    }
}
