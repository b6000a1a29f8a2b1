//! Makes a product's mesh face outward, and finds out how inside and outside can be told on it.

use crate::audit::{audit_of, find, join, middle, signed_volume};
use crate::edges::{Side, joins, sides};
use crate::mesh::{Mesh, Standing, Vec3, standings};
use crate::winding::solid_angle;

/// A part whose holes, spanned flat, have more than this part of its area is a sheet. A mug with a missing facet has less than 0.01, a tube
/// ten times as long as wide 0.05 for each open end.
const SHEET: f64 = 0.02;

/// A product's mesh, turned outward where that could be decided.
pub(crate) struct Oriented {
    pub mesh: Mesh,
    /// The triangles with vertices of equal position made one, as exporters split them at seams.
    pub welded: Vec<[u32; 3]>,
    pub standing: Vec<Standing>,
    /// Whether there are holes: then a point may be half inside.
    pub is_open: bool,
    /// For each triangle, whether its part is a sheet without thickness rather than a body with small holes.
    pub is_sheet: Vec<bool>,
    /// Whether angle-weighted pseudo-normals decide inside and outside: closed, manifold, no flat triangle, no parts that may overlap.
    pub is_simple: bool,
    /// Whether parts may lie within each other.
    pub may_overlap: bool,
    /// Sides of the triangles that join their neighbors.
    pub sides: Vec<Side>,
    pub warnings: Vec<String>,
}

/// A piece of surface connected over edges with two triangles.
struct Part {
    triangles: Vec<usize>,
    volume: f64,
    is_closed: bool,
    low: Vec3,
    high: Vec3,
}

/// Welds, turns and judges a product's mesh.
pub(crate) fn orient(mesh: Mesh) -> Oriented {
    let mut welded = weld(&mesh);
    let standing = standings(mesh.positions(), &welded);
    let listed =
        |welded: &[[u32; 3]]| sides(mesh.positions().len(), welded, |t| joins(standing[t]));
    let mut all = listed(&welded);
    let mut warnings = audit_of(&mesh, &welded, &standing, &all).warnings("the product");
    warnings.retain(|w| !w.ends_with("flip its normals") && !w.contains("opposite ways"));
    let mut flips = turn_alike(&all, welded.len());
    let turned = flips.iter().filter(|f| **f).count();
    if turned > 0 {
        warnings.push(format!("the product has {turned} triangles that faced against their neighbors; they were turned"));
    }
    let before = mesh.clone().with_triangles(flipped(&welded, &flips));
    let parts = parts(&before, &all);
    let inward = inward_parts(&before, &parts);
    for part in inward.iter().map(|&p| &parts[p]) {
        part.triangles.iter().for_each(|&t| flips[t] = !flips[t]);
    }
    if !inward.is_empty() {
        warnings.push(format!(
            "{} of {} parts of the product were inside out; they were turned",
            inward.len(),
            parts.len()
        ));
    }
    if flips.contains(&true) {
        welded = flipped(&welded, &flips);
        all = listed(&welded);
    }
    let ascending = |g: &[Side]| g.iter().filter(|s| s.ascends).count();
    let is_open = all.chunk_by(same_edge).any(|g| 2 * ascending(g) != g.len());
    let is_manifold = all.chunk_by(same_edge).all(|g| g.len() == 2);
    let has_flat = standing.contains(&Standing::Flat);
    let may_overlap = may_overlap(&parts);
    let is_simple = !is_open && is_manifold && !has_flat && !may_overlap;
    let triangles = flipped(mesh.triangles(), &flips);
    let mesh = mesh.with_triangles(triangles);
    let is_sheet = sheets(&mesh, &welded, &parts, &all);
    Oriented {
        mesh,
        welded,
        standing,
        is_open,
        is_sheet,
        is_simple,
        may_overlap,
        sides: all,
        warnings,
    }
}

fn same_edge(a: &Side, b: &Side) -> bool {
    a.edge == b.edge
}

