//! Locating where nothing local is amiss: noise, absorbed directions and noise judged too small raise no alarm.

use crate::synthetic;

use nalgebra::DMatrix;
use synthetic::{Design, Noise, nothing};
use thenar_comparison::{Location, Search, locate};
use thenar_contact::Control;
use thenar_inference::{Fit, Quantity};

/// The simulation that the data are made from is exact, and taken as such.
fn located(fit: &Fit, draws: usize) -> Location {
    let search = Search {
        draws,
        model_error: None,
        ..Search::default()
    };
    locate(fit, &search, &Control::none()).unwrap()
}

#[test]
fn noise_alone_is_left_alone() {
    false_alarms(200, 7);
}

/// `cargo test -p thenar-comparison --release --test integration location_nulls:: -- --ignored --nocapture`
#[test]
#[ignore = "a thousand data sets"]
fn noise_alone_is_left_alone_in_a_thousand_data_sets() {
    false_alarms(1000, 1_000_000);
}

fn false_alarms(count: u64, seed: u64) {
    let design = Design::flat(6);
    let mut alarms = 0;
    let mut low = 0;
    for case in 0..count {
        let location = located(&design.fit(&mut Noise::new(seed + case), &nothing), 199);
        alarms += usize::from(!location.mismatches.is_empty());
        low += usize::from(location.p.unwrap() <= 0.1);
    }
    println!("false alarms at 1 %: {alarms} of {count}; p <= 0.1: {low} of {count}");
    let (n, limit) = (count as f64, 3.0);
    let bound = |p: f64| limit * (n * p * (1.0 - p)).sqrt();
    assert!(
        (alarms as f64) <= n * 0.01 + bound(0.01),
        "{alarms} of {count}"
    );
    assert!(
        (low as f64 - n * 0.1).abs() <= bound(0.1),
        "{low} of {count}"
    );
}

#[test]
fn many_absorbed_directions_across_the_patch_keep_the_level() {
    // A parameter for each sensel of a column and one for its neighbor: looks there are correlated and partly absorbed.
    let design = Design::flat(5);
    let mut alarms = 0;
    for seed in 0..150 {
        let mut fit = design.fit(&mut Noise::new(seed), &nothing);
        let count: usize = fit.simulated.iter().map(Vec::len).sum();
        let mut wide = DMatrix::zeros(count, 13);
        wide.columns_mut(0, 3).copy_from(&fit.absorbed);
        let mut row = 0;
        for one in &fit.measured {
            for sample in &one.samples {
                if let Quantity::Pressure(sensel) = sample.quantity
                    && sensel % 5 < 2
                {
                    wide[(row, 3 + (sensel / 5 + 5 * (sensel % 5)) as usize)] = 1.0;
                }
                row += 1;
            }
        }
        fit.absorbed = wide.qr().q();
        let stacked: Vec<f64> = fit.projected.iter().flatten().copied().collect();
        let whole = nalgebra::DVector::from_vec(stacked);
        let left = &whole - &fit.absorbed * (fit.absorbed.transpose() * &whole);
        let mut rest = left.iter().copied();
        for list in &mut fit.projected {
            for value in list {
                *value = rest.next().unwrap();
            }
        }
        alarms += usize::from(!located(&fit, 199).mismatches.is_empty());
    }
    // 1 % of 150: more than 6 with a probability below 0.1 %.
    assert!(alarms <= 6, "{alarms} of 150");
}

#[test]
fn noise_judged_too_small_raises_no_alarm() {
    let design = Design::flat(6);
    let mut alarms = 0;
    let mut told = 0;
    for seed in 0..100 {
        let mut fit = design.fit(&mut Noise::new(seed), &nothing);
        for value in fit.projected.iter_mut().flatten() {
            *value *= 1.8;
        }
        let location = located(&fit, 199);
        alarms += usize::from(!location.mismatches.is_empty());
        let is_it = |note: &String| note.contains("maps") && note.contains("times what noise");
        told += usize::from(location.notes.iter().any(is_it));
    }
    assert!(told >= 95 && alarms <= 5, "{alarms} of 100, told {told}");
}
