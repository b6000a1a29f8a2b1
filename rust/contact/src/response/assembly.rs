//! From rows of the response to the matrix of a contact problem, and from forces to displacements.

use rayon::prelude::*;
use thenar_surface::Vec3;

use super::rows::Response;
use crate::sites::Sites;
use crate::solve::operator::{Rows, Run};

/// `K` between the sites of `zone` (ascending): symmetric, 1/mm.
pub fn coupling(response: &Response, zone: &[u32], sites: &Sites) -> Rows<f32> {
    let members: Vec<(usize, usize)> = sites
        .patch_range
        .iter()
        .map(|&(first, last)| {
            (
                zone.partition_point(|&z| z < first),
                zone.partition_point(|&z| z < last),
            )
        })
        .collect();
    let mut matrix = Rows::new();
    let mut runs: Vec<Run> = Vec::new();
    let mut values: Vec<f32> = Vec::new();
    for &site in zone {
        runs.clear();
        values.clear();
        let row = response.row(site);
        let mut diagonal = 0.0;
        for &(patch, offset) in response.near(sites.patch[site as usize]) {
            let (from, to) = members[patch as usize];
            if from == to {
                continue;
            }
            let first = sites.patch_range[patch as usize].0;
            match runs.last_mut() {
                Some(run) if (run.start + run.len) as usize == from => {
                    run.len += (to - from) as u32
                }
                _ => runs.push(Run {
                    start: from as u32,
                    len: (to - from) as u32,
                }),
            }
            for &other in &zone[from..to] {
                let value = row[(offset + other - first) as usize];
                if other == site {
                    diagonal = f64::from(value);
                }
                values.push(value);
            }
        }
        matrix.push(runs.iter().copied(), values.iter().copied(), diagonal);
    }
    matrix
}

/// The compliance (mm/N) along directions: `A_ij = w_i w_j K_ij t_i.t_j`, for weights `w` and unit directions `t`.
pub fn compliance(coupling: &Rows<f32>, weight: &[f64], direction: &[Vec3]) -> Rows<f32> {
    let weighted: Vec<[f64; 3]> = weight
        .iter()
        .zip(direction)
        .map(|(w, t)| [w * t.x, w * t.y, w * t.z])
        .collect();
    coupling.map_runs(|i, start, values, out| {
        scale_run(
            &weighted[start..start + values.len()],
            weighted[i],
            values,
            out,
        )
    })
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn scale_run(columns: &[[f64; 3]], row: [f64; 3], values: &[f32], out: &mut [f32]) {
    for ((b, value), out) in columns.iter().zip(values).zip(out) {
        *out = (f64::from(*value) * (row[0] * b[0] + row[1] * b[1] + row[2] * b[2])) as f32;
    }
}

/// One pressed site.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// The site.
    pub site: u32,
    /// Force times the response weight s of the site, along its direction.
    pub load: Vec3,
}

/// `sum_j K_ij load_j` at every site; zero out of range. Multiply by the response weight s of the site for mm.
pub fn displacements(response: &Response, loads: &[Load], sites: &Sites) -> Vec<Vec3> {
    let fields: Vec<Vec<Vec3>> = (0..sites.patch_range.len() as u32)
        .into_par_iter()
        .with_min_len(16)
        .map(|patch| patch_field(response, loads, (patch, sites)))
        .collect();
    fields.concat()
}

fn patch_field(response: &Response, loads: &[Load], (patch, sites): (u32, &Sites)) -> Vec<Vec3> {
    let (first, last) = sites.patch_range[patch as usize];
    let n = (last - first) as usize;
    let mut field = vec![0.0; 3 * n];
    let mut home = (u32::MAX, None);
    for load in loads {
        let from = sites.patch[load.site as usize];
        if home.0 != from {
            let near = response.near(from);
            let offset = near
                .binary_search_by_key(&patch, |entry| entry.0)
                .ok()
                .map(|k| near[k].1 as usize);
            home = (from, offset);
        }
        if let Some(offset) = home.1 {
            accumulate(
                &mut field,
                &response.row(load.site)[offset..offset + n],
                [load.load.x, load.load.y, load.load.z],
            );
        }
    }
    (0..n)
        .map(|i| Vec3::new(field[i], field[n + i], field[2 * n + i]))
        .collect()
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn accumulate(field: &mut [f64], row: &[f32], load: [f64; 3]) {
    for (component, load) in field.chunks_exact_mut(row.len()).zip(load) {
        for (out, k) in component.iter_mut().zip(row) {
            *out += f64::from(*k) * load;
        }
    }
}
