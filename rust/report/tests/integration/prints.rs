//! Handprints of a study against closed forms: a Hertz contact's area by depth, force and ink; their part in a fit; what they lack.

use crate::cells;
use crate::scenes;

use cells::{measure, shares};
use scenes::{Dice, add, curve, material, pad, study};
use std::f64::consts::PI;
use std::path::PathBuf;
use thenar_comparison::Comparison;
use thenar_comparison::compare;
use thenar_contact::Control;
use thenar_inference::Options;
use thenar_recordings::handprint::{Handprint, Ink};
use thenar_recordings::study::{Data, PlacedSensel, Shape};
use thenar_recordings::{Curve, Study};
use thenar_report::{comparison_html, comparison_json};

const BALL_MM: f64 = 30.0;
const G_MPA: f64 = 0.01;
/// Contact modulus 2 G / (1 - nu) with nu = 1/2.
const E_STAR: f64 = 4.0 * G_MPA;

/// A print of 24 x 24 mm in cells of 0.5 mm about the site, its rows along y.
fn print_of(is_in: &dyn Fn(f64, f64) -> bool) -> (Handprint, Vec<Option<PlacedSensel>>) {
    let (size, cell) = ([48, 48], 0.5);
    let inked = shares(size, cell, &|x, y| is_in(x - 12.0, y - 12.0));
    let place = |k: usize| {
        let at = |number: usize| (number as f64 + 0.5) * cell - 12.0;
        Some(PlacedSensel {
            center_mm: [at(k % 48), at(k / 48), 0.0],
            normal: Some([0.0, 0.0, -1.0]),
            area_mm2: cell * cell,
        })
    };
    let placed = (0..inked.len()).map(place).collect();
    let print = Handprint {
        size_px: [480, 480],
        mm_per_px: 0.05,
        threshold: 0.5,
        ink: Ink::Dark,
        cells: size,
        cell_mm: cell,
        inked_mm2: inked.iter().sum::<f64>() * cell * cell,
        inked,
        unknown: Vec::new(),
        warnings: Vec::new(),
    };
    (print, placed)
}

/// How it was pressed, and the ink's pressure.
type Press = (Option<f64>, Option<f64>, f64);

fn add_print(study: &mut Study, name: &str, is_in: &dyn Fn(f64, f64) -> bool, press: Press) {
    let (print, sensels) = print_of(is_in);
    add(study, (name, "held", "ball"), Curve::default());
    let last = study.recordings.last_mut().unwrap();
    (last.data, last.file) = (
        Data::Handprint {
            print: Box::new(print),
            sensels: Some(sensels),
            depth_mm: press.0,
            force_n: press.1,
            ink_kpa: press.2,
            motion: None,
        },
        PathBuf::new(),
    );
}

fn half_space() -> Study {
    study(
        pad(f64::INFINITY, 13.0, 0.5),
        material(G_MPA, G_MPA, f64::INFINITY),
        vec![("ball", Shape::Sphere { radius_mm: BALL_MM })],
    )
}

fn run(study: &Study) -> Comparison {
    compare(study, &Options::default(), &Control::none()).unwrap()
}

/// A ball on a half space touches on pi R d (Johnson 1985, Eq. 4.23) at the force 4/3 E* R^(1/2) d^(3/2) (Eq. 4.24), and presses with
/// more than p on pi a^2 (1 - (p / p0)^2), p0 = 2 E* a / (pi R) (Eq. 4.22).
#[test]
fn a_balls_print_has_hertz_area_by_depth_force_and_ink() {
    let depth: f64 = 1.2;
    let a = (BALL_MM * depth).sqrt();
    let force = 4.0 / 3.0 * E_STAR * BALL_MM.sqrt() * f64::powf(depth, 1.5);
    let peak_kpa = 1e3 * 2.0 * E_STAR * a / (PI * BALL_MM);
    for (name, press, radius) in [
        ("by depth", (Some(depth), None, 0.0), a),
        ("by force", (None, Some(force), 0.0), a),
        (
            "with ink that asks for pressure",
            (Some(depth), None, 0.6 * peak_kpa),
            0.8 * a,
        ),
    ] {
        let mut study = half_space();
        add_print(&mut study, "ink", &|x, y| x.hypot(y) < radius, press);
        let comparison = run(&study);
        let recording = &comparison.recordings[0];
        let area = PI * radius * radius;
        let [recorded, simulated] = measure(recording, "area_mm2");
        let overlap = measure(recording, "overlap")[1];
        let print = recording.print.as_ref().unwrap();
        println!(
            "{name}: closed form {area:.2}, ink {recorded:.2}, simulated {simulated:.2}, overlap {overlap:.3}, {:?}",
            print.pose
        );
        assert!((recorded / area - 1.0).abs() < 0.03, "{name}");
        // The contact's radius is 2 % large on such a mesh, and vertices and cells of 0.5 mm tell it to a part of that.
        let off = (simulated / PI).sqrt() - radius;
        assert!(off.abs() < 0.2 && overlap > 0.92, "{name}: {off}");
        assert!(measure(recording, "center_distance_mm")[1] < 0.15);
        let [x, y, turn] = print.pose;
        assert!(
            [x, y]
                .iter()
                .all(|part| part.low < 0.1 && part.high > -0.1 && part.high - part.low < 1.0)
        );
        // All is round: the turn stays as uncertain as it was taken.
        assert!(turn.high - turn.low > 0.1 && !print.is_mirrored && print.beside == 0.0);
        assert!(
            comparison
                .sentence
                .starts_with("The handprint \u{201c}ink\u{201d} overlaps"),
            "{}",
            comparison.sentence
        );
    }
}

