//! Small studies for the integration tests, made in memory: a fingertip pad or a flat skin, tools, and curves.
#![allow(dead_code, clippy::unwrap_used)]

pub mod laboratory;

use std::path::PathBuf;

use thenar_recordings::meshes::MeshFile;
use thenar_recordings::study::{
    Data, Indenter, PlacedSensel, Shape, Site, StudyMaterial, StudyRecording, StudySkin,
};
use thenar_recordings::{Channel, Curve, PressureMap, PressureUnit, Sensel, Source, Study};
use thenar_surface::Vec3;

/// A reproducible stream of random numbers, apart from the library's.
pub struct Dice(pub u64);

impl Dice {
    /// Uniform in (0, 1).
    pub fn roll(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Standard normal (Box & Muller).
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.roll().ln()).sqrt() * (std::f64::consts::TAU * self.roll()).cos()
    }
}

/// A pad z = -r^2 / 2R about the origin, normals up, on a triangular lattice of `spacing` within `extent`, mm; R infinite is flat.
pub fn pad(radius: f64, extent: f64, spacing: f64) -> MeshFile {
    let step = spacing * 0.75f64.sqrt();
    let rows = (extent / step).ceil() as i64;
    let columns = (extent / spacing).ceil() as i64;
    let width = (2 * columns + 1) as u32;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for row in -rows..=rows {
        let shift = if row.rem_euclid(2) == 1 { 0.5 } else { 0.0 };
        for column in -columns..=columns {
            let (x, y) = ((column as f64 + shift) * spacing, row as f64 * step);
            positions.push(Vec3::new(x, y, -(x * x + y * y) / (2.0 * radius)));
        }
    }
    for row in 0..2 * rows as u32 {
        let is_odd = (i64::from(row) - rows).rem_euclid(2) == 1;
        for column in 0..width - 1 {
            let (a, b) = (row * width + column, row * width + column + 1);
            let (c, d) = (a + width, b + width);
            triangles.extend(if is_odd {
                [[a, b, d], [a, d, c]]
            } else {
                [[a, b, c], [b, d, c]]
            });
        }
    }
    MeshFile {
        positions,
        triangles,
        notes: Vec::new(),
    }
}

/// A study of one region with a site at the origin, pressed downwards, and no recordings yet.
pub fn study(mesh: MeshFile, material: StudyMaterial, shapes: Vec<(&str, Shape)>) -> Study {
    let indenter = |(name, shape): (&str, Shape)| Indenter {
        name: name.into(),
        shape,
    };
    Study {
        folder: PathBuf::new(),
        title: String::new(),
        skin: StudySkin {
            mesh,
            materials: vec![StudyMaterial {
                region: "default".into(),
                ..material
            }],
            ..StudySkin::default()
        },
        indenters: shapes.into_iter().map(indenter).collect(),
        sites: vec![Site {
            name: "pad".into(),
            point_mm: [0.0; 3],
            direction: [0.0, 0.0, -1.0],
            distance_mm: 0.0,
        }],
        recordings: Vec::new(),
        instrument: None,
        warnings: Vec::new(),
    }
}

/// A material with G0 and Glim to be fitted.
pub fn material(g0_mpa: f64, g_lim_mpa: f64, thickness_mm: f64) -> StudyMaterial {
    StudyMaterial {
        region: "default".into(),
        g0_mpa: Some(g0_mpa),
        g_lim_mpa: Some(g_lim_mpa),
        d_lim_mm: Some(4.0),
        thickness_mm: Some(thickness_mm),
        fit: vec!["g0_mpa".into(), "g_lim_mpa".into()],
        ..StudyMaterial::default()
    }
}

/// Adds an indentation.
pub fn add(study: &mut Study, (name, protocol, indenter): (&str, &str, &str), curve: Curve) {
    study.recordings.push(StudyRecording {
        name: name.into(),
        file: PathBuf::new(),
        data: Data::Indentation(curve),
        indenter: indenter.into(),
        site: "pad".into(),
        protocol: protocol.into(),
        subject: None,
        day: None,
        temperature_c: None,
        rest_s: None,
        order: None,
    });
}

