//! A planned recording: its moments, and its noise model.

use nalgebra::{DMatrix, DVector};

use crate::forward::surrogate::force_recording::{ForceRecording, Row};
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::noise::channel::Channel;
#[cfg(test)]
use crate::noise::correlation::Correlation;
use crate::noise::correlation::Filter;
use crate::observe::measured::Phase;

/// Readings on every leg of a recording, and at its end without contact.
const READINGS: (usize, usize) = (24, 6);
/// Time without contact at the end, s, and how far the tool leaves, as a part of the depth.
const AFTER: (f64, f64) = (3.0, 0.15);

/// A recording that could be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Number of the tool at its site.
    pub place: usize,
    /// Largest depth, mm.
    pub depth_mm: f64,
    /// mm/s.
    pub speed_mm_s: f64,
    /// s.
    pub hold_s: f64,
    /// Loadings.
    pub cycles: u32,
}

/// The noise of a recording: what a reading adds to what the one before it said.
pub struct RecordingNoise {
    filter: Filter,
    /// By reading, what an innovation is divided by.
    deviation: Vec<f64>,
}

impl RecordingNoise {
    /// Of a course in a study, with a standard deviation of `sigma` (N).
    pub fn new(ready: &PreparedStudy, course: &ForceRecording, sigma: f64) -> RecordingNoise {
        let channel = Channel::Force as usize;
        let times = course.rows.iter().map(|row| (row.time_s, 1.0));
        let filter = ready.noise.correlation[channel].filter(times);
        RecordingNoise::filtered(sigma, filter, ready.noise.step[channel])
    }

    /// Noise of which each reading knows nothing of the others.
    #[cfg(test)]
    pub fn white(sigma: f64, readings: usize) -> RecordingNoise {
        let times = (0..readings).map(|k| (k as f64, 1.0));
        RecordingNoise::filtered(sigma, Correlation::NONE.filter(times), 1.0)
    }

    fn filtered(sigma: f64, filter: Filter, step: f64) -> RecordingNoise {
        let deviation = filter.variances().enumerate().map(|(k, variance)| match k {
            0 => sigma * variance.sqrt(),
            _ => sigma * (step * variance.sqrt()),
        });
        RecordingNoise {
            deviation: deviation.collect(),
            filter,
        }
    }

    /// Products of columns with each other in units of the noise, what the recording's own coordinates can take up taken out.
    pub fn square<'a>(
        &self,
        (columns, own): (impl Iterator<Item = &'a Vec<f64>>, &[Vec<f64>]),
    ) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = columns.map(|c| self.of(c)).collect();
        let all = DMatrix::from_columns(&columns);
        let mut square = all.tr_mul(&all);
        let own: Vec<DVector<f64>> = own.iter().map(|c| self.of(c)).collect();
        if !own.is_empty() {
            let own = DMatrix::from_columns(&own);
            let across = own.tr_mul(&all);
            let inner = own.tr_mul(&own) + DMatrix::identity(own.ncols(), own.ncols());
            if let Some(factor) = inner.cholesky() {
                square -= across.tr_mul(&factor.solve(&across));
            }
        }
        square
    }

    fn of(&self, column: &[f64]) -> DVector<f64> {
        let innovations = self.filter.innovations(|k| column[k]);
        let pairs = innovations.iter().zip(&self.deviation);
        DVector::from_iterator(column.len(), pairs.map(|(e, deviation)| e / deviation))
    }
}

/// The moments of a recording that is yet to be made, last of the session.
pub fn course(press: &Press, number: usize) -> ForceRecording {
    let mut rows = vec![row((0.0, 0.0), Phase::Apart, 0)];
    let leave = -AFTER.1 * press.depth_mm;
    let mut leg = |phase: Phase, (to_mm, seconds): (f64, f64), (count, cycle): (usize, u32)| {
        let from = rows[rows.len() - 1];
        for k in 1..=count {
            let share = k as f64 / count as f64;
            let depth = from.depth_mm + (to_mm - from.depth_mm) * share;
            let phase = if depth > 0.0 { phase } else { Phase::Apart };
            rows.push(row((from.time_s + seconds * share, depth), phase, cycle));
        }
    };
    for cycle in 0..press.cycles {
        let (down, up) = match cycle + 1 == press.cycles {
            true => (press.depth_mm, leave),
            false => (press.depth_mm, 0.0),
        };
        let way = |to: f64| to / press.speed_mm_s;
        leg(Phase::Load, (down, way(down)), (READINGS.0, cycle));
        if press.hold_s > 0.0 {
            leg(Phase::Hold, (down, press.hold_s), (READINGS.0, cycle));
        }
        leg(Phase::Unload, (up, way(down - up)), (READINGS.0, cycle));
    }
    leg(
        Phase::Apart,
        (leave, AFTER.0),
        (READINGS.1, press.cycles.saturating_sub(1)),
    );
    ForceRecording {
        is_coarse: false,
        recording: usize::MAX,
        name: String::new(),
        protocol: String::new(),
        place: press.place,
        order: number,
        travel_before_mm: [0.0; 2],
        rows,
        samples: (0, 0),
    }
}

fn row((time_s, depth_mm): (f64, f64), phase: Phase, cycle: u32) -> Row {
    Row {
        time_s,
        depth_mm,
        spread_mm: 0.0,
        force_step_n: 0.0,
        force_n: f64::NAN,
        sample: None,
        phase,
        cycle,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planned_press_loads_holds_unloads_and_rests() {
        let press = Press {
            place: 0,
            depth_mm: 0.8,
            speed_mm_s: 1.6,
            hold_s: 8.0,
            cycles: 2,
        };
        let one = course(&press, 3);
        let time = one.rows[one.rows.len() - 1].time_s;
        let leave = AFTER.1 * 0.8;
        assert!(
            (time - (3.2 + leave) / 1.6 - 16.0 - AFTER.0).abs() < 1e-9,
            "{time}"
        );
        assert!((one.deepest() - 0.8).abs() < 1e-12 && (one.hold_s() - 8.0).abs() < 0.5);
        assert!((one.speed() - 1.6).abs() < 1e-9);
        assert!(one.rows.windows(2).all(|w| w[1].time_s > w[0].time_s));
        let touches = |r: &Row| r.depth_mm > 0.0;
        assert!(
            one.rows
                .iter()
                .all(|r| touches(r) == (r.phase != Phase::Apart))
        );
    }
}
