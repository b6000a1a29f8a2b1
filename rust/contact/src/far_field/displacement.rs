//! Displacement of a large skin under loads: near loads one by one, far clusters by skeletons; error sampled.

use rayon::prelude::*;
use thenar_surface::Vec3;

use super::block_kernels::{Fields, zeros};
use super::cluster_bases::Clusters;
use super::cluster_tree::Node;
use super::hierarchy::{Hierarchy, SEPARATION, SiteList, SkinResponse, gap};
use super::matrix_vector::raise;
use crate::response::assembly::Load;
use crate::response::entries::Scratch;
use crate::{ContactError, Control};

/// Sites at which the field is summed directly as well.
const SAMPLES: usize = 48;
/// Smallest clusters between two looks at the caller's wish to stop.
const AT_ONCE: usize = 512;

/// A field and what it is worth.
pub struct FarFieldDisplacement {
    /// `sum_j K_ij load_j` at every site; multiply by the response weight of the site for mm.
    pub field: Vec<Vec3>,
    /// Largest difference from the direct sum on a sample of sites, relative to the largest field.
    pub certificate: f64,
}

/// Loads by cluster.
struct Sources<'a> {
    clusters: &'a Clusters,
    offset: Vec<usize>,
    /// Of the clusters' sites, and of their chosen ones.
    loads: Fields,
    raised: Fields,
}

impl Hierarchy {
    /// The field of `loads` (ascending sites), all within `clusters`; `known` is what is already known of it, by site.
    ///
    /// # Errors
    /// [`ContactError::Cancelled`].
    pub fn displacement(
        &self,
        (loads, clusters): (&[Load], &Clusters),
        known: &[Option<Vec3>],
        ground: SkinResponse<'_>,
        control: &Control,
    ) -> Result<FarFieldDisplacement, ContactError> {
        let sources = Sources::new(loads, clusters);
        let members = |node: &Node| &self.tree.order[node.first..node.last];
        let is_open = |node: &&Node| {
            let mut sites = members(node).iter();
            node.children.is_none() && sites.any(|&i| known[i as usize].is_none())
        };
        let leaves: Vec<&Node> = self.tree.nodes.iter().filter(is_open).collect();
        let mut field: Vec<Vec3> = known.iter().map(|u| u.unwrap_or_default()).collect();
        for (part, some) in leaves.chunks(AT_ONCE).enumerate() {
            let share = (part * AT_ONCE) as f64 / leaves.len() as f64;
            control.step("displacement", share)?;
            let found: Vec<Fields> = some
                .par_iter()
                .map(|leaf| self.at(leaf, &sources, ground))
                .collect();
            for (leaf, found) in some.iter().zip(found) {
                for (k, &site) in members(leaf).iter().enumerate() {
                    if known[site as usize].is_none() {
                        field[site as usize] = Vec3::from(at(&found, k));
                    }
                }
            }
        }
        let certificate = self.certify(loads, &field, ground);
        Ok(FarFieldDisplacement { field, certificate })
    }

    /// The field at the sites of a smallest cluster.
    fn at(&self, leaf: &Node, sources: &Sources<'_>, ground: SkinResponse<'_>) -> Fields {
        let listed = SiteList::new(&self.tree.order[leaf.first..leaf.last], ground.sites);
        let mut out = zeros(listed.sites.len());
        let mut row = vec![0.0f32; listed.sites.len()];
        let mut scratch = Scratch::default();
        let mut add = |site: u32, load: [f64; 3]| {
            if load == [0.0; 3] {
                return;
            }
            self.fill(ground, &listed, site, (&mut scratch, &mut row));
            for (out, load) in out.iter_mut().zip(load) {
                out.iter_mut()
                    .zip(&row)
                    .for_each(|(u, k)| *u += f64::from(*k) * load);
            }
        };
        let mut open = if sources.clusters.list.is_empty() {
            Vec::new()
        } else {
            vec![0]
        };
        while let Some(c) = open.pop() {
            let cluster = &sources.clusters.list[c];
            let node = &self.tree.nodes[cluster.node];
            if self.is_out_of_range(leaf, node) {
                continue;
            }
            let far = gap(leaf, node) >= SEPARATION * node.radius;
            match &cluster.basis {
                Some(basis) if far => {
                    for (k, &site) in basis.chosen.iter().enumerate() {
                        add(site, at(&sources.raised, sources.offset[c] + k));
                    }
                }
                _ if cluster.children.is_empty() => {
                    for k in cluster.first..cluster.last {
                        add(sources.clusters.sites[k], at(&sources.loads, k));
                    }
                }
                _ => open.extend(cluster.children.iter().rev()),
            }
        }
        out
    }

    fn certify(&self, loads: &[Load], field: &[Vec3], ground: SkinResponse<'_>) -> f64 {
        let largest = field.iter().map(|u| u.norm()).fold(0.0, f64::max);
        if largest == 0.0 {
            return 0.0;
        }
        // Half among the loads, half anywhere.
        let some = |count: usize| (0..SAMPLES / 2).map(move |k| (2 * k + 1) * count / SAMPLES);
        let among = some(loads.len()).map(|k| loads[k].site);
        let anywhere = some(field.len()).map(|k| self.tree.order[k]);
        let samples: Vec<u32> = among.chain(anywhere).collect();
        let bearing: Vec<u32> = loads.iter().map(|load| load.site).collect();
        let listed = SiteList::new(&bearing, ground.sites);
        let off = |&site: &u32| {
            let mut row = vec![0.0f32; bearing.len()];
            self.fill(ground, &listed, site, (&mut Scratch::default(), &mut row));
            let terms = row
                .iter()
                .zip(loads)
                .map(|(k, load)| load.load * f64::from(*k));
            (terms.sum::<Vec3>() - field[site as usize]).norm()
        };
        let off: Vec<f64> = samples.par_iter().map(off).collect();
        off.into_iter().fold(0.0, f64::max) / largest
    }
}

impl<'a> Sources<'a> {
    fn new(loads: &[Load], clusters: &'a Clusters) -> Self {
        let mut own = zeros(clusters.sites.len());
        for (k, site) in clusters.sites.iter().enumerate() {
            if let Ok(place) = loads.binary_search_by_key(site, |load| load.site) {
                for (axis, own) in own.iter_mut().enumerate() {
                    own[k] = loads[place].load[axis];
                }
            }
        }
        let offset = clusters.offsets();
        let raised = raise(clusters, &offset, &own);
        Sources {
            clusters,
            offset,
            loads: own,
            raised,
        }
    }
}

fn at(fields: &Fields, k: usize) -> [f64; 3] {
    [0, 1, 2].map(|axis| fields[axis][k])
}
