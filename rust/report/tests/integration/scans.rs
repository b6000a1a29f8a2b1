//! Scans against closed forms: the skin beside a ball on a half space, a skin at rest, and what a wrong thickness leaves.

use crate::scenes;

use nalgebra::{Rotation3, Vector3};
use scenes::{Dice, add, material, pad, study};
use thenar_comparison::compare;
use thenar_comparison::{Comparison, RecordingComparison};
use thenar_contact::Control;
use thenar_inference::{Estimate, Options, Scan};
use thenar_recordings::meshes::MeshFile;
use thenar_recordings::study::{Data, Shape};
use thenar_recordings::{Curve, Study};
use thenar_report::{comparison_html, comparison_json};

type Vec3 = Vector3<f64>;

const BALL_MM: f64 = 10.0;
const DEPTH_MM: f64 = 1.0;
const NOISE_MM: f64 = 0.02;
/// Shift and turn of the scanner against the skin.
const AWAY: ([f64; 3], [f64; 3]) = ([0.6, -0.4, 1.5], [0.03, -0.02, 0.04]);

/// Depth of the surface of an incompressible half space under a ball, mm (Johnson, Contact Mechanics, 1985, Eq. 3.42a, with
/// delta = a^2 / R): it does not move sideways outside the contact, and is the ball within.
fn hertz(r: f64) -> f64 {
    let a = (BALL_MM * DEPTH_MM).sqrt();
    if r <= a {
        return DEPTH_MM - r * r / (2.0 * BALL_MM);
    }
    ((2.0 * a * a - r * r) * (a / r).asin() + a * (r * r - a * a).sqrt())
        / (std::f64::consts::PI * BALL_MM)
}

/// What a scanner sees of a surface, in its own coordinates, with noise.
fn scanned(height: &dyn Fn(f64, f64) -> f64, seed: u64) -> MeshFile {
    let mut dice = Dice(seed);
    let turn = Rotation3::new(Vec3::from(AWAY.1));
    let mut positions = Vec::new();
    for i in -44..=44 {
        for j in -44..=44 {
            let (x, y) = (0.25 * f64::from(i), 0.25 * f64::from(j));
            let z = height(x, y) + NOISE_MM * dice.normal();
            positions.push(turn * Vec3::new(x, y, z) + Vec3::from(AWAY.0));
        }
    }
    MeshFile {
        positions,
        triangles: Vec::new(),
        notes: Vec::new(),
    }
}

fn add_scan(study: &mut Study, (name, protocol): (&str, &str), mesh: MeshFile, depth: f64) {
    add(study, (name, protocol, "ball"), Curve::default());
    let last = study.recordings.len() - 1;
    study.recordings[last].data = Data::Scan {
        mesh,
        at_time_s: None,
        depth_mm: Some(depth),
        motion: None,
    };
}

/// A flat half space, or a layer where it is said to be thinner, with two scans at a depth of 1 mm.
fn under_a_ball(thickness_mm: f64, added: &dyn Fn(f64, f64) -> f64) -> Comparison {
    let mut study = study(
        pad(f64::INFINITY, 13.0, 0.6),
        material(0.01, 0.01, thickness_mm),
        vec![("ball", Shape::Sphere { radius_mm: BALL_MM })],
    );
    for seed in [3, 4] {
        let scan = scanned(&|x, y| added(x, y) - hertz(x.hypot(y)), seed);
        add_scan(
            &mut study,
            (&format!("scan {seed}"), "held"),
            scan,
            DEPTH_MM,
        );
    }
    compare(&study, &Options::default(), &Control::none()).unwrap()
}

fn of<'c>(comparison: &'c Comparison, name: &str) -> impl Iterator<Item = &'c Estimate> {
    comparison.estimates.iter().filter(move |e| e.name == name)
}

fn measure(recording: &RecordingComparison, name: &str) -> f64 {
    recording
        .measures
        .iter()
        .find(|row| row.name == name)
        .unwrap()
        .after
}

