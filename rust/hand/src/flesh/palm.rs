//! The palm: four metacarpals under a transverse arch, thenar and hypothenar masses, webs, the hollow, the wrist.

use super::solid::{Chain, Frame, Solid};
use crate::skeleton::{Skeleton, THUMB};
use thenar_surface::Vec3;

/// Half depth of each metacarpal at base and head, aspect at both; mm at the reference size.
const METACARPALS: [[f64; 4]; 4] = [
    [13.0, 13.9, 1.05, 0.99],
    [13.5, 14.2, 1.0, 0.88],
    [13.0, 13.3, 1.0, 0.90],
    [11.5, 11.8, 1.05, 1.02],
];

/// Everything of the hand but fingers and thumb.
pub(super) fn palm(skeleton: &Skeleton) -> Chain {
    let mut chain = Chain::new();
    metacarpals(skeleton, &mut chain);
    pads(skeleton, &mut chain);
    knuckles(skeleton, &mut chain);
    webs(skeleton, &mut chain);
    masses(skeleton, &mut chain);
    wrist(skeleton, &mut chain);
    let s = skeleton.across();
    let hollow = Frame::new(skeleton.point(-6.0, 50.0, 31.0), Vec3::y(), Vec3::z());
    chain.cut(
        9.0 * s,
        Solid::ellipsoid(hollow, Vec3::new(17.0, 27.0, 15.0) * s),
    );
    chain
}

fn metacarpals(skeleton: &Skeleton, chain: &mut Chain) {
    let s = skeleton.across();
    for (digit, [base, head, aspect_base, aspect_head]) in skeleton.digits.iter().zip(METACARPALS) {
        let ends = (
            digit.base + skeleton.point(0.0, -4.0, 2.5),
            digit.joints[0] + skeleton.point(0.0, 3.0, 1.6),
        );
        chain.join(
            11.0 * s,
            Solid::cone(
                ends,
                Vec3::z(),
                [base * s, head * s],
                [aspect_base, aspect_head],
            ),
        );
    }
}

/// Distal palm pads between the crease and the webs, and one at each side of the hand.
fn pads(skeleton: &Skeleton, chain: &mut Chain) {
    let s = skeleton.across();
    let mcp = |k: usize| skeleton.digits[k].joints[0];
    let mut pad = |center: Vec3, half: Vec3| {
        chain.join(
            9.0 * s,
            Solid::ellipsoid(Frame::new(center, Vec3::y(), Vec3::z()), half * s),
        );
    };
    for k in 0..3 {
        let between = 0.5 * (mcp(k) + mcp(k + 1));
        pad(
            between + skeleton.point(0.0, 6.0, 9.7),
            Vec3::new(11.5, 12.5, 6.4),
        );
    }
    pad(
        mcp(0) + skeleton.point(2.5, 5.0, 8.0),
        Vec3::new(10.0, 14.0, 7.5),
    );
    pad(
        mcp(3) + skeleton.point(-1.5, -2.0, 4.5),
        Vec3::new(9.5, 20.0, 8.0),
    );
}

/// Heads of the metacarpals: knuckles on the back, the middle one the highest.
fn knuckles(skeleton: &Skeleton, chain: &mut Chain) {
    let s = skeleton.across();
    for (digit, height) in skeleton.digits.iter().take(THUMB).zip([7.4, 8.1, 7.2, 6.2]) {
        let center = digit.joints[0] + skeleton.point(0.0, 1.0, -height);
        let frame = Frame::new(center, digit.along[0], digit.palmar[0]);
        chain.join(
            6.0 * s,
            Solid::ellipsoid(frame, Vec3::new(6.4, 9.0, 5.2) * s),
        );
    }
}

/// A saddle between neighbouring fingers, its edge 13 to 15 mm beyond the MCP centres, and the first web.
fn webs(skeleton: &Skeleton, chain: &mut Chain) {
    let s = skeleton.across();
    for (k, reach) in [(0, 15.0), (1, 15.0), (2, 13.0)] {
        let end = |k: usize| {
            let digit = &skeleton.digits[k];
            digit.joints[0]
                + digit.along[0] * (reach * skeleton.lengthwise())
                + Vec3::z() * (1.5 * s)
        };
        chain.join(
            5.0 * s,
            Solid::cone(
                (end(k), end(k + 1)),
                Vec3::z(),
                [6.2 * s, 6.0 * s],
                [1.0, 1.0],
            ),
        );
    }
    let thumb = &skeleton.digits[THUMB];
    let metacarpal = thumb.joints[1] - thumb.joints[0];
    let index = skeleton.digits[0].joints[0] + skeleton.point(2.0, -16.0, 1.0);
    for (from, to, radius) in [(0.93, 0.0, 5.2), (0.69, 0.4, 6.5)] {
        let a = thumb.joints[0] + metacarpal * from;
        let b = index + (skeleton.digits[0].base - index) * to;
        let across = (b - a).cross(&(Vec3::y() + thumb.along[0]));
        chain.join(
            9.0 * s,
            Solid::cone((a, b), across, [radius * s, radius * s], [1.0, 1.0]),
        );
    }
}

/// Hypothenar and thenar eminences: fat drops on both sides of the hollow.
fn masses(skeleton: &Skeleton, chain: &mut Chain) {
    let s = skeleton.across();
    let hypothenar = Frame::new(
        skeleton.point(-27.5, 36.0, 4.5),
        Vec3::new(-0.18, 1.0, 0.05),
        Vec3::z(),
    );
    chain.join(
        11.0 * s,
        Solid::ellipsoid(hypothenar, Vec3::new(12.5, 34.0, 14.5) * s),
    );
    let thenar = Frame::new(
        skeleton.point(19.0, 37.0, 11.5),
        Vec3::new(0.50, 0.80, 0.28),
        Vec3::new(-0.25, -0.1, 1.0),
    );
    chain.join(
        10.0 * s,
        Solid::ellipsoid(thenar, Vec3::new(15.5, 32.0, 14.5) * s),
    );
}

/// The wrist: oval, a little broader towards the forearm, with the head of the ulna on the back.
fn wrist(skeleton: &Skeleton, chain: &mut Chain) {
    let s = skeleton.across();
    let ends = (
        skeleton.point(-1.0, -66.0, -1.5),
        skeleton.point(0.5, 12.0, 0.0),
    );
    let section = ([23.0 * s, 16.8 * s], [1.34, 1.56]);
    chain.join(17.0 * s, Solid::cone(ends, Vec3::z(), section.0, section.1));
    let ulna = Frame::new(skeleton.point(-18.0, -20.0, -10.5), Vec3::y(), Vec3::z());
    chain.join(
        8.0 * s,
        Solid::ellipsoid(ulna, Vec3::new(7.0, 10.0, 6.0) * s),
    );
}
