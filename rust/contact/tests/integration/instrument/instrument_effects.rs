//! Instrument effects against closed forms: amplitude 0, each law, the order, and what is refused.

use thenar_contact::ActiveEffect;
use thenar_contact::effects::{CATALOGUE, Effect, Entry};
use thenar_contact::instrument::{Mat, MatLayout, PointLoad, Signals, observe};
use thenar_surface::Vec3;

const SIDE: usize = 6;

fn mat() -> Mat {
    mat_of(|_| 25.0)
}

fn mat_of(area: impl Fn(usize) -> f64) -> Mat {
    let mut layout = MatLayout {
        along: Some(Vec3::x()),
        ..MatLayout::default()
    };
    for k in 0..SIDE * SIDE {
        let (row, column) = ((k / SIDE) as f64, (k % SIDE) as f64);
        layout
            .centers
            .push(Vec3::new(5.0 * column - 12.5, 5.0 * row - 12.5, 0.0));
        layout.normals.push(Vec3::z());
        layout.areas.push(area(k));
    }
    Mat::new(layout).unwrap()
}

/// Loads on a ring that grows with time, and channels to go with them.
fn signals() -> Signals {
    let mut signals = Signals::default();
    for k in 0..40 {
        let time = 0.05 * f64::from(k);
        let depth = (2.0 * time).sin().abs();
        let loads = (0..60).map(|j| {
            let angle = 0.3 * f64::from(j);
            let r = 4.0 * depth + 0.03 * f64::from(j);
            PointLoad {
                position: Vec3::new(r * angle.cos(), r * angle.sin(), 0.1),
                force_n: 0.01 * depth,
                area_mm2: 2.0,
            }
        });
        signals.time_s.push(time);
        signals.depth_mm.push(depth);
        signals.force_n.push(0.6 * depth);
        signals.area_mm2.push(50.0 * depth);
        signals.tangential_force_n.push(0.1 * depth);
        signals.loads.push(loads.collect());
    }
    signals
}

fn instruments() -> impl Iterator<Item = &'static (Effect, &'static Entry)> {
    CATALOGUE.iter().filter(|(_, entry)| entry.is_instrument())
}

fn named(name: &str) -> ActiveEffect {
    ActiveEffect::named(name, 1.0).unwrap()
}

/// The effect as it stands, painted where it must be.
fn ready(effect: Effect, amplitude: f64) -> ActiveEffect {
    let active = ActiveEffect::new(effect, amplitude);
    match effect {
        Effect::DeadCells => active.painted(
            (0..SIDE * SIDE)
                .map(|k| f64::from(u8::from(k % 5 == 0)))
                .collect(),
        ),
        Effect::Saturation => active.with("ceiling_kpa", 3.0).unwrap(),
        Effect::Threshold => active.with("floor_kpa", 2.0).unwrap(),
        _ => active,
    }
}

#[test]
fn there_are_the_nine_of_the_catalogue_and_dead_cells() {
    let names: Vec<&str> = instruments().map(|(_, entry)| entry.name).collect();
    for name in [
        "gain",
        "offset",
        "drift",
        "saturation",
        "threshold",
        "crosstalk",
        "misregistration",
        "fixture_compliance",
        "timing",
        "dead_cells",
    ] {
        assert!(names.contains(&name), "{name}");
    }
    assert_eq!(names.len(), 10);
    assert!(CATALOGUE.iter().all(|(_, e)| e.kind()
        == if names.contains(&e.name) {
            "instrument"
        } else {
            "tissue"
        }));
}

#[test]
fn amplitude_zero_is_the_bare_reading_bit_for_bit_and_one_is_not() {
    let (mat, signals) = (mat(), signals());
    let bare = observe(&signals, Some(&mat), &[]).unwrap();
    assert_eq!(bare.frames[7], mat.read(&signals.loads[7]));
    assert_eq!(
        (&bare.force_n, &bare.depth_mm),
        (&signals.force_n, &signals.depth_mm)
    );
    for &(effect, entry) in instruments() {
        let off = observe(&signals, Some(&mat), &[ready(effect, 0.0)]).unwrap();
        assert_eq!(bare, off, "{}", entry.name);
        let on = observe(&signals, Some(&mat), &[ready(effect, 1.0)]).unwrap();
        assert_ne!(bare, on, "{}", entry.name);
    }
}

