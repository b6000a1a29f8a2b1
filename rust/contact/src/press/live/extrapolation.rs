//! Live presses: extrapolation of the last frame, the zone that follows from it, and the tolerance of a live solve.

use thenar_surface::{Gap, Vec3};

use crate::press::setting::{SolveSetting, vertex};
use crate::skin::prepare::Skin;
use crate::solve::Accuracy;
use crate::workspace::Pressing;
use crate::workspace::live_cache::LiveField;
use crate::{ContactError, Control, Model};

/// Range of the near field, mm: 3 thicknesses of a finger's tissue; sites farther apart keep their last effect on each other.
/// A shorter range needs more rounds (tests pass from 15 to 1000).
const NEAR: f64 = 22.0;
/// Sites whose extrapolated gap is below this join the zone, mm.
const CLEARANCE: f64 = 0.01;
/// Sites whose extrapolated gap is above this leave the zone, mm; twice this for sites of the last zone. A smaller gap needs
/// more rounds.
const CLEAR: f64 = 0.3;
/// Largest distance between written contact and product that ends a live solve, mm, and over the deepest penetration.
const MISFIT: f64 = 0.02;
const MISFIT_SHARE: f64 = 2.5e-3;

/// Loads on the solved sites from outside their coupling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OuterLoads {
    /// None: all loaded sites are solved and coupled.
    Nothing,
    /// Forces of the last live press.
    Last,
    /// Forces extrapolated from the last live press.
    Trend,
}

/// Whether a displacement `u` is longer than the `distance` to the product, mm.
pub fn can_reach(u: &Vec3, distance: f64) -> bool {
    distance < 0.0 || distance * distance < u.norm_squared()
}

/// Extrapolated displacement of a site, if the last change continues, mm; zero if unknown.
pub fn extrapolated(pressing: &Pressing<'_>, setting: &SolveSetting<'_>, site: u32) -> Vec3 {
    moved(pressing, setting, site, |live_field, site| {
        live_field.field[site] + live_field.field_change[site]
    })
}

/// Last change of a site's displacement, mm; zero if unknown.
pub fn extrapolated_change(pressing: &Pressing<'_>, setting: &SolveSetting<'_>, site: u32) -> Vec3 {
    moved(pressing, setting, site, |live_field, site| {
        live_field.field_change[site]
    })
}

/// A `field` of the last live press at a site, mm.
fn moved(
    pressing: &Pressing<'_>,
    setting: &SolveSetting<'_>,
    site: u32,
    field: impl Fn(&LiveField, usize) -> Vec3,
) -> Vec3 {
    let skin = pressing.skin;
    let (live_field, site) = (&pressing.workspace.live_field, site as usize);
    if !live_field.matches(skin.sites.len()) {
        return Vec3::zeros();
    }
    field(live_field, site) * (setting.weight[site] * skin.sites.follow[site])
}

/// The `zone` (ascending) by extrapolation: without sites that stay clear of the product, with those that the field will carry
/// into it, and their neighbors.
///
/// A wrong guess costs a round: sites outside the zone that the field carries into the product join it.
pub fn extrapolated_zone(
    pressing: &Pressing<'_>,
    setting: &SolveSetting<'_>,
    mut zone: Vec<u32>,
) -> Vec<u32> {
    let (skin, workspace) = (pressing.skin, &pressing.workspace);
    if !is_live(skin, setting) || zone.is_empty() || !workspace.live_field.matches(skin.sites.len())
    {
        return zone;
    }
    let gap = |site: u32| setting.detection.gaps[vertex(skin, site)].as_ref();
    let clearance = |site: u32| {
        let comes_by =
            |gap: &Gap| gap.distance + gap.normal.dot(&extrapolated(pressing, setting, site));
        gap(site).map_or(f64::INFINITY, comes_by)
    };
    zone.retain(|&site| {
        let most = match workspace.live_contact.of(site) {
            Some(_) => 2.0 * CLEAR,
            None => CLEAR,
        };
        gap(site).is_some_and(|gap| gap.distance < 0.0) || clearance(site) < most
    });
    let is_carried_in = |site: &u32| {
        let distance = setting.detection.distances[vertex(skin, *site)];
        distance < f64::INFINITY
            && can_reach(&extrapolated(pressing, setting, *site), distance)
            && clearance(*site) < CLEARANCE
            && skin.sites.is_skin(*site as usize)
            && zone.binary_search(site).is_err()
    };
    let carried_in = (0..skin.sites.len() as u32).filter(is_carried_in);
    let more = with_neighbors(skin, setting, &zone, carried_in.collect());
    zone.extend(more);
    zone.sort();
    zone
}

