//! Makes a product's mesh face outward, and finds out how inside and outside can be told on it.

use crate::mesh::audit::{audit_of, cone_volumes, find, join};
use crate::mesh::edges::{Side, joins, sides};
use crate::mesh::triangles::{Mesh, Standing, Vec3, least_height, standings};
use crate::mesh::welded_vertices::weld;
use crate::solid::cells::{Verdict, verdicts};
use crate::tree::winding_number::solid_angle;

/// A part whose holes, spanned flat, have more than this part of its area is a sheet. A mug with a missing facet has less than 0.01, a tube
/// ten times as long as wide 0.05 for each open end.
const SHEET: f64 = 0.02;

/// Walls and gaps that are not thicker than this, in parts of the product's extent, or than [`THIN_MM`], are none.
const THIN: f64 = 1e-6;

/// The same in mm: blocks laid side by side leave as much by rounding and by the tolerance of CAD. Skin cannot enter it.
const THIN_MM: f64 = 0.001;

/// Height, in parts of the product's extent, below which a triangle's normal is that of the rounding of its corners to f32.
pub(crate) const SLIVER: f64 = 1e-6;

/// How many triangles a warning names.
const NAMED: usize = 6;

/// A product's mesh, turned outward where that could be decided.
pub(crate) struct Oriented {
    pub mesh: Mesh,
    /// The triangles with vertices of equal position made one, as exporters split them at seams; those of separate closed parts stay apart.
    pub welded: Vec<[u32; 3]>,
    pub standing: Vec<Standing>,
    /// Whether there are holes: then a point may be half inside.
    pub is_open: bool,
    /// For each triangle, whether its part is a sheet without thickness rather than a body with small holes.
    pub is_sheet: Vec<bool>,
    /// Whether angle-weighted pseudo-normals decide inside and outside: closed, manifold, no flat triangle and no sliver, no parts that may overlap.
    pub is_simple: bool,
    /// Whether parts may lie within each other.
    pub may_overlap: bool,
    /// Sides of the triangles that join their neighbors.
    pub sides: Vec<Side>,
    pub parts: Vec<Part>,
    /// What counts as no distance between two surfaces, mm.
    pub thin: f64,
    pub warnings: Vec<String>,
}

/// A piece of surface connected over edges with two triangles, or all that bounds one solid.
pub(crate) struct Part {
    pub triangles: Vec<usize>,
    pub volume: f64,
    pub is_closed: bool,
    pub low: Vec3,
    pub high: Vec3,
}

/// Welds, turns and judges a product's mesh.
pub(crate) fn orient(mesh: Mesh) -> Oriented {
    let mut welded = weld(&mesh);
    let mut standing = standings(mesh.positions(), &welded);
    let listed = |welded: &[[u32; 3]], standing: &[Standing]| {
        sides(mesh.positions().len(), welded, |t| joins(standing[t]))
    };
    let mut all = listed(&welded, &standing);
    let mut audit = audit_of(&mesh, &welded, &standing, &all);
    let mut warnings = Vec::new();
    let mut flips = turn_alike(&all, welded.len());
    let turned = flips.iter().filter(|f| **f).count();
    if turned > 0 {
        warnings.push(format!("the product has {turned} triangles that faced against their neighbors; they were turned"));
        welded = flipped(&welded, &flips);
        all = listed(&welded, &standing);
    }
    let thin = thin(&mesh);
    let before = mesh.clone().with_triangles(welded.clone());
    let verdicts = verdicts(&before, &all, thin);
    let is_told = verdicts.iter().any(|v| *v != Verdict::Unknown);
    if is_told {
        // The rooms tell more than the count of edges.
        if !verdicts.contains(&Verdict::Fin) {
            audit.non_manifold_edges = 0;
        }
        for (t, verdict) in verdicts.iter().enumerate() {
            match verdict {
                Verdict::Within => standing[t] = Standing::Within,
                Verdict::Bounds {
                    is_inward: true, ..
                } => {
                    welded[t].swap(1, 2);
                    flips[t] = !flips[t];
                }
                _ => {}
            }
        }
        all = listed(&welded, &standing);
        warnings.extend(within(&verdicts));
    }
    let before = if is_told {
        before.with_triangles(welded.clone())
    } else {
        before
    };
    let parts = parts(&before, &all, &verdicts);
    let inward = inward_parts(&before, &parts);
    for &t in inward.iter().flat_map(|&p| &parts[p].triangles) {
        flips[t] = !flips[t];
        welded[t].swap(1, 2);
    }
    if !inward.is_empty() {
        warnings.push(format!(
            "{} of {} parts of the product were inside out; they were turned",
            inward.len(),
            parts.len()
        ));
        all = listed(&welded, &standing);
    }
    let mut audited = audit.warnings("the product");
    audited.retain(|w| !w.ends_with("flip its normals") && !w.contains("opposite ways"));
    warnings.splice(0..0, audited);
    let ascending = |g: &[Side]| g.iter().filter(|s| s.ascends).count();
    let is_open = all.chunk_by(same_edge).any(|g| 2 * ascending(g) != g.len());
    let is_manifold = all.chunk_by(same_edge).all(|g| g.len() == 2);
    let has_flat = standing.contains(&Standing::Flat);
    let may_overlap = may_overlap(&parts, thin);
    let is_even = !has_flat && !has_slivers(&mesh, &standing);
    let is_simple = !is_open && is_manifold && is_even && !may_overlap;
    let mesh = if flips.contains(&true) {
        let triangles = flipped(mesh.triangles(), &flips);
        mesh.with_triangles(triangles)
    } else {
        mesh
    };
    let mut is_sheet = sheets(&mesh, &welded, &parts, &all);
    for (t, _) in verdicts
        .iter()
        .enumerate()
        .filter(|(_, v)| **v == Verdict::Fin)
    {
        is_sheet[t] = true;
    }
    Oriented {
        mesh,
        welded,
        standing,
        is_open,
        is_sheet,
        is_simple,
        may_overlap,
        sides: all,
        parts,
        thin,
        warnings,
    }
}

