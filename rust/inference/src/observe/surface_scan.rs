//! A scan as moments and samples: points on the skin and away from the tool, summed up around places of the skin.

use nalgebra::Vector3;
use thenar_recordings::Curve;
use thenar_recordings::meshes::MeshFile;
use thenar_recordings::study::{Indenter, Site};
use thenar_surface::{GapLimits, Mesh, Product};

use crate::forward::setup::indenter::tool as tool_at;
use crate::interpolation::linear;
use crate::number_format::number;
use crate::observe::indentation;
use crate::observe::limits::MOST_MOMENTS;
use crate::observe::measured::{
    Censoring, Measured, Moment, Phase, Quantity, Sample, Scan, ScanPoint,
};
use crate::observe::motion::moving_average::Window;
use crate::observe::robust_scale::{median, median_deviation};
use crate::observe::scan_registration::{Foot, Surface, moved};

/// Most points of a scan that are looked at, and of those that lay it.
const MOST_POINTS: (usize, usize) = (200_000, 2_000);
/// Most places of a site, and points around each of them.
const MOST_PLACES: usize = 400;
const MOST_AROUND: usize = 12;
/// Part of the most points around a place that another must have: at the rim of the tool and of the scan a few would tell a slope as a height.
const LEAST_SHARE: f64 = 1.0 / 3.0;
/// Places lie no farther from the site, mm: beyond, nothing that the tool does is seen.
const REACH: f64 = 40.0;
/// Points nearer to the tool than this are the tool, or skin that touches it, mm.
const TOUCHING: f64 = 0.5;
/// Points farther from the skin than the tool is deep and this are no skin, mm.
const BESIDE: f64 = 3.0;
/// Fewest places of a scan that is compared: a pose has 6 numbers.
const FEWEST: usize = 12;

/// A scan with what the study says of it.
pub struct Seen<'a> {
    /// The points, mm.
    pub points: &'a [Vector3<f64>],
    /// Time, s; depth, mm; the indentation during which it was taken.
    pub when: (Option<f64>, Option<f64>, Option<&'a Curve>),
    /// Direction of a slide.
    pub across: Vector3<f64>,
    /// Direction of travel.
    pub direction: Vector3<f64>,
    /// Where the tool touches.
    pub site: Option<&'a Site>,
    /// The tool.
    pub indenter: Option<&'a Indenter>,
}

/// Fills in moments, samples and scan; what keeps it from being compared is said.
pub fn observe(seen: &Seen<'_>, skin: &MeshFile, measured: &mut Measured) {
    match compared(seen, skin, measured) {
        Ok(()) => measured.unknown.push(
            "noise of neighboring places is taken as independent, which a scanner's own warp is not"
                .to_owned(),
        ),
        Err(reason) => measured.unknown.push(reason),
    }
}

