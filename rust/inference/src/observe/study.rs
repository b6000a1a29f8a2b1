//! Conducts the observation of a study: every recording to moments and samples.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use thenar_recordings::study::{Data, Indenter, PlacedSensel, Site, StudyRecording};
use thenar_recordings::{Curve, PressureMap, Study};

use crate::forward::setup::indenter::tool as tool_at;
use crate::observe::indentation::Division;
use crate::observe::limits::{MOST_FRAMES, MOST_MOMENTS};
use crate::observe::measured::Measured;
use crate::observe::motion::moving_average::{Press, Window, differences, window};

/// Extent of a tool that only tells the normals of sensels on it, mm: more than a mat's.
const FAR: f64 = 500.0;

/// Differences between repeats from which those of one protocol, tool and site say by themselves over which readings their forces are averaged.
const DECIDES: usize = 300;

/// A study's recordings, and what the fit must know of them besides.
#[derive(Debug, Clone)]
pub struct Observed {
    /// The recordings, in the study's order.
    pub measured: Vec<Measured>,
    /// By recording: false where the depth of first touch is a guess from the force.
    pub is_touch_known: Vec<bool>,
}

/// Turns every recording of a study into moments and samples; long ones are thinned to means ([`MOST_MOMENTS`], [`MOST_FRAMES`]).
pub fn observe(study: &Study) -> Observed {
    let mut observed = Observed {
        measured: Vec::new(),
        is_touch_known: Vec::new(),
    };
    let pairs = repeats(study);
    let all: Vec<[Press; 2]> = pairs.values().flatten().copied().collect();
    let of_all = window(&all);
    let own = |pairs: &[[Press; 2]]| match differences(pairs) >= DECIDES {
        true => window(pairs),
        false => of_all,
    };
    let mut alike = Alike {
        averaged: pairs
            .into_iter()
            .map(|(key, pairs)| (key, own(&pairs)))
            .collect(),
        averaged_of_all: of_all,
        divisions: BTreeMap::new(),
    };
    for recording in &study.recordings {
        let (measured, is_touch_known) = observe_one(study, recording, &mut alike);
        observed.measured.push(measured);
        observed.is_touch_known.push(is_touch_known);
    }
    observed
}

/// Protocol, tool and site of a recording.
type Key = [String; 3];

/// Presses of one protocol with one tool at one place, each with the one before.
fn repeats(study: &Study) -> BTreeMap<Key, Vec<[Press<'_>; 2]>> {
    let mut last: BTreeMap<Key, Press> = BTreeMap::new();
    let mut pairs: BTreeMap<Key, Vec<[Press; 2]>> = BTreeMap::new();
    for one in &study.recordings {
        let Data::Indentation(curve) = &one.data else {
            continue;
        };
        let depth = curve.channel("depth_mm").or(curve.channel("travel_mm"));
        if let Some((depth, force)) = depth.zip(curve.channel("force_n"))
            && !one.protocol.is_empty()
        {
            let key = [&one.protocol, &one.indenter, &one.site].map(String::clone);
            let press = Press { depth, force };
            if let Some(before) = last.insert(key.clone(), press) {
                pairs.entry(key).or_default().push([before, press]);
            }
        }
    }
    pairs
}

/// What recordings share.
struct Alike {
    /// Over which readings each force is averaged, by itself and with all others.
    averaged: BTreeMap<Key, Window>,
    averaged_of_all: Window,
    /// How the first recording of each was divided.
    divisions: BTreeMap<Key, Division>,
}

/// One recording, and whether its depth of first touch is known.
fn observe_one(study: &Study, recording: &StudyRecording, alike: &mut Alike) -> (Measured, bool) {
    let said = Said::of(study, recording);
    let mut measured = unread(recording);
    let is_touch_known = match &recording.data {
        Data::Indentation(curve) => said.curve(curve, &mut measured, alike),
        Data::PressureMap {
            map,
            sensels,
            motion,
        } => {
            let seen = (&**map, motion.as_deref());
            said.map(seen, sensels.as_deref(), &mut measured)
        }
        Data::Grasp { .. } => {
            let text =
                "a grasp is diagnosed with other grasps, and not fitted to presses of a tool";
            measured.unknown.push(text.to_owned());
            true
        }
        Data::Scan {
            mesh,
            at_time_s,
            depth_mm,
            motion,
        } => {
            let when = (*at_time_s, *depth_mm, motion.as_deref());
            said.scan(&mesh.positions, when, &mut measured);
            true
        }
        Data::Handprint { print, ink_kpa, .. } => {
            measured.unknown.extend(print.unknown.iter().cloned());
            measured.unknown.extend(of_print(*ink_kpa));
            true
        }
    };
    (measured, is_touch_known)
}

