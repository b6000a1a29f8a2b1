//! Presses that hum, stick, are read in steps, or only scatter: what of them counts as waves that repeats share.

use super::*;
use crate::forward::surrogate::synthetic::{Reading, ready, tool};
use crate::observe::measured::Phase;
use crate::observe::motion::rounding::wide_step;
use crate::random::Random;

/// Repeats of a press of a flat punch of 10 N/mm to 1 mm at 1 mm/s and back, read 100 times a way.
#[derive(Default, Clone)]
struct Presses {
    /// All but the first two, which there always are.
    more_repeats: usize,
    /// Size of a hum of 8 Hz, N, whose phase in each repeat is another.
    hum: f64,
    /// Standard deviation of noise, N; part of it that the next sample keeps.
    noise: (f64, f64),
    /// Teeth in the force, N from top to bottom, over 0.15 mm of way; and by how much of one those of each repeat begin later.
    teeth: (f64, f64),
    /// Whether teeth are of that size at full depth only, and grow with it.
    teeth_grow: bool,
    /// The stage goes in steps, of which ten make a tooth's way.
    goes_in_steps: bool,
    /// Step in which the depth is read, mm, and the force, N.
    read_in: (f64, f64),
    /// Readings (by number) that are off by 2 N in the first repeats.
    astray: [Option<usize>; 4],
    /// Seconds by which each repeat's samples come later, but for its first.
    later_s: f64,
    /// Whether the hum is known, so that it is taken off.
    knows_hum: bool,
    /// Whether each recording is of a protocol of its own, which presses more slowly than the one before.
    at_other_speeds: bool,
    /// Part of the force that is lost on the way out, which the model does not have.
    lost: f64,
    /// Whether every second recording is made at another site.
    at_two_sites: bool,
    /// What the model does not have at full depth, N; it grows as the cube of the depth.
    bend: f64,
}

impl Presses {
    fn reading(&self, repeat: usize, k: usize, noise: f64) -> Reading {
        let time = 0.01 * k as f64 + self.later_s * (repeat * k.min(1)) as f64;
        let way = match self.goes_in_steps {
            true => (time / 0.06).floor() * 0.06,
            false => time,
        };
        let depth = if way < 1.0 { way } else { 2.0 - way };
        let side = if way < 1.0 { 1.0 } else { -1.0 };
        let phase = if time < 1.0 {
            Phase::Load
        } else {
            Phase::Unload
        };
        let (most, later) = self.teeth;
        let most = if self.teeth_grow {
            most * depth * depth
        } else {
            most
        };
        let tooth = (way / 0.15 + later * repeat as f64).fract() - 0.5;
        let astray = if self.astray.get(repeat) == Some(&Some(k)) {
            2.0
        } else {
            0.0
        };
        let rounded = |x: f64, step: f64| {
            if step > 0.0 {
                (x / step).round() * step
            } else {
                x
            }
        };
        let kept = if way < 1.0 { 1.0 } else { 1.0 - self.lost };
        let force =
            kept * 10.0 * depth + self.bend * depth.powi(3) + side * most * tooth + noise + astray;
        (
            time,
            rounded(depth, self.read_in.0),
            phase,
            rounded(rounded(force, self.read_in.1), self.written_n()),
        )
    }

    /// What a file of three decimals, or of seven where noise is as small, holds.
    fn written_n(&self) -> f64 {
        if self.noise.0 < 1e-3 { 1e-7 } else { 1e-3 }
    }

    fn hum_hz(&self) -> Option<f64> {
        self.knows_hum.then_some(8.0)
    }

    fn found(&self, seed: u64) -> ShortWaves {
        let mut random = Random::new(seed);
        let (sigma, keeps) = self.noise;
        let mut recordings = Vec::new();
        for repeat in 0..2 + self.more_repeats {
            let phase = std::f64::consts::TAU * random.uniform();
            let mut noise = sigma * random.normal();
            let mut all = Vec::new();
            for k in 0..200 {
                noise = keeps * noise + (1.0 - keeps * keeps).sqrt() * sigma * random.normal();
                let turn = std::f64::consts::TAU * 0.08 * k as f64 + phase;
                all.push(self.reading(repeat, k, noise + self.hum * libm::sin(turn)));
            }
            let site = usize::from(self.at_two_sites) * (repeat % 2);
            recordings.push((site, all));
        }
        let (mut made, _) = ready(
            [0, 1].map(|_| tool(1.0, |d| d, |_| 1.0)).into(),
            &recordings,
            sigma,
        );
        for (number, course) in made.courses.iter_mut().enumerate() {
            if self.at_other_speeds {
                let slower = 1.0 + number as f64;
                course.rows.iter_mut().for_each(|row| row.time_s *= slower);
                course.protocol = slower.to_string();
            }
            let forces: Vec<f64> = course.rows.iter().map(|row| row.force_n).collect();
            let step_n = wide_step(&forces);
            let rows = course.rows.iter_mut();
            rows.for_each(|row| row.force_step_n = step_n);
        }
        let depths = made.courses.iter().flat_map(|c| &c.rows);
        let simulated: Vec<f64> = depths.map(|row| 10.0 * row.depth_mm).collect();
        short_waves(&made.courses, &[0, 1], (&simulated, self.hum_hz())).expect("repeats")
    }

