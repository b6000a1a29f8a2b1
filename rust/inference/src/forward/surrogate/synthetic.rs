//! Synthetic studies for tests: tools with a closed-form response, and stated force recordings.

use nalgebra::Vector3;
use thenar_contact::Material;

use crate::forward::mesh::press_table::PressTable;
use crate::forward::surrogate::force_recording::{ForceRecording, Row, carries_use};
use crate::forward::surrogate::mechanism::Scales;
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::forward::tables::elastic::Elastic;
use crate::forward::tables::elastic_table::Tabulated;
use crate::interpolation::Table;
use crate::noise::channel::CHANNELS;
use crate::noise::correlation::Correlation;
use crate::noise::estimate::Noise;
use crate::noise::whitening::Whitening;
use crate::observe::measured::{Censoring, Measured, Moment, Phase, Quantity, Sample};
use crate::parameters::priors::SHARED_DEPTH;
use crate::parameters::surrogate_parameter::{Coordinate, Kind};

/// Depth at which the modulus of made tissue stops growing, mm.
const LIMIT_MM: f64 = 3.0;

/// One reading: time (s), depth (mm), phase, force (N).
pub type Reading = (f64, f64, Phase, f64);

/// A tool whose force over the modulus (mm2) and whose contact's radius (mm) are functions of the depth, as far as `deepest` (mm).
pub fn tool(deepest: f64, force: impl Fn(f64) -> f64, radius: impl Fn(f64) -> f64) -> Tabulated {
    let roots: Vec<f64> = (0..=30)
        .map(|k| deepest.sqrt() * f64::from(k) / 30.0)
        .collect();
    let of = |law: &dyn Fn(f64) -> f64| -> Vec<f64> { roots.iter().map(|r| law(r * r)).collect() };
    let rungs = of(&force);
    Tabulated {
        force: Table::new(&roots, rungs.clone()),
        radius: of(&radius),
        deepest,
        rungs,
        roots,
        is_exact: false,
    }
}

/// The same as it is pressed: forces, N, by depth.
pub(crate) fn press_table(deepest: f64, force: impl Fn(f64) -> f64) -> PressTable {
    let made = tool(deepest, force, |_| 0.0);
    PressTable {
        force: made.rungs,
        area: made.radius,
        loads: Vec::new(),
        touched: vec![true],
        roots: made.roots,
    }
}

/// Recordings by their tool, with noise of `sigma` (N), in tissue of 1 MPa whose two moduli are free.
pub fn ready(
    tools: Vec<Tabulated>,
    recordings: &[(usize, Vec<Reading>)],
    sigma: f64,
) -> (PreparedStudy, Vec<Measured>) {
    let measured: Vec<Measured> = recordings.iter().map(|(_, all)| measured(all)).collect();
    let noise = noise(&measured, sigma);
    let courses = courses(recordings);
    let prepared = PreparedStudy {
        whitening: Whitening::new(&measured, &noise, &vec![true; measured.len()]),
        values: recordings
            .iter()
            .flat_map(|(_, all)| all.iter().map(|one| one.3))
            .collect(),
        sigma: noise.sigma.concat(),
        noise,
        shared: [Kind::First, Kind::Limit].map(modulus).to_vec(),
        touch_mm: crate::parameters::priors::TOUCH,
        copies: None,
        scales: scales(&courses),
        elastic: Elastic {
            drained: vec![1.0; tools.len()],
            studied: tools.len(),
            site_of: vec![0; tools.len()],
            places: tools,
            variants: Vec::new(),
            limit_depth: LIMIT_MM,
            is_flat: true,
            is_bone_stated: false,
            shared_depth: SHARED_DEPTH * LIMIT_MM,
        },
        base_material: Material::finger_layer(),
        courses,
    };
    (prepared, measured)
}

fn modulus(kind: Kind) -> Coordinate {
    Coordinate {
        kind,
        start: 0.0,
        bounds: (-3.0, 3.0),
        prior: None,
        step: 1e-3,
    }
}

fn scales(courses: &[ForceRecording]) -> Scales {
    let peaks = || courses.iter().map(ForceRecording::most);
    Scales {
        deepest: courses
            .iter()
            .map(ForceRecording::deepest)
            .fold(0.0, f64::max),
        radius: 1.0,
        forces: (
            peaks().fold(f64::INFINITY, f64::min),
            peaks().fold(0.0, f64::max),
        ),
        has_bone: false,
        has_strain: false,
        carries_use: carries_use(courses),
    }
}

fn courses(recordings: &[(usize, Vec<Reading>)]) -> Vec<ForceRecording> {
    let mut first = 0;
    let mut all = Vec::new();
    for (number, (place, readings)) in recordings.iter().enumerate() {
        let row = |(k, one): (usize, &Reading)| Row {
            time_s: one.0,
            depth_mm: one.1,
            spread_mm: 0.0,
            force_step_n: 0.0,
            force_n: one.3,
            sample: Some(first + k),
            phase: one.2,
            cycle: 0,
        };
        all.push(ForceRecording {
            is_coarse: false,
            recording: number,
            name: String::new(),
            protocol: String::new(),
            place: *place,
            order: number,
            travel_before_mm: [0.0; 2],
            rows: readings.iter().enumerate().map(row).collect(),
            samples: (first, readings.len()),
        });
        first += readings.len();
    }
    all
}

fn measured(readings: &[Reading]) -> Measured {
    let moment = |one: &Reading| Moment {
        time_s: one.0,
        depth_mm: one.1,
        demand_n: f64::NAN,
        slide_mm: Vector3::zeros(),
        rate_mm_s: 1.0,
        phase: one.2,
        cycle: 0,
        readings: 1,
        depth_spread_mm: 0.0,
        force_step_n: 0.0,
    };
    let sample = |(k, one): (usize, &Reading)| Sample {
        moment: k as u32,
        quantity: Quantity::Force,
        value: one.3,
        censoring: Censoring::Seen,
    };
    Measured {
        name: String::new(),
        protocol: String::new(),
        indenter: String::new(),
        site: String::new(),
        moments: readings.iter().map(moment).collect(),
        samples: readings.iter().enumerate().map(sample).collect(),
        mat: None,
        scan: None,
        is_calibrated: true,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: Vec::new(),
    }
}

fn noise(measured: &[Measured], sigma: f64) -> Noise {
    Noise {
        sigma: measured
            .iter()
            .map(|one| vec![sigma; one.samples.len()])
            .collect(),
        profile: measured
            .iter()
            .map(|one| vec![1.0; one.samples.len()])
            .collect(),
        correlation: [Correlation::NONE; CHANNELS.len()],
        degrees: None,
        gain: 0.0,
        zero_mm: None,
        force_zero_n: None,
        has_clear_zeros: false,
        step: [1.0; CHANNELS.len()],
        drawn_from: Default::default(),
        rhythm: None,
        hum: None,
        has_depth_error: false,
        notes: Vec::new(),
    }
}