fn flipped(triangles: &[[u32; 3]], flips: &[bool]) -> Vec<[u32; 3]> {
    let turn = |(&[a, b, c], &flip): (&[u32; 3], &bool)| if flip { [a, c, b] } else { [a, b, c] };
    triangles.iter().zip(flips).map(turn).collect()
}

/// Triangles that name, for each vertex, the first one at the same place.
fn weld(mesh: &Mesh) -> Vec<[u32; 3]> {
    let p = mesh.positions();
    // Adding 0 makes -0 and 0 one.
    let bits = |i: u32| {
        let q = p[i as usize];
        [
            (q.x + 0.0).to_bits(),
            (q.y + 0.0).to_bits(),
            (q.z + 0.0).to_bits(),
        ]
    };
    let mut order: Vec<u32> = (0..p.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (bits(i), i));
    let mut first = vec![0u32; p.len()];
    for group in order.chunk_by(|a, b| bits(*a) == bits(*b)) {
        group.iter().for_each(|&i| first[i as usize] = group[0]);
    }
    mesh.triangles()
        .iter()
        .map(|t| t.map(|i| first[i as usize]))
        .collect()
}

/// Which triangles to flip so that neighbors across edges with two triangles agree; the fewer of each piece. One-sided surfaces are left.
fn turn_alike(all: &[Side], triangles: usize) -> Vec<bool> {
    let mut neighbors: Vec<Vec<(u32, bool)>> = Vec::new();
    if all
        .chunk_by(same_edge)
        .any(|g| matches!(g, [a, b] if a.ascends == b.ascends))
    {
        neighbors.resize(triangles, Vec::new());
        for pair in all.chunk_by(same_edge).filter(|g| g.len() == 2) {
            let clash = pair[0].ascends == pair[1].ascends;
            neighbors[pair[0].triangle as usize].push((pair[1].triangle, clash));
            neighbors[pair[1].triangle as usize].push((pair[0].triangle, clash));
        }
    }
    let mut flips = vec![None; triangles];
    for start in 0..neighbors.len() {
        if flips[start].is_some() {
            continue;
        }
        flips[start] = Some(false);
        let (mut piece, mut at, mut is_two_sided) = (vec![start], 0, true);
        while at < piece.len() {
            let t = piece[at];
            at += 1;
            for &(other, clash) in &neighbors[t] {
                let wanted = flips[t].map(|f| f ^ clash);
                if flips[other as usize].is_none() {
                    flips[other as usize] = wanted;
                    piece.push(other as usize);
                } else {
                    is_two_sided &= flips[other as usize] == wanted;
                }
            }
        }
        let count = piece.iter().filter(|&&t| flips[t] == Some(true)).count();
        if !is_two_sided {
            piece.iter().for_each(|&t| flips[t] = Some(false));
        } else if 2 * count > piece.len() {
            piece.iter().for_each(|&t| flips[t] = flips[t].map(|f| !f));
        }
    }
    flips.into_iter().map(|f| f == Some(true)).collect()
}

fn parts(mesh: &Mesh, all: &[Side]) -> Vec<Part> {
    let mut root: Vec<u32> = (0..mesh.triangles().len() as u32).collect();
    let mut is_closed = vec![true; root.len()];
    for group in all.chunk_by(same_edge) {
        match group {
            [a, b] => join(&mut root, a.triangle, b.triangle),
            _ => group
                .iter()
                .for_each(|s| is_closed[s.triangle as usize] = false),
        }
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); root.len()];
    for t in all.iter().filter(|s| s.side == 0).map(|s| s.triangle) {
        members[find(&mut root, t) as usize].push(t as usize);
    }
    members.retain(|m| !m.is_empty());
    let middle = middle(mesh);
    let describe = |mut triangles: Vec<usize>| {
        triangles.sort_unstable();
        let corners = || triangles.iter().flat_map(|&t| mesh.corners(t));
        Part {
            volume: signed_volume(mesh, &middle, triangles.iter().copied()),
            is_closed: triangles.iter().all(|&t| is_closed[t]),
            low: corners().fold(Vec3::repeat(f64::INFINITY), |m, p| m.inf(&p)),
            high: corners().fold(Vec3::repeat(f64::NEG_INFINITY), |m, p| m.sup(&p)),
            triangles,
        }
    };
    members.into_iter().map(describe).collect()
}

