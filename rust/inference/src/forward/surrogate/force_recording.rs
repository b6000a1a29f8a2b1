//! Force recordings as the surrogate predicts them: rows of a protocol with their force samples.

use thenar_recordings::Study;

use crate::checks::copies::copies;
use crate::forward::surrogate::mechanism::UseAtStart;
use crate::observe::measured::{Censoring, Measured, Moment, Phase, Quantity};

/// One moment of a protocol.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// s.
    pub time_s: f64,
    /// Depth as stated, mm.
    pub depth_mm: f64,
    /// Standard deviation of that depth over the readings, mm.
    pub spread_mm: f64,
    /// As [`Moment::force_step_n`].
    pub force_step_n: f64,
    /// Force that was measured, N; NaN where it is only planned.
    pub force_n: f64,
    /// Number of the force sample among all samples of the study.
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
    /// Loading travel of the protocols before it, and of all recordings before it, that no stated rest has undone, mm.
    pub travel_before_mm: [f64; 2],
    /// Moments.
    pub rows: Vec<Row>,
    /// Whether forces are rounded to steps that are larger than their noise.
    pub is_coarse: bool,
    /// First sample of the recording among all samples, and number of its samples.
    pub samples: (usize, usize),
}

impl ForceRecording {
    /// Largest force, N.
    pub fn most(&self) -> f64 {
        let forces = self.rows.iter().map(|row| row.force_n);
        forces.fold(0.0, f64::max)
    }

    /// Largest stated depth, mm.
    pub fn deepest(&self) -> f64 {
        let depths = self.rows.iter().map(|row| row.depth_mm);
        depths.fold(0.0, f64::max)
    }

    /// Loading travel before it, as the tissue's use at the start is taken, mm.
    pub fn travel_before(&self, start: UseAtStart) -> f64 {
        match start {
            UseAtStart::Rested => 0.0,
            UseAtStart::AfterProtocols => self.travel_before_mm[0],
            UseAtStart::AfterRecordings => self.travel_before_mm[1],
        }
    }

    /// Depth gained in contact over all loadings, mm: from the least depth of each to its largest, so that jitter does not count.
    pub fn loading_travel(&self) -> f64 {
        let last = self.rows.last().map_or(0, |row| row.cycle);
        let of = |cycle: u32| {
            let rows = self.rows.iter().filter(move |r| r.cycle == cycle);
            let loading = rows.filter(|r| matches!(r.phase, Phase::Load | Phase::Hold));
            let depths = loading.map(|r| r.depth_mm.max(0.0));
            let (low, high) = depths.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), d| {
                (low.min(d), high.max(d))
            });
            (high - low).max(0.0)
        };
        (0..=last).map(of).sum()
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
    let (mut first, copies) = (0, copies(measured));
    let mut found = Vec::new();
    for (recording, one) in measured.iter().enumerate() {
        let start = first;
        first += one.samples.len();
        let is_known = one.moments.iter().all(|m| m.depth_mm.is_finite());
        let is_still = one.moments.iter().all(|m| m.slide_mm.norm() == 0.0);
        if !is_known
            || one.moments.len() < 8
            || !one.is_calibrated
            || !is_still
            || copies.iter().any(|(copy, _)| *copy == recording)
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
            travel_before_mm: [0.0; 2],
            is_coarse: one.is_coarse,
            rows,
            samples: (start, one.samples.len()),
        });
    }
    let of = |c: &ForceRecording| &study.recordings[c.recording];
    let stated = |c: &ForceRecording| of(c).order.unwrap_or(c.recording as f64);
    let mut by_order: Vec<usize> = (0..found.len()).collect();
    by_order.sort_by(|a, b| stated(&found[*a]).total_cmp(&stated(&found[*b])));
    for (order, course) in by_order.iter().enumerate() {
        found[*course].order = order;
    }
    let is_in_order = |c: &ForceRecording| of(c).order.is_some() && of(c).rest_s.is_none();
    if found.iter().all(is_in_order) {
        let tissue = |course: &usize| {
            let stated = &study.recordings[found[*course].recording];
            (&stated.subject, &stated.day, &stated.site)
        };
        for own in by_tissue(&by_order, tissue) {
            carry_use(&mut found, &own);
        }
    }
    found
}

