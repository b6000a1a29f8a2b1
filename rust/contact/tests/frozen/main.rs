//! Results held bit for bit, so that the tree may be moved about: every case's hash stands in `hashes.txt`.
//!
//! House rule: no golden numbers. These are the one exception, since they claim something else: they say that nothing changed,
//! not that it is right. What is right is for the tests beside this one. A commit that only renames, moves or splits code leaves
//! `hashes.txt` as it is; a commit that changes what is computed rewrites it and says so in its message:
//!
//!     THENAR_FREEZE=1 cargo test -p thenar-contact --test frozen
//!
//! Bits hold for one kind of machine (`machine`): a kind that the table does not know is told so, and only the threads are
//! compared. Profiles do not matter: tests and release builds give the same bits.
#![allow(clippy::unwrap_used)]

mod bits;
mod courses;
mod live;
mod machine;
mod presses;
mod products;
mod readings;
#[path = "../scenes/mod.rs"]
mod scenes;
mod shapes;
mod table;

use std::collections::BTreeMap;
use std::io::Write;

use bits::Bits;
use table::{Table, Verdict};

/// A name, and what it computes.
pub type Case = (String, Box<dyn Fn(&mut Bits) + Send + Sync>);

/// A case of that name.
pub fn case(name: &str, compute: impl Fn(&mut Bits) + Send + Sync + 'static) -> Case {
    (name.to_owned(), Box::new(compute))
}

fn cases() -> Vec<Case> {
    let mut all = presses::cases();
    all.extend(products::cases());
    all.extend(live::cases());
    all.extend(courses::cases());
    all.extend(readings::cases());
    all
}

fn hashes() -> BTreeMap<String, u64> {
    let hash = |(name, compute): Case| {
        let start = std::time::Instant::now();
        let mut bits = Bits::default();
        compute(&mut bits);
        println!("{name}: {:.2} s", start.elapsed().as_secs_f64());
        (name, bits.hash())
    };
    cases().into_iter().map(hash).collect()
}

#[test]
fn results_are_the_frozen_bits() {
    let found = hashes();
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    assert_eq!(
        found,
        one.install(hashes),
        "a second run in one thread differs"
    );
    let machine = machine::kind();
    let table = Table::read();
    if std::env::var_os("THENAR_FREEZE").is_some() {
        table.with(&machine, &found).write();
        println!("{} cases frozen for {machine}", found.len());
        return;
    }
    match table.compare(&machine, &found) {
        Verdict::Same(count) => println!("{count} cases are as frozen"),
        // Not by a macro: what those print is shown only where a test fails.
        Verdict::Unknown => writeln!(
            std::io::stderr(),
            "frozen: NOTHING COMPARED but threads: hashes.txt does not know this kind of machine ({machine}); it knows {}",
            table.machines().join("; ")
        )
        .unwrap(),
        Verdict::Changed(lines) => panic!(
            "{}\nif this commit is meant to change results, run THENAR_FREEZE=1 cargo test -p thenar-contact --test frozen and say \
             so in its message",
            lines.join("\n")
        ),
    }
}

#[test]
fn every_case_has_a_name_of_its_own_and_something_to_hold() {
    let names: Vec<String> = cases().into_iter().map(|(name, _)| name).collect();
    let distinct: std::collections::BTreeSet<&String> = names.iter().collect();
    assert_eq!(distinct.len(), names.len());
    for (_, entry) in thenar_contact::effects::CATALOGUE {
        let name = format!("effect {}", entry.name);
        assert!(names.contains(&name), "no case for {name}");
    }
}
