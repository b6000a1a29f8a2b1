//! Tables of a stiff skin layer, by its thickness and its modulus over that of the pulp.
//!
//! Where a tool answers as some ball on the bare layer does, the skin's part is that ball's (`thenar_contact::ball`), whose skin gives
//! way through its thickness and stretches as it is pressed deep. Other tools are pressed on the mesh with a skin of
//! `MESHED_MM`, a plate at small strains; of that only its bending stiffness counts, which gives every thickness.

use crate::forward::mesh::replay::Replay;
use thenar_contact::ball::{Ball, StiffSkin};
use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Control, Material};

use crate::errors::InferenceError;
use crate::forward::mesh::press_table::PressTable;
use crate::forward::tables::elastic_table::Variant;
use crate::forward::tables::sphere::SphereTable;
use crate::forward::tables::table_presses::{ratios, tables};
use crate::interpolation::{Table, interval, mixed};

/// Thicknesses that are tried, mm: a fingertip's horny layer has 0.3 (Adams 2013), all of its skin above the pulp about a millimetre.
pub const THICKNESSES_MM: [f64; 3] = [0.3, 0.5, 0.9];
/// Moduli over that of pulp at which a skin is tabulated; the first is none.
const RATIOS: [f64; 6] = [1.0, 2.5, 6.0, 15.0, 40.0, 100.0];
/// The largest of them.
pub const MOST: f64 = RATIOS[RATIOS.len() - 1];
/// Thickness of the skin that is pressed on the mesh, mm, and its moduli over that of pulp.
const MESHED_MM: f64 = 0.5;
const MESHED: [f64; 4] = [1.0, 6.0, 40.0, 240.0];
/// Most of the layer that a skin takes.
const MOST_TAKEN: f64 = 0.5;
/// Depths at which a skin is pressed: what it adds changes most at first touch.
const RUNGS: usize = 10;
/// Part by which a tool's force may differ from a ball's on the way to its depth.
const ROUND: f64 = 0.06;
/// Radius of a ball over thickness or depth, at most and at least; and how often it is sought.
const RADII: (f64, f64) = (40.0, 0.7);
const SOUGHT: usize = 8;

/// The modulus of a skin over that of pulp at a coordinate of its tables.
pub fn ratio(at: f64) -> f64 {
    let last = RATIOS.len() - 2;
    let k = (at.max(0.0) as usize).min(last);
    let share = at.max(0.0) - k as f64;
    libm::exp(mixed(&RATIOS.map(libm::log), (k, share)))
}