/// Recordings of each tissue, in the order given.
fn by_tissue<T: PartialEq>(by_order: &[usize], tissue: impl Fn(&usize) -> T) -> Vec<Vec<usize>> {
    let mut tissues: Vec<Vec<usize>> = Vec::new();
    for course in by_order {
        let is_own = |one: &&mut Vec<usize>| tissue(&one[0]) == tissue(course);
        match tissues.iter_mut().find(is_own) {
            Some(own) => own.push(*course),
            None => tissues.push(vec![*course]),
        }
    }
    tissues
}

/// Adds up what was traveled before each recording of one tissue (a site of a subject on one day), in the session's order. What the first repeat of a protocol finds, its other repeats
/// find, where repeats begin alike.
pub(crate) fn carry_use(courses: &mut [ForceRecording], by_order: &[usize]) {
    let (mut protocols, mut recordings) = (0.0, 0.0);
    let mut begun: Vec<(String, f64)> = Vec::new();
    for course in by_order {
        let one = &mut courses[*course];
        let travel = one.loading_travel();
        let known = begun.iter().find(|(name, _)| *name == one.protocol);
        let before = known.map(|(_, before)| *before);
        one.travel_before_mm = [before.unwrap_or(protocols), recordings];
        if before.is_none() {
            begun.push((one.protocol.clone(), protocols));
            protocols += travel;
        }
        recordings += travel;
    }
}

/// Whether use can be carried from recording to recording, and be known by it: the order is stated, no rest is, and cycles show
/// whether use softens.
pub(crate) fn carries_use(courses: &[ForceRecording]) -> bool {
    let cycles = |c: &ForceRecording| c.rows.iter().any(|row| row.cycle > 0);
    courses.iter().any(|c| c.travel_before_mm[1] > 0.0) && courses.iter().any(cycles)
}

