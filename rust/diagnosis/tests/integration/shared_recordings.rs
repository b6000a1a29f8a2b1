//! Real recordings that are shared beside the repository: compared where they can be, and what they cannot tell is said.

use crate::scenes;

use std::path::{Path, PathBuf};

use scenes::{add, material, pad, study};
use thenar_contact::Control;
use thenar_diagnosis::{DiagnoseOptions, diagnose};
use thenar_inference::{Fitting, Options, fit_study};
use thenar_recordings::meshes::MeshFile;
use thenar_recordings::study::Shape;
use thenar_recordings::{Curve, read};
use thenar_surface::Vec3;

/// Where the recordings lie, or `None` with a line that says so.
fn folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("THENAR_RECORDINGS").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!(
        "skipped: no recordings in {} (set THENAR_RECORDINGS)",
        folder.display()
    );
    None
}

/// A paraboloid of curvature `radius` that touches the origin from above, closed by a lid at `extent` mm.
fn paraboloid(radius: f64, extent: f64) -> MeshFile {
    let (rings, sectors) = (160u32, 128u32);
    let mut positions = vec![Vec3::zeros()];
    for ring in 1..=rings {
        let r = extent * f64::from(ring) / f64::from(rings);
        for k in 0..sectors {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(sectors);
            positions.push(Vec3::new(
                r * angle.cos(),
                r * angle.sin(),
                r * r / (2.0 * radius),
            ));
        }
    }
    positions.push(Vec3::new(0.0, 0.0, extent * extent / radius));
    let at = |ring: u32, k: u32| 1 + (ring - 1) * sectors + k % sectors;
    let lid = positions.len() as u32 - 1;
    let mut triangles = Vec::new();
    for k in 0..sectors {
        triangles.push([0, at(1, k + 1), at(1, k)]);
        triangles.push([lid, at(rings, k), at(rings, k + 1)]);
        for ring in 1..rings {
            let (a, b, c, d) = (
                at(ring, k),
                at(ring, k + 1),
                at(ring + 1, k),
                at(ring + 1, k + 1),
            );
            triangles.extend([[a, d, c], [a, b, d]]);
        }
    }
    MeshFile {
        positions,
        triangles,
        notes: Vec::new(),
    }
}

/// The approach: from where the piezo moves on to the largest load.
fn approach(curve: &Curve) -> Curve {
    let (force, piezo) = (
        curve.channel("force_n").unwrap(),
        curve.channel("piezo_mm").unwrap(),
    );
    let end = (0..force.len()).fold(0, |best, k| if force[k] > force[best] { k } else { best });
    let start = (0..=end).fold(0, |best, k| if piezo[k] < piezo[best] { k } else { best });
    let mut part = curve.clone();
    part.segments.clear();
    for channel in &mut part.channels {
        channel.values = channel.values[start..=end].to_vec();
    }
    part
}

/// The instrument states 156.009 Pa for E / (1 - nu^2), from Hertz's law; contact point and force offset are ours to find.
#[test]
fn chiaro_gives_the_instruments_own_modulus() {
    let Some(folder) = folder() else { return };
    let file = folder.join("afm_gel_and_soft_matrix/chiaro_sphere_indentation.txt");
    let curve = read(&file).unwrap().curves.remove(0);
    let radius = curve.fact("tip_radius_mm").unwrap();
    let stated = curve.fact("instrument_effective_modulus_mpa").unwrap();
    let mut study = study(
        pad(f64::INFINITY, 0.075, 0.0045),
        material(1e-4, 1e-4, f64::INFINITY),
        vec![("tip", Shape::Mesh(paraboloid(radius, 0.11)))],
    );
    study.skin.materials[0].d_lim_mm = Some(1e3);
    study.skin.materials[0].fit = vec!["g0_mpa".into()];
    add(&mut study, ("approach", "", "tip"), approach(&curve));
    let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
    // E / (1 - nu^2) = 4 G at nu = 1/2.
    let found = 4.0 * fit.estimates[0].value;
    println!(
        "E_eff {:.3} Pa ({:.3} to {:.3}), the instrument's {:.3}",
        found * 1e6,
        4e6 * fit.estimates[0].low,
        4e6 * fit.estimates[0].high,
        stated * 1e6
    );
    for e in &fit.estimates {
        println!("{} {:.6} ({:.6} to {:.6})", e.name, e.value, e.low, e.high);
    }
    println!("{:?}", fit.measured[0].unknown);
    assert!((found / stated - 1.0).abs() < 0.01, "{found} for {stated}");
    assert_eq!(
        fit.lack_of_fit_p, None,
        "one recording tells no noise between repeats"
    );
    let told = fit.measured[0].unknown.join(" ");
    assert!(
        told.contains("no point of first touch") && told.contains("never unloads"),
        "{told}"
    );
    let said = diagnose(&study, &DiagnoseOptions::default(), &Control::none()).unwrap();
    println!("{} {:?}", said.sentence, said.notes);
    assert!(
        said.sentence
            .contains("beyond the parameters nothing is suspected")
    );
    assert!(said.notes.iter().any(|n| n.contains("hysteresis")));
}

/// What cannot be known from each of them is said.
#[test]
fn ramps_gels_and_silicone_say_what_they_lack() {
    let Some(folder) = folder() else { return };
    for (name, must_say) in [
        (
            "skin_indent_force_ramp/target_0400mN.csv",
            "no point of first touch",
        ),
        ("silicone_compression/EF10_0T_A1.csv", "never unloads"),
    ] {
        let curve = read(&folder.join(name)).unwrap().curves.remove(0);
        let mut study = study(
            pad(f64::INFINITY, 12.0, 1.0),
            material(0.01, 0.01, 8.0),
            vec![("tip", Shape::Punch { radius_mm: 3.0 })],
        );
        add(&mut study, (name, "", "tip"), curve);
        let fitting = Fitting::new(&study, &Control::none()).unwrap();
        let told = fitting.measured()[0].unknown.join(" | ");
        println!(
            "{name}: {} moments; {told}",
            fitting.measured()[0].moments.len()
        );
        assert!(told.contains(must_say), "{told}");
        assert!(fitting.measured()[0].moments.len() <= 110);
    }
}
