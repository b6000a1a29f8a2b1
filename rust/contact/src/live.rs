//! What of the last live contact still holds: skin that neither moved nor was strained from elsewhere keeps its forces.
//!
//! Certified each time: held skin is not carried off by what changed elsewhere, nor solved skin by what changed beyond its near
//! coupling, farther than the written surface may miss the product; where it is, it is solved anew.

use thenar_surface::{Gap, Vec3};

use crate::carried::{Found, can_reach};
use crate::contact_state::Beyond;
use crate::direction::Sums;
use crate::linearize::{Setting, vertex};
use crate::memory::Shown;
use crate::skin::Skin;
use crate::solve::Accuracy;
use crate::{ContactError, Control, Model};

/// Skin in patches nearer than this to one in which skin moved is solved with it, mm (tests pass from 1 to 8).
const REACH: f64 = 3.0;
/// The same about skin that is found to stray or to be lifted, mm: it is off by little (tests pass from 1 to 3).
const REACH_AGAIN: f64 = 1.0;
/// Sites whose patches are farther apart than this answer each other as they did last, mm: 3 thicknesses of a finger's tissue.
/// The fewer, the more often a round more is needed (tests pass from 15 to 1000).
const NEAR: f64 = 22.0;
/// Share of the zone above which all of it is solved.
const MOST: f64 = 0.7;
/// How many times as many sites as need be are solved with a coupling that is there already.
const MORE: f64 = 1.25;
/// How far skin may stray, over the deepest penetration: somewhat less than the certificate's half per cent, so that what is held
/// on to stays within that.
const STRAY: f64 = 4.5e-3;
/// Share of that from which skin that is foreseen to stray is solved.
const EARLY: f64 = 0.9;
/// Skin that is foreseen to come nearer to the product joins the zone, mm.
const CLEARANCE: f64 = 0.01;
/// Largest distance between written contact and product that ends a live solve, mm, and over the deepest penetration.
const MISFIT: f64 = 0.02;
const MISFIT_SHARE: f64 = 2.5e-3;

/// Where a site met the product in the last live solve.
#[derive(Debug, Clone)]
pub struct Met {
    /// Its gap before deformation, and its response weight.
    gap: Option<Gap>,
    weight: f64,
    /// As in a solve's state.
    pub touch: Gap,
    pub direction: Vec3,
    /// What the direction comes from, where it is an average.
    pub sums: Sums,
    pub cosine: f64,
    pub travel: f64,
    pub force: f64,
    pub slack: f64,
}

/// The last live solve.
#[derive(Debug, Clone, Default)]
pub struct Held {
    /// Its zone (ascending), and what each site met.
    zone: Vec<u32>,
    met: Vec<Met>,
}

impl Held {
    /// What a site met, if it was in the zone.
    fn of(&self, site: u32) -> Option<&Met> {
        let place = self.zone.binary_search(&site).ok()?;
        self.met.get(place)
    }
}

/// What each site of `zone` still holds from the last live solve; None where it is to be solved. Empty if all are.
///
/// `strayed`: sites that were carried off in this very press, if that is why it solves again; None in its first round.
pub fn held(
    skin: &Skin,
    setting: &Setting<'_>,
    zone: &[u32],
    strayed: Option<&[u32]>,
) -> Vec<Option<Met>> {
    let last = &skin.memory.held;
    if !is_live(skin, setting) || last.zone.is_empty() {
        return Vec::new();
    }
    let met: Vec<Option<&Met>> = zone.iter().map(|&site| last.of(site)).collect();
    let is_changed = |(&site, met): (&u32, &Option<&Met>)| {
        let gap = &setting.detection.gaps[vertex(skin, site)];
        let weight = setting.weight[site as usize];
        !met.is_some_and(|met| met.gap == *gap && met.weight == weight)
    };
    let changed = zone.iter().zip(&met).filter(|&pair| is_changed(pair));
    let mut changed: Vec<u32> = changed.map(|(&site, _)| site).collect();
    // What will stray is solved with what moved; where nothing did, the last certificate stands.
    match strayed {
        Some(strayed) => changed.extend(strayed),
        None if changed.is_empty() => {}
        None => changed.extend(will_stray(skin, setting, zone, &met)),
    }
    changed.sort_unstable();
    let reach = strayed.map_or(REACH, |_| REACH_AGAIN);
    let mut is_open = near(skin, &changed, reach);
    open_coupled(skin, zone, &mut is_open);
    let held: Vec<Option<Met>> = zone
        .iter()
        .zip(met)
        .map(|(&site, met)| met.filter(|_| !is_open[site as usize]).cloned())
        .collect();
    let open = held.iter().filter(|met| met.is_none()).count();
    if open as f64 > MOST * zone.len() as f64 {
        return Vec::new();
    }
    held
}