#[test]
fn the_order_given_does_not_matter() {
    let (mat, signals) = (mat(), signals());
    let all: Vec<ActiveEffect> = instruments()
        .map(|(effect, _)| ready(*effect, 0.7))
        .collect();
    let back: Vec<ActiveEffect> = all.iter().rev().cloned().collect();
    let (a, b) = (
        observe(&signals, Some(&mat), &all).unwrap(),
        observe(&signals, Some(&mat), &back).unwrap(),
    );
    assert_eq!(a, b);
    assert!(a.frames.iter().flatten().all(|p| p.is_finite()));
}

#[test]
fn effects_follow_one_another_as_documented() {
    // A reading of 100: crosstalk aside, gain 1.1, then offset 5, then a ceiling of 112, then a floor.
    let mut signals = Signals {
        time_s: vec![0.0],
        ..Signals::default()
    };
    signals.frames = vec![vec![100.0; SIDE * SIDE]];
    let saturation = named("saturation").with("ceiling_kpa", 112.0).unwrap();
    let offset = named("offset").with("offset_kpa", 5.0).unwrap();
    let read =
        |effects: &[ActiveEffect]| observe(&signals, Some(&mat()), effects).unwrap().frames[0][0];
    assert!((read(&[offset.clone(), named("gain")]) - 115.0).abs() < 1e-9);
    assert!((read(&[saturation.clone(), offset, named("gain")]) - 112.0).abs() < 1e-9);
    let low = named("gain").with("error", -0.97).unwrap();
    assert_eq!(read(&[named("threshold"), saturation, low]), 0.0);
}

#[test]
fn an_offset_is_added_to_the_force_and_half_a_threshold_halves() {
    let offset = named("offset").choose("channel", "force").unwrap();
    let more = offset.shape[1];
    let signals = signals();
    let read = observe(&signals, Some(&mat()), &[offset]).unwrap();
    for (found, force) in read.force_n.iter().zip(&signals.force_n) {
        assert!(more != 0.0 && (found - force - more).abs() < 1e-12);
    }
    let mut faint = Signals {
        time_s: vec![0.0],
        ..Signals::default()
    };
    faint.frames = vec![vec![1.0; SIDE * SIDE]];
    let half = ready(Effect::Threshold, 0.5);
    let read = observe(&faint, Some(&mat()), &[half]).unwrap();
    assert!(read.frames[0].iter().all(|p| (p - 0.5).abs() < 1e-12));
}

#[test]
fn crosstalk_keeps_the_force_of_sensels_of_any_size() {
    let mat = mat_of(|k| 20.0 + (k % 4) as f64);
    let signals = Signals {
        time_s: vec![0.0],
        frames: vec![(0..SIDE * SIDE).map(|k| (k % 7) as f64).collect()],
        ..Signals::default()
    };
    let blurred = observe(&signals, Some(&mat), &[named("crosstalk")]).unwrap();
    let (before, after) = (&signals.frames[0], &blurred.frames[0]);
    assert!(before.iter().zip(after).any(|(a, b)| (a - b).abs() > 0.01));
    assert!((mat.force_n(before) - mat.force_n(after)).abs() < 1e-12);
}

