//! Bones of the rig: where they are, about which axes they turn and how far.

use crate::proportions::FINGERS;
use crate::skeleton::{Digit, Skeleton, THUMB};
use thenar_surface::Vec3;

/// Range of a joint's turn away from the rest pose, radians; zero is the rest pose itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Least and greatest turn about [`Bone::flexion_axis`].
    pub flexion: (f64, f64),
    /// Least and greatest turn about [`Bone::abduction_axis`].
    pub abduction: (f64, f64),
}

/// One bone. It turns about its head; everything below it follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Bone {
    /// `forearm`, `carpus`, `index_metacarpal`, `index_proximal`, `index_middle`, `index_distal`, ... `thumb_distal`.
    pub name: String,
    /// Place of the parent in [`crate::Hand::bones`]; parents stand before their children.
    pub parent: Option<usize>,
    /// Joint centre, mm.
    pub head: Vec3,
    /// Far end, mm.
    pub tail: Vec3,
    /// Unit axis; a positive right-handed turn about it flexes (closes the hand), on either side.
    pub flexion_axis: Vec3,
    /// Unit axis; a positive right-handed turn about it moves the far end radially (fingers, wrist) or away from the palm (thumb).
    pub abduction_axis: Vec3,
    /// Unit direction in which the bone's palmar skin faces.
    pub palmar: Vec3,
    /// Flexion this joint already has at rest, radians: anatomical angle = rest + turn.
    pub rest_flexion: f64,
    /// How far the joint turns from rest.
    pub limits: Limits,
}

/// Anatomical ranges in degrees: flexion, abduction.
type Range = ((f64, f64), (f64, f64));

/// Wrist: AAOS clinical norms. Thumb and fingers: e-hand.com tables (MCP hyperextension 20 instead of 45, as practice uses).
/// Finger spread about the MCP: Chatzioglou et al. 2024, the 17, 14 and 32 degrees between neighbours shared between them.
const WRIST: Range = ((-70.0, 80.0), (-30.0, 20.0));
const MCP: Range = ((-20.0, 90.0), (-20.0, 20.0));
const PIP: Range = ((0.0, 100.0), (0.0, 0.0));
const DIP: Range = ((0.0, 80.0), (0.0, 0.0));
/// Flexion of the four CMC joints, index to little: ring 15, little 30 degrees let the palm cup.
const CMC: [f64; 4] = [0.0, 0.0, 15.0, 30.0];
/// Thumb CMC about our axes: radial abduction to 60 and palmar abduction to 45 degrees (e-hand.com), less the 42 and 27 degrees of the rest pose.
const THUMB_CMC: Range = ((-18.0, 50.0), (-27.0, 18.0));
const THUMB_MP: Range = ((-10.0, 55.0), (-5.0, 5.0));
const THUMB_IP: Range = ((-15.0, 80.0), (0.0, 0.0));

/// The bones of a right hand; the forearm starts at y = `cut_y` mm.
pub(crate) fn bones(skeleton: &Skeleton, cut_y: f64) -> Vec<Bone> {
    let still: Range = ((0.0, 0.0), (0.0, 0.0));
    let straight = |name: &str, parent, head: Vec3, tail: Vec3, range| {
        let along = (tail - head).normalize();
        let axis = along.cross(&Vec3::z()).normalize();
        bone(
            name.to_string(),
            parent,
            [head, tail],
            &Joint {
                axis,
                palmar: axis.cross(&along),
                rest: 0.0,
                range,
            },
        )
    };
    let mut bones = vec![
        straight(
            "forearm",
            None,
            Vec3::new(0.0, cut_y, -1.0),
            Vec3::zeros(),
            still,
        ),
        straight(
            "carpus",
            Some(0),
            Vec3::zeros(),
            skeleton.digits[1].base,
            WRIST,
        ),
    ];
    for (k, digit) in skeleton.digits.iter().enumerate().take(THUMB) {
        let range = ((0.0, CMC[k]), (0.0, 0.0));
        let name = format!("{}_metacarpal", digit.name);
        bones.push(straight(&name, Some(1), digit.base, digit.joints[0], range));
        let [_, _, rest @ ..] = FINGERS[k].rest;
        chain(
            &mut bones,
            digit,
            (["proximal", "middle", "distal"], rest, [MCP, PIP, DIP]),
        );
    }
    let thumb = &skeleton.digits[THUMB];
    let parts = (
        ["metacarpal", "proximal", "distal"],
        [0.0, 12.0, 10.0],
        [THUMB_CMC, THUMB_MP, THUMB_IP],
    );
    chain(&mut bones, thumb, parts);
    let start = bones.len() - 3;
    bones[start].parent = Some(1);
    bones
}

fn chain(
    bones: &mut Vec<Bone>,
    digit: &Digit,
    (parts, rest, ranges): ([&str; 3], [f64; 3], [Range; 3]),
) {
    for k in 0..3 {
        let parent = Some(bones.len() - 1);
        let ends = [digit.joints[k], digit.joints[k + 1]];
        let joint = Joint {
            axis: digit.axis,
            palmar: digit.palmar[k],
            rest: rest[k],
            range: ranges[k],
        };
        let name = format!("{}_{}", digit.name, parts[k]);
        bones.push(bone(name, parent, ends, &joint));
    }
}

/// How a bone turns about its head.
struct Joint {
    axis: Vec3,
    palmar: Vec3,
    /// Flexion at rest, degrees.
    rest: f64,
    range: Range,
}

fn bone(name: String, parent: Option<usize>, [head, tail]: [Vec3; 2], joint: &Joint) -> Bone {
    let Joint {
        axis,
        palmar,
        rest,
        range,
    } = *joint;
    let radians = |(low, high): (f64, f64), rest: f64| {
        ((low - rest).to_radians(), (high - rest).to_radians())
    };
    let limits = Limits {
        flexion: radians(range.0, rest),
        abduction: radians(range.1, 0.0),
    };
    Bone {
        name,
        parent,
        head,
        tail,
        flexion_axis: axis,
        abduction_axis: -palmar,
        palmar,
        rest_flexion: rest.to_radians(),
        limits,
    }
}

impl Bone {
    /// The same bone of the other hand: points mirrored in x = 0, axes so that positive turns still flex and abduct.
    pub(crate) fn mirrored(&self) -> Bone {
        let point = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let axis = |v: Vec3| Vec3::new(v.x, -v.y, -v.z);
        Bone {
            head: point(self.head),
            tail: point(self.tail),
            palmar: point(self.palmar),
            flexion_axis: axis(self.flexion_axis),
            abduction_axis: axis(self.abduction_axis),
            ..self.clone()
        }
    }
}