/// Where the skin of a site will lie if what changed last goes on as it did, mm from where it is posed; zero if not known.
fn ahead(skin: &Skin, setting: &Setting<'_>, site: u32) -> Vec3 {
    moved(skin, setting, site, |shown, site| {
        shown.field[site] + shown.field_change[site]
    })
}

/// How the displacement of a site changes if it does as it did last, mm; zero if not known.
pub fn goes_on(skin: &Skin, setting: &Setting<'_>, site: u32) -> Vec3 {
    moved(skin, setting, site, |shown, site| shown.field_change[site])
}

/// What a `field` of the last live press is at a site, mm.
fn moved(
    skin: &Skin,
    setting: &Setting<'_>,
    site: u32,
    field: impl Fn(&Shown, usize) -> Vec3,
) -> Vec3 {
    let (shown, site) = (&skin.memory.shown, site as usize);
    if !shown.is_of(skin.sites.len()) {
        return Vec3::zeros();
    }
    field(shown, site) * (setting.weight[site] * skin.sites.follow[site])
}

/// Sites of `zone` that would stray if they were held while what changed last goes on.
fn will_stray(skin: &Skin, setting: &Setting<'_>, zone: &[u32], met: &[Option<&Met>]) -> Vec<u32> {
    let most = EARLY * STRAY * setting.detection.deepest();
    let strays = |(site, met): &(&u32, &Option<&Met>)| {
        let off = |met: &&Met| met.direction.dot(&ahead(skin, setting, **site)) - met.travel;
        met.as_ref().is_some_and(|met| off(met).abs() > most)
    };
    let straying = zone.iter().zip(met).filter(strays);
    straying.map(|(&site, _)| site).collect()
}

/// A `zone` (ascending) with skin beyond it that is carried into the product if what changed last goes on, and its neighbors.
pub fn with_foreseen(skin: &Skin, setting: &Setting<'_>, mut zone: Vec<u32>) -> Vec<u32> {
    if !is_live(skin, setting) || zone.is_empty() {
        return zone;
    }
    let is_carried_in = |site: &u32| {
        let vertex = vertex(skin, *site);
        let distance = setting.detection.distances[vertex];
        if distance.is_infinite() {
            return false;
        }
        let u = ahead(skin, setting, *site);
        let comes_near = |gap: &Gap| distance + gap.normal.dot(&u) < CLEARANCE;
        can_reach(&u, distance)
            && setting.detection.gaps[vertex]
                .as_ref()
                .is_some_and(comes_near)
            && skin.sites.is_skin(*site as usize)
            && zone.binary_search(site).is_err()
    };
    let carried_in = (0..skin.sites.len() as u32).filter(is_carried_in);
    let more = ringed(skin, setting, &zone, carried_in.collect());
    zone.extend(more);
    zone.sort_unstable();
    zone
}

fn is_live(skin: &Skin, setting: &Setting<'_>) -> bool {
    let is_rough = setting.accuracy == Accuracy::Rough;
    is_rough && skin.model == Model::Layer && skin.hierarchy.is_none()
}