#[test]
fn crosstalk_keeps_force_and_evenness_and_blurs_an_edge() {
    let (mat, signals) = (mat(), signals());
    let bare = observe(&signals, Some(&mat), &[]).unwrap();
    let blurred = observe(&signals, Some(&mat), &[named("crosstalk")]).unwrap();
    for (a, b) in bare.frames.iter().zip(&blurred.frames) {
        assert!((mat.force_n(a) - mat.force_n(b)).abs() < 1e-12);
    }
    let of = |frame: Vec<f64>| {
        let signals = Signals {
            time_s: vec![0.0],
            frames: vec![frame],
            ..Signals::default()
        };
        observe(&signals, Some(&mat), &[named("crosstalk")])
            .unwrap()
            .frames
            .remove(0)
    };
    assert!(
        of(vec![10.0; SIDE * SIDE])
            .iter()
            .all(|p| (p - 10.0).abs() < 1e-12)
    );
    // Half the mat under a stamp: 5 % crosses the edge, and nothing farther.
    let stamp: Vec<f64> = (0..SIDE * SIDE)
        .map(|k| if k % SIDE < 3 { 40.0 } else { 0.0 })
        .collect();
    let row = &of(stamp)[2 * SIDE..3 * SIDE];
    for (found, expected) in row.iter().zip([40.0, 40.0, 38.0, 2.0, 0.0, 0.0]) {
        assert!((found - expected).abs() < 1e-12, "{row:?}");
    }
}

#[test]
fn a_yielding_fixture_is_a_spring_in_series() {
    // Skin of 3 N/mm behind 0.2 mm/N: together 1 / (1/3 + 0.2) N/mm.
    let skin: Vec<f64> = (0..50).map(|k| 0.02 * f64::from(k)).collect();
    let signals = Signals {
        time_s: skin.clone(),
        force_n: skin.iter().map(|d| 3.0 * d).collect(),
        depth_mm: skin,
        ..Signals::default()
    };
    let fixture = named("fixture_compliance")
        .with("compliance_mm_per_n", 0.2)
        .unwrap();
    let shown = observe(&signals, None, &[fixture]).unwrap();
    for (depth, force) in shown.depth_mm.iter().zip(&shown.force_n) {
        assert!((force - depth / (1.0 / 3.0 + 0.2)).abs() < 1e-12);
    }
}

#[test]
fn drift_goes_on_without_contact() {
    let signals = Signals {
        time_s: (0..61).map(f64::from).collect(),
        force_n: vec![0.0; 61],
        frames: vec![vec![0.0; SIDE * SIDE]; 61],
        ..Signals::default()
    };
    let drift = named("drift").with("rate_kpa_per_min", 2.0).unwrap();
    let shown = observe(&signals, Some(&mat()), std::slice::from_ref(&drift)).unwrap();
    assert!((shown.frames[60][3] - 2.0).abs() < 1e-12 && (shown.frames[30][0] - 1.0).abs() < 1e-12);
    assert_eq!(shown.force_n[60], 0.0);
    let cell = drift
        .with("rate_n_per_min", 0.3)
        .unwrap()
        .choose("channel", "force")
        .unwrap();
    let shown = observe(&signals, Some(&mat()), &[cell]).unwrap();
    assert!((shown.force_n[60] - 0.3).abs() < 1e-12);
    // Sensitivity: 2 % a decade of time on a dead weight, nothing on nothing.
    let weighed = Signals {
        force_n: vec![5.0; 61],
        ..signals
    };
    let creep = named("drift")
        .choose("channel", "force")
        .unwrap()
        .choose("form", "sensitivity")
        .unwrap();
    let shown = observe(&weighed, Some(&mat()), &[creep]).unwrap();
    assert!(
        (shown.force_n[9] - 5.0 * 1.02).abs() < 1e-12,
        "{}",
        shown.force_n[9]
    );
}