#[test]
fn skin_beside_a_ball_is_where_hertz_says() {
    let comparison = under_a_ball(f64::INFINITY, &|_, _| 0.0);
    println!("{}", comparison.sentence);
    let contact = (BALL_MM * DEPTH_MM).sqrt();
    for recording in &comparison.recordings {
        let scan = recording.scan.as_ref().unwrap();
        let radius = |k: usize| scan.places[k].xy().norm();
        let (mut worst, mut square) = (0.0f64, 0.0);
        for k in 0..scan.places.len() {
            // Nothing of the contact is compared.
            assert!(radius(k) > contact, "{} mm from the middle", radius(k));
            let off = scan.simulated[k] + hertz(radius(k));
            square += off * off;
            // Up to 4.5 mm the gap is under 0.5 mm: only the outer side of a place is seen there.
            if radius(k) > 1.7 * contact {
                worst = worst.max(off.abs());
            }
        }
        let rms = (square / scan.places.len() as f64).sqrt();
        let left = measure(recording, "scan_rms_residual_mm");
        println!(
            "{} places, simulation off by {rms:.4} rms, {worst:.4} at most; residual {left:.4}",
            scan.places.len()
        );
        // 2 % of the depth; at most 4 % where the skin is steep beside the contact.
        assert!(rms < 0.02 * DEPTH_MM && worst < 0.04 * DEPTH_MM);
        assert!(left < 0.02 * DEPTH_MM, "{left}");
        // Twelve points of 0.02 mm around a place.
        let noise = scan.sigma[0];
        assert!(
            (0.5..2.0).contains(&(noise * 12f64.sqrt() / NOISE_MM)),
            "{noise}"
        );
    }
    // All is round about z: the turn about it stays as uncertain as it was taken, 0.035 rad. The dent tells the rest.
    let width = |e: &Estimate| e.high - e.low;
    assert!(of(&comparison, "scan_turn_z_rad").all(|e| width(e) > 0.1));
    for (name, size) in [
        ("scan_x_mm", 0.2),
        ("scan_y_mm", 0.2),
        ("scan_z_mm", 0.05),
        ("scan_turn_x_rad", 0.01),
    ] {
        for e in of(&comparison, name) {
            println!("{name}: {:.4} to {:.4}", e.low, e.high);
            assert!(width(e) < size);
        }
    }
    // A plane is laid by height and tilt alone: the shift along it, 0.6 and -0.4 mm, is the fit's to find from the dent.
    let back = |name: &str, by: f64| of(&comparison, name).all(|e| (e.value + by).abs() < 0.15);
    assert!(back("scan_x_mm", AWAY.0[0]) && back("scan_y_mm", AWAY.0[1]));
    let json = comparison_json(&comparison);
    assert!(json.contains("\"residual_mm\"") && json.contains("scan_rms_residual_mm"));
    let html = comparison_html(&comparison);
    assert!(html.contains("Height over the skin at rest at a depth of 1 mm"));
    assert!(
        html.contains("Scanned height") && !html.contains("The noise of no recording is known")
    );
    assert!(html.contains("one moment"));
}

/// Without repeats the noise of a place is what its points scatter, over the root of their number.
#[test]
fn one_scan_tells_how_its_points_scatter() {
    let mesh = pad(f64::INFINITY, 13.0, 0.6);
    let shapes = vec![("ball", Shape::Sphere { radius_mm: BALL_MM })];
    let mut study = study(mesh, material(0.01, 0.01, f64::INFINITY), shapes);
    let scan = scanned(&|x, y| -hertz(x.hypot(y)), 8);
    add_scan(&mut study, ("alone", "held"), scan, DEPTH_MM);
    let comparison = compare(&study, &Options::default(), &Control::none()).unwrap();
    let recording = &comparison.recordings[0];
    assert!(comparison.lack_of_fit_p.is_none() && !recording.is_noise_told);
    let noise = recording.scan.as_ref().unwrap().sigma[0];
    println!("{noise} and {}", measure(recording, "scan_rms_residual_mm"));
    assert!(
        (0.7..1.5).contains(&(noise * 12f64.sqrt() / NOISE_MM)),
        "{noise}"
    );
}

/// The truth is a half space; a study that says 3 mm over bone predicts a bulge that no scan shows. No pose and no first touch hide it.
#[test]
fn a_bulge_that_is_not_there_stands_out() {
    let comparison = under_a_ball(3.0, &|_, _| 0.0);
    println!("{}", comparison.sentence);
    assert!(comparison.lack_of_fit_p.unwrap() <= 0.01);
    // What locating allows a simulation is of curves and mats: it excuses no scan.
    assert!(
        comparison.sentence.contains("do not explain"),
        "{}",
        comparison.sentence
    );
    assert!(of(&comparison, "contact_zero_mm").all(|e| e.is_at_bound));
    for recording in &comparison.recordings {
        assert!(measure(recording, "scan_rms_residual_mm") > NOISE_MM);
    }
}

