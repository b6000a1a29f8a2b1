//! Legs of constant direction and stands of a motion, by the depth alone.

use crate::observe::measured::Phase;
use crate::observe::protocol_phases::{least_move, moves};

/// Fewest readings of a leg.
pub(crate) const FEWEST: usize = 6;

/// Readings of one leg or stand: first, one past the last, and what the stage does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) start: usize,
    pub(crate) end: usize,
    pub(crate) phase: Phase,
}

/// What becomes of a stand of few readings at the beginning or the end of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum EndStands {
    /// It belongs to the leg next to it.
    Joined,
    /// It is a part of its own: in the leg next to it, it would be a kink.
    Apart,
}

/// Whether a leg is the stand that a recording of that many legs begins or ends with.
pub(crate) fn is_end_stand(leg: &Leg, (k, count): (usize, usize)) -> bool {
    leg.phase == Phase::Hold && (k == 0 || k + 1 == count)
}

/// Legs and stands by the depth alone; what has few readings and goes no way belongs to the longer of its neighbors.
pub(crate) fn legs((time, depth): (&[f64], &[f64]), ends: EndStands) -> Vec<Leg> {
    let mut found: Vec<Leg> = Vec::new();
    for (k, phase) in moves(time, depth).into_iter().enumerate() {
        match found.last_mut() {
            Some(last) if last.phase == phase => last.end = k + 1,
            _ => found.push(Leg {
                start: k,
                end: k + 1,
                phase,
            }),
        }
    }
    let length = |leg: &Leg| leg.end - leg.start;
    let least = least_move(depth);
    let goes = |leg: &Leg| {
        let (from, to) = (leg.start.saturating_sub(1), leg.end.min(depth.len() - 1));
        leg.phase != Phase::Hold && (depth[to] - depth[from]).abs() > least
    };
    while found.len() > 1 {
        let is_apart =
            |k: usize| ends == EndStands::Apart && is_end_stand(&found[k], (k, found.len()));
        let is_none = |k: &usize| length(&found[*k]) < FEWEST && !goes(&found[*k]) && !is_apart(*k);
        let shortest = (0..found.len()).filter(is_none);
        let Some(k) = shortest.min_by_key(|k| length(&found[*k])) else {
            break;
        };
        let is_before = k > 0
            && found
                .get(k + 1)
                .is_none_or(|next| length(next) <= length(&found[k - 1]));
        let gone = found.remove(k);
        match is_before {
            true => found[k - 1].end = gone.end,
            false => found[k].start = gone.start,
        }
        found.dedup_by(|next, last| {
            let is_same = next.phase == last.phase;
            if is_same {
                last.end = next.end;
            }
            is_same
        });
    }
    found
}

/// Two neighbors as one leg, which does what the longer of them does.
pub(crate) fn joined(a: Leg, b: Leg) -> Leg {
    let is_first = a.end - a.start >= b.end - b.start;
    Leg {
        start: a.start,
        end: b.end,
        phase: if is_first { a.phase } else { b.phase },
    }
}
