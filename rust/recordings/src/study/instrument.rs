//! The instrument's data sheet, a prior for fits.

use super::toml_tree::Section;
use crate::fault::Fault;

/// Numbers of a data sheet; what is not given is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Instrument {
    /// Uncertainty of the gain, percent.
    pub gain_percent: Option<f64>,
    /// Standard deviation of a force reading, N.
    pub noise_n: Option<f64>,
    /// Pressure at which sensels clip, kPa.
    pub saturation_kpa: Option<f64>,
    /// Pressure below which sensels read nothing, kPa.
    pub threshold_kpa: Option<f64>,
    /// Distance of neighboring sensels, mm.
    pub pitch_mm: Option<f64>,
    /// Uncertainty of where the tool or mat lies, mm.
    pub position_mm: Option<f64>,
    /// Standard deviation of the depth of first touch that all recordings of a tool share, mm.
    pub first_touch_mm: Option<f64>,
}

pub(super) fn read(root: &mut Section) -> Result<Option<Instrument>, Fault> {
    let Some(mut section) = root.section("instrument")? else {
        return Ok(None);
    };
    let instrument = Instrument {
        gain_percent: section.positive("gain_percent")?,
        noise_n: section.positive("noise_n")?,
        saturation_kpa: section.positive("saturation_kpa")?,
        threshold_kpa: section.positive("threshold_kpa")?,
        pitch_mm: section.positive("pitch_mm")?,
        position_mm: section.positive("position_mm")?,
        first_touch_mm: section.positive("first_touch_mm")?,
    };
    section.finish()?;
    Ok(Some(instrument))
}