/// What the study says of a recording by its name, without its data.
fn unread(recording: &StudyRecording) -> Measured {
    Measured {
        name: recording.name.clone(),
        protocol: match recording.protocol.as_str() {
            "" => recording.name.clone(),
            named => named.to_owned(),
        },
        indenter: recording.indenter.clone(),
        site: recording.site.clone(),
        moments: Vec::new(),
        samples: Vec::new(),
        mat: None,
        scan: None,
        is_calibrated: true,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: Vec::new(),
    }
}

/// What the study says of a recording's site and tool.
struct Said<'a> {
    study: &'a Study,
    tool: &'a str,
    site: Option<&'a Site>,
    /// Direction of travel.
    direction: Vector3<f64>,
}

impl<'a> Said<'a> {
    fn of(study: &'a Study, recording: &'a StudyRecording) -> Said<'a> {
        let site = study.sites.iter().find(|site| site.name == recording.site);
        Said {
            study,
            tool: &recording.indenter,
            site,
            direction: site.map_or(-Vector3::z(), |site| site.direction.into()),
        }
    }

    fn indenter(&self) -> Option<&'a Indenter> {
        self.study.indenters.iter().find(|i| i.name == self.tool)
    }

    fn curve(&self, curve: &Curve, measured: &mut Measured, alike: &mut Alike) -> bool {
        let key = [&measured.protocol, &measured.indenter, &measured.site].map(String::clone);
        let division = alike.divisions.get(&key);
        let averaged = alike.averaged.get(&key).unwrap_or(&alike.averaged_of_all);
        let how = (across(self.direction), division, *averaged);
        let seen = crate::observe::indentation::observe(curve, how, MOST_MOMENTS);
        measured.depth_error_mm = seen.depth_error_mm;
        measured.is_coarse = seen.is_coarse;
        alike.divisions.entry(key).or_insert(seen.division);
        measured.moments = seen.moments;
        measured.samples = seen.samples;
        measured.unknown = seen.unknown;
        if curve.unknown.iter().any(|text| text.contains("of the tip")) {
            measured.unknown.push(format!(
                "the tool '{}' is the study's assumption and not the recording's: the moduli hold for that tool alone",
                self.tool
            ));
        }
        seen.is_touch_known
    }

    fn map(
        &self,
        (map, motion): (&PressureMap, Option<&Curve>),
        sensels: Option<&[Option<PlacedSensel>]>,
        measured: &mut Measured,
    ) -> bool {
        let mut placed = sensels.iter().copied().flatten().flatten();
        let lacks = placed.any(|sensel| sensel.normal.is_none());
        // A tool that cannot be is refused where it presses.
        let tool = self
            .indenter()
            .filter(|_| lacks)
            .zip(self.site)
            .and_then(|(indenter, site)| tool_at(indenter, site, FAR).ok());
        let instrument = self.study.instrument.as_ref();
        let seen = crate::observe::pressure_map::Seen {
            tool: tool.as_ref(),
            map,
            sensels,
            motion,
            saturation: instrument.and_then(|i| i.saturation_kpa),
            threshold: instrument.and_then(|i| i.threshold_kpa),
            across: across(self.direction),
            direction: self.direction,
        };
        crate::observe::pressure_map::observe(&seen, measured, MOST_FRAMES)
    }

    fn scan(
        &self,
        points: &[Vector3<f64>],
        when: (Option<f64>, Option<f64>, Option<&Curve>),
        measured: &mut Measured,
    ) {
        let seen = crate::observe::surface_scan::Seen {
            points,
            when,
            across: across(self.direction),
            direction: self.direction,
            site: self.site,
            indenter: self.indenter(),
        };
        crate::observe::surface_scan::observe(&seen, &self.study.skin.mesh, measured);
    }
}

/// What cannot be known from a print; it has no samples, and no fit sees it.
fn of_print(ink_kpa: f64) -> [String; 2] {
    [
        "no parameter is fitted to it: it is compared with the model that the other recordings give, pressed as hard as the study says"
            .to_owned(),
        match ink_kpa > 0.0 {
            true => format!("skin is taken to leave ink where it presses with more than {ink_kpa} kPa"),
            false => "skin is taken to leave ink wherever it touches; give ink_kpa if ink asks for more".to_owned(),
        },
    ]
}

/// The direction in which a slide counts: the skin's x, laid across the travel; y where x is the travel.
///
/// The study gives a slide's length only, and friction on an even skin does not ask for more.
pub(crate) fn across(direction: Vector3<f64>) -> Vector3<f64> {
    let lay = |axis: Vector3<f64>| axis - direction * direction.dot(&axis);
    let along_x = lay(Vector3::x());
    match along_x.norm() > 0.1 {
        true => along_x.normalize(),
        false => lay(Vector3::y()).normalize(),
    }
}
