//! A mat's frames as moments and samples.

use nalgebra::Vector3;
use thenar_recordings::study::PlacedSensel;
use thenar_recordings::{Curve, PressureMap, PressureUnit};
use thenar_surface::{GapLimits, Product};

use crate::interpolation::linear;
use crate::observe::downsampling::{bins, means};
use crate::observe::first_touch::onset;
use crate::observe::measured::{Censoring, Mat, Measured, Moment, Phase, Quantity, Sample};
use crate::observe::protocol_phases::{Courses, Stretch, range, stretches};

/// A map with what the study says of it.
pub struct Seen<'a> {
    /// The frames.
    pub map: &'a PressureMap,
    /// Where the sensels lie.
    pub sensels: Option<&'a [Option<PlacedSensel>]>,
    /// The indentation that goes with it.
    pub motion: Option<&'a Curve>,
    /// Data sheet: where sensels clip, kPa.
    pub saturation: Option<f64>,
    /// Data sheet: what sensels do not pass on, kPa.
    pub threshold: Option<f64>,
    /// Direction of a slide.
    pub across: Vector3<f64>,
    /// Direction of travel.
    pub direction: Vector3<f64>,
    /// The tool at first touch, if a sensel's normal is to be told from it.
    pub tool: Option<&'a Product>,
}

/// Sensels farther from the tool than this do not lie on it, mm.
const ON_TOOL: f64 = 5.0;

/// Fills in moments, samples and mat, frames thinned to `budget`; returns whether the depth of first touch is known.
pub fn observe(seen: &Seen<'_>, measured: &mut Measured, budget: usize) -> bool {
    let map = seen.map;
    measured.is_calibrated = map.unit == PressureUnit::Kilopascal;
    measured.unknown.extend(map.unknown.iter().cloned());
    let Some(placed) = seen.sensels else {
        measured.unknown.push(
            "its sensels are not placed on the tool, so no pressure of it can be simulated; give sensels or placing".to_owned(),
        );
        return true;
    };
    let kept: Vec<usize> = (0..placed.len()).filter(|&k| placed[k].is_some()).collect();
    let mat = mat(&kept, placed, (seen, &mut measured.unknown));
    let course = Course::of(seen, &kept, &mut measured.unknown);
    let bins = course.bins(budget);
    if bins.len() < map.frames() {
        measured.unknown.push(format!(
            "its {} frames are compared as {} means, none across a change of phase",
            map.frames(),
            bins.len()
        ));
    }
    measured.moments = course.moments(&bins, seen.across);
    let limits = Limits::of(seen, measured.is_calibrated);
    for (moment, bin) in bins.iter().enumerate() {
        for (number, &cell) in kept.iter().enumerate() {
            let mut cells = bin.clone().map(|frame| map.frame(frame)[cell]);
            if let Some((value, censoring)) = limits.mean(&mut cells) {
                measured.samples.push(Sample {
                    moment: moment as u32,
                    quantity: Quantity::Pressure(number as u32),
                    value,
                    censoring,
                });
            }
        }
    }
    measured.mat = Some(mat);
    if !measured.is_calibrated {
        measured.unknown.push(
            "it is not calibrated: only the shape of its maps and their relative size are compared"
                .to_owned(),
        );
    }
    course.is_touch_known
}

/// The way out of the tool where a sensel lies; None off it.
fn out_of_tool(tool: &Product, sensel: &PlacedSensel) -> Option<Vector3<f64>> {
    let limits = GapLimits {
        cut_off_mm: ON_TOOL,
        max_depth_mm: ON_TOOL,
    };
    let gap = tool.gap(sensel.center_mm.into(), None, limits)?;
    let triangle = tool.mesh().triangles()[gap.triangle as usize];
    let [a, b, c] = triangle.map(|corner| tool.mesh().positions()[corner as usize]);
    (b - a).cross(&(c - a)).try_normalize(1e-300)
}

