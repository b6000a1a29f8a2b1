//! The cluster tree: sites bisected by rest position; leaves lie within one patch.

use thenar_surface::Vec3;

use crate::skin::sites::Sites;

/// Most sites of a cluster that is not cut. 32 to 128 serve; smaller ones store less, larger ones multiply faster.
pub const LEAF: usize = 64;

/// Where a site or a patch lies, mm, and its number.
type Placed = (Vec3, u32);

/// Sites that lie together.
#[derive(Debug, Clone)]
pub struct Node {
    /// Its part of [`Tree::order`].
    pub first: usize,
    pub last: usize,
    /// The two halves; none of a smallest cluster.
    pub children: Option<[usize; 2]>,
    /// A ball around its sites, mm.
    pub center: Vec3,
    pub radius: f64,
}

/// Clusters of all sites, each before its halves.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    pub nodes: Vec<Node>,
    /// Sites so that every cluster's follow one another.
    pub order: Vec<u32>,
}

impl Tree {
    /// Cuts the sites between patches first, then the patches themselves.
    pub fn new(sites: &Sites) -> Tree {
        let mut patches: Vec<Placed> = Vec::new();
        for (patch, &(first, last)) in sites.patch_range.iter().enumerate() {
            let members = &sites.rest[first as usize..last as usize];
            if !members.is_empty() {
                let sum: Vec3 = members.iter().map(|site| site.position).sum();
                patches.push((sum / members.len() as f64, patch as u32));
            }
        }
        let mut tree = Tree::default();
        if !patches.is_empty() {
            tree.cut_patches(&mut patches, sites);
        }
        tree
    }

    fn cut_patches(&mut self, patches: &mut [Placed], sites: &Sites) -> usize {
        if let [(_, patch)] = *patches {
            let (first, last) = sites.patch_range[patch as usize];
            let place = |i: u32| (sites.rest[i as usize].position, i);
            let mut members: Vec<Placed> = (first..last).map(place).collect();
            return self.cut_sites(&mut members);
        }
        let node = self.open();
        let (low, high) = halves(patches);
        let children = [self.cut_patches(low, sites), self.cut_patches(high, sites)];
        let members = self.order[self.nodes[node].first..].to_vec();
        let place = |&i: &u32| sites.rest[i as usize].position;
        self.close(node, Some(children), members.iter().map(place).collect());
        node
    }

    fn cut_sites(&mut self, members: &mut [Placed]) -> usize {
        let node = self.open();
        let mut children = None;
        if members.len() > LEAF {
            let (low, high) = halves(members);
            children = Some([self.cut_sites(low), self.cut_sites(high)]);
        } else {
            self.order.extend(members.iter().map(|m| m.1));
        }
        self.close(node, children, members.iter().map(|m| m.0).collect());
        node
    }

    fn open(&mut self) -> usize {
        self.nodes.push(Node {
            first: self.order.len(),
            last: self.order.len(),
            children: None,
            center: Vec3::zeros(),
            radius: 0.0,
        });
        self.nodes.len() - 1
    }

    fn close(&mut self, node: usize, children: Option<[usize; 2]>, places: Vec<Vec3>) {
        let (low, high) = bounds(places.iter());
        let center = (low + high) / 2.0;
        let radius = places.iter().map(|p| (p - center).norm());
        let node = &mut self.nodes[node];
        node.radius = radius.fold(0.0, f64::max);
        node.last = self.order.len();
        (node.center, node.children) = (center, children);
    }
}

/// The two halves along the longest side of the box around them.
fn halves(places: &mut [Placed]) -> (&mut [Placed], &mut [Placed]) {
    let (low, high) = bounds(places.iter().map(|p| &p.0));
    let axis = (high - low).imax();
    places.sort_unstable_by(|a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    places.split_at_mut(places.len() / 2)
}

fn bounds<'a>(places: impl Iterator<Item = &'a Vec3>) -> (Vec3, Vec3) {
    let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    places.fold(none, |(low, high), p| (low.inf(p), high.sup(p)))
}
