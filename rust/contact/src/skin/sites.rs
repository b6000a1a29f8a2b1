//! Sites: skin vertices in patch order, with rest positions, areas, regions and blends over creases.

use thenar_surface::{Adjacency, Mesh, SkinDistance, vertex_areas, vertex_normals};

use super::arc_length::Site;

/// Width over which materials of neighboring regions blend, mm: about a crease's own width (tests pass from 1 to 6).
const BLEND_WIDTH: f64 = 3.0;
/// Most smoothing steps, so that very fine meshes stay affordable.
const MOST_BLEND_STEPS: usize = 60;

/// Vertices of the skin and a fringe around it, numbered so that a patch's sites are neighbors in memory.
#[derive(Debug, Clone)]
pub struct Sites {
    /// Mesh vertex of each site.
    pub vertex: Vec<u32>,
    /// Site of each mesh vertex; `u32::MAX` for vertices away from the skin.
    pub of_vertex: Vec<u32>,
    /// Rest position and normal.
    pub rest: Vec<Site>,
    /// Rest area, mm2.
    pub area: Vec<f64>,
    /// Region; negative in the fringe.
    pub region: Vec<i32>,
    /// Share of each region in a site, summing to 1.
    pub blend: Vec<Vec<(u32, f64)>>,
    /// How much a site follows the skin: 1 on skin, falling to 0 over the fringe.
    pub follow: Vec<f64>,
    /// Patch of each site.
    pub patch: Vec<u32>,
    /// First and one-past-last site of each patch.
    pub patch_range: Vec<(u32, u32)>,
}

impl Sites {
    /// Number of sites.
    pub fn len(&self) -> usize {
        self.vertex.len()
    }

    /// Numbers the skin of `mesh`. `regions` has one entry per vertex, `spacing` is the median edge (mm).
    pub fn new(
        (mesh, adjacency): (&Mesh, &Adjacency),
        regions: &[i32],
        spacing: f64,
        metric: &SkinDistance,
    ) -> Self {
        let shares = blend_regions(regions, adjacency, spacing);
        let (normals, areas) = (vertex_normals(mesh), vertex_areas(mesh));
        let mut sites = Sites::empty(mesh.positions().len());
        for (patch, members) in metric.patches().enumerate() {
            let first = sites.vertex.len() as u32;
            for &v in members {
                let share = &shares[v as usize];
                let follow: f64 = share.iter().map(|s| s.1).sum();
                if follow > 0.0 && areas[v as usize] > 0.0 {
                    sites.of_vertex[v as usize] = sites.vertex.len() as u32;
                    sites.vertex.push(v);
                    sites.rest.push(Site {
                        position: mesh.positions()[v as usize],
                        normal: normals[v as usize],
                    });
                    sites.area.push(areas[v as usize]);
                    sites.region.push(regions[v as usize]);
                    sites
                        .blend
                        .push(share.iter().map(|&(r, w)| (r, w / follow)).collect());
                    sites.follow.push(if regions[v as usize] >= 0 {
                        1.0
                    } else {
                        follow
                    });
                    sites.patch.push(patch as u32);
                }
            }
            sites.patch_range.push((first, sites.vertex.len() as u32));
        }
        sites
    }

    fn empty(vertices: usize) -> Self {
        Sites {
            vertex: Vec::new(),
            of_vertex: vec![u32::MAX; vertices],
            rest: Vec::new(),
            area: Vec::new(),
            region: Vec::new(),
            blend: Vec::new(),
            follow: Vec::new(),
            patch: Vec::new(),
            patch_range: Vec::new(),
        }
    }

    /// True if the site may carry contact.
    pub fn is_skin(&self, site: usize) -> bool {
        self.region[site] >= 0
    }

    /// Region of a site, or in the fringe the one it is most of.
    pub fn home_region(&self, site: usize) -> u32 {
        if self.region[site] >= 0 {
            return self.region[site] as u32;
        }
        let most = self.blend[site].iter().max_by(|a, b| a.1.total_cmp(&b.1));
        most.map_or(0, |share| share.0)
    }

    /// Values of `of_region` blended at every site.
    pub fn blended(&self, of_region: &[f64]) -> Vec<f64> {
        (0..self.blend.len())
            .map(|site| self.blended_at(site, of_region))
            .collect()
    }

    /// The same at one site.
    pub fn blended_at(&self, site: usize, of_region: &[f64]) -> f64 {
        let shares = self.blend[site].iter();
        shares.map(|&(r, w)| w * of_region[r as usize]).sum()
    }
}

/// Diffuses the region numbers over the mesh: one list of (region, share) per vertex; shares on skin sum to 1.
fn blend_regions(regions: &[i32], adjacency: &Adjacency, spacing: f64) -> Vec<Vec<(u32, f64)>> {
    let own = |&r: &i32| {
        if r >= 0 {
            vec![(r as u32, 1.0)]
        } else {
            Vec::new()
        }
    };
    let mut shares: Vec<Vec<(u32, f64)>> = regions.iter().map(own).collect();
    let steps = (2.0 * (BLEND_WIDTH / spacing).powi(2) / 2.0).ceil() as usize;
    let mut is_border: Vec<bool> = (0..regions.len())
        .map(|i| {
            adjacency
                .neighbors(i)
                .iter()
                .any(|&j| regions[j as usize] != regions[i])
        })
        .collect();
    for _ in 0..steps.clamp(1, MOST_BLEND_STEPS) {
        let mixed: Vec<(usize, Vec<(u32, f64)>)> = (0..regions.len())
            .filter(|&i| is_border[i])
            .map(|i| (i, average(&shares, i, adjacency.neighbors(i))))
            .collect();
        for (i, share) in mixed {
            shares[i] = share;
            for &j in adjacency.neighbors(i) {
                is_border[j as usize] = true;
            }
        }
    }
    for (share, region) in shares.iter_mut().zip(regions) {
        let sum: f64 = share.iter().map(|s| s.1).sum();
        if *region >= 0 && sum > 0.0 {
            share.iter_mut().for_each(|s| s.1 /= sum);
        }
    }
    shares
}

fn average(shares: &[Vec<(u32, f64)>], i: usize, neighbors: &[u32]) -> Vec<(u32, f64)> {
    let mut sum = shares[i].clone();
    for &j in neighbors {
        for &(region, weight) in &shares[j as usize] {
            match sum.iter_mut().find(|s| s.0 == region) {
                Some(entry) => entry.1 += weight,
                None => sum.push((region, weight)),
            }
        }
    }
    let count = (neighbors.len() + 1) as f64;
    sum.iter_mut().for_each(|s| s.1 /= count);
    sum.sort_by_key(|s| s.0);
    sum
}