/// The mat; what is taken for normals that the study does not give is said.
fn mat(
    kept: &[usize],
    placed: &[Option<PlacedSensel>],
    (seen, unknown): (&Seen<'_>, &mut Vec<String>),
) -> Mat {
    let each = || kept.iter().filter_map(|&k| placed[k].as_ref());
    let (mut of_tool, mut of_travel) = (0, 0);
    let mut normal = |sensel: &PlacedSensel| {
        let given = sensel.normal.map(Vector3::from);
        given.unwrap_or_else(
            || match seen.tool.and_then(|tool| out_of_tool(tool, sensel)) {
                Some(normal) => {
                    of_tool += 1;
                    normal
                }
                None => {
                    of_travel += 1;
                    -seen.direction
                }
            },
        )
    };
    let normals = each().map(&mut normal).collect();
    if of_tool > 0 {
        unknown.push(format!(
            "sensels of which the study gives no normals ({of_tool}) are taken to look out of the tool where they lie"
        ));
    }
    if of_travel > 0 {
        unknown.push(format!(
            "sensels without normals that lie off the tool ({of_travel}) are taken to look back along the travel; check their places, or give placing"
        ));
    }
    Mat {
        centers: each().map(|s| s.center_mm.into()).collect(),
        normals,
        areas: each().map(|s| s.area_mm2).collect(),
        places: kept.iter().map(|&k| seen.map.sensels[k].place).collect(),
    }
}

/// Where readings are censored, in the map's unit.
struct Limits {
    clipped_from: f64,
    /// Readings of this and less are not passed on; 0 where nothing is known, since no mat shows less.
    threshold: f64,
}

impl Limits {
    fn of(seen: &Seen<'_>, is_calibrated: bool) -> Limits {
        let stated = seen
            .map
            .threshold
            .filter(|t| t.unit == seen.map.unit)
            .map(|t| t.value);
        let sheet = |value: Option<f64>| value.filter(|_| is_calibrated);
        let clips = [seen.map.clipped_from, sheet(seen.saturation)];
        Limits {
            clipped_from: clips.into_iter().flatten().fold(f64::INFINITY, f64::min),
            threshold: stated.or(sheet(seen.threshold)).unwrap_or(0.0),
        }
    }

    /// The mean of the frames in which the cell is there; the limit where most of them are censored.
    fn mean(&self, cells: &mut dyn Iterator<Item = f64>) -> Option<(f64, Censoring)> {
        let (mut sum, mut count, mut clipped, mut below) = (0.0, 0, 0, 0);
        for value in cells.filter(|value| !value.is_nan()) {
            (sum, count) = (sum + value, count + 1);
            clipped += usize::from(value >= self.clipped_from);
            below += usize::from(value <= self.threshold);
        }
        let mean = sum / count as f64;
        match count {
            0 => None,
            _ if clipped > 0 => Some((mean.min(self.clipped_from), Censoring::AtLeast)),
            _ if 2 * below > count => Some((self.threshold, Censoring::AtMost)),
            _ => Some((mean, Censoring::Seen)),
        }
    }
}

/// The protocol of a map, frame by frame.
struct Course {
    time_s: Vec<f64>,
    depth_mm: Option<Vec<f64>>,
    slide_mm: Vec<f64>,
    /// Sum of pressure times area, N; without calibration what it would be at a count per kPa.
    total: Vec<f64>,
    /// Phase that the file states, by frame.
    stated: Vec<Option<Phase>>,
    is_touch_known: bool,
}

impl Course {
    fn of(seen: &Seen<'_>, kept: &[usize], unknown: &mut Vec<String>) -> Course {
        let (map, frames) = (seen.map, seen.map.frames());
        let time_s = map.time_s.clone().unwrap_or_else(|| {
            unknown.push(
                "its frames have no times, so nothing that depends on time can be tested with it"
                    .to_owned(),
            );
            (0..frames).map(|frame| frame as f64).collect()
        });
        let own = |name: &str| {
            map.channels
                .iter()
                .find(|c| c.name == name)
                .map(|c| c.values.clone())
        };
        let mut is_touch_known = true;
        let of_motion = |name: &str| {
            let curve = seen.motion?;
            let values = curve.channel(name)?;
            Some(linear(curve.channel("time_s")?, values, &time_s))
        };
        let depth_mm = own("depth_mm")
            .or_else(|| of_motion("depth_mm"))
            .or_else(|| {
                let curve = seen.motion?;
                let (travel, force) = (curve.channel("travel_mm")?, curve.channel("force_n")?);
                let touch = travel[onset(travel, force).sample];
                is_touch_known = false;
                Some(of_motion("travel_mm")?.iter().map(|t| t - touch).collect())
            });
        if depth_mm.is_none() {
            let at = match map.unit == PressureUnit::Kilopascal {
                true => "",
                false => " at the counts per kPa that fit its shapes best",
            };
            unknown.push(format!(
                "no depth goes with it: each frame is simulated at the force that its own cells sum to{at}, so its total says nothing"
            ));
        }
        let total = |frame: usize| {
            let area = |cell: usize| {
                seen.sensels
                    .and_then(|s| s[cell])
                    .map_or(0.0, |s| s.area_mm2)
            };
            let values = kept
                .iter()
                .map(|&cell| (map.frame(frame)[cell], area(cell)));
            1e-3 * values
                .filter(|(value, _)| !value.is_nan())
                .map(|(v, a)| v * a)
                .sum::<f64>()
        };
        let stated = |frame: usize| match map.phases.get(frame).map(String::as_str) {
            Some("load") => Some(Phase::Load),
            Some("hold") => Some(Phase::Hold),
            Some("unload") => Some(Phase::Unload),
            Some("slide") => Some(Phase::Slide),
            Some("rest" | "apart") => Some(Phase::Apart),
            _ => None,
        };
        Course {
            slide_mm: own("slide_mm")
                .or_else(|| of_motion("slide_mm"))
                .unwrap_or_default(),
            total: (0..frames).map(total).collect(),
            stated: (0..frames).map(stated).collect(),
            is_touch_known,
            time_s,
            depth_mm,
        }
    }

    /// What stands for depth where it is not known: the total, which rises and falls with it.
    fn travel(&self) -> &[f64] {
        self.depth_mm.as_deref().unwrap_or(&self.total)
    }

    fn courses(&self) -> Courses<'_> {
        Courses {
            time_s: &self.time_s,
            depth_mm: self.travel(),
            force_n: &self.total,
            slide_mm: &self.slide_mm,
        }
    }

    fn stretches(&self) -> Vec<Stretch> {
        stretches(self.courses())
    }

    fn bins(&self, budget: usize) -> Vec<std::ops::Range<usize>> {
        bins(self.courses(), &self.stretches(), budget)
    }

    fn moments(&self, bins: &[std::ops::Range<usize>], across: Vector3<f64>) -> Vec<Moment> {
        let stretches = self.stretches();
        let (times, travel) = (means(&self.time_s, bins), means(self.travel(), bins));
        let (totals, slides) = (means(&self.total, bins), &self.slide_mm);
        let (low, high) = range(&times);
        let has_depth = self.depth_mm.is_some();
        let moment = |k: usize| {
            let first = bins[k].start;
            let found = stretches.iter().find(|s| first < s.end);
            let (a, b) = (k.saturating_sub(1), (k + 1).min(times.len() - 1));
            let rate = match has_depth && high > low && b > a {
                true => (travel[b] - travel[a]) / (times[b] - times[a]),
                false => 0.0,
            };
            Moment {
                time_s: times[k],
                depth_mm: if has_depth { travel[k] } else { f64::NAN },
                demand_n: if has_depth { f64::NAN } else { totals[k] },
                slide_mm: across * slides.get(first).copied().unwrap_or(0.0),
                rate_mm_s: rate,
                phase: self.stated[first].unwrap_or(found.map_or(Phase::Hold, |s| s.phase)),
                cycle: found.map_or(0, |s| s.cycle),
                readings: 1,
                depth_spread_mm: 0.0,
                force_step_n: 0.0,
            }
        };
        (0..bins.len()).map(moment).collect()
    }
}