/// Closed parts to flip: those whose outermost closed part has negative volume. A part facing inward within a sound one is a cavity and stays.
fn inward_parts(mesh: &Mesh, parts: &[Part]) -> Vec<usize> {
    let closed: Vec<usize> = (0..parts.len()).filter(|&p| parts[p].is_closed).collect();
    if closed.iter().all(|&p| parts[p].volume >= 0.0) {
        return Vec::new();
    }
    let outermost = |inner: usize| {
        let around = closed.iter().copied().filter(|&outer| {
            let is_mixed = parts[outer].volume < 0.0 || parts[inner].volume < 0.0;
            outer == inner || (is_mixed && contains(mesh, &parts[outer], &parts[inner]))
        });
        around
            .max_by(|a, b| parts[*a].volume.abs().total_cmp(&parts[*b].volume.abs()))
            .unwrap_or(inner)
    };
    closed
        .iter()
        .copied()
        .filter(|&p| parts[outermost(p)].volume < 0.0)
        .collect()
}

fn contains(mesh: &Mesh, outer: &Part, inner: &Part) -> bool {
    let boxed = (0..3).all(|k| outer.low[k] <= inner.low[k] && inner.high[k] <= outer.high[k]);
    let from = mesh.corners(inner.triangles[0]).iter().sum::<Vec3>() / 3.0;
    boxed
        && outer
            .triangles
            .iter()
            .map(|&t| solid_angle(mesh.corners(t), from))
            .sum::<f64>()
            .abs()
            > 6.0
}

/// Whether the boxes of any two parts meet, by a sweep along x. Cavities do too; the winding number is right for them as well.
fn may_overlap(parts: &[Part]) -> bool {
    let mut order: Vec<&Part> = parts.iter().collect();
    order.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    order.iter().enumerate().any(|(i, a)| {
        let ahead = order[i + 1..].iter().take_while(|b| b.low.x <= a.high.x);
        ahead
            .into_iter()
            .any(|b| (1..3).all(|k| a.low[k] <= b.high[k] && b.low[k] <= a.high[k]))
    })
}

/// Which triangles are of parts whose holes are large.
fn sheets(mesh: &Mesh, welded: &[[u32; 3]], parts: &[Part], all: &[Side]) -> Vec<bool> {
    let mut is_sheet = vec![false; welded.len()];
    let rim: Vec<&Side> = all
        .chunk_by(same_edge)
        .filter(|g| g.len() == 1)
        .map(|g| &g[0])
        .collect();
    if rim.is_empty() {
        return is_sheet;
    }
    let mut part_of = vec![usize::MAX; welded.len()];
    for (p, part) in parts.iter().enumerate() {
        part.triangles.iter().for_each(|&t| part_of[t] = p);
    }
    let mut root: Vec<u32> = (0..mesh.positions().len() as u32).collect();
    rim.iter()
        .for_each(|s| join(&mut root, s.edge[0], s.edge[1]));
    // The flat span of a loop of edges is its vector area: half the sum of p x dp.
    let mut spans = std::collections::BTreeMap::new();
    for s in rim {
        let [a, b] = s.edge.map(|i| mesh.positions()[i as usize]);
        let from = mesh.positions()[find(&mut root, s.edge[0]) as usize];
        let area = (a - from).cross(&(b - from)) * if s.ascends { 0.5 } else { -0.5 };
        let key = (part_of[s.triangle as usize], find(&mut root, s.edge[0]));
        *spans.entry(key).or_insert_with(Vec3::zeros) += area;
    }
    let area = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(&(c - a)).norm() / 2.0
    };
    for (p, part) in parts.iter().enumerate() {
        let holes: f64 = spans
            .range((p, 0)..(p + 1, 0))
            .map(|(_, span)| span.norm())
            .sum();
        if holes > SHEET * part.triangles.iter().map(|&t| area(t)).sum::<f64>() {
            part.triangles.iter().for_each(|&t| is_sheet[t] = true);
        }
    }
    is_sheet
}
