//! Tests of the far field of small skins against the direct sum, entry by entry.

use nalgebra::DMatrix;
use thenar_surface::{Mesh, Vec3};

use super::block_kernels::{Fields, zeros};
use super::hierarchy::{Hierarchy, SiteList, SkinResponse};
use super::{DirectionalCoupling, ZoneCoupling};
use crate::response::assembly::Load;
use crate::response::entries::Scratch;
use crate::skin::prepare::Skin;
use crate::solve::{Compliance, Symmetric};
use crate::{ActiveEffect, ContactError, Control, Material, Model, SkinInput};

/// A bent and bumpy sheet of `side` by `side` vertices, `spacing` mm apart.
fn sheet(side: u32, spacing: f64) -> Mesh {
    let at = |k: u32| (f64::from(k) - 0.5 * f64::from(side)) * spacing;
    let place = |k: u32| {
        let (x, y) = (
            at(k % side) + 0.3 * spacing * f64::from(k / side % 2),
            at(k / side),
        );
        let bump = 0.3 * (0.9 * x).sin() * (0.7 * y + 0.4).sin();
        Vec3::new(x, y, bump - x * x / 40.0 - y * y / 60.0)
    };
    let corner = |k: u32| [(k, k + 1, k + side), (k + 1, k + side + 1, k + side)];
    let cells = (0..side * (side - 1)).filter(|k| k % side != side - 1);
    let triangles = cells.flat_map(corner).map(|(a, b, c)| [a, b, c]);
    Mesh::new((0..side * side).map(place).collect(), triangles.collect()).unwrap()
}

fn layer(thickness_mm: f64) -> Material {
    Material {
        thickness_mm,
        poisson_ratio: 0.5,
        ..Material::finger_layer()
    }
}

/// A sheet of three stripes of these thicknesses.
pub fn skin(side: u32, thickness: [f64; 3], effects: Vec<ActiveEffect>) -> Skin {
    let input = SkinInput {
        mesh: sheet(side, 0.45),
        regions: (0..side * side)
            .map(|k| (3 * (k % side) / side) as i32)
            .collect(),
        materials: thickness.map(layer).to_vec(),
        model: Model::Layer,
    };
    let bare = Skin::prepare(input, &Control::none()).unwrap();
    bare.with_effects(effects, &Control::none()).unwrap()
}

pub fn all(skin: &Skin) -> Vec<u32> {
    (0..skin.sites.len() as u32).collect()
}

/// What a contact bears: most in its middle, nothing beyond 9 mm, and rough.
fn loads(skin: &Skin, zone: &[u32]) -> Fields {
    let one = |axis: usize| {
        move |(k, &site): (usize, &u32)| {
            let from_middle = skin.sites.rest[site as usize].position.norm() / 9.0;
            let rough = 1.0 + 0.3 * ((k * (7 + 4 * axis)) as f64 * 0.61).sin();
            (1.0 - from_middle * from_middle).max(0.0) * rough
        }
    };
    [0, 1, 2].map(|axis| zone.iter().enumerate().map(one(axis)).collect())
}

/// Row `j` of the response, summed directly.
fn direct(
    ground: SkinResponse<'_>,
    hierarchy: &Hierarchy,
    (zone, j): (&[u32], u32),
    x: &Fields,
) -> [f64; 3] {
    let listed = SiteList::new(zone, ground.sites);
    let mut row = vec![0.0; zone.len()];
    hierarchy.fill(ground, &listed, j, (&mut Scratch::default(), &mut row));
    [0, 1, 2].map(|axis| {
        row.iter()
            .zip(&x[axis])
            .map(|(k, x)| f64::from(*k) * x)
            .sum()
    })
}

/// Largest difference between product and direct sum on a sample of rows, relative to the largest.
fn astray(skin: &Skin, zone: &[u32]) -> f64 {
    let (ground, none) = (skin.ground(), Control::none());
    let hierarchy = Hierarchy::of(ground);
    let coupled = ZoneCoupling::new(&hierarchy, zone, ground, &none).unwrap();
    let x = loads(skin, zone);
    let found = coupled.times(&x, (&vec![true; zone.len()], &vec![true; zone.len()]));
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for k in (0..zone.len()).step_by(zone.len() / 150) {
        let wanted = direct(ground, &hierarchy, (zone, zone[k]), &x);
        for axis in 0..3 {
            worst = worst.max((found[axis][k] - wanted[axis]).abs());
            largest = largest.max(wanted[axis].abs());
        }
    }
    worst / largest
}

