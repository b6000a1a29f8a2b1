//! Steps of the outer loop on a zone: slopes, directions, lengths.

use super::setting::{SolveSetting, vertex};
use super::zone_state::ZoneState;
use crate::detection::press_direction::{LEAST_COSINE, MOST_DETOUR};
use crate::skin::prepare::Skin;

impl ZoneState {
    /// Takes the slope of the distance over the last step as the cosine of what does not fit: at an edge it lies between those of the sides.
    pub(crate) fn take_secants(&mut self, before: &[(f64, f64)], tolerance: f64) {
        let misfits = self.misfits();
        for k in 0..self.travel.len() {
            let way = self.travel[k] - before[k].0;
            let slope = (self.touch[k].distance - before[k].1) / way;
            if misfits[k] > tolerance && way != 0.0 && slope.is_finite() {
                self.cosine[k] = slope.clamp(LEAST_COSINE, 1.0);
            }
        }
    }

    /// Lets what does not fit yield along the normal of the wall that it was detected at, from where it was posed.
    pub(crate) fn yield_along_walls(
        &mut self,
        skin: &Skin,
        setting: &SolveSetting<'_>,
        tolerance: f64,
    ) {
        let misfits = self.misfits();
        let places = (0..misfits.len()).filter(|&k| misfits[k] > tolerance);
        self.turn_to_walls(skin, setting, &places.collect::<Vec<usize>>());
    }

    /// The same for what bears a force and was sent farther than its depth and [`MOST_DETOUR`]; whether there was any. Each is turned once.
    pub(crate) fn turn_strayed(&mut self, skin: &Skin, setting: &SolveSetting<'_>) -> bool {
        let has_strayed = |&k: &usize| {
            let is_bearing = self.force[k] > 0.0 && self.direction[k] != self.wall[k];
            is_bearing && self.travel[k] > self.depth(skin, setting, k) + MOST_DETOUR
        };
        let strayed: Vec<usize> = self.solved().into_iter().filter(has_strayed).collect();
        if !strayed.is_empty() {
            self.turn_to_walls(skin, setting, &strayed);
        }
        !strayed.is_empty()
    }

    fn turn_to_walls(&mut self, skin: &Skin, setting: &SolveSetting<'_>, places: &[usize]) {
        for &k in places {
            self.direction[k] = self.wall[k];
            (self.travel[k], self.cosine[k]) = (self.depth(skin, setting, k), 1.0);
        }
        self.place(skin, setting);
    }

    /// Depth at which a place was detected, mm.
    fn depth(&self, skin: &Skin, setting: &SolveSetting<'_>, k: usize) -> f64 {
        (-setting.detection.distances[vertex(skin, self.zone[k])]).max(0.0)
    }

    /// Takes back half the way of what did not come nearer to fitting, from travels and misfits (mm) that were better, and measures it.
    pub(crate) fn step_back(
        &mut self,
        skin: &Skin,
        setting: &SolveSetting<'_>,
        (travel, misfits): (&[f64], &[f64]),
    ) {
        let now = self.misfits();
        for k in 0..self.travel.len() {
            if now[k] > misfits[k] {
                self.travel[k] = 0.5 * (self.travel[k] + travel[k]);
            }
        }
        self.place(skin, setting);
    }
}
