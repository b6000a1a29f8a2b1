//! Noise of scans from repeats: place by place, with each repeat's own pose taken out.

use nalgebra::{Matrix6, Vector6};

use crate::noise::deviations::{Group, robust_deviation};
use crate::noise::scatter::Scatter;
use crate::observe::measured::{Measured, Quantity};

/// Numbers of a pose.
const POSE: usize = 6;
/// Fewest places that repeats share.
const LEAST: usize = 20;

/// What repeated scans show: standard deviations in mm (not shares); None where no two of them share enough places.
pub fn scatter(groups: &[Group], measured: &[Measured]) -> Option<Scatter> {
    let (mut deviations, mut degrees, mut members) = (Vec::new(), 0.0, Vec::new());
    for group in groups {
        let Some(found) = of_group(group, measured) else {
            continue;
        };
        let places = found[0].len() as f64;
        let repeats = group.len() as f64;
        let own = (repeats - 1.0) * (places - POSE as f64);
        // What is left of each repeat once its mean and its pose are taken out.
        let scale = (repeats * places / own).sqrt();
        deviations.extend(found.into_iter().flatten().map(|u| u * scale));
        degrees += own;
        members.extend(group.iter().copied());
    }
    (!members.is_empty())
        .then(|| Scatter::of_map(&members, (robust_deviation(&deviations), 0.0), degrees, 0.0))
}

/// Deviations from the mean by repeat and place.
fn of_group(group: &Group, measured: &[Measured]) -> Option<Vec<Vec<f64>>> {
    let scan = measured[group[0]].scan.as_ref()?;
    let heights: Vec<Vec<Option<f64>>> = group
        .iter()
        .map(|k| by_place(&measured[*k], scan.places.len()))
        .collect();
    let shared: Vec<usize> = (0..scan.places.len())
        .filter(|place| heights.iter().all(|repeat| repeat[*place].is_some()))
        .collect();
    if shared.len() < LEAST {
        return None;
    }
    let value = |repeat: &Vec<Option<f64>>, place: usize| repeat[place].unwrap_or(0.0);
    let mean = |place: usize| {
        heights
            .iter()
            .map(|repeat| value(repeat, place))
            .sum::<f64>()
            / heights.len() as f64
    };
    let columns: Vec<Vector6<f64>> = shared
        .iter()
        .map(|place| {
            let normal = scan.normals[*place];
            let turn = (scan.places[*place] - scan.center).cross(&normal);
            Vector6::new(normal.x, normal.y, normal.z, turn.x, turn.y, turn.z)
        })
        .collect();
    let gram: Matrix6<f64> = columns.iter().map(|c| c * c.transpose()).sum();
    // Directions that the surface leaves free take nothing out.
    let inverse = gram.pseudo_inverse(1e-9 * gram.norm()).ok()?;
    let of_repeat = |repeat: &Vec<Option<f64>>| {
        let off: Vec<f64> = shared
            .iter()
            .map(|p| value(repeat, *p) - mean(*p))
            .collect();
        let pull: Vector6<f64> = columns.iter().zip(&off).map(|(c, u)| c * *u).sum();
        let pose = inverse * pull;
        let left = columns.iter().zip(&off);
        left.map(|(c, u)| u - c.dot(&pose)).collect()
    };
    Some(heights.iter().map(of_repeat).collect())
}

fn by_place(measured: &Measured, places: usize) -> Vec<Option<f64>> {
    let mut heights = vec![None; places];
    for sample in &measured.samples {
        if let Quantity::Scan(place) = sample.quantity
            && let Some(height) = heights.get_mut(place as usize)
        {
            *height = Some(sample.value);
        }
    }
    heights
}
