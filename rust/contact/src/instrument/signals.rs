//! Predicted signals of a recording, channel by channel, and their consistency checks.

use super::mat::{Mat, PointLoad};
use crate::ContactError;

/// Channels against time; what is empty is not there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Signals {
    /// Instants, s, growing.
    pub time_s: Vec<f64>,
    /// What the machine shows of its motion, mm.
    pub depth_mm: Vec<f64>,
    /// Force of the load cell, N.
    pub force_n: Vec<f64>,
    /// Contact area, mm2.
    pub area_mm2: Vec<f64>,
    /// Force along the surface, N.
    pub tangential_force_n: Vec<f64>,
    /// What presses on the mat at each instant, in the mat's frame; makes the frames where there is a mat.
    pub loads: Vec<Vec<PointLoad>>,
    /// What the mat reads at each instant, kPa by sensel.
    pub frames: Vec<Vec<f64>>,
}

impl Signals {
    /// Checks lengths, times and frames.
    ///
    /// # Errors
    /// [`ContactError::Signals`] naming the channel, the instant and the remedy.
    pub fn check(&self, mat: Option<&Mat>) -> Result<(), ContactError> {
        let refuse = |problem: String| Err(ContactError::Signals { problem });
        let n = self.time_s.len();
        let pairs = self.time_s.windows(2);
        if let Some(k) = pairs
            .clone()
            .position(|t| t[1].partial_cmp(&t[0]) != Some(std::cmp::Ordering::Greater))
        {
            return refuse(format!(
                "time_s does not grow at instant {}; sort the instants",
                k + 1
            ));
        }
        if !self.time_s.iter().all(|t| t.is_finite()) {
            return refuse(
                "time_s holds a number that is not finite; leave that instant out".to_owned(),
            );
        }
        let lengths = [
            ("depth_mm", self.depth_mm.len()),
            ("force_n", self.force_n.len()),
            ("area_mm2", self.area_mm2.len()),
            ("tangential_force_n", self.tangential_force_n.len()),
            ("loads", self.loads.len()),
            ("frames", self.frames.len()),
        ];
        if let Some((name, found)) = lengths.iter().find(|(_, found)| *found != 0 && *found != n) {
            return refuse(format!(
                "{name} has {found} entries for {n} instants; give one each, or none"
            ));
        }
        let Some(mat) = mat else {
            return match self.frames.is_empty() && self.loads.is_empty() {
                true => Ok(()),
                false => refuse(
                    "there are frames or loads, but no mat; give the mat they belong to".to_owned(),
                ),
            };
        };
        match self
            .frames
            .iter()
            .position(|frame| frame.len() != mat.len())
        {
            None => Ok(()),
            Some(k) => refuse(format!(
                "frame {k} has {} values for {} sensels; give one per sensel",
                self.frames[k].len(),
                mat.len()
            )),
        }
    }
}
