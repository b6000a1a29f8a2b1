//! Place of a scan window: center, confidence region, skin under it, and whether it moves with skin or sensor.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use thenar_surface::{Mesh, closest_point};

use crate::location::mismatch::{Carrier, Place};
use crate::location::scan_statistic::Scan;
use crate::location::scan_windows::{Coordinates, Disc, ScanWindow, ScanWindows};
use thenar_inference::observe::measured::Measured;

/// Correlation of two looks' statistics from which their places count as one.
const ALIKE: f64 = 0.9;
/// Lead in log-likelihood from which one of skin and sensor is named: odds of 20.
const LEAD: f64 = 3.0;
/// Probability that the set of sensels holds.
const HELD: f64 = 0.9;

/// A scan and what it found.
#[derive(Clone, Copy)]
pub(crate) struct Scored<'a> {
    pub scan: &'a Scan<'a>,
    pub windows: &'a ScanWindows,
    /// Statistic of every look, in units of its standard deviation.
    pub scores: &'a [f64],
}

/// The place of look `best`; None if it is of no disc.
pub(crate) fn place(
    scored: Scored<'_>,
    best: usize,
    (measured, skin): (&[Measured], Option<&Mesh>),
) -> Option<Place> {
    let disc = scored.windows.list[best].disc?;
    let sensor = &scored.windows.sensors[disc.sensor];
    let mat = measured[sensor.recording].mat.as_ref()?;
    let held = held(scored, best, disc);
    let near = 2.0 * sensor.pitch + disc.radius;
    let close = held
        .iter()
        .filter(|one| (one.center - disc.center).norm() <= near);
    let (mut center, mut whole) = (Vector3::zeros(), 0.0);
    for one in close {
        center += one.center * one.share;
        whole += one.share;
    }
    let center = if whole > 0.0 {
        center / whole
    } else {
        disc.center
    };
    let resolution = resolution(scored, best, disc).max(0.5 * sensor.pitch);
    // The set is no finer than the resolution either: sensels that reach into it belong.
    let reach = resolution + 0.5 * sensor.pitch;
    let pose = sensor.pose_at(disc.center, disc.sensel);
    let around = (0u32..)
        .zip(pose)
        .filter(|(_, c)| (*c - center).norm() <= reach);
    let mut sensels: Vec<u32> = held.iter().map(|one| one.sensel).collect();
    sensels.extend(around.map(|(sensel, _)| sensel));
    sensels.sort_unstable();
    sensels.dedup();
    let area = sensels
        .iter()
        .map(|sensel| mat.areas[*sensel as usize])
        .sum();
    let (on_skin, vertices) = match skin {
        Some(skin) => under(skin, center, disc.radius),
        None => (None, Vec::new()),
    };
    Some(Place {
        center_mm: center,
        row_column: mat.places.get(disc.sensel as usize).copied().flatten(),
        on_skin_mm: on_skin,
        vertices,
        radius_mm: disc.radius,
        resolution_mm: resolution,
        sensels_90: sensels,
        area_90_mm2: area,
        carrier: carrier(scored, best, disc.sensor),
    })
}

/// A sensel with its probability to be the middle.
struct Held {
    sensel: u32,
    center: Vector3<f64>,
    share: f64,
}

/// The most probable middles of a disc at equal odds for all sensels and radii, until nine tenths are held.
fn held(scored: Scored<'_>, best: usize, disc: Disc) -> Vec<Held> {
    let top = scored.scores[best];
    let mut middles: BTreeMap<(u32, [u64; 3]), Held> = BTreeMap::new();
    for (window, score) in scored.windows.list.iter().zip(scored.scores) {
        let Some(other) = of_kind(window, scored.windows.list[best].group, disc) else {
            continue;
        };
        if score * top <= 0.0 {
            continue;
        }
        let key = (other.sensel, other.center.map(f64::to_bits).into());
        let share = (0.5 * (score * score - top * top)).exp();
        let middle = middles.entry(key).or_insert(Held {
            sensel: other.sensel,
            center: other.center,
            share: 0.0,
        });
        middle.share += share;
    }
    let mut middles: Vec<Held> = middles.into_values().collect();
    middles.sort_by(|one, two| two.share.total_cmp(&one.share));
    let whole: f64 = middles.iter().map(|one| one.share).sum();
    let mut sum = 0.0;
    let needed = middles.iter().take_while(|one| {
        let more = sum < HELD * whole;
        sum += one.share;
        more
    });
    let count = needed.count();
    middles.truncate(count);
    middles
}