/// What acts on the sites that are solved in a `round` besides the coupling among them.
pub fn beyond(skin: &Skin, setting: &Setting<'_>, round: usize) -> Beyond {
    match is_live(skin, setting) {
        false => Beyond::Nothing,
        true if round == 1 && !skin.memory.held.zone.is_empty() => Beyond::Trend,
        true => Beyond::Last,
    }
}

/// Makes the near coupling between the sites of `open` (ascending), or keeps the last one if it is the same.
///
/// # Errors
/// [`ContactError::TooLarge`](crate::ContactError) before memory is taken, or `Cancelled`.
pub fn couple(skin: &mut Skin, open: &[u32], control: &Control) -> Result<(), ContactError> {
    // Without a last live press nothing is known of what lies farther off: all of it is coupled.
    let range = match skin.memory.shown.is_of(skin.sites.len()) {
        true => NEAR,
        false => f64::INFINITY,
    };
    let near = skin.memory.near.now();
    if near.sites == open && near.range >= range {
        return Ok(());
    }
    control.step("response", 0.0)?;
    skin.make_rows(open, control)?;
    let ground = (&skin.response, &skin.sites);
    let memory = &mut skin.memory;
    memory.rounded.make(open.iter().copied(), ground);
    let near = memory.near.now_mut();
    near.renew(open, &memory.rounded, ground, range);
    Ok(())
}

/// Opens what was coupled last too, where that is little more: the coupling then serves again, or will in the next frames.
fn open_coupled(skin: &Skin, zone: &[u32], is_open: &mut [bool]) {
    let coupled = &skin.memory.near.now().sites;
    let is_in_zone = |site: &&u32| zone.binary_search(site).is_ok();
    let open = zone.iter().filter(|&&site| is_open[site as usize]).count();
    let more = coupled.iter().filter(|&&site| !is_open[site as usize]);
    let more: Vec<u32> = more.filter(is_in_zone).copied().collect();
    if more.len() as f64 <= (MORE - 1.0) * open as f64 {
        more.iter().for_each(|&site| is_open[site as usize] = true);
    }
}

/// Which sites lie in patches within `reach` (mm) of that of some of `sites` (ascending).
fn near(skin: &Skin, sites: &[u32], reach: f64) -> Vec<bool> {
    let patch_of = |site: &u32| skin.sites.patch[*site as usize];
    let mut is_near = vec![false; skin.sites.len()];
    for of_patch in sites.chunk_by(|a, b| patch_of(a) == patch_of(b)) {
        let bounds = skin.response.bounds(patch_of(&of_patch[0]));
        for (patch, _) in bounds.filter(|(_, bound)| *bound < reach) {
            let (first, last) = skin.sites.patch_range[patch as usize];
            is_near[first as usize..last as usize].fill(true);
        }
    }
    is_near
}

/// Sites lifted into the product with their neighbors beyond the zone, ascending: where skin rolls on, these are next.
pub fn ringed(skin: &Skin, setting: &Setting<'_>, zone: &[u32], mut lifted: Vec<u32>) -> Vec<u32> {
    let beside = |&site: &u32| skin.adjacency.neighbors(vertex(skin, site));
    let ring = lifted.iter().flat_map(beside);
    let ring = ring.map(|&v| skin.sites.of_vertex[v as usize]);
    let may_join = |site: &u32| {
        let is_skin = *site != u32::MAX && skin.sites.is_skin(*site as usize);
        is_skin
            && setting.detection.gaps[vertex(skin, *site)].is_some()
            && zone.binary_search(site).is_err()
    };
    let ring: Vec<u32> = ring.filter(may_join).collect();
    lifted.extend(ring);
    lifted.sort_unstable();
    lifted.dedup();
    lifted
}

