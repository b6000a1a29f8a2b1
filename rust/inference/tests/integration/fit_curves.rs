//! Parameters fitted to indentation curves: closed forms, planted numbers, repeats, censored numbers, and the same bits.

use crate::scenes;

use scenes::laboratory::{TRUE_G0, TRUE_GLIM, USUAL, clean, measured};
use scenes::{add, curve, material, pad, press_hold_release, study};
use thenar_contact::Control;
use thenar_inference::{Fit, Options, Target, fit_study};
use thenar_recordings::study::Shape;

fn value(fit: &Fit, name: &str) -> f64 {
    estimate(fit, name).0
}

/// Value and interval of a material's number.
fn estimate(fit: &Fit, name: &str) -> (f64, f64, f64) {
    let is_it =
        |e: &&thenar_inference::Estimate| e.name == name && matches!(e.target, Target::Region(_));
    let found = fit.estimates.iter().find(is_it).unwrap();
    (found.value, found.low, found.high)
}

/// Force (N) and depth (mm) of a rigid sphere on an elastic half space, nu = 1/2, by its contact radius: exact for the sphere's arc
/// (Sneddon 1965, Int. J. Eng. Sci. 3:47, section 6), of which Hertz's law is the limit for small a / R.
fn sphere_on_half_space(g: f64, radius: f64, a: f64) -> (f64, f64) {
    let log = ((radius + a) / (radius - a)).ln();
    (
        4.0 * g * (0.5 * (a * a + radius * radius) * log - a * radius),
        0.5 * a * log,
    )
}

#[test]
fn a_sphere_on_a_half_space_gives_its_modulus_back() {
    let (g, radius) = (0.012, 10.0f64);
    let mut study = study(
        pad(f64::INFINITY, 9.0, 0.5),
        material(0.005, 0.005, f64::INFINITY),
        vec![("ball", Shape::Sphere { radius_mm: radius })],
    );
    for speed in [0.5, 2.0] {
        let (times, depths) = press_hold_release((1.0, speed, 1.0), 80);
        let force = |d: &f64| {
            let (mut low, mut high) = (0.0, 0.9 * radius);
            for _ in 0..100 {
                let a = 0.5 * (low + high);
                match sphere_on_half_space(g, radius, a).1 < *d {
                    true => low = a,
                    false => high = a,
                }
            }
            sphere_on_half_space(g, radius, low).0
        };
        let forces: Vec<f64> = depths.iter().map(force).collect();
        let name = format!("{speed} mm/s");
        let curve = curve(&[
            ("time_s", &times),
            ("depth_mm", &depths),
            ("force_n", &forces),
        ]);
        add(&mut study, (&name, &name, "ball"), curve);
    }
    // A body without stiffening: the law's limit lies far beyond the depths.
    study.skin.materials[0].d_lim_mm = Some(1e3);
    study.skin.materials[0].fit = vec!["g0_mpa".into()];
    let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
    let found = value(&fit, "g0_mpa");
    println!("G = {found:.6} MPa for {g}; {:?}", fit.estimates);
    // 0.3 % is the kernel's own error on a mesh with a / h = 6; the tool's facets and the table add as much.
    assert!((found / g - 1.0).abs() < 0.01, "{found}");
    assert_eq!(fit.lack_of_fit_p, None);
    assert!(
        fit.notes
            .iter()
            .any(|note| note.contains("no protocol was repeated"))
    );
}

/// How often intervals hold the truth in `sets` data sets, and how often the test for lack of fit calls a right model wrong.
fn coverage(sets: u64) -> (f64, f64, f64) {
    let clean = clean();
    let (mut g0, mut g_lim, mut accused) = (0, 0, 0);
    let (mut gain, mut share, mut p) = (0.0, 0.0, 0.0);
    for seed in 0..sets {
        let study = measured(&clean, &USUAL, seed);
        let options = Options {
            draws: 199,
            seed,
            ..Options::default()
        };
        let fit = fit_study(&study, &options, &Control::none()).unwrap();
        let holds = |name: &str, truth: f64| {
            let (_, low, high) = estimate(&fit, name);
            usize::from(low <= truth && truth <= high)
        };
        g0 += holds("g0_mpa", TRUE_G0);
        g_lim += holds("g_lim_mpa", TRUE_GLIM);
        p += fit.lack_of_fit_p.unwrap();
        accused += usize::from(fit.lack_of_fit_p.unwrap() < 0.01);
        let most = fit.measured[0]
            .samples
            .iter()
            .fold(0.0f64, |most, s| most.max(s.value));
        share += fit.sigma[0][0] / most;
        let (_, low, high) = estimate(&fit, "g0_mpa");
        gain += (high / low).ln() / 2.0;
    }
    let part = |count: usize| count as f64 / sets as f64;
    let n = sets as f64;
    println!(
        "{sets} data sets: 90 % intervals hold G0 in {:.1} %, Glim in {:.1} %",
        100.0 * part(g0),
        100.0 * part(g_lim)
    );
    println!(
        "mean noise {:.4} of the peak, half width of log G0 {:.4}, mean p {:.2}, accused {:.3}",
        share / n,
        gain / n,
        p / n,
        part(accused)
    );
    (part(g0), part(g_lim), part(accused))
}

#[test]
fn intervals_hold_planted_parameters() {
    let (g0, g_lim, accused) = coverage(40);
    // Three standard errors of 40 draws about 90 %.
    assert!(g0 >= 0.76 && g_lim >= 0.76, "{g0} {g_lim}");
    assert!(accused <= 0.075, "{accused}");
}

/// `cargo test --release -p thenar-inference --test integration fit_curves:: -- --ignored --nocapture`
#[test]
#[ignore = "200 fits"]
fn intervals_hold_planted_parameters_in_85_to_95_of_100() {
    let (g0, g_lim, accused) = coverage(200);
    assert!(
        (0.85..=0.95).contains(&g0) && (0.85..=0.95).contains(&g_lim),
        "{g0} {g_lim}"
    );
    assert!(accused <= 0.03, "{accused}");
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let study = measured(&clean(), &USUAL, 3);
    let fit = || fit_study(&study, &Options::default(), &Control::none()).unwrap();
    let (a, b) = (fit(), fit());
    assert_eq!(a.estimates, b.estimates);
    assert_eq!(
        (a.projected, a.lack_of_fit_p),
        (b.projected, b.lack_of_fit_p)
    );
}
