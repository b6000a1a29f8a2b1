//! One skin against products of every kind: closed, open, sheets, several parts, edges, folds.

use thenar_contact::{Press, Unsolved};
use thenar_surface::{Mesh, Vec3};

use crate::presses::{of, pressed};
use crate::shapes::{block, dome, ellipsoid, inside_out, joined, plain, product, sheet};
use crate::shapes::{stiffening, tube};
use crate::{Case, case};

type Made = Box<dyn Fn() -> Mesh + Send + Sync>;

pub fn cases() -> Vec<Case> {
    let ball = || ellipsoid(40, Vec3::new(9.0, 9.0, 9.0), Vec3::new(0.0, 0.0, 8.0));
    let low = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let all: Vec<(&str, Made)> = vec![
        ("closed ball", Box::new(ball)),
        ("ball inside out", Box::new(move || inside_out(&ball()))),
        (
            "plate with edges",
            Box::new(move || block(low(-30.0, -4.0, -0.9), low(30.0, 4.0, 8.0))),
        ),
        (
            "thin plate",
            Box::new(move || block(low(-30.0, -30.0, -1.0), low(30.0, 30.0, -0.2))),
        ),
        ("open tube", Box::new(|| tube(15.0, 40.0, 1.0))),
        ("sheet", Box::new(|| sheet(16.0, 25.0, 0.9))),
        (
            "ball and plate that overlap",
            Box::new(move || joined(&[ball(), block(low(-2.0, -9.0, -0.6), low(20.0, 9.0, 7.0))])),
        ),
        (
            "ball beside a sheet",
            Box::new(move || {
                let beside = sheet(16.0, 25.0, 0.5);
                let up = beside.positions().iter().map(|p| p + low(0.0, 0.0, 0.2));
                let beside = beside.with_positions(up.collect()).unwrap();
                joined(&[ball(), beside])
            }),
        ),
    ];
    let mut cases: Vec<Case> = Vec::new();
    for (name, mesh) in all {
        cases.push(case(&format!("product, {name}"), move |bits| {
            let mut skin = plain(dome(11.0, 1.2, 16.0), stiffening());
            let product = product(mesh());
            let request = Press {
                unsolved: Unsolved::Keep,
                ..of(&product)
            };
            let contact = pressed(&mut skin, &request);
            assert!(contact.total_force.norm() > 0.0);
            bits.contact(&contact);
        }));
    }
    cases
}