/// Keeps a live solve for the next; forgets what there was after any other.
pub fn keep(
    skin: &mut Skin,
    setting: &Setting<'_>,
    found: &Found<'_>,
    (slack, sums): (&[f64], &[Sums]),
) {
    if setting.accuracy != Accuracy::Rough {
        skin.memory.held = Held::default();
        return;
    }
    let met = |(k, &site): (usize, &u32)| Met {
        gap: setting.detection.gaps[vertex(skin, site)],
        weight: setting.weight[site as usize],
        touch: found.touch[k],
        direction: found.direction[k],
        sums: sums[k],
        cosine: found.cosine[k],
        travel: found.travel[k],
        force: found.force[k],
        slack: slack[k],
    };
    let met = found.zone.iter().enumerate().map(met).collect();
    skin.memory.held = Held {
        zone: found.zone.to_vec(),
        met,
    };
}

/// The largest misfit of a live solve, mm.
pub fn tolerance(deepest: f64) -> f64 {
    MISFIT.min(MISFIT_SHARE * deepest)
}

/// How far skin was carried off along its directions, over the deepest penetration, and the sites that strayed too far: held skin
/// by what changed elsewhere, solved skin by what changed beyond its near coupling.
///
/// `field`: displacement of every site by all forces.
pub fn strays(found: &Found<'_>, field: &[Vec3], deepest: f64) -> (f64, Vec<u32>) {
    let most = STRAY * deepest;
    let (mut worst, mut far) = (0.0f64, Vec::new());
    for (k, &site) in found.zone.iter().enumerate() {
        let off = (found.direction[k].dot(&field[site as usize]) - found.travel[k]).abs();
        worst = worst.max(off);
        if off > most {
            far.push(site);
        }
    }
    (worst / deepest.max(f64::MIN_POSITIVE), far)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::test_sheet::sheet;
    use crate::zone::detect;
    use thenar_surface::{Mesh, Product};

    #[test]
    fn skin_that_is_carried_in_if_it_goes_on_joins_the_zone_with_its_neighbors() {
        let (mut skin, _) = sheet();
        // A plate that faces down, into which the sheet rises.
        let corner = |x: f64, y: f64| Vec3::new(x, y, 2.0);
        let corners = [(-50.0, -50.0), (90.0, -50.0), (90.0, 90.0), (-50.0, 90.0)];
        let plate = Mesh::new(
            corners.map(|(x, y)| corner(x, y)).to_vec(),
            vec![[0, 2, 1], [0, 3, 2]],
        );
        let product = Product::new(plate.unwrap()).unwrap();
        let mesh = skin.welded.mesh.clone();
        let detection = detect(&mut skin, &mesh, &product, Vec3::zeros()).unwrap();
        let count = skin.sites.len();
        let weight = vec![0.5; count];
        let setting = Setting {
            product: &product,
            detection: &detection,
            weight: &weight,
            start: None,
            accuracy: Accuracy::Rough,
            spacing: skin.spacing,
        };
        let distance = |site: u32| detection.distances[vertex(&skin, site)];
        let zone: Vec<u32> = (0..count as u32).filter(|s| distance(*s) < 0.2).collect();
        let lifted = (0..count as u32).find(|s| (0.8..1.2).contains(&distance(*s)));
        let lifted = lifted.unwrap();
        let (far, beside) = (
            distance(lifted),
            skin.adjacency.neighbors(vertex(&skin, lifted)),
        );
        let beside = beside.iter().map(|&v| skin.sites.of_vertex[v as usize]);
        let mut wanted: Vec<u32> = zone.iter().copied().chain(beside).collect();
        wanted.push(lifted);
        wanted.sort_unstable();
        wanted.dedup();
        let none = vec![Vec3::zeros(); count];
        // It lies half way there, and goes on by as much or by little.
        for (change, wanted) in [(0.55, &wanted), (0.1, &zone)] {
            let up = |share: f64| {
                let mut field = none.clone();
                let share = share * far / (weight[0] * skin.sites.follow[lifted as usize]);
                field[lifted as usize] = Vec3::z() * share;
                field
            };
            skin.memory.shown = Shown {
                load: none.clone(),
                field: up(0.5),
                load_change: none.clone(),
                field_change: up(change),
            };
            assert_eq!(&with_foreseen(&skin, &setting, zone.clone()), wanted);
        }
    }
}