#[test]
fn the_product_is_the_direct_sum_for_every_kind_of_layer() {
    let named = |name| vec![ActiveEffect::named(name, 0.7).unwrap()];
    let cases = [
        ([6.0; 3], Vec::new()),
        ([f64::INFINITY; 3], Vec::new()),
        ([3.0, 6.0, 11.0], Vec::new()),
        ([3.0, 6.0, 11.0], named("region_coupling")),
        ([5.0, 5.0, 8.0], named("stiff_skin")),
    ];
    for (number, (thickness, effects)) in cases.into_iter().enumerate() {
        let skin = skin(72, thickness, effects);
        let off = astray(&skin, &all(&skin));
        assert!(off <= 1e-4, "case {number}: {off}");
        let some: Vec<u32> = all(&skin).into_iter().filter(|i| i % 7 < 3).collect();
        let off = astray(&skin, &some);
        assert!(off <= 1e-4, "case {number}, part of the sites: {off}");
    }
}

#[test]
fn near_entries_are_those_of_the_rows() {
    let skin = skin(40, [3.0, 6.0, 11.0], Vec::new());
    let hierarchy = Hierarchy::of(skin.ground());
    let zone = all(&skin);
    skin.response.make_rows(&zone, &skin.sites);
    let listed = SiteList::new(&zone, &skin.sites);
    let mut row = vec![0.0; zone.len()];
    for &j in zone.iter().step_by(31) {
        hierarchy.fill(
            skin.ground(),
            &listed,
            j,
            (&mut Scratch::default(), &mut row),
        );
        for &(patch, offset) in skin.response.near(skin.sites.patch[j as usize]) {
            let (first, last) = skin.sites.patch_range[patch as usize];
            let kept = &skin.response.row(j, &skin.sites)
                [offset as usize..(offset + last - first) as usize];
            assert_eq!(
                kept,
                &row[first as usize..last as usize],
                "row {j}, patch {patch}"
            );
        }
    }
}

#[test]
fn the_operator_is_symmetric_and_definite() {
    let skin = skin(36, [3.0, 6.0, 11.0], Vec::new());
    let (ground, zone) = (skin.ground(), all(&skin));
    let hierarchy = Hierarchy::of(ground);
    let coupled = ZoneCoupling::new(&hierarchy, &zone, ground, &Control::none()).unwrap();
    let turned = |&i: &u32| Vec3::new((f64::from(i) * 0.01).sin() * 0.3, 0.2, 1.0).normalize();
    let along: Vec<Vec3> = zone.iter().map(turned).collect();
    let directed = DirectionalCoupling::new(&coupled, &along);
    let n = zone.len();
    let mut dense = DMatrix::zeros(n, n);
    let mut unit = vec![0.0; n];
    for j in 0..n {
        unit[j] = 1.0;
        directed.times(&unit, dense.column_mut(j).as_mut_slice());
        unit[j] = 0.0;
    }
    let off = (&dense - dense.transpose()).amax();
    assert!(off <= 1e-14 * dense.amax(), "{off}");
    for (j, own) in directed.diagonal().iter().enumerate() {
        assert!((dense[(j, j)] - own).abs() <= 1e-12 * own);
    }
    assert!(dense.cholesky().is_some(), "not definite");
}

#[test]
fn some_rows_are_those_of_the_whole_product() {
    let skin = skin(64, [3.0, 6.0, 11.0], Vec::new());
    let (ground, zone) = (skin.ground(), all(&skin));
    let coupled =
        ZoneCoupling::new(&Hierarchy::of(ground), &zone, ground, &Control::none()).unwrap();
    let along = vec![Vec3::new(0.2, 0.1, 0.9); zone.len()];
    let directed = DirectionalCoupling::new(&coupled, &along);
    // Loads within 9 mm of the middle; rows about it, and two in it.
    let [x, ..] = loads(&skin, &zone);
    let is_outer = |&k: &u32| x[k as usize] == 0.0 || k % 997 == 3;
    let rows: Vec<u32> = (0..zone.len() as u32).filter(is_outer).collect();
    assert!(rows.len() > 200 && rows.len() < zone.len() - 200);
    let (mut whole, mut some) = (vec![0.0; zone.len()], vec![f64::NAN; rows.len()]);
    directed.times(&x, &mut whole);
    directed.times_rows(&rows, &x, &mut some);
    let most = whole.iter().fold(0.0, |m, v| f64::max(m, v.abs()));
    for (&k, some) in rows.iter().zip(&some) {
        let off = (some - whole[k as usize]).abs();
        assert!(off < 1e-13 * most, "row {k}: {off} of {most}");
    }
}