fn of_kind(window: &ScanWindow, group: usize, disc: Disc) -> Option<Disc> {
    let same = |other: &Disc| (other.coordinates, other.sensor) == (disc.coordinates, disc.sensor);
    window
        .disc
        .filter(|other| window.group == group && same(other))
}

/// Largest distance to a disc of the same size that shows nearly the same.
fn resolution(scored: Scored<'_>, best: usize, disc: Disc) -> f64 {
    let group = scored.windows.list[best].group;
    let mut farthest: f64 = 0.0;
    for (at, window) in scored.windows.list.iter().enumerate() {
        let Some(other) = of_kind(window, group, disc).filter(|o| o.radius == disc.radius) else {
            continue;
        };
        let distance = (other.center - disc.center).norm();
        if distance > farthest && scored.scan.correlation(best, at).abs() >= ALIKE {
            farthest = distance;
        }
    }
    farthest
}

/// Skin or sensor: which coordinates gather more of the mismatch, over cells of two poses or more.
fn carrier(scored: Scored<'_>, best: usize, sensor: usize) -> Carrier {
    let own = scored.scan.atoms_of(&scored.windows.list[best]);
    let sign = scored.scores[best].signum();
    let mut by_group: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for (window, score) in scored.windows.list.iter().zip(scored.scores) {
        let Some(disc) = window.disc.filter(|disc| disc.sensor == sensor) else {
            continue;
        };
        let shares = || {
            let theirs = scored.scan.atoms_of(window);
            own.iter()
                .any(|cell_sum| theirs.binary_search(cell_sum).is_ok())
        };
        let gain = 0.5 * (score * sign).max(0.0).powi(2);
        let most = by_group.entry(window.group).or_insert([0.0; 2]);
        let kind = usize::from(disc.coordinates == Coordinates::Skin);
        if gain > most[kind] && shares() {
            most[kind] = gain;
        }
    }
    let poses = |group: &usize| {
        let skin = |window: &&ScanWindow| {
            window
                .disc
                .is_some_and(|d| d.coordinates == Coordinates::Skin)
        };
        scored
            .windows
            .list
            .iter()
            .filter(|window| window.group == *group)
            .any(|window| skin(&window))
    };
    let told = by_group.iter().filter(|(group, _)| poses(group));
    let strongest = told.max_by(|one, two| {
        let most = |gains: &[f64; 2]| gains[0].max(gains[1]);
        most(one.1).total_cmp(&most(two.1))
    });
    match strongest {
        Some((_, [sensor, skin])) if skin - sensor >= LEAD => Carrier::Skin,
        Some((_, [sensor, skin])) if sensor - skin >= LEAD => Carrier::Sensor,
        _ => Carrier::CannotTell,
    }
}

/// The point of the skin next to a center, and the vertices within a radius of it, or the nearest one.
fn under(skin: &Mesh, center: Vector3<f64>, radius: f64) -> (Option<Vector3<f64>>, Vec<u32>) {
    let positions = skin.positions();
    let points = (0..skin.triangles().len()).map(|triangle| {
        let [a, b, c] = skin.corners(triangle);
        closest_point([a, b, c], center).point
    });
    let nearer = |one: &Vector3<f64>, two: &Vector3<f64>| {
        (one - center)
            .norm_squared()
            .total_cmp(&(two - center).norm_squared())
    };
    let Some(point) = points.min_by(nearer) else {
        return (None, Vec::new());
    };
    let distance = |vertex: &u32| (positions[*vertex as usize] - point).norm();
    let mut vertices: Vec<u32> = (0..positions.len() as u32)
        .filter(|vertex| distance(vertex) <= radius)
        .collect();
    if vertices.is_empty() {
        let nearest =
            (0..positions.len() as u32).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        vertices.extend(nearest);
    }
    (Some(point), vertices)
}
