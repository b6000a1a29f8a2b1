//! Damaged files at random, over all readers: finds panics, reads of more than 5 s, and reads that take more than 1 GiB.
//!
//! `cargo run --profile fuzz -p thenar-recordings --example fuzz -- --runs 1000000 --minutes 60 --seed 1 --out FOLDER`
//!
//! Runs until one of both bounds. An input that breaks a bound is kept in the folder (default `target/fuzz`), and the exit code is 1.
//! `--only WORD` takes the readers whose names hold the word; `--input FILE` reads one kept file again. With
//! `RUSTFLAGS="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=3 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters"`
//! and `--target` of the machine the search is guided by coverage: an input that reaches a new edge is damaged further.
#![allow(clippy::unwrap_used)]

mod coverage;
mod limits;
mod mutate;
#[path = "../../tests/random/mod.rs"]
mod random;
#[path = "../../tests/exports/mod.rs"]
mod exports;
#[path = "../../tests/folders/mod.rs"]
mod folders;
#[path = "../../tests/inked/mod.rs"]
mod inked;
#[path = "../../tests/promises/mod.rs"]
mod promises;
mod seeds;
mod targets;

use limits::Limits;
use random::Random;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use targets::Target;

/// Most inputs that are kept for each reader to be damaged further.
const MOST_KEPT: usize = 4_000;
/// By how many letters of its text a fault is known again.
const LONGEST_FAULT: usize = 140;
/// Longest input, bytes.
const LONGEST: usize = 64 << 10;
/// How often a line says how far the search is.
const PRINTED_EVERY: Duration = Duration::from_secs(20);

/// What the command line asks for.
struct Wanted {
    runs: u64,
    minutes: f64,
    seed: u64,
    out: PathBuf,
    only: String,
    input: Option<PathBuf>,
}

/// What was found so far.
#[derive(Default)]
struct Found {
    runs: u64,
    read: u64,
    faults: HashMap<String, u64>,
    slowest: Duration,
    largest: usize,
}

fn main() {
    let wanted = arguments();
    std::fs::create_dir_all(&wanted.out).unwrap();
    let limits = Limits::start(&wanted.out);
    std::panic::set_hook(Box::new(limits::note_panic));
    let mut targets: Vec<Target> = targets::all(&wanted.out)
        .into_iter()
        .filter(|target| target.name.contains(&wanted.only))
        .collect();
    assert!(!targets.is_empty(), "no reader is called {}", wanted.only);
    let mut found = Found::default();
    if let Some(input) = &wanted.input {
        let bytes = std::fs::read(input).unwrap();
        for target in &targets {
            try_one(target, &bytes, &limits, &mut found);
        }
    } else {
        search(&wanted, &mut targets, &limits, &mut found);
    }
    println!("{}", sum(&found, &targets));
    for (fault, count) in &found.faults {
        println!("FAULT, {count} times: {fault}");
    }
    std::process::exit(i32::from(!found.faults.is_empty()));
}

fn search(wanted: &Wanted, targets: &mut [Target], limits: &Limits, found: &mut Found) {
    let mut random = Random(wanted.seed);
    let started = Instant::now();
    let (end, mut printed) = (
        started + Duration::from_secs_f64(60.0 * wanted.minutes),
        started,
    );
    for target in targets.iter_mut() {
        for seed in target.corpus.clone() {
            try_one(target, &seed, limits, found);
            coverage::is_new(&mut target.seen);
        }
    }
    while found.runs < wanted.runs && Instant::now() < end {
        let at = random.below(targets.len());
        let target = &mut targets[at];
        let mut input = mutate::damaged(&target.corpus, &mut random);
        input.truncate(LONGEST.max(target.longest));
        try_one(target, &input, limits, found);
        if coverage::is_new(&mut target.seen) && target.corpus.len() < MOST_KEPT {
            target.corpus.push(input);
        }
        if printed.elapsed() > PRINTED_EVERY {
            printed = Instant::now();
            println!(
                "{:.0} s: {}",
                started.elapsed().as_secs_f64(),
                sum(found, targets)
            );
        }
    }
}

fn sum(found: &Found, targets: &[Target]) -> String {
    let kept: usize = targets.iter().map(|target| target.corpus.len()).sum();
    let edges: usize = targets
        .iter()
        .map(|target| target.seen.iter().filter(|seen| **seen != 0).count())
        .sum();
    format!(
        "{} inputs, {} read, {kept} kept, {edges} edges, slowest {:.2} s, largest {} MB, {} faults",
        found.runs,
        found.read,
        found.slowest.as_secs_f64(),
        found.largest >> 20,
        found.faults.values().sum::<u64>()
    )
}

/// Reads one input; a panic, a long time or much memory is counted, and its first input kept.
fn try_one(target: &Target, input: &[u8], limits: &Limits, found: &mut Found) {
    coverage::clear();
    let watch = limits.begin(target.name, input);
    let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| (target.read)(input)));
    let taken = watch.end();
    found.runs += 1;
    found.slowest = found.slowest.max(taken.time);
    found.largest = found.largest.max(taken.bytes);
    let fault = match result {
        Err(_) => Some(format!("{}: panic: {}", target.name, limits::last_panic())),
        Ok(_) if taken.time > limits::LONGEST => Some(format!("{}: time", target.name)),
        Ok(_) if taken.bytes > limits::MOST_BYTES => Some(format!("{}: memory", target.name)),
        Ok(is_read) => {
            found.read += u64::from(is_read);
            None
        }
    };
    let Some(fault) = fault else { return };
    // One fault with many texts is one fault.
    let fault: String = fault.chars().take(LONGEST_FAULT).collect();
    let count = found.faults.entry(fault.clone()).or_default();
    *count += 1;
    if *count == 1 {
        let kept = limits.keep(target.name, input, found.faults.len());
        println!(
            "{fault} ({:.1} s, {} MB): {}",
            taken.time.as_secs_f64(),
            taken.bytes >> 20,
            kept.display()
        );
    }
}

fn arguments() -> Wanted {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/fuzz");
    let mut wanted = Wanted {
        runs: u64::MAX,
        minutes: 1.0,
        seed: 1,
        out: default,
        only: String::new(),
        input: None,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words
            .next()
            .unwrap_or_else(|| panic!("{word} needs a value"));
        match word.as_str() {
            "--runs" => wanted.runs = value.parse().unwrap(),
            "--minutes" => wanted.minutes = value.parse().unwrap(),
            "--seed" => wanted.seed = value.parse().unwrap(),
            "--out" => wanted.out = value.into(),
            "--only" => wanted.only = value,
            "--input" => wanted.input = Some(value.into()),
            _ => panic!("{word} is no option"),
        }
    }
    wanted
}