#[test]
fn a_clock_behind_shows_a_ramp_later() {
    let times: Vec<f64> = (0..101).map(|k| 0.01 * f64::from(k)).collect();
    let ramp: Vec<f64> = times.iter().map(|t| 3.0 * t).collect();
    let signals = Signals {
        depth_mm: ramp.clone(),
        force_n: ramp.clone(),
        tangential_force_n: ramp.clone(),
        frames: ramp.iter().map(|p| vec![*p; SIDE * SIDE]).collect(),
        time_s: times,
        ..Signals::default()
    };
    for (channel, k) in [("map", 0), ("force", 1), ("depth", 2)] {
        let late = named("timing")
            .with("delay_s", 0.123)
            .unwrap()
            .choose("channel", channel)
            .unwrap();
        let shown = observe(&signals, Some(&mat()), &[late]).unwrap();
        let channels = [shown.frames[50][1], shown.force_n[50], shown.depth_mm[50]];
        for (j, value) in channels.iter().enumerate() {
            let expected = if j == k { 3.0 * (0.5 - 0.123) } else { 1.5 };
            assert!((value - expected).abs() < 1e-12, "{channel}: {value}");
        }
        let first = [shown.frames[5][1], shown.force_n[5], shown.depth_mm[5]][k];
        assert_eq!(
            first, 0.0,
            "before the first instant a channel keeps its value"
        );
    }
}

#[test]
fn a_map_that_was_read_moves_as_its_loads_would() {
    // A plane of pressure: moved by bilinear shares it stays a plane, off the rim.
    let mat = mat();
    let plane: Vec<f64> = mat
        .centers()
        .iter()
        .map(|c| 50.0 + 2.0 * c.x + c.y)
        .collect();
    let signals = Signals {
        time_s: vec![0.0],
        frames: vec![plane],
        ..Signals::default()
    };
    let moved = named("misregistration")
        .with("shift_1_mm", 1.7)
        .unwrap()
        .with("shift_2_mm", -0.6)
        .unwrap();
    let shown = observe(&signals, Some(&mat), &[moved]).unwrap();
    for (center, reading) in mat.centers().iter().zip(&shown.frames[0]) {
        let expected = 50.0 + 2.0 * (center.x + 1.7) + center.y - 0.6;
        if center.x.abs() < 10.0 && center.y.abs() < 10.0 {
            assert!(
                (reading - expected).abs() < 1e-9,
                "{center}: {reading} {expected}"
            );
        }
    }
}

#[test]
fn each_sensel_may_have_its_own_gain_and_dead_ones_stay_silent() {
    let signals = Signals {
        time_s: vec![0.0],
        frames: vec![vec![20.0; SIDE * SIDE]],
        ..Signals::default()
    };
    let errors: Vec<f64> = (0..SIDE * SIDE).map(|k| 0.01 * k as f64).collect();
    let shown = observe(&signals, Some(&mat()), &[named("gain").painted(errors)]).unwrap();
    assert!((shown.frames[0][30] - 26.0).abs() < 1e-12);
    let mut dead = vec![0.0; SIDE * SIDE];
    dead[4] = 1.0;
    let shown = observe(&signals, Some(&mat()), &[named("dead_cells").painted(dead)]).unwrap();
    assert_eq!((shown.frames[0][4], shown.frames[0][5]), (0.0, 20.0));
}

#[test]
fn what_cannot_be_applied_is_refused_in_one_sentence() {
    let (mat, signals) = (mat(), signals());
    let refused = |effect: ActiveEffect| {
        observe(&signals, Some(&mat), &[effect])
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refused(named("bone")),
        "effect bone: it acts on the skin, not on readings; give it to the skin"
    );
    assert_eq!(
        refused(ActiveEffect::named("gain", 2.0).unwrap()),
        "effect gain: amplitude is 2, but must be from 0 to 1"
    );
    assert_eq!(
        refused(named("crosstalk").with("share", 0.3).unwrap()),
        "effect crosstalk: share is 0.3, but must be from 0 to 0.25"
    );
    assert_eq!(
        refused(named("gain").painted(vec![0.0; 3])),
        "effect gain: 3 values are painted for 36 sensels; paint one per sensel of the mat"
    );
    let short = Signals {
        force_n: vec![0.0; 3],
        ..signals.clone()
    };
    assert_eq!(
        observe(&short, Some(&mat), &[]).unwrap_err().to_string(),
        "signals: force_n has 3 entries for 40 instants; give one each, or none"
    );
    assert_eq!(
        observe(&signals, None, &[]).unwrap_err().to_string(),
        "signals: there are frames or loads, but no mat; give the mat they belong to"
    );
}
