//! Check whether a tool presses the rim of the study's skin, where the model's tissue goes on and the sample's may not.

use std::collections::BTreeMap;

use thenar_surface::{GapLimits, Product, Vec3};

/// Depth under which a press of the rim is not worth a word, mm, and as a part of the deepest press.
const TOUCH: (f64, f64) = (1e-3, 0.1);

/// True if the tool, `travel` from first touch, lies on vertices at which the surface ends.
pub(crate) fn presses_rim(
    (positions, triangles): (&[Vec3], &[[u32; 3]]),
    (tool, travel): (&Product, Vec3),
) -> bool {
    let mut sides: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *sides.entry([*from.min(to), *from.max(to)]).or_default() += 1;
        }
    }
    let limits = GapLimits {
        cut_off_mm: 0.0,
        max_depth_mm: f64::INFINITY,
    };
    let deep = TOUCH.0.max(TOUCH.1 * travel.norm());
    let is_in = |vertex: u32| {
        let at = positions[vertex as usize] - travel;
        tool.gap(at, None, limits)
            .is_some_and(|gap| gap.distance < -deep)
    };
    sides
        .into_iter()
        .filter(|(_, faces)| *faces == 1)
        .any(|([from, to], _)| is_in(from) || is_in(to))
}