/// Whether a press is live, on a skin with its response rows in memory.
pub fn is_live(skin: &Skin, setting: &SolveSetting<'_>) -> bool {
    let is_rough = setting.accuracy == Accuracy::Rough;
    is_rough && skin.model == Model::Layer && skin.hierarchy.is_none()
}

/// Loads on the sites solved in a `round` from outside their coupling.
pub fn beyond(pressing: &Pressing<'_>, setting: &SolveSetting<'_>, round: usize) -> OuterLoads {
    match is_live(pressing.skin, setting) {
        false => OuterLoads::Nothing,
        true if round == 1 && !pressing.workspace.live_contact.zone.is_empty() => OuterLoads::Trend,
        true => OuterLoads::Last,
    }
}

/// Makes the near coupling between the sites of `open` (ascending), which are among those of `zone`, or keeps the last one if it
/// is the same.
///
/// # Errors
/// [`ContactError::TooLarge`](crate::ContactError) before memory is taken, or `Cancelled`.
pub fn couple(
    pressing: &mut Pressing<'_>,
    (zone, open): (&[u32], &[u32]),
    control: &Control,
) -> Result<(), ContactError> {
    // Without a last live press nothing is known of what lies farther off: all of it is coupled.
    let (skin, workspace) = (pressing.skin, &mut *pressing.workspace);
    let range = match workspace.live_field.matches(skin.sites.len()) {
        true => NEAR,
        false => f64::INFINITY,
    };
    if workspace.near.now().matches(open, range) {
        return Ok(());
    }
    control.step("response", 0.0)?;
    skin.make_rows(open, control)?;
    let ground = (&*skin.response, &*skin.sites);
    workspace.quantized.make(open.iter().copied(), ground);
    let near = workspace.near.now_mut();
    near.update((zone, open), &workspace.quantized, ground, range);
    Ok(())
}