fn compared(seen: &Seen<'_>, skin: &MeshFile, measured: &mut Measured) -> Result<(), String> {
    let moments = moments(seen)?;
    let depth = moments.last().map_or(0.0, |moment| moment.depth_mm);
    let unusable = |_| "the skin is no surface that a scan could be held against".to_owned();
    let mesh = Mesh::new(skin.positions.clone(), skin.triangles.clone()).map_err(unusable)?;
    let surface = Surface::new(mesh);
    let touch = seen
        .site
        .map_or_else(Vector3::zeros, |site| site.point_mm.into());
    let tool = tool(seen, depth);
    let points = thinned(seen.points, MOST_POINTS.0);
    let center = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let is_clear = |p: Vector3<f64>| tool.as_ref().is_none_or(|tool| tool.is_clear(p));
    let few = thinned(&points, MOST_POINTS.1);
    let pose = surface.lay(&few, center, &is_clear);
    let pose = pose.ok_or("too few of its points lie on the skin to lay it there")?;
    let laid: Vec<Vector3<f64>> = points.iter().map(|p| moved(*p, &pose, center)).collect();
    let near = surface
        .nearest(&laid)
        .unwrap_or_else(|| vec![0; laid.len()]);
    let mut places = places(&surface, touch);
    let within = BESIDE + depth.max(0.0);
    let mut kept: Vec<(ScanPoint, f64)> = Vec::new();
    for (position, triangle) in laid.iter().zip(&near) {
        let foot: Foot = surface.foot(*position, *triangle);
        let is_skin = !foot.is_at_end && foot.distance.abs() <= within && is_clear(*position);
        let place = is_skin.then(|| places.next_to(position - foot.normal * foot.distance));
        if let Some(place) = place.flatten() {
            let point = ScanPoint {
                position: *position,
                place,
                triangle: foot.triangle,
            };
            kept.push((point, foot.distance));
        }
    }
    kept.sort_by_key(|(point, _)| point.place);
    let (count, all) = (kept.len(), points.len());
    let last = moments.len() as u32 - 1;
    let (samples, points, scatter_mm) = summed(kept, last);
    if samples.len() < FEWEST {
        return Err(format!(
            "its points lie around {} places of the skin away from the tool, and {FEWEST} are needed to lay it there",
            samples.len()
        ));
    }
    let shift = number(pose[..3].iter().map(|x| x * x).sum::<f64>().sqrt());
    let turn = pose[3..].iter().map(|x| x * x).sum::<f64>().sqrt();
    measured.unknown.push(format!(
        "its own place is not known: it was laid on the skin by {shift} mm and {} degrees, and its pose is fitted from there; {} of \
         {all} points lie on the tool, within {TOUCHING} mm of it, or off the skin, and are left out",
        number(turn.to_degrees()),
        all - count
    ));
    places.scan.points = points;
    places.scan.center = center;
    places.scan.laid = pose;
    places.scan.scatter_mm = scatter_mm;
    measured.moments = moments;
    measured.samples = samples;
    measured.scan = Some(places.scan);
    Ok(())
}

/// The protocol until the scan; the scan is the last moment.
fn moments(seen: &Seen<'_>) -> Result<Vec<Moment>, String> {
    let (at, depth, motion) = seen.when;
    let time_s = at.unwrap_or(0.0);
    let of_motion = |curve: &Curve| {
        let (times, depths) = (curve.channel("time_s")?, curve.channel("depth_mm")?);
        Some(linear(times, depths, &[time_s])[0])
    };
    let Some(depth_mm) = depth.or_else(|| motion.and_then(of_motion)) else {
        return Err(
            "no depth goes with it: give depth_mm (0 before touch), or motion and at_time_s".into(),
        );
    };
    let mut moments = motion.map_or_else(Vec::new, |curve| {
        let mut moments =
            indentation::observe(curve, (seen.across, None, Window::ONE), MOST_MOMENTS).moments;
        moments.retain(|moment| moment.time_s < time_s);
        moments
    });
    moments.push(Moment {
        time_s,
        depth_mm,
        demand_n: f64::NAN,
        slide_mm: moments.last().map_or_else(Vector3::zeros, |m| m.slide_mm),
        rate_mm_s: 0.0,
        phase: if depth_mm > 0.0 {
            Phase::Hold
        } else {
            Phase::Apart
        },
        cycle: moments.last().map_or(0, |m| m.cycle),
        readings: 1,
        depth_spread_mm: 0.0,
        force_step_n: 0.0,
    });
    Ok(moments)
}

/// The tool where it stood.
struct Tool {
    surface: Product,
    travel: Vector3<f64>,
}

impl Tool {
    fn is_clear(&self, point: Vector3<f64>) -> bool {
        let limits = GapLimits {
            cut_off_mm: TOUCHING,
            max_depth_mm: f64::INFINITY,
        };
        let gap = self.surface.gap(point - self.travel, None, limits);
        gap.is_none_or(|gap| gap.distance > TOUCHING)
    }
}

/// The tool at its depth; none apart. What is wrong with it is told where it presses.
fn tool(seen: &Seen<'_>, depth: f64) -> Option<Tool> {
    let (indenter, site) = seen.indenter.zip(seen.site).filter(|_| depth > 0.0)?;
    Some(Tool {
        surface: tool_at(indenter, site, 2.0 * REACH).ok()?,
        travel: seen.direction * depth,
    })
}

fn thinned(points: &[Vector3<f64>], most: usize) -> Vec<Vector3<f64>> {
    let step = points.len().div_ceil(most).max(1);
    points.iter().step_by(step).copied().collect()
}

