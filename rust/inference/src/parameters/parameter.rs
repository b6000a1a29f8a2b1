//! A parameter: what it is, its name and target, its bounds and prior, and the coordinate in which a fit moves it.

use thenar_contact::{ActiveEffect, Material};

use crate::forward::setup::study_skin::Tissue;
use crate::observe::measured::Measured;
use crate::parameters::estimate::Estimate;
use crate::parameters::target::Target;

/// What a number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Logarithm of a number of a region's material.
    Tissue(usize, Number),
    /// Depth of first touch of a recording, about that of its tool at its site.
    Zero(usize),
    /// Depth of first touch that a tool at a site (by number) has in all its recordings: an operator who judges late always does.
    Touch(usize),
    /// Logarithm of a recording's gain.
    Gain(usize),
    /// Logarithm of the instrument's gain.
    InstrumentGain,
    /// Shift of a recording's mat along its first (0) or second (1) direction, or its turn (2).
    Pose(usize, usize),
    /// Shift of a scan along x, y, z (0 to 2, mm), or its turn about them (3 to 5, rad).
    Scan(usize, usize),
    /// What a recording's load cell shows without load.
    ForceZero(usize),
    /// Logarithm of counts per kPa of a recording.
    Counts(usize),
    /// Logarithm of the factor by which the model's own form is off at one knot of depth, for a tool at a site.
    Form(usize, usize),
    /// A number of an effect: its shape number, or None for its amplitude.
    Effect(usize, Option<usize>, Scale),
}

/// A number of a material that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// `g0_mpa`
    G0,
    /// `g_lim_mpa`
    GLim,
    /// `d_lim_mm`
    DLim,
    /// `thickness_mm`
    Thickness,
}

impl Number {
    const ALL: [Number; 4] = [Number::G0, Number::GLim, Number::DLim, Number::Thickness];

    /// Its key in a study.
    pub fn name(self) -> &'static str {
        match self {
            Number::G0 => "g0_mpa",
            Number::GLim => "g_lim_mpa",
            Number::DLim => "d_lim_mm",
            Number::Thickness => "thickness_mm",
        }
    }

    pub(crate) fn named(name: &str) -> Option<Number> {
        Number::ALL.into_iter().find(|number| number.name() == name)
    }

    /// Its place in a material.
    pub fn of(self, material: &mut Material) -> &mut f64 {
        match self {
            Number::G0 => &mut material.g0_mpa,
            Number::GLim => &mut material.g_lim_mpa,
            Number::DLim => &mut material.d_lim_mm,
            Number::Thickness => &mut material.thickness_mm,
        }
    }
}

impl Tissue {
    /// The study's materials with what was estimated of them.
    pub(crate) fn fitted_materials(&self, estimates: &[Estimate]) -> Vec<Material> {
        let mut materials = self.materials.clone();
        for estimate in estimates {
            let Target::Region(name) = &estimate.target else {
                continue;
            };
            let region = self.regions.iter().position(|region| region == name);
            if let Some((region, number)) = region.zip(Number::named(&estimate.name)) {
                *number.of(&mut materials[region]) = estimate.value;
            }
        }
        materials
    }
}

/// A number that is fitted, in the coordinate in which the fit moves it (a logarithm where its kind says so).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter<K = Kind> {
    /// What it is.
    pub kind: K,
    /// Where a fit begins.
    pub start: f64,
    /// Smallest and largest admissible value.
    pub bounds: (f64, f64),
    /// Standard deviation about 0 before the data are seen; None: anything within the bounds.
    pub prior: Option<f64>,
    /// Step of a finite difference.
    pub step: f64,
}

impl<K> Parameter<K> {
    /// A number about 0 of that standard deviation, at most so many of them off.
    pub fn about(kind: K, (sd, most): (f64, f64), step: f64) -> Parameter<K> {
        Parameter {
            kind,
            start: 0.0,
            bounds: (-most * sd, most * sd),
            prior: Some(sd),
            step,
        }
    }
}

impl Parameter {
    /// True if the coordinate is a logarithm.
    pub(crate) fn is_log(&self) -> bool {
        let is_plain = matches!(
            self.kind,
            Kind::Zero(_)
                | Kind::Touch(_)
                | Kind::Pose(..)
                | Kind::Scan(..)
                | Kind::ForceZero(_)
                | Kind::Form(..)
                | Kind::Effect(_, _, Scale::Plain)
        );
        !is_plain
    }

    /// Name with its unit.
    pub fn name(&self, effects: &[ActiveEffect]) -> &'static str {
        const MAT: [&str; 3] = ["pose_x_mm", "pose_y_mm", "pose_turn_rad"];
        const SCAN: [&str; 6] = [
            "scan_x_mm",
            "scan_y_mm",
            "scan_z_mm",
            "scan_turn_x_rad",
            "scan_turn_y_rad",
            "scan_turn_z_rad",
        ];
        match self.kind {
            Kind::Tissue(_, number) => number.name(),
            Kind::Zero(_) | Kind::Touch(_) => "contact_zero_mm",
            Kind::Gain(_) => "repeat_gain",
            Kind::InstrumentGain => "gain",
            Kind::Pose(_, axis) => MAT[axis],
            Kind::Scan(_, axis) => SCAN[axis],
            Kind::ForceZero(_) => "force_zero_n",
            Kind::Counts(_) => "counts_per_kpa",
            Kind::Form(..) => "form",
            Kind::Effect(_, None, _) => "amplitude",
            Kind::Effect(effect, Some(number), _) => effects[effect].entry().shape[number].name,
        }
    }

    /// What it belongs to, by the names of regions and the recordings.
    pub fn target(&self, regions: &[String], measured: &[Measured]) -> Target {
        match (self.kind, self.recording()) {
            (Kind::Tissue(region, _), _) => Target::Region(regions[region].clone()),
            (_, Some(recording)) => Target::Recording(measured[recording].name.clone()),
            _ => Target::Instrument,
        }
    }

    /// The number itself.
    pub fn value(&self, coordinate: f64) -> f64 {
        if self.is_log() {
            libm::exp(coordinate)
        } else {
            coordinate
        }
    }

    /// The one recording it matters to; None: all.
    pub fn recording(&self) -> Option<usize> {
        match self.kind {
            Kind::Zero(r)
            | Kind::Gain(r)
            | Kind::Pose(r, _)
            | Kind::Scan(r, _)
            | Kind::ForceZero(r)
            | Kind::Counts(r) => Some(r),
            Kind::Tissue(..)
            | Kind::InstrumentGain
            | Kind::Touch(_)
            | Kind::Form(..)
            | Kind::Effect(..) => None,
        }
    }
}

/// How a number is moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// As it is.
    Plain,
    /// By its logarithm.
    Logarithm,
}