#[test]
fn threads_leave_no_mark() {
    let skin = skin(64, [3.0, 6.0, 11.0], Vec::new());
    let (zone, ground) = (all(&skin), skin.ground());
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let hierarchy = Hierarchy::of(ground);
            let none = Control::none();
            let coupled = ZoneCoupling::new(&hierarchy, &zone, ground, &none).unwrap();
            let every = vec![true; zone.len()];
            let found = coupled.times(&loads(&skin, &zone), (&every, &every));
            let pressed = |&site: &u32| Load {
                site,
                load: Vec3::new(0.1, f64::from(site % 5), 1.0),
            };
            let some: Vec<Load> = zone[300..1200].iter().map(pressed).collect();
            let carried = hierarchy
                .displacement(
                    (&some, &coupled.clusters),
                    &vec![None; zone.len()],
                    ground,
                    &none,
                )
                .unwrap();
            (found, carried.field, carried.certificate)
        })
    };
    let (one, four) = (run(1), run(4));
    assert_eq!(one, four);
    assert!(one.2 > 0.0 && one.2 <= 1e-4, "certificate {}", one.2);
}

#[test]
fn a_certificate_is_what_the_direct_sum_says() {
    let skin = skin(64, [5.0; 3], Vec::new());
    let (zone, ground) = (all(&skin), skin.ground());
    let hierarchy = Hierarchy::of(ground);
    let coupled = ZoneCoupling::new(&hierarchy, &zone, ground, &Control::none()).unwrap();
    let some: Vec<Load> = zone[500..900]
        .iter()
        .map(|&site| Load {
            site,
            load: Vec3::z(),
        })
        .collect();
    let carried = hierarchy
        .displacement(
            (&some, &coupled.clusters),
            &vec![None; zone.len()],
            ground,
            &Control::none(),
        )
        .unwrap();
    let mut x = zeros(zone.len());
    some.iter().for_each(|load| x[2][load.site as usize] = 1.0);
    let largest = carried.field.iter().map(|u| u.norm()).fold(0.0, f64::max);
    for &site in zone.iter().step_by(37) {
        let wanted = direct(ground, &hierarchy, (&zone, site), &x)[2];
        let off = (carried.field[site as usize].z - wanted).abs();
        assert!(off <= 1e-4 * largest, "site {site}: {off} of {largest}");
    }
}

#[test]
fn memory_is_stated_beforehand_and_refused_in_a_sentence() {
    let skin = skin(64, [6.0; 3], Vec::new());
    let (zone, ground) = (all(&skin), skin.ground());
    let hierarchy = Hierarchy::of(ground);
    let planned = ZoneCoupling::planned(&hierarchy, &zone, ground, &Control::none()).unwrap();
    let stated = planned.needed_gib();
    let refused = planned.check(0.5 * stated).unwrap_err();
    assert!(matches!(refused, ContactError::TooLarge { vertices, .. } if vertices == zone.len()));
    assert!(refused.to_string().contains("GiB"), "{refused}");
    let made = ZoneCoupling::new(&hierarchy, &zone, ground, &Control::none()).unwrap();
    let entries = made.near.values.capacity() + made.far.values.capacity();
    let bases = made.clusters.list.iter().filter_map(|c| c.basis.as_ref());
    let transfers: usize = bases.map(|b| b.transfer.capacity()).sum();
    let inverses = made.sparse_inverse.made();
    let used = (4 * (entries + transfers) + 8 * inverses) as f64 / f64::from(1 << 30);
    assert!(used <= stated, "{used} GiB used, {stated} stated");
    assert!(used > 0.5 * stated);
}

#[test]
fn the_building_can_be_cancelled_at_every_look() {
    let skin = skin(64, [6.0; 3], Vec::new());
    let (zone, ground) = (all(&skin), skin.ground());
    let hierarchy = Hierarchy::of(ground);
    let looks = std::sync::atomic::AtomicUsize::new(0);
    let until = |last: usize| {
        looks.store(0, std::sync::atomic::Ordering::Relaxed);
        let cancelled = || looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed) == last;
        let control = Control {
            cancelled: &cancelled,
            progress: &|_, _| {},
        };
        ZoneCoupling::new(&hierarchy, &zone, ground, &control).map(|_| ())
    };
    assert!(until(usize::MAX).is_ok());
    let all = looks.load(std::sync::atomic::Ordering::Relaxed);
    assert!(all >= 4, "{all}");
    for last in 0..all {
        assert_eq!(until(last), Err(ContactError::Cancelled), "look {last}");
    }
}