/// Places of the skin about a site.
struct Places {
    scan: Scan,
}

/// Vertices of the skin about a point, each as far from the next as leaves at most [`MOST_PLACES`] of them.
fn places(surface: &Surface, touch: Vector3<f64>) -> Places {
    let positions = surface.positions();
    let near: Vec<u32> = (0..positions.len() as u32)
        .filter(|v| (positions[*v as usize] - touch).norm() <= REACH)
        .collect();
    let mut spacing = 0.0;
    let mut chosen = near.clone();
    while chosen.len() > MOST_PLACES {
        let (low, high) = near.iter().fold(
            (
                Vector3::repeat(f64::INFINITY),
                Vector3::repeat(f64::NEG_INFINITY),
            ),
            |(low, high), v| {
                (
                    low.inf(&positions[*v as usize]),
                    high.sup(&positions[*v as usize]),
                )
            },
        );
        let least = (high - low).norm() / (2.0 * MOST_PLACES as f64);
        spacing = f64::max(1.2 * spacing, least);
        chosen.clear();
        for vertex in &near {
            let apart =
                |other: &u32| (positions[*other as usize] - positions[*vertex as usize]).norm();
            if chosen.iter().all(|other| apart(other) >= spacing) {
                chosen.push(*vertex);
            }
        }
    }
    let of = |list: &[Vector3<f64>]| chosen.iter().map(|v| list[*v as usize]).collect();
    let (own, normals): (Vec<_>, Vec<_>) = (of(positions), of(surface.normals()));
    let nearest = |k: usize| {
        let others = (0..own.len()).filter(|other| *other != k);
        others
            .map(|other| (own[other] - own[k]).norm())
            .fold(f64::INFINITY, f64::min)
    };
    let mut apart: Vec<f64> = (0..own.len()).map(nearest).collect();
    let scan = Scan {
        spacing: median(&mut apart),
        places: own,
        vertices: chosen,
        normals,
        points: Vec::new(),
        center: Vector3::zeros(),
        laid: [0.0; 6],
        scatter_mm: f64::NAN,
    };
    Places { scan }
}

impl Places {
    /// The place next to a point of the skin; none if it is farther than a spacing.
    fn next_to(&self, point: Vector3<f64>) -> Option<u32> {
        let apart = |k: &usize| (self.scan.places[*k] - point).norm_squared();
        let nearest = (0..self.scan.places.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        nearest
            .filter(|k| apart(k) <= self.scan.spacing.powi(2))
            .map(|k| k as u32)
    }
}

/// Mean heights by place, the points that make them, and the standard deviation of a mean as points scatter.
///
/// Points of one place lie on a slope: what they scatter is told by differences of neighbors in the list, which lie side by side.
fn summed(kept: Vec<(ScanPoint, f64)>, moment: u32) -> (Vec<Sample>, Vec<ScanPoint>, f64) {
    let (mut samples, mut points) = (Vec::new(), Vec::new());
    let (mut differences, mut counts) = (Vec::new(), 0.0);
    let groups = || kept.chunk_by(|a, b| a.0.place == b.0.place);
    let fullest = groups().map(|group| group.len().min(MOST_AROUND)).max();
    let least = (LEAST_SHARE * fullest.unwrap_or(0) as f64).ceil() as usize;
    for group in groups().filter(|group| group.len() >= least) {
        let step = group.len().div_ceil(MOST_AROUND);
        let used: Vec<&(ScanPoint, f64)> = group.iter().step_by(step).collect();
        let mean = used.iter().map(|(_, height)| height).sum::<f64>() / used.len() as f64;
        differences.extend(
            used.windows(3)
                .map(|w| (w[0].1 - 2.0 * w[1].1 + w[2].1).abs()),
        );
        counts += 1.0 / used.len() as f64;
        samples.push(Sample {
            moment,
            quantity: Quantity::Scan(group[0].0.place),
            value: mean,
            censoring: Censoring::Seen,
        });
        points.extend(used.iter().map(|(point, _)| *point));
    }
    // A second difference of independent noise has the variance (1 + 4 + 1) s^2.
    let single = median_deviation(&mut differences) / 6f64.sqrt();
    let mean = (counts / samples.len().max(1) as f64).sqrt();
    (samples, points, single * mean)
}