fn rows(measured: &Measured, start: usize) -> Vec<Row> {
    let row = |m: &Moment| Row {
        time_s: m.time_s,
        depth_mm: m.depth_mm,
        spread_mm: m.depth_spread_mm,
        force_step_n: m.force_step_n,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::candidate_model::Model;
    use crate::forward::surrogate::mechanism::Law;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::least_squares::surrogate_fit::refit;
    use crate::selection::candidates::singles;
    use thenar_contact::effects::Effect;

    /// `cycles` triangles of 2 mm at 1 mm/s, without forces.
    fn triangles(cycles: u32) -> Vec<Reading> {
        let row = |k: u32| {
            let time = f64::from(k) / 20.0;
            let way = time % 4.0;
            let phase = if way < 2.0 {
                Phase::Load
            } else {
                Phase::Unload
            };
            (time, 2.0 - (way - 2.0).abs(), phase, 0.0)
        };
        (0..=80 * cycles).map(row).collect()
    }

    /// Recordings of these numbers of cycles and protocols, in this order.
    fn recordings(of: &[(u32, &str)]) -> Vec<ForceRecording> {
        let all: Vec<_> = of
            .iter()
            .map(|(cycles, _)| (0, triangles(*cycles)))
            .collect();
        let mut courses = ready(vec![tool(2.0, |d| d, |_| 1.0)], &all, 0.1).0.courses;
        for (course, (_, protocol)) in courses.iter_mut().zip(of) {
            course.protocol = (*protocol).to_owned();
            for row in &mut course.rows {
                row.cycle = (row.time_s / 4.0) as u32;
            }
        }
        courses
    }

    #[test]
    fn loading_travel_adds_up_over_recordings_and_protocols_in_session_order() {
        // Taken in the order 2, 0, 1, 3: three cycles, two repeats of a press, one cycle.
        let mut courses = recordings(&[(1, "press"), (1, "press"), (3, "cycles"), (1, "last")]);
        carry_use(&mut courses, &[2, 0, 1, 3]);
        let wanted = [[6.0, 6.0], [6.0, 8.0], [0.0, 0.0], [8.0, 10.0]];
        for (course, wanted) in courses.iter().zip(wanted) {
            for (found, wanted) in course.travel_before_mm.iter().zip(wanted) {
                // The last step of a loading, 0.05 mm, ends where unloading begins.
                let short = wanted - found;
                assert!(
                    (-1e-9..0.026 * wanted + 1e-9).contains(&short),
                    "{found} {wanted}"
                );
            }
        }
        assert!(carries_use(&courses));
        courses
            .iter_mut()
            .for_each(|c| c.travel_before_mm = [0.0; 2]);
        assert!(!carries_use(&courses), "the tissue has rested");
    }

    /// Recordings 0 and 3 are of another finger: what 2 and 1 did before them does not count there.
    #[test]
    fn use_of_one_site_is_not_carried_to_another() {
        let fingers = ["index", "thumb", "thumb", "index"];
        let own = by_tissue(&[2, 0, 1, 3], |course| fingers[*course]);
        assert_eq!(own, [vec![2, 1], vec![0, 3]]);
        let mut courses = recordings(&[(1, "a"), (1, "b"), (3, "c"), (1, "d")]);
        for one in &own {
            carry_use(&mut courses, one);
        }
        let before: Vec<f64> = courses
            .iter()
            .map(|c| c.travel_before_mm[1].round())
            .collect();
        assert_eq!(before, [0.0, 6.0, 0.0, 2.0]);
    }

    /// Forces of a closed form in which damage never heals: the carried laws find its share, the rested one cannot.
    #[test]
    fn softening_carried_over_a_session_is_found_in_its_own_form() {
        let (share, travel) = (0.3, 5.0);
        let mut courses = recordings(&[(4, "cycles"), (1, "press"), (1, "press")]);
        let mut gone: f64 = 0.0;
        let mut all = Vec::new();
        for course in &mut courses {
            let mut last = 0.0;
            let read = |row: &Row| {
                gone += (row.depth_mm - last).max(0.0);
                last = row.depth_mm;
                let left = 1.0 - share * (1.0 - libm::exp(-gone / travel));
                (
                    row.time_s,
                    row.depth_mm,
                    row.phase,
                    10.0 * row.depth_mm * left,
                )
            };
            all.push((0, course.rows.iter().map(read).collect::<Vec<Reading>>()));
        }
        let (mut ready, _) = ready(vec![tool(2.0, |d| 10.0 * d, |_| 1.0)], &all, 0.02);
        for (course, of) in ready.courses.iter_mut().zip(&courses) {
            course.protocol.clone_from(&of.protocol);
            for (row, cycle) in course.rows.iter_mut().zip(&of.rows) {
                row.cycle = cycle.cycle;
            }
        }
        carry_use(&mut ready.courses, &[0, 1, 2]);
        ready.scales.carries_use = carries_use(&ready.courses);
        let tried = singles(ready.scales);
        let surrogate = ready.surrogate();
        let mut best = [f64::INFINITY; 2];
        let mut found = 0.0;
        for mechanism in tried.iter().filter(|m| m.effect == Effect::CycleSoftening) {
            let Law::Softening { start, .. } = mechanism.law else {
                unreachable!("softening by use")
            };
            let one = [mechanism.clone()];
            let fit = refit(&surrogate, &Model::new(&surrogate, &one), &[]);
            let rested = usize::from(start == UseAtStart::Rested);
            if fit.deviance < best[rested] {
                best[rested] = fit.deviance;
                found = if rested == 0 {
                    *fit.at.last().unwrap()
                } else {
                    found
                };
            }
        }
        assert!(best[0] < 0.2 * best[1], "{best:?}");
        assert!((found / share - 1.0).abs() < 0.15, "{found}");
    }
}