    /// The most that ten seeds show.
    fn most(&self) -> f64 {
        let each = (1..11).map(|seed| self.found(seed).standard_errors);
        each.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The least that ten seeds show.
    fn least(&self) -> f64 {
        let each = (1..11).map(|seed| self.found(seed).standard_errors);
        each.fold(f64::INFINITY, f64::min)
    }
}

const NOISE: (f64, f64) = (0.05, 0.0);
/// Teeth that grow with the depth, N: seen as waves count in proportion to the force, and not in all draws where all count alike.
const GROWING_N: f64 = 0.2;

#[test]
fn noise_shares_no_waves_however_long_it_remembers() {
    let all = [0, 1]
        .into_iter()
        .flat_map(|more| [0.0, 0.5, 0.9, 0.99].map(|keeps| (more, keeps)));
    for (more_repeats, keeps) in all {
        let quiet = Presses {
            more_repeats,
            noise: (0.05, keeps),
            ..Presses::default()
        };
        assert!(quiet.most() < 4.0, "{keeps}: {}", quiet.most());
    }
}

/// The sum over six pairs of repeats has the standard error that it is given, though neighbors are alike.
#[test]
fn sum_over_several_pairs_knows_that_noise_remembers() {
    let quiet = Presses {
        more_repeats: 2,
        noise: (0.05, 0.9),
        ..Presses::default()
    };
    let each = (1..401).map(|seed| quiet.found(seed).standard_errors);
    let most = each.fold(f64::NEG_INFINITY, f64::max);
    assert!(most < 4.0, "{most}");
}

/// Teeth of four times the noise from top to bottom: their root mean square is that over the root of 12.
#[test]
fn teeth_at_the_same_way_are_shared_and_measured() {
    let teeth = Presses {
        more_repeats: 1,
        noise: NOISE,
        teeth: (0.2, 0.0),
        ..Presses::default()
    };
    assert!(teeth.least() > 4.0, "{}", teeth.least());
    let larger = Presses {
        teeth: (0.3, 0.0),
        ..teeth.clone()
    };
    let rms = larger.found(1).rms_n * 12f64.sqrt();
    assert!((0.2..0.4).contains(&rms), "{rms}");
    // Samples of the second repeat fall between those of the first, or half a tooth on.
    let between = Presses {
        later_s: 0.004,
        ..teeth.clone()
    };
    assert!(between.least() > 4.0, "{}", between.least());
    let one_astray = Presses {
        astray: [Some(60), None, None, None],
        ..teeth.clone()
    };
    assert!(one_astray.least() > 4.0, "{}", one_astray.least());
    let apart = Presses {
        teeth: (0.2, 0.5),
        ..teeth
    };
    assert!(apart.most() < 4.0, "{}", apart.most());
}

/// Each shares waves in the force or in the rest, and neither in both; a force that is read in steps shares them in both.
#[test]
fn steps_of_the_stage_and_of_the_readings_are_no_waves_of_the_skin() {
    let quiet = Presses {
        noise: (0.005, 0.0),
        ..Presses::default()
    };
    let stage = Presses {
        goes_in_steps: true,
        ..quiet.clone()
    };
    assert!(stage.most() < 4.0, "{}", stage.most());
    let read_in = |read_in: (f64, f64)| Presses {
        read_in,
        ..quiet.clone()
    };
    let (encoder, converter) = (read_in((0.03, 0.0)), read_in((0.0, 0.3)));
    // Steps of 12 bits, as a file of three decimals has them.
    for range_n in [900.0, 1000.0, 1100.0, 1200.0] {
        let as_written = read_in((0.0, range_n / 4096.0));
        assert!(as_written.most() < 4.0, "{range_n}: {}", as_written.most());
    }
    assert!(encoder.most() < 4.0, "{}", encoder.most());
    assert!(converter.most() < 4.0, "{}", converter.most());
}

/// Phases of two repeats are alike by chance: held against what differs between them alone, a fifth of these would be above 4.
#[test]
fn hum_that_is_in_step_by_chance_is_not_shared_by_two_repeats() {
    let hum = Presses {
        noise: NOISE,
        hum: 0.07,
        ..Presses::default()
    };
    let often = (1..201).filter(|seed| hum.found(*seed).standard_errors > 4.0);
    assert!(often.count() <= 2);
}

/// Of three repeats, so that several pairs may agree by chance; and teeth are seen through it.
#[test]
fn hum_that_is_known_is_taken_off() {
    let hum = Presses {
        more_repeats: 1,
        noise: NOISE,
        hum: 0.5,
        knows_hum: true,
        ..Presses::default()
    };
    assert!(hum.most() < 4.0, "{}", hum.most());
    let with_teeth = Presses {
        teeth: (0.3, 0.0),
        ..hum
    };
    assert!(with_teeth.least() > 4.0, "{}", with_teeth.least());
    let not_taken_off = Presses {
        knows_hum: false,
        ..with_teeth
    };
    assert!(not_taken_off.least() < 4.0, "{}", not_taken_off.least());
}

/// What the way out loses is alike in all repeats, and no hum.
#[test]
fn hum_is_taken_off_without_what_the_model_does_not_have() {
    let hum = Presses {
        more_repeats: 2,
        noise: (0.02, 0.0),
        hum: 0.05,
        knows_hum: true,
        lost: 0.15,
        ..Presses::default()
    };
    assert!(hum.most() < 4.0, "{}", hum.most());
}

#[test]
fn curve_that_bends_more_than_the_model_is_no_wave_of_many_protocols() {
    let bent = Presses {
        more_repeats: 6,
        noise: (0.02, 0.0),
        at_other_speeds: true,
        bend: 1.0,
        ..Presses::default()
    };
    assert!(bent.most() < 4.0, "{}", bent.most());
}

/// Of 28 pairs, of which each recording is in seven: sums of their products are skewed.
#[test]
fn sum_over_pairs_that_share_recordings_is_as_rare_as_it_says() {
    for keeps in [0.0, 0.8] {
        let quiet = Presses {
            more_repeats: 6,
            noise: (0.05, keeps),
            at_other_speeds: true,
            ..Presses::default()
        };
        let each = (1..301).map(|seed| quiet.found(seed).standard_errors);
        let most = each.fold(f64::NEG_INFINITY, f64::max);
        assert!(most < 4.0, "{keeps}: {most}");
    }
}

/// Recordings of other protocols have no moments in common, and the same depths.
#[test]
fn teeth_at_the_same_depth_are_shared_at_any_speed() {
    let quiet = Presses {
        more_repeats: 2,
        noise: NOISE,
        at_other_speeds: true,
        ..Presses::default()
    };
    assert!(quiet.most() < 4.0, "{}", quiet.most());
    let teeth = Presses {
        teeth: (0.2, 0.0),
        ..quiet.clone()
    };
    assert!(teeth.least() > 4.0, "{}", teeth.least());
    assert!(teeth.found(1).is_by_depth);
    let growing = Presses {
        teeth: (GROWING_N, 0.0),
        teeth_grow: true,
        ..quiet.clone()
    };
    assert!(growing.least() > 4.0, "{}", growing.least());
    // Two and two, each at a site of its own.
    let elsewhere = Presses {
        at_two_sites: true,
        ..teeth.clone()
    };
    assert!(elsewhere.least() < teeth.least());
    let apart = Presses {
        teeth: (0.2, 0.37),
        ..quiet
    };
    assert!(apart.most() < 4.0, "{}", apart.most());
}

/// Of 10 N, read within 0.1 mN. A single running mean leaves 2 mN of a curve that bends by 0.5 N more than the model does.
#[test]
fn what_a_precise_cell_sees_of_a_curve_or_of_the_model_is_no_wave() {
    let precise = Presses {
        more_repeats: 1,
        noise: (1e-4, 0.0),
        bend: 0.5,
        ..Presses::default()
    };
    assert!(precise.most() < 4.0, "{}", precise.most());
    let of_teeth = |most_n: f64| Presses {
        teeth: (most_n, 0.0),
        ..precise.clone()
    };
    let (within, beyond) = (of_teeth(0.002), of_teeth(0.02));
    assert!(within.most() < 4.0, "{}", within.most());
    assert!(beyond.least() > 4.0, "{}", beyond.least());
}

#[test]
fn readings_that_are_astray_decide_nothing() {
    let far = Presses {
        noise: NOISE,
        astray: [Some(60), Some(60), None, None],
        ..Presses::default()
    };
    assert!(far.most() < 4.0, "{}", far.most());
    // As where a switch of the stage is heard in each.
    let in_all = Presses {
        more_repeats: 2,
        astray: [Some(60); 4],
        ..far
    };
    assert!(in_all.most() < 4.0, "{}", in_all.most());
}
