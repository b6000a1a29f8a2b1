//! Locating on made-up fits: planted patches are found where they are, and noise is left alone.

use crate::synthetic;

use nalgebra::{DMatrix, Vector3};
use synthetic::{Design, Noise, PITCH, nothing};
use thenar_comparison::{Carrier, Location, Search, Shown, locate};
use thenar_contact::Control;
use thenar_inference::{Censoring, Fit, Moment, Phase, Quantity};
use thenar_surface::Mesh;

fn found(fit: &Fit) -> Location {
    located(fit, 999)
}

/// The simulation that the data are made from is exact, and taken as such.
fn located(fit: &Fit, draws: usize) -> Location {
    let search = Search {
        draws,
        model_error: None,
        ..Search::default()
    };
    locate(fit, &search, &Control::none()).unwrap()
}

/// A bump of height 1 and radius 5 mm around a point.
fn bump(center: Option<Vector3<f64>>, at: Vector3<f64>) -> f64 {
    center.map_or(0.0, |c| (1.0 - (c - at).norm_squared() / 50.0).max(0.0))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn a_planted_patch_is_found_within_a_pitch_at_its_time_and_size() {
    let design = Design::flat(8);
    let mut noise = Noise::new(3);
    let mut misses = Vec::new();
    let mut held = 0;
    let cases = 60;
    for _ in 0..cases {
        let place = |noise: &mut Noise| 14.0 * (noise.uniform() - 0.5);
        let at = Vector3::new(place(&mut noise), place(&mut noise), 0.0);
        let fit = design.fit(&mut noise, &|_, moment, center, _| {
            let holds = moment.phase == Phase::Hold;
            if holds { 1.8 * bump(center, at) } else { 0.0 }
        });
        let location = located(&fit, 199);
        let first = location.mismatches.first().expect(&location.sentence);
        let place = first.place.as_ref().unwrap();
        assert_eq!(first.shown, Shown::Pressure);
        assert_eq!(first.when.phases, [Phase::Hold], "{}", first.sentence);
        assert!(first.low < first.size && first.size < first.high && first.size > 0.0);
        assert!(place.resolution_mm >= 0.5 * PITCH && place.carrier == Carrier::CannotTell);
        misses.push((place.center_mm - at).norm());
        let near = place.sensels_90.iter().any(|sensel| {
            let away = design.center([0.0, 0.0], *sensel) - at;
            away.x.abs() <= 0.5 * PITCH && away.y.abs() <= 0.5 * PITCH
        });
        held += usize::from(near);
    }
    println!(
        "place: median miss {:.2} mm of a pitch of {PITCH} mm, 90 % sets held {held} of {cases}",
        median(misses.clone())
    );
    assert!(misses.iter().all(|miss| *miss < 2.0 * PITCH));
    assert!(median(misses) < 0.5 * PITCH);
    // Of 60 sets of 90 %, fewer than 47 hold with a probability below 0.5 %.
    assert!(held >= 47, "{held} of {cases}");
}

#[test]
fn the_size_is_that_of_what_was_planted() {
    // A disc over exactly the sensels of one look, so that its mean is known: 0.9 kPa, in all frames.
    let mut design = Design::flat(8);
    design.sigma = 0.05;
    let at = design.center([0.0, 0.0], 27);
    let planted = |_: usize, _: &_, center: Option<Vector3<f64>>, _: f64| {
        let inside = center.is_some_and(|c| (c - at).norm() < 1.2 * PITCH);
        if inside { -0.9 } else { 0.0 }
    };
    let mut covered = 0;
    for seed in 0..40 {
        let location = located(&design.fit(&mut Noise::new(seed), &planted), 99);
        let first = &location.mismatches[0];
        assert!((first.size + 0.9).abs() < 0.03, "{}", first.sentence);
        assert_eq!(first.place.as_ref().unwrap().row_column, Some([3, 3]));
        covered += usize::from(first.low <= -0.9 && -0.9 <= first.high);
    }
    // 90 % intervals: fewer than 29 of 40 with a probability below 0.1 %.
    assert!(covered >= 29, "{covered} of 40");
}

#[test]
fn what_parameters_absorb_is_not_found_and_what_they_imitate_in_part_is_told_smaller_in_share() {
    let design = Design::flat(6);
    let gain = |_: usize, _: &_, _: Option<Vector3<f64>>, value: f64| 0.2 * value;
    assert!(
        found(&design.fit(&mut Noise::new(1), &gain))
            .mismatches
            .is_empty()
    );
    let at = design.center([0.0, 0.0], 14);
    let bumped = |_: usize, _: &_, center: Option<Vector3<f64>>, _: f64| 2.0 * bump(center, at);
    let first = found(&design.fit(&mut Noise::new(1), &bumped))
        .mismatches
        .remove(0);
    assert!(first.kept > 0.2 && first.kept < 1.0, "{}", first.kept);
}

/// A simulation that is off as layers are off finite elements: by a factor quadratic in place that changes with depth, and by bumps of
/// about a percent of the largest pressure, the same in every press.
fn model_error(noise: &mut Noise) -> impl Fn(&Moment, Option<Vector3<f64>>, f64) -> f64 + use<> {
    let bend: Vec<f64> = (0..5).map(|_| 0.06 * noise.normal()).collect();
    let bumps: Vec<f64> = (0..64).map(|_| noise.normal()).collect();
    move |moment, center, value| {
        let Some(center) = center else {
            return value * 0.05 * bend[0] * (moment.depth_mm - 1.0) / 0.06;
        };
        let (x, y) = (center.x / 6.0, center.y / 6.0);
        let quadratic = bend[0] + bend[1] * x * x + bend[2] * y * y + bend[3] * x * y + bend[4] * x;
        let mut rough = 0.0;
        for (at, size) in bumps.iter().enumerate() {
            let node = Vector3::new((at % 8) as f64 - 3.5, (at / 8) as f64 - 3.5, 0.0) * 5.5;
            rough += size * (-(node - center).norm_squared() / 30.0).exp();
        }
        value * quadratic * moment.depth_mm + 0.01 * 15.0 * moment.depth_mm * rough
    }
}

#[test]
fn a_simulation_that_is_off_by_a_little_everywhere_raises_no_alarm_and_hides_no_patch() {
    let mut design = Design::flat(8);
    design.corners = vec![[1.0, 0.5], [1.0, 0.5], [-1.5, 1.0], [-1.5, 1.0]];
    let trusted = Search {
        draws: 199,
        ..Search::default()
    };
    let (mut alarms, mut misled, mut misses) = (0, 0, Vec::new());
    for seed in 0..60 {
        let mut noise = Noise::new(100 + seed);
        let error = model_error(&mut noise);
        let fit = design.fit(&mut noise, &|_, moment, center, value| {
            error(moment, center, value)
        });
        let location = locate(&fit, &trusted, &Control::none()).unwrap();
        alarms += usize::from(!location.mismatches.is_empty());
        misled += usize::from(!located(&fit, 199).mismatches.is_empty());
        let at = Vector3::new(
            12.0 * (noise.uniform() - 0.5),
            12.0 * (noise.uniform() - 0.5),
            0.0,
        );
        let fit = design.fit(&mut noise, &|_, moment, center, value| {
            error(moment, center, value) + 5.0 * moment.depth_mm * bump(center, at)
        });
        let location = locate(&fit, &trusted, &Control::none()).unwrap();
        let place = location
            .mismatches
            .iter()
            .find_map(|one| one.place.as_ref());
        misses.push(place.map_or(100.0, |place| (place.center_mm - at).norm()));
    }
    println!(
        "model error: {alarms} alarms of 60, {misled} if it were not allowed for; median miss {:.2} mm",
        median(misses.clone())
    );
    // Of 60 nulls at 1 %, more than 4 with a probability below 0.1 %.
    assert!(alarms <= 4, "{alarms} of 60");
    assert!(misled >= 55, "{misled}: the error would not have mattered");
    assert!(median(misses) < 0.5 * PITCH);
}

#[test]
fn two_poses_tell_skin_from_sensor_and_one_does_not() {
    let mut design = Design::flat(8);
    design.curve = false;
    design.corners = vec![[0.0, 0.0], [10.0, 5.0]];
    let skin = design.center([0.0, 0.0], 28);
    let on_skin = |_: usize, _: &_, center: Option<Vector3<f64>>, _: f64| 1.5 * bump(center, skin);
    let on_sensor = |which: usize, _: &_, center: Option<Vector3<f64>>, _: f64| {
        let corner = design.corners[which];
        let own = center.map(|c| c - Vector3::new(corner[0], corner[1], 0.0));
        1.5 * bump(own, skin)
    };
    let carrier = |fit: Fit| found(&fit).mismatches[0].place.as_ref().unwrap().carrier;
    for seed in 0..10 {
        assert_eq!(
            carrier(design.fit(&mut Noise::new(seed), &on_skin)),
            Carrier::Skin
        );
        assert_eq!(
            carrier(design.fit(&mut Noise::new(seed), &on_sensor)),
            Carrier::Sensor
        );
    }
    let mut still = design.clone();
    still.corners = vec![[0.0, 0.0]; 2];
    assert_eq!(
        carrier(still.fit(&mut Noise::new(1), &on_skin)),
        Carrier::CannotTell
    );
}

#[test]
fn a_mismatch_in_time_alone_is_told_by_its_time() {
    let design = Design::flat(6);
    // The curve's force falls short while it is held, by 0.3 N.
    let held = |which: usize, moment: &Moment, center: Option<_>, _: f64| {
        let is_curve = center.is_none() && which % 2 == 1;
        if is_curve && moment.phase == Phase::Hold {
            -0.3
        } else {
            0.0
        }
    };
    let location = found(&design.fit(&mut Noise::new(5), &held));
    let first = &location.mismatches[0];
    assert_eq!((first.shown, first.place.is_none()), (Shown::Force, true));
    assert_eq!(first.when.phases, [Phase::Hold], "{}", first.sentence);
    assert_eq!(first.when.recordings, ["curve 0", "curve 1"]);
    assert!(first.low < -0.3 && -0.3 < first.high, "{}", first.sentence);
    assert!(first.sentence.contains("holding") && first.sentence.contains("less force"));
}

#[test]
fn the_order_of_sensels_does_not_matter() {
    let design = Design::flat(6);
    let at = Vector3::new(4.0, -3.0, 0.0);
    let planted = |_: usize, _: &_, center: Option<Vector3<f64>>, _: f64| 1.5 * bump(center, at);
    let fit = design.fit(&mut Noise::new(9), &planted);
    let mut turned = fit.clone();
    let last = 35;
    for one in &mut turned.measured {
        if let Some(mat) = &mut one.mat {
            mat.centers.reverse();
            mat.places.reverse();
        }
        for sample in &mut one.samples {
            if let Quantity::Pressure(sensel) = &mut sample.quantity {
                *sensel = last - *sensel;
            }
        }
    }
    let (one, two) = (found(&fit), found(&turned));
    let (a, b) = (&one.mismatches[0], &two.mismatches[0]);
    let (p, q) = (a.place.as_ref().unwrap(), b.place.as_ref().unwrap());
    assert_eq!(
        (one.look_elsewhere_count, p.row_column),
        (two.look_elsewhere_count, q.row_column)
    );
    assert!((p.center_mm - q.center_mm).norm() < 1e-9 && (a.size - b.size).abs() < 1e-9);
    assert_eq!(a.when, b.when);
    let mirrored: Vec<u32> = q
        .sensels_90
        .iter()
        .rev()
        .map(|sensel| last - sensel)
        .collect();
    assert_eq!(p.sensels_90, mirrored);
    assert_eq!(found(&fit), one, "the same seed gives the same bits");
}

#[test]
fn the_place_is_carried_to_the_skin() {
    let design = Design::flat(6);
    let at = Vector3::new(5.0, -2.0, 0.0);
    let planted = |_: usize, _: &_, center: Option<Vector3<f64>>, _: f64| 3.0 * bump(center, at);
    let fit = design.fit(&mut Noise::new(2), &planted);
    // A plane of 2 mm quads, 1.5 mm under the mat.
    let point = |index: u32| {
        let (row, column) = (index / 31, index % 31);
        Vector3::new(
            2.0 * f64::from(column) - 30.0,
            2.0 * f64::from(row) - 30.0,
            -1.5,
        )
    };
    let quads = (0..30u32).flat_map(|row| (0..30u32).map(move |column| 31 * row + column));
    let triangles = quads
        .flat_map(|i| [[i, i + 1, i + 32], [i, i + 32, i + 31]])
        .collect();
    let skin = Mesh::new((0..31 * 31).map(point).collect(), triangles).unwrap();
    let search = Search {
        skin: Some(&skin),
        model_error: None,
        ..Search::default()
    };
    let location = locate(&fit, &search, &Control::none()).unwrap();
    let place = location.mismatches[0].place.clone().unwrap();
    let under = place.on_skin_mm.unwrap();
    assert!((under.z + 1.5).abs() < 1e-12 && (under - place.center_mm).xy().norm() < 1e-9);
    assert!(!place.vertices.is_empty());
    for vertex in &place.vertices {
        assert!((point(*vertex) - under).norm() <= place.radius_mm);
    }
}

#[test]
fn little_data_and_hidden_data_are_told_as_such() {
    let mut design = Design::flat(3);
    design.corners.truncate(1);
    design.depths.truncate(1);
    assert!(
        found(&design.fit(&mut Noise::new(1), &nothing))
            .mismatches
            .is_empty()
    );
    // Everything clips, and the simulation lies over every limit: nothing is known to be amiss.
    let mut fit = Design::flat(4).fit(&mut Noise::new(1), &nothing);
    for (which, one) in fit.measured.iter_mut().enumerate() {
        for (at, sample) in one.samples.iter_mut().enumerate() {
            sample.censoring = Censoring::AtLeast;
            sample.value = fit.simulated[which][at] - 3.0 * fit.sigma[which][at];
            fit.projected[which][at] = 0.0;
        }
    }
    let location = found(&fit);
    assert!(location.mismatches.is_empty(), "{}", location.sentence);
    assert!(location.notes[0].contains("272 values that the instrument's limits hide"));
    let mut empty = fit;
    for list in [&mut empty.projected, &mut empty.sigma, &mut empty.simulated] {
        list.iter_mut().for_each(Vec::clear);
    }
    empty
        .measured
        .iter_mut()
        .for_each(|one| one.samples.clear());
    empty.absorbed = DMatrix::zeros(0, 0);
    let location = found(&empty);
    assert_eq!((location.look_elsewhere_count, location.p), (0, None));
    assert!(location.sentence.contains("Nothing can be located"));
}

#[test]
fn sensels_that_clip_where_the_simulation_says_less_are_found() {
    let design = Design::flat(6);
    let mut fit = design.fit(&mut Noise::new(4), &nothing);
    let patch = [14, 15, 20, 21];
    for (which, one) in fit.measured.iter_mut().enumerate() {
        for (at, sample) in one.samples.iter_mut().enumerate() {
            if matches!(sample.quantity, Quantity::Pressure(sensel) if patch.contains(&sensel)) {
                sample.censoring = Censoring::AtLeast;
                sample.value = fit.simulated[which][at] + 3.0 * fit.sigma[which][at];
                // Root of minus twice the logarithm of 0.001350, the probability of such a reading.
                fit.projected[which][at] = 3.635;
            }
        }
    }
    let first = found(&fit).mismatches.remove(0);
    assert!(first.size > 0.0, "{}", first.sentence);
    let place = first.place.unwrap();
    assert!((place.center_mm - Vector3::new(0.0, 0.0, 0.0)).norm() < PITCH);
}

#[test]
fn a_caller_may_stop_it() {
    let fit = Design::flat(4).fit(&mut Noise::new(1), &nothing);
    let control = Control {
        cancelled: &|| true,
        progress: &|_, _| {},
    };
    let stopped = locate(&fit, &Search::default(), &control);
    assert_eq!(stopped, Err(thenar_inference::InferenceError::Cancelled));
}
