//! Conducts an observation: applies the instrument effects to predicted signals in their fixed order.

use super::mat::Mat;
use super::mat::placement::Placement;
use super::signals::Signals;
use super::{crosstalk, dead_cells, drift, fixture_compliance, gain, misregistration};
use super::{offset, saturation, threshold, timing};
use crate::ContactError;
use crate::effects::definition::active::in_order;
use crate::effects::{ActiveEffect, Effect};

/// What a set-up shows of `signals`, which are what happens at the skin.
///
/// Where there are loads and a mat, the mat reads them into the frames; else frames given are taken as read. Effects act in
/// the catalogue's order, whatever the order given. Without effects, or with amplitudes of 0, the channels come back as they
/// are, bit for bit. Tissue effects are refused: they act on the skin.
///
/// # Errors
/// [`ContactError::Signals`] for channels that do not fit together, [`ContactError::Effect`] for an effect that cannot be
/// applied, with what is admissible.
pub fn observe(
    signals: &Signals,
    mat: Option<&Mat>,
    effects: &[ActiveEffect],
) -> Result<Signals, ContactError> {
    signals.check(mat)?;
    for effect in effects {
        check(effect, mat)?;
    }
    let effects = in_order(effects);
    let mut shown = signals.clone();
    if let Some(mat) = mat {
        read(&mut shown, mat, &effects);
    }
    for effect in effects {
        match effect.effect {
            Effect::FixtureCompliance => fixture_compliance::apply(effect, &mut shown),
            Effect::Crosstalk => {
                if let Some(mat) = mat {
                    crosstalk::apply(effect, &mut shown, mat);
                }
            }
            Effect::Gain => gain::apply(effect, &mut shown),
            Effect::Offset => offset::apply(effect, &mut shown),
            Effect::Drift => drift::apply(effect, &mut shown),
            Effect::Saturation => saturation::apply(effect, &mut shown),
            Effect::Threshold => threshold::apply(effect, &mut shown),
            Effect::DeadCells => dead_cells::apply(effect, &mut shown),
            Effect::Timing => timing::apply(effect, &mut shown),
            // Misregistration acted when the mat was read; tissue effects were refused.
            _ => {}
        }
    }
    Ok(shown)
}

/// Checks an instrument effect for a set-up with, or without, a mat.
///
/// # Errors
/// [`ContactError::Effect`]: a tissue effect, an inadmissible number, painting that does not fit the mat.
pub fn check(effect: &ActiveEffect, mat: Option<&Mat>) -> Result<(), ContactError> {
    if !effect.entry().is_instrument() {
        return Err(
            effect.refuse("it acts on the skin, not on readings; give it to the skin".to_owned())
        );
    }
    effect.check_numbers()?;
    let Some(painted) = &effect.painted else {
        return Ok(());
    };
    let sensels = mat.map_or(0, Mat::len);
    if effect.entry().painted.is_none() {
        return Err(effect.refuse("it cannot be painted; give its numbers".to_owned()));
    }
    if painted.len() != sensels {
        return Err(effect.refuse(format!(
            "{} values are painted for {sensels} sensels; paint one per sensel of the mat",
            painted.len()
        )));
    }
    Ok(())
}

/// Reads loads into frames; moves what was read where the mat lies otherwise than it should.
fn read(shown: &mut Signals, mat: &Mat, effects: &[&ActiveEffect]) {
    let misplaced = effects
        .iter()
        .filter(|e| e.effect == Effect::Misregistration);
    let mut placement = Placement::default();
    for effect in misplaced {
        let more = misregistration::placement(effect);
        placement.shift_mm = [0, 1].map(|k| placement.shift_mm[k] + more.shift_mm[k]);
        placement.turn_rad += more.turn_rad;
    }
    if !shown.loads.is_empty() {
        shown.frames = shown
            .loads
            .iter()
            .map(|loads| mat.read_at(loads, &placement))
            .collect();
    } else if !placement.is_none() {
        for frame in &mut shown.frames {
            *frame = mat.read_at(&mat.loads_of(frame), &placement);
        }
    }
}