/// What counts as no distance, mm.
fn thin(mesh: &Mesh) -> f64 {
    THIN_MM.max(THIN * extent(mesh))
}

/// Largest side of the box around a mesh, mm.
fn extent(mesh: &Mesh) -> f64 {
    let p = mesh.positions();
    let low = p.iter().fold(Vec3::repeat(f64::INFINITY), |m, p| m.inf(p));
    let high = p
        .iter()
        .fold(Vec3::repeat(f64::NEG_INFINITY), |m, p| m.sup(p));
    (high - low).amax()
}

/// Whether some sound triangle has no normal that its corners could tell, as Booleans leave them: pseudo-normals next to it are wrong.
fn has_slivers(mesh: &Mesh, standing: &[Standing]) -> bool {
    let least = SLIVER * extent(mesh);
    let is_sliver = |t: usize| least_height(mesh.corners(t)) < least;
    (0..standing.len()).any(|t| standing[t] == Standing::Sound && is_sliver(t))
}

/// The sentence on triangles within the solid, which names them.
fn within(verdicts: &[Verdict]) -> Option<String> {
    let all = || (0..verdicts.len()).filter(|&t| verdicts[t] == Verdict::Within);
    let count = all().count();
    let named: Vec<String> = all().take(NAMED).map(|t| t.to_string()).collect();
    let more = if count > NAMED { ", ..." } else { "" };
    (count > 0).then(|| {
        format!(
            "the product has {count} triangles inside its solid, where nothing can touch them; they are ignored (triangles {}{more}): \
             delete interior faces",
            named.join(", ")
        )
    })
}

fn same_edge(a: &Side, b: &Side) -> bool {
    a.edge == b.edge
}

fn flipped(triangles: &[[u32; 3]], flips: &[bool]) -> Vec<[u32; 3]> {
    let turn = |(&[a, b, c], &flip): (&[u32; 3], &bool)| if flip { [a, c, b] } else { [a, b, c] };
    triangles.iter().zip(flips).map(turn).collect()
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

fn parts(mesh: &Mesh, all: &[Side], verdicts: &[Verdict]) -> Vec<Part> {
    let mut root: Vec<u32> = (0..mesh.triangles().len() as u32).collect();
    let mut is_closed = vec![true; root.len()];
    for group in all.chunk_by(same_edge) {
        match group {
            [a, b] if verdicts[a.triangle as usize] == verdicts[b.triangle as usize] => {
                join(&mut root, a.triangle, b.triangle);
            }
            _ => group
                .iter()
                .for_each(|s| is_closed[s.triangle as usize] = false),
        }
    }
    let mut first = std::collections::BTreeMap::new();
    for (t, verdict) in verdicts.iter().enumerate() {
        if let Verdict::Bounds { body, .. } = verdict {
            join(&mut root, *first.entry(*body).or_insert(t as u32), t as u32);
            is_closed[t] = true;
        }
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); root.len()];
    for t in all.iter().filter(|s| s.side == 0).map(|s| s.triangle) {
        members[find(&mut root, t) as usize].push(t as usize);
    }
    members.retain(|m| !m.is_empty());
    let cones = cone_volumes(mesh);
    let describe = |mut triangles: Vec<usize>| {
        triangles.sort_unstable();
        let corners = || triangles.iter().flat_map(|&t| mesh.corners(t));
        Part {
            volume: triangles.iter().map(|&t| cones(t)).sum(),
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
fn may_overlap(parts: &[Part], thin: f64) -> bool {
    let mut order: Vec<&Part> = parts.iter().collect();
    order.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    order.iter().enumerate().any(|(i, a)| {
        let ahead = order[i + 1..]
            .iter()
            .take_while(|b| b.low.x <= a.high.x + thin);
        let meets = |b: &&Part| {
            (1..3).all(|k| a.low[k] <= b.high[k] + thin && b.low[k] <= a.high[k] + thin)
        };
        ahead.into_iter().any(meets)
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