/// Tables of `places`, whose base tables are given, by thickness; materials have one modulus.
///
/// # Errors
/// What the contact model says of a press, or `Cancelled`.
pub(crate) fn tabulate(
    replay: &mut Replay,
    (base, spheres, flat): (&[PressTable], &[Option<SphereTable>], &[Material]),
    (places, control): (&[usize], &Control<'_>),
) -> Result<Vec<Variant>, InferenceError> {
    let mut round = Vec::new();
    for (table, known) in base.iter().zip(spheres) {
        control.check().map_err(|_| InferenceError::Cancelled)?;
        let most = MOST_TAKEN * flat[0].thickness_mm;
        let alike = match known {
            Some(known) => known.ball(),
            None => ball(table, &flat[0]),
        };
        round.push(alike.and_then(|ball| of_ball(&ball, table, most)));
    }
    let others: Vec<usize> = (0..base.len())
        .filter(|place| round[*place].is_none())
        .collect();
    let meshed = meshed(replay, ((base, &others), flat), (places, control))?;
    let one = |(form, thickness_mm): (usize, f64)| {
        let log_ratio = (0..base.len()).map(|place| match &round[place] {
            Some(tables) => tables[form].clone(),
            None => of_plate(
                &meshed[others.iter().position(|o| *o == place).unwrap_or(0)],
                thickness_mm,
            ),
        });
        Variant {
            effect: Effect::StiffSkin,
            form,
            knots: (0..RATIOS.len()).map(|k| k as f64).collect(),
            log_ratio: log_ratio.collect(),
        }
    };
    Ok(THICKNESSES_MM.into_iter().enumerate().map(one).collect())
}

/// The ball whose force on the bare layer is that of a table; None where there is none.
fn ball(table: &PressTable, material: &Material) -> Option<Ball> {
    let root = table.roots.last().copied()?;
    let deepest = root * root;
    let at = |k: usize| (table.roots[k].powi(2), table.force[k] / material.g0_mpa);
    let last = table.roots.len() - 1;
    let (before, whole) = (at(last * 3 / 4), at(last));
    let layer = (material.thickness_mm, material.poisson_ratio);
    let most = RADII.0 * material.thickness_mm.min(10.0 * deepest);
    let mut radius = (2.0 * deepest).max(1.0);
    for _ in 0..SOUGHT {
        let ball = Ball::new(layer, radius, deepest);
        let found = ball.forces(None, &[before.0, whole.0])?;
        let off = whole.1 / found[1];
        if (off - 1.0).abs() < 0.1 * ROUND {
            let is_round = (before.1 / found[0] / off - 1.0).abs() < ROUND;
            return is_round.then_some(ball);
        }
        // Force goes as the radius to between 1/2 and 1.
        radius *= libm::pow(off, 1.3);
        if !(RADII.1 * deepest..most).contains(&radius) {
            return None;
        }
    }
    None
}

/// By thickness (`most` mm at most), knot and rung, of a ball; None where a skin's tension does not settle.
fn of_ball(ball: &Ball, table: &PressTable, most: f64) -> Option<Vec<Vec<Vec<f64>>>> {
    let stride = (table.roots.len() - 1) / RUNGS;
    let roots: Vec<f64> = table.roots.iter().step_by(stride).copied().collect();
    let depths: Vec<f64> = roots[1..].iter().map(|root| root * root).collect();
    let bare = ball.forces(None, &depths)?;
    let one = |(thickness_mm, ratio): (f64, f64)| {
        let skin = StiffSkin {
            thickness_mm: thickness_mm.min(most),
            ratio,
        };
        let with = match ratio {
            1.0 => bare.clone(),
            _ => ball.forces(Some(skin), &depths)?,
        };
        let logs = with.iter().zip(&bare).map(|(a, b)| libm::log(a / b));
        let mut few: Vec<f64> = logs.collect();
        // First touch, where both vanish, as at the first rung.
        few.insert(0, few[0]);
        let smooth = Table::new(&roots, few);
        Some(table.roots.iter().map(|root| smooth.at(*root)).collect())
    };
    let knots = |thickness_mm| RATIOS.iter().map(|r| one((thickness_mm, *r))).collect();
    THICKNESSES_MM.into_iter().map(knots).collect()
}

/// By place (`others` are numbers of base tables) and knot of [`MESHED`], the logarithm of force over the base's.
fn meshed(
    replay: &mut Replay,
    ((base, others), flat): ((&[PressTable], &[usize]), &[Material]),
    (places, control): (&[usize], &Control<'_>),
) -> Result<Vec<Vec<Vec<f64>>>, InferenceError> {
    let none = |other: &usize| vec![vec![0.0; base[*other].roots.len()]];
    let mut found: Vec<Vec<Vec<f64>>> = others.iter().map(none).collect();
    if others.is_empty() {
        return Ok(found);
    }
    let at: Vec<usize> = others.iter().map(|other| places[*other]).collect();
    for ratio in &MESHED[1..] {
        let mut skin = ActiveEffect::new(Effect::StiffSkin, 1.0);
        (skin.shape[0], skin.shape[1]) = (3.0 * flat[0].g0_mpa * ratio, MESHED_MM);
        let with = tables(
            replay,
            (std::slice::from_ref(&skin), flat, RUNGS),
            (&at, control),
        )?;
        for ((of, other), table) in found.iter_mut().zip(others).zip(&with) {
            of.push(ratios(table, &base[*other]));
        }
    }
    Ok(found)
}

/// By knot and rung, of a plate as stiff against bending.
fn of_plate(meshed: &[Vec<f64>], thickness_mm: f64) -> Vec<Vec<f64>> {
    let over = 3.0 * libm::log(thickness_mm / MESHED_MM);
    let one = |ratio: &f64| {
        let at = match *ratio {
            1.0 => 0.0,
            _ => (libm::log(*ratio) + over).max(0.0),
        };
        let (k, share) = interval(&MESHED.map(libm::log), at);
        let share = share.min(1.0);
        let both = meshed[k].iter().zip(&meshed[k + 1]);
        both.map(|(a, b)| a * (1.0 - share) + b * share).collect()
    };
    RATIOS.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::press_table as table;

    /// Hertz' force on a half space is that of its own ball; a flat punch's, which grows as the depth, is that of none.
    #[test]
    fn equivalent_sphere_is_found_from_force_and_rejected_for_a_punch() {
        let material = Material {
            g0_mpa: 0.01,
            thickness_mm: f64::INFINITY,
            poisson_ratio: 0.5,
            ..Material::default()
        };
        let hertz =
            |radius: f64| move |d: f64| 0.01 * 16.0 / 3.0 * radius.sqrt() * libm::pow(d, 1.5);
        for radius in [2.0, 6.0, 20.0] {
            let found = ball(&table(0.7, hertz(radius)), &material).unwrap();
            let force = found.forces(None, &[0.7]).unwrap()[0];
            assert!((0.01 * force / hertz(radius)(0.7) - 1.0).abs() < 0.01);
        }
        assert!(ball(&table(0.7, |d| 0.1 * d), &material).is_none());
        assert!(ball(&table(0.7, |_| 0.0), &material).is_none());
    }

    /// A plate bends by E t^3: twice as thick a skin is as stiff as one with eight times the modulus.
    #[test]
    fn plate_tables_scale_with_bending_stiffness() {
        let meshed: Vec<Vec<f64>> = MESHED.iter().map(|r| vec![libm::log(*r)]).collect();
        for (thickness_mm, at) in [(MESHED_MM, 3), (0.8 * MESHED_MM, 3), (1.2 * MESHED_MM, 2)] {
            let found = of_plate(&meshed, thickness_mm)[at][0];
            let wanted = RATIOS[at] * (thickness_mm / MESHED_MM).powi(3);
            assert!((found - libm::log(wanted)).abs() < 1e-9, "{found} {wanted}");
        }
        let most = of_plate(&meshed, 4.0 * MESHED_MM)[5][0];
        assert!((most - libm::log(MESHED[3])).abs() < 1e-9);
        assert_eq!(of_plate(&meshed, 4.0 * MESHED_MM)[0][0], 0.0);
    }

    #[test]
    fn skin_modulus_is_log_linear_between_knots() {
        for (k, known) in RATIOS.iter().enumerate() {
            assert!((ratio(k as f64) / known - 1.0).abs() < 1e-12);
        }
        assert!((ratio(1.5) / (2.5f64 * 6.0).sqrt() - 1.0).abs() < 1e-12);
        assert_eq!(ratio(-0.2), 1.0);
    }
}