/// A study of presses and a print: no number of the fit depends on the print, which is compared with the fitted skin.
#[test]
fn a_print_takes_no_part_in_the_fit() {
    // Presses of a skin 3 times as stiff as where the fit starts.
    let depths: Vec<f64> = (1..=30).map(|k| 0.04 * f64::from(k)).collect();
    let mut dice = Dice(5);
    let mut presses = half_space();
    for name in ["slow 1", "slow 2"] {
        let hertz = |d: &f64| 4.0 * E_STAR * BALL_MM.sqrt() * d.powf(1.5);
        let forces: Vec<f64> = depths
            .iter()
            .map(|d| hertz(d) + 2e-3 * dice.normal())
            .collect();
        let channels = [
            ("time_s", &depths[..]),
            ("depth_mm", &depths[..]),
            ("force_n", &forces[..]),
        ];
        add(&mut presses, (name, "slow", "ball"), curve(&channels));
    }
    let alone = run(&presses);
    let mut with = presses.clone();
    let a = BALL_MM.sqrt();
    let force = 4.0 * E_STAR * BALL_MM.sqrt();
    add_print(
        &mut with,
        "ink",
        &|x, y| x.hypot(y) < a,
        (None, Some(force), 0.0),
    );
    let both = run(&with);
    assert_eq!(alone.estimates, both.estimates);
    assert_eq!(alone.lack_of_fit_p, both.lack_of_fit_p);
    assert_eq!(
        alone.location.map(|l| l.sentence),
        both.location.clone().map(|l| l.sentence)
    );
    let recording = &both.recordings[2];
    let row = recording
        .measures
        .iter()
        .find(|row| row.name == "area_mm2")
        .unwrap();
    println!("{} -> {} of {}", row.before, row.after, row.measured);
    // At one force the soft skin of the start touches on 3^(2/3) times the area.
    assert!(((row.after / PI).sqrt() - a).abs() < 0.2);
    assert!(((row.before / PI).sqrt() - a * 3f64.cbrt()).abs() < 0.25);
    assert!(
        both.sentence.contains("All 2 recordings")
            && both.sentence.contains("overlaps with simulated contact by")
    );
    assert!(
        recording
            .unknown
            .iter()
            .any(|text| text.contains("no parameter is fitted to it"))
    );
    let (json, html) = (comparison_json(&both), comparison_html(&both));
    assert!(json.contains("\"simulated_share\"") && json.contains("\"columns_mm\""));
    assert!(html.contains("orange: inked alone") && html.contains("a handprint"));
}

/// Of a print that cannot be compared the reason is said.
#[test]
fn what_a_print_lacks_is_said() {
    let disc = |x: f64, y: f64| x.hypot(y) < 3.0;
    let mut nothing = half_space();
    add_print(&mut nothing, "unpressed", &disc, (None, None, 0.0));
    add_print(&mut nothing, "blank", &|_, _| false, (Some(1.0), None, 0.0));
    add_print(&mut nothing, "loose", &disc, (Some(1.0), None, 0.0));
    if let Data::Handprint { sensels, .. } = &mut nothing.recordings[2].data {
        *sensels = None;
    }
    let comparison = run(&nothing);
    let told = [
        "how hard it was pressed is not known",
        "no cell of it is half inked",
        "its paper is not placed",
    ];
    for (recording, told) in comparison.recordings.iter().zip(told) {
        assert!(
            recording.print.is_none() && recording.unknown.iter().any(|text| text.contains(told)),
            "{told}"
        );
    }
}