/// A curve of channels.
pub fn curve(channels: &[(&str, &[f64])]) -> Curve {
    let channel = |(name, values): &(&str, &[f64])| Channel {
        name: (*name).into(),
        unit: String::new(),
        values: values.to_vec(),
    };
    Curve {
        channels: channels.iter().map(channel).collect(),
        ..Curve::default()
    }
}

/// Depth against time: in at `speed`, hold, out; `count` samples.
pub fn press_hold_release(
    (deepest, speed, hold): (f64, f64, f64),
    count: usize,
) -> (Vec<f64>, Vec<f64>) {
    let ramp = deepest / speed;
    let whole = 2.0 * ramp + hold;
    let at = |t: f64| (t * speed).min(deepest).min((whole - t) * speed).max(0.0);
    let times: Vec<f64> = (1..=count)
        .map(|k| whole * k as f64 / count as f64)
        .collect();
    let depths = times.iter().map(|t| at(*t)).collect();
    (times, depths)
}

/// The curve of a recording, to be changed.
pub fn curve_of(study: &mut Study, recording: usize) -> &mut Curve {
    match &mut study.recordings[recording].data {
        Data::Indentation(curve) => curve,
        _ => panic!("recording {recording} is no indentation"),
    }
}

/// A flat mat of `size` x `size` sensels of `pitch` mm on a plate over the origin, its columns along x and rows along y.
pub fn mat(size: usize, pitch: f64) -> (Vec<Sensel>, Vec<Option<PlacedSensel>>) {
    let offset = (size as f64 - 1.0) / 2.0;
    let each = (0..size * size).map(|k| (k / size, k % size));
    let sensel = |(row, column): (usize, usize)| Sensel {
        place: Some([row as u32, column as u32]),
        area_mm2: Some(pitch * pitch),
        ..Sensel::default()
    };
    let placed = |(row, column): (usize, usize)| {
        let at = |k: usize| (k as f64 - offset) * pitch;
        Some(PlacedSensel {
            center_mm: [at(column), at(row), 0.0],
            normal: Some([0.0, 0.0, -1.0]),
            area_mm2: pitch * pitch,
        })
    };
    (
        each.clone().map(sensel).collect(),
        each.map(placed).collect(),
    )
}

/// Adds a map of frames at `times` and `depths` on such a mat; its values are 0.
pub fn add_map(
    study: &mut Study,
    (name, protocol): (&str, &str),
    (size, pitch): (usize, f64),
    (times, depths): (&[f64], &[f64]),
) {
    let (sensels, placed) = mat(size, pitch);
    let map = PressureMap {
        name: String::new(),
        source: Source::default(),
        unit: PressureUnit::Kilopascal,
        values: vec![0.0; sensels.len() * times.len()],
        sensels,
        time_s: Some(times.to_vec()),
        clipped_from: None,
        threshold: None,
        pitch_mm: Some([pitch, pitch]),
        is_mirrored: [None; 2],
        channels: vec![Channel {
            name: "depth_mm".into(),
            unit: "mm".into(),
            values: depths.to_vec(),
        }],
        phases: Vec::new(),
        checks: Vec::new(),
        unknown: Vec::new(),
        warnings: Vec::new(),
    };
    add(study, (name, protocol, "plate"), Curve::default());
    let last = study.recordings.len() - 1;
    study.recordings[last].data = Data::PressureMap {
        map: Box::new(map),
        sensels: Some(placed),
        motion: None,
    };
}

/// The map of a recording, to be changed.
pub fn map_of(study: &mut Study, recording: usize) -> &mut PressureMap {
    match &mut study.recordings[recording].data {
        Data::PressureMap { map, .. } => map,
        _ => panic!("recording {recording} is no map"),
    }
}