/// Sites lifted into the product with their neighbors beyond the zone, ascending: where skin rolls on, these are next.
pub fn with_neighbors(
    skin: &Skin,
    setting: &SolveSetting<'_>,
    zone: &[u32],
    mut lifted: Vec<u32>,
) -> Vec<u32> {
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

/// The largest misfit of a live solve, mm.
pub fn tolerance(deepest: f64) -> f64 {
    MISFIT.min(MISFIT_SHARE * deepest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::gaps::{Stand, detect};
    use crate::detection::press_direction::Sums;
    use crate::press::live::reused_sites::keep_solution;
    use crate::press::solution::ZoneSolution;
    use crate::response::test_sheet::sheet;
    use thenar_surface::{Mesh, Product};

    /// A plate that faces down, into which the sheet rises.
    fn plate() -> Product {
        let corners = [(-50.0, -50.0), (90.0, -50.0), (90.0, 90.0), (-50.0, 90.0)];
        let plate = Mesh::new(
            corners.map(|(x, y)| Vec3::new(x, y, 2.0)).to_vec(),
            vec![[0, 2, 1], [0, 3, 2]],
        );
        Product::new(plate.unwrap()).unwrap()
    }

    /// The skin last lay where a displacement `u` (mm) by site, which changed by `change`, had carried it.
    fn live_field(skin: &Skin, weight: f64, u: &[f64], change: &[f64]) -> LiveField {
        let none = vec![Vec3::zeros(); u.len()];
        let field = |u: &[f64]| -> Vec<Vec3> {
            let sites = u.iter().zip(&skin.sites.follow);
            let up = |(u, follow): (&f64, &f64)| Vec3::z() * (u / (weight * follow));
            sites.map(up).collect()
        };
        LiveField {
            load: none.clone(),
            field: field(u),
            load_change: none,
            field_change: field(change),
        }
    }

    #[test]
    fn a_zone_is_what_is_foreseen_to_touch() {
        let (skin, mut workspace, _) = sheet();
        let mut pressing = workspace.on(&skin);
        let (product, mesh) = (plate(), skin.merged.mesh.clone());
        let detection = detect(&mut pressing, &mesh, &Stand::as_given(&product)).unwrap();
        let count = skin.sites.len();
        let weight = vec![0.5; count];
        let setting = SolveSetting {
            product: &product,
            detection: &detection,
            weight: &weight,
            start: None,
            accuracy: Accuracy::Rough,
            spacing: skin.spacing,
        };
        let distances: Vec<f64> = (0..count as u32)
            .map(|site| detection.distances[vertex(&skin, site)])
            .collect();
        let within = |most: f64| -> Vec<u32> {
            let sites = 0..count as u32;
            sites.filter(|s| distances[*s as usize] < most).collect()
        };
        let (still, wide) = (vec![0.0; count], within(0.9));
        assert_eq!(extrapolated_zone(&pressing, &setting, wide.clone()), wide);

        // Skin that is clear of the product is left out, and taken in when it comes nearer.
        pressing.workspace.live_field = live_field(&skin, 0.5, &still, &still);
        assert_eq!(
            extrapolated_zone(&pressing, &setting, wide.clone()),
            within(CLEAR)
        );
        pressing.workspace.live_field =
            live_field(&skin, 0.5, &vec![0.1; count], &vec![0.15; count]);
        let nearer = within(CLEAR + 0.25);
        assert!(nearer.len() > within(CLEAR).len() && nearer.len() < wide.len());
        assert_eq!(extrapolated_zone(&pressing, &setting, wide.clone()), nearer);

        // One site lies half way there, and goes on by as much or by little: then its neighbors join too.
        let zone = within(0.2);
        let lifted = distances.iter().position(|d| (0.8..1.2).contains(d));
        let lifted = lifted.unwrap();
        let beside = skin.adjacency.neighbors(vertex(&skin, lifted as u32));
        let beside = beside.iter().map(|&v| skin.sites.of_vertex[v as usize]);
        let mut joined: Vec<u32> = zone.iter().copied().chain(beside).collect();
        joined.push(lifted as u32);
        joined.sort_unstable();
        joined.dedup();
        for (change, wanted) in [(0.55, &joined), (0.1, &zone)] {
            let up = |share: f64| {
                let mut u = still.clone();
                u[lifted] = share * distances[lifted];
                u
            };
            pressing.workspace.live_field = live_field(&skin, 0.5, &up(0.5), &up(change));
            assert_eq!(
                &extrapolated_zone(&pressing, &setting, zone.clone()),
                wanted
            );
        }

        // What was in it stays until it is twice as far away; what has left it has to come as near as any other.
        pressing.workspace.live_field = live_field(&skin, 0.5, &still, &still);
        let mut was = |zone: &[u32]| {
            let gap = |&site: &u32| detection.gaps[vertex(&skin, site)].unwrap();
            let (touch, zeros): (Vec<Gap>, _) =
                (zone.iter().map(gap).collect(), vec![0.0; zone.len()]);
            let found = ZoneSolution {
                zone,
                force: &zeros,
                direction: &vec![-Vec3::z(); zone.len()],
                cosine: &vec![1.0; zone.len()],
                travel: &zeros,
                touch: &touch,
                slack: &zeros,
                sums: &vec![Sums::default(); zone.len()],
                is_reused: &[],
            };
            keep_solution(&mut pressing, &setting, &found);
            extrapolated_zone(&pressing, &setting, wide.clone())
        };
        let stays = within(2.0 * CLEAR);
        assert!(stays.len() > within(CLEAR).len() && stays.len() < wide.len());
        assert_eq!(was(&wide), stays);
        assert_eq!(was(&zone), within(CLEAR));
    }
}