/// A bump of 0.3 mm on the scanned skin is the worst place, within a spacing of where it lies.
#[test]
fn a_bump_is_found_where_it_is() {
    let middle = [6.0, 2.0];
    let bump = |x: f64, y: f64| {
        let square = (x - middle[0]).powi(2) + (y - middle[1]).powi(2);
        0.3 * (-0.5 * square).exp()
    };
    let comparison = under_a_ball(f64::INFINITY, &bump);
    assert!(comparison.lack_of_fit_p.unwrap() <= 0.01);
    for recording in &comparison.recordings {
        let scan = recording.scan.as_ref().unwrap();
        let worst = &recording.worst[0];
        let [x, y, _] = worst.position_mm.unwrap();
        let miss = (x - middle[0]).hypot(y - middle[1]);
        println!(
            "{miss:.2} mm beside it, places are {:.2} mm apart; {:.3} mm",
            scan.spacing, worst.residual
        );
        assert!(miss <= scan.spacing, "{miss}");
        assert!((0.15..0.35).contains(&worst.residual) && !worst.vertices.is_empty());
        assert_eq!(
            worst.vertices[0],
            scan.vertices[scan
                .places
                .iter()
                .position(|p| p.x == x && p.y == y)
                .unwrap()]
        );
    }
}

/// A skin at rest with unequal curvatures: nothing is left, and the scanner's pose is found within its intervals.
#[test]
fn a_scan_before_touch_tells_its_pose() {
    let height = |x: f64, y: f64| -x * x / 18.0 - y * y / 40.0 + x * y * y / 900.0;
    let mut mesh = pad(f64::INFINITY, 13.0, 0.6);
    for p in &mut mesh.positions {
        p.z = height(p.x, p.y);
    }
    let shapes = vec![("ball", Shape::Sphere { radius_mm: BALL_MM })];
    let mut study = study(mesh, material(0.01, 0.01, 7.0), shapes);
    for seed in [5, 6, 7] {
        add_scan(
            &mut study,
            (&format!("before {seed}"), "rest"),
            scanned(&height, seed),
            0.0,
        );
    }
    let options = Options::default();
    let fit = thenar_inference::fit_study(&study, &options, &Control::none()).unwrap();
    let comparison = compare(&study, &options, &Control::none()).unwrap();
    println!("{}", comparison.sentence);
    let back = Rotation3::new(Vec3::from(AWAY.1)).inverse();
    for (recording, measured) in comparison.recordings.iter().zip(&fit.measured) {
        assert!(measure(recording, "scan_rms_residual_mm") < 0.02);
        let scan: &Scan = measured.scan.as_ref().unwrap();
        let own = |name: &str| {
            let mut all = of(&comparison, name);
            let target = thenar_inference::Target::Recording(recording.name.clone());
            all.find(|e| e.target == target).unwrap().clone()
        };
        let names = [
            "scan_x_mm",
            "scan_y_mm",
            "scan_z_mm",
            "scan_turn_x_rad",
            "scan_turn_y_rad",
            "scan_turn_z_rad",
        ];
        let fitted = names.map(|name| own(name).value);
        let lay = |p: Vec3, pose: &[f64]| {
            let turn = Rotation3::new(Vec3::new(pose[3], pose[4], pose[5]));
            scan.center + turn * (p - scan.center) + Vec3::new(pose[0], pose[1], pose[2])
        };
        let width = own("scan_x_mm").high - own("scan_x_mm").low;
        for at in [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(8.0, 0.0, -3.5),
            Vec3::new(0.0, -8.0, -1.6),
        ] {
            let seen = back.inverse() * at + Vec3::from(AWAY.0);
            let found = lay(lay(seen, &scan.laid), &fitted);
            println!(
                "{at:?} found {:.4} mm off, interval of x {width:.4} mm wide",
                (found - at).norm()
            );
            assert!((found - at).norm() < 0.05, "{found:?}");
        }
        assert!(width < 0.1);
    }
}

/// What keeps a scan from being compared is said.
#[test]
fn a_scan_without_a_depth_or_off_the_skin_says_so() {
    let mesh = pad(f64::INFINITY, 13.0, 0.8);
    let shapes = vec![("ball", Shape::Sphere { radius_mm: BALL_MM })];
    let mut study = study(mesh, material(0.01, 0.01, 7.0), shapes);
    add_scan(&mut study, ("no depth", "a"), scanned(&|_, _| 0.0, 1), 0.0);
    if let Data::Scan { depth_mm, .. } = &mut study.recordings[0].data {
        *depth_mm = None;
    }
    let far = MeshFile {
        positions: (0..50)
            .map(|k| Vec3::new(500.0 + f64::from(k), 0.0, 0.0))
            .collect(),
        triangles: Vec::new(),
        notes: Vec::new(),
    };
    add_scan(&mut study, ("far", "b"), far, 0.0);
    let fit = thenar_inference::Fitting::new(&study, &Control::none()).unwrap();
    let told: Vec<String> = fit.measured().iter().map(|m| m.unknown.join(" ")).collect();
    println!("{told:?}");
    assert!(told[0].contains("no depth goes with it: give depth_mm"));
    assert!(told[1].contains("too few of its points") || told[1].contains("are needed to lay it"));
    assert!(fit.measured().iter().all(|m| m.samples.is_empty()));
}
