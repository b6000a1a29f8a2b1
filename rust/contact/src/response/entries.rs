//! Single entries of the response between any sites, bit for bit those of its rows; bounds and memory of rows.

use super::rows::Response;
use crate::skin::arc_length::{Site, arc_lengths};
use crate::skin::sites::Sites;

/// What entries are made with, kept for its storage.
#[derive(Debug, Default)]
pub struct Scratch {
    distances: Vec<f64>,
    psi: Vec<f64>,
}

/// Sites of one patch.
#[derive(Clone, Copy)]
pub struct Group<'a> {
    /// The sites.
    pub sites: &'a [u32],
    /// Their rest positions and normals.
    pub rest: &'a [Site],
}

impl Response {
    /// Whether entries are those of a bare layer without cuts.
    fn is_plain(&self) -> bool {
        self.stiff.is_none() && self.cuts.is_empty()
    }

    /// Memory that the rows of `zone` and the coupling between them may take, bytes.
    pub fn bytes(&self, zone: &[u32], sites: &Sites) -> f64 {
        let row = |&site: &u32| self.row_length(sites.patch[site as usize], sites);
        let entries: f64 = zone.iter().map(|site| row(site) as f64).sum();
        // The coupling, and the compliance made of it, hold what lies within the zone.
        let within: f64 = zone
            .iter()
            .map(|site| row(site).min(zone.len()) as f64)
            .sum();
        size_of::<f32>() as f64 * (entries + 2.0 * within)
    }

    /// Largest range of any site's response, mm.
    pub fn most_reach(&self) -> f64 {
        self.reach.iter().fold(0.0, |most, r| f64::max(most, *r))
    }

    /// Patches within range of `patch`, each with the lower bound of its skin distance, mm.
    pub fn bounds(&self, patch: u32) -> impl Iterator<Item = (u32, f64)> {
        let bounds = self.at_least[patch as usize].iter();
        self.near(patch).iter().map(|p| p.0).zip(bounds.copied())
    }

    /// `K` of model layer between the sites of a group and site `j`, 1/mm, as a row in memory holds it; `bound` is the two
    /// patches' lower bound of the skin distance (mm), infinite where they are out of range.
    pub fn entries(
        &self,
        there: Group<'_>,
        (j, bound): (usize, f64),
        (sites, scratch): (&Sites, &mut Scratch),
        out: &mut [f32],
    ) {
        if bound == f64::INFINITY {
            out.fill(0.0);
            return;
        }
        let Scratch { distances, psi } = scratch;
        distances.resize(out.len(), 0.0);
        psi.resize(out.len(), 0.0);
        arc_lengths(there.rest, &sites.rest[j], bound, distances);
        let places = there.sites.iter().map(|&i| i as usize);
        self.find_psi(places.clone(), j, distances, psi);
        if self.is_plain() {
            // The same operations, without asking at every entry.
            for ((i, out), (r, psi)) in places
                .clone()
                .zip(&mut *out)
                .zip(distances.iter().zip(&*psi))
            {
                let is_near = *r < 0.5 * (self.reach[i] + self.reach[j]);
                *out = if is_near { (1.0 / r - psi) as f32 } else { 0.0 };
            }
            if let Some(own) = places.clone().position(|i| i == j) {
                out[own] = self.layer_entry((j, j), distances[own], psi[own], sites) as f32;
            }
            return;
        }
        for ((i, out), (r, psi)) in places.zip(out).zip(distances.iter().zip(psi.iter())) {
            *out = (self.layer_entry((i, j), *r, *psi, sites) * self.kept(i, j)) as f32;
        }
    }
}
