//! A hunt through random persons for a skin that breaks a promise. Not part of the usual run, for it takes minutes:
//! `THENAR_PERSONS=600 cargo test -p thenar-hand --release --test integration hunt:: -- --ignored --nocapture`
//! (`THENAR_PERSONS`: how many, 600 if not given; `THENAR_FIRST_PERSON`: number of the first, 0 if not given).

use crate::measuring;

use rayon::prelude::*;
use std::collections::BTreeSet;
use thenar_hand::{Hand, HandShape, Sex, Side};
use thenar_surface::{Adjacency, self_intersections};

/// The finest hands, some 60,000 vertices, take a few seconds on one core; longer than this is taken for a hang.
const LONGEST_S: f64 = 120.0;

#[test]
#[ignore = "takes minutes; see the first lines of this file"]
fn random_persons_all_get_a_sound_hand() {
    let (count, first) = (
        asked("THENAR_PERSONS", 600),
        asked("THENAR_FIRST_PERSON", 0),
    );
    hunt((first..first + count).map(person).collect());
}

#[test]
#[ignore = "takes minutes; see the first lines of this file"]
fn persons_at_the_ends_of_what_is_accepted_get_a_sound_hand() {
    let usual = HandShape::default();
    let by_percentile = [
        (1.0, Sex::Female),
        (99.0, Sex::Female),
        (1.0, Sex::Male),
        (99.0, Sex::Male),
    ]
    .map(|(percentile, sex)| HandShape {
        percentile,
        sex,
        ..usual
    });
    let own = [
        (120.0, 0.3801),
        (120.0, 0.5399),
        (240.0, 0.3801),
        (240.0, 0.5399),
    ]
    .map(|(length, share)| HandShape {
        length_mm: Some(length),
        breadth_mm: Some(share * length),
        ..usual
    });
    let shapes = by_percentile.into_iter().chain(own);
    hunt(
        shapes
            .flat_map(|shape| {
                [1.0, 6.0].map(|spacing_mm| HandShape {
                    spacing_mm,
                    ..shape
                })
            })
            .collect(),
    );
}

fn hunt(persons: Vec<HandShape>) {
    let broken = persons.par_iter().filter_map(broken_promises).count();
    println!("{} persons, {broken} broken", persons.len());
    assert_eq!(broken, 0, "of {} persons", persons.len());
}

/// What is wrong with the hand of a person, printed as soon as it is known; `None` if nothing is.
fn broken_promises(shape: &HandShape) -> Option<String> {
    let start = std::time::Instant::now();
    let mut faults = match shape.build() {
        Ok(hand) => faults(&hand, shape.spacing_mm),
        Err(error) => vec![error.to_string()],
    };
    let seconds = start.elapsed().as_secs_f64();
    if seconds > LONGEST_S {
        faults.push(format!("took {seconds:.0} s"));
    }
    if faults.is_empty() {
        return None;
    }
    let line = format!("{shape:?}: {}", faults.join("; "));
    println!("{line}");
    Some(line)
}

fn asked(variable: &str, usual: u64) -> u64 {
    std::env::var(variable)
        .map(|text| text.parse().expect("a whole number"))
        .unwrap_or(usual)
}

/// One of endlessly many persons over all that is accepted: two in three by percentile, one in three by own measurements.
fn person(number: u64) -> HandShape {
    let draw = |k: u64, low: f64, high: f64| low + (high - low) * unit(number * 8 + k);
    let length = draw(4, 120.0, 240.0);
    let breadth = length * draw(5, 0.3801, 0.5399);
    let is_own = number % 3 == 2;
    HandShape {
        percentile: draw(0, 1.0, 99.0),
        sex: if unit(number * 8 + 1) < 0.5 {
            Sex::Male
        } else {
            Sex::Female
        },
        side: if unit(number * 8 + 2) < 0.5 {
            Side::Right
        } else {
            Side::Left
        },
        spacing_mm: draw(3, 0.0, 6.0_f64.ln()).exp().clamp(1.0, 6.0),
        length_mm: is_own.then_some(length),
        breadth_mm: is_own.then_some(breadth),
    }
}

/// Evenly spread numbers from 0 to 1 (SplitMix64; Steele, Lea & Flood 2014).
fn unit(number: u64) -> f64 {
    let mut z = number.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Every promise a hand breaks.
fn faults(hand: &Hand, spacing_mm: f64) -> Vec<String> {
    let mut faults = Vec::new();
    let mut demand = |holds: bool, what: String| {
        if !holds {
            faults.push(what);
        }
    };
    let audit = hand.mesh.audit();
    let count = hand.mesh.positions().len();
    demand(
        audit.is_closed() && !audit.is_inside_out(),
        "not closed".into(),
    );
    demand(audit.parts == 1, format!("{} parts", audit.parts));
    demand(
        hand.mesh.triangles().len() == 2 * (count - 2),
        "has a handle".into(),
    );
    let crossings = self_intersections(&hand.mesh);
    demand(crossings == 0, format!("{crossings} self-intersections"));
    let sharpest = (0..hand.mesh.triangles().len())
        .map(|t| measuring::smallest_angle(measuring::corners(&hand.mesh, t)))
        .fold(90.0, f64::min);
    demand(sharpest >= 20.0, format!("{sharpest:.1} degrees"));
    let share = measuring::palmar_edges_in_range(hand, spacing_mm);
    demand(
        share >= 0.99,
        format!("{share:.4} of palmar edges in range"),
    );
    let adjacency = Adjacency::new(&hand.mesh);
    for (region, name) in hand.region_names.iter().enumerate() {
        let pieces = pieces(hand, &adjacency, region as i32);
        demand(pieces == 1, format!("{pieces} pieces of {name}"));
    }
    for weights in &hand.weights {
        let sum: f64 = weights.shares.iter().sum();
        demand((sum - 1.0).abs() < 1e-9, format!("weights sum to {sum}"));
    }
    faults
}

fn pieces(hand: &Hand, adjacency: &Adjacency, region: i32) -> usize {
    let mut left: BTreeSet<usize> = (0..hand.regions.len())
        .filter(|&v| hand.regions[v] == region)
        .collect();
    let mut pieces = 0;
    while let Some(start) = left.pop_first() {
        pieces += 1;
        let mut front = vec![start];
        while let Some(v) = front.pop() {
            let around = adjacency.neighbors(v);
            front.extend(
                around
                    .iter()
                    .map(|&n| n as usize)
                    .filter(|n| left.remove(n)),
            );
        }
    }
    pieces
}
