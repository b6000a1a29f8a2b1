//! Force recordings as the surrogate predicts them: rows of a protocol with their force samples.

use thenar_recordings::Study;

use crate::observe::measured::{Censoring, Measured, Phase, Quantity};

/// One moment of a protocol.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// s.
    pub time_s: f64,
    /// Depth as stated, mm.
    pub depth_mm: f64,
    /// Force that was measured, N; NaN where it is only planned.
    pub force_n: f64,
    /// Number of the force sample among all samples of the study, stacked.
    pub sample: Option<usize>,
    /// Part of the protocol.
    pub phase: Phase,
    /// Loadings before this one.
    pub cycle: u32,
}

/// A recording of force over depth.
#[derive(Debug, Clone)]
pub struct ForceRecording {
    /// Number of the recording in the study.
    pub recording: usize,
    /// Name.
    pub name: String,
    /// Protocol that its repeats share.
    pub protocol: String,
    /// Number of the tool at its site.
    pub place: usize,
    /// Place in the session, from 0: as the study orders its recordings, or else as they stand.
    pub order: usize,
    /// Moments.
    pub rows: Vec<Row>,
    /// First sample of the recording among all samples, and number of its samples.
    pub samples: (usize, usize),
}

impl ForceRecording {
    /// Largest force, N.
    pub fn most(&self) -> f64 {
        self.rows
            .iter()
            .fold(0.0, |most, row| f64::max(most, row.force_n))
    }

    /// Largest stated depth, mm.
    pub fn deepest(&self) -> f64 {
        self.rows
            .iter()
            .fold(0.0, |most, row| f64::max(most, row.depth_mm))
    }

    /// Longest time at one depth in contact, s.
    pub fn hold_s(&self) -> f64 {
        let mut longest: f64 = 0.0;
        let mut begun = None;
        for row in &self.rows {
            match (row.phase, begun) {
                (Phase::Hold, None) => begun = Some(row.time_s),
                (Phase::Hold, Some(start)) => longest = longest.max(row.time_s - start),
                _ => begun = None,
            }
        }
        longest
    }

    /// Typical speed of loading, mm/s; 0 if it never loads.
    pub fn speed(&self) -> f64 {
        let pairs = self.rows.windows(2);
        let loading = pairs.filter(|w| w[1].phase == Phase::Load && w[1].depth_mm > w[0].depth_mm);
        let mut rates: Vec<f64> = loading
            .map(|w| (w[1].depth_mm - w[0].depth_mm) / (w[1].time_s - w[0].time_s))
            .collect();
        match rates.is_empty() {
            true => 0.0,
            false => crate::observe::robust_scale::median(&mut rates),
        }
    }
}

/// Whether some recording goes on after its loading: holds, unloads or is read after contact.
pub fn goes_on(courses: &[ForceRecording]) -> bool {
    let after = |row: &&Row| matches!(row.phase, Phase::Hold | Phase::Unload | Phase::Slide);
    courses
        .iter()
        .any(|c| c.rows.iter().filter(after).count() >= FEW)
}

/// Whether some recording unloads.
pub fn unloads(courses: &[ForceRecording]) -> bool {
    let unloading = |row: &&Row| row.phase == Phase::Unload;
    courses
        .iter()
        .any(|c| c.rows.iter().filter(unloading).count() >= FEW)
}

/// Whether one tool was pressed at speeds that differ by twice or more.
pub fn changes_speed(courses: &[ForceRecording]) -> bool {
    let differ =
        |a: &ForceRecording, b: &ForceRecording| a.place == b.place && a.speed() > 2.0 * b.speed();
    courses
        .iter()
        .any(|a| courses.iter().any(|b| b.speed() > 0.0 && differ(a, b)))
}

/// Rows from which a part of a protocol counts as recorded.
const FEW: usize = 4;

/// Recordings of which force and depth are known, in the study's order.
pub(crate) fn force_recordings(
    study: &Study,
    measured: &[Measured],
    place_of: &[usize],
) -> Vec<ForceRecording> {
    let mut first = 0;
    let mut found = Vec::new();
    for (recording, one) in measured.iter().enumerate() {
        let start = first;
        first += one.samples.len();
        let is_known = one.moments.iter().all(|m| m.depth_mm.is_finite());
        let still = |m: &crate::observe::measured::Moment| m.slide_mm.norm() == 0.0;
        if !is_known
            || one.moments.len() < 8
            || !one.is_calibrated
            || !one.moments.iter().all(still)
        {
            continue;
        }
        let rows = rows(one, start);
        if rows.iter().filter(|row| row.sample.is_some()).count() < 8 {
            continue;
        }
        found.push(ForceRecording {
            recording,
            name: one.name.clone(),
            protocol: one.protocol.clone(),
            place: place_of[recording],
            order: 0,
            rows,
            samples: (start, one.samples.len()),
        });
    }
    let stated = |c: &ForceRecording| {
        study.recordings[c.recording]
            .order
            .unwrap_or(c.recording as f64)
    };
    let mut by_order: Vec<usize> = (0..found.len()).collect();
    by_order.sort_by(|a, b| stated(&found[*a]).total_cmp(&stated(&found[*b])));
    for (order, course) in by_order.into_iter().enumerate() {
        found[course].order = order;
    }
    found
}

fn rows(measured: &Measured, start: usize) -> Vec<Row> {
    let row = |m: &crate::observe::measured::Moment| Row {
        time_s: m.time_s,
        depth_mm: m.depth_mm,
        force_n: 0.0,
        sample: None,
        phase: m.phase,
        cycle: m.cycle,
    };
    let mut rows: Vec<Row> = measured.moments.iter().map(row).collect();
    for (k, sample) in measured.samples.iter().enumerate() {
        let is_seen = sample.censoring == Censoring::Seen;
        if sample.quantity == Quantity::Force && is_seen {
            let row = &mut rows[sample.moment as usize];
            (row.force_n, row.sample) = (sample.value, Some(start + k));
        }
    }
    rows
}
