//! The table of frozen hashes: a section for every kind of machine, a line for every case.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

const HEAD: &str = "# Hashes of results: see main.rs. Written by THENAR_FREEZE=1 cargo test -p thenar-contact --test frozen\n";

type Hashes = BTreeMap<String, u64>;

pub struct Table {
    sections: BTreeMap<String, Hashes>,
}

pub enum Verdict {
    /// As many cases are as frozen.
    Same(usize),
    /// The table does not know this kind of machine.
    Unknown,
    /// What is otherwise, a line each.
    Changed(Vec<String>),
}

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/frozen/hashes.txt")
}

impl Table {
    /// The table of the tree; without sections where there is none.
    pub fn read() -> Table {
        Table::parse(&std::fs::read_to_string(path()).unwrap_or_default())
    }

    fn parse(text: &str) -> Table {
        let (mut sections, mut machine) = (BTreeMap::<String, Hashes>::new(), String::new());
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            if let Some(name) = line.strip_prefix('[') {
                machine = name.trim_end_matches(']').to_owned();
            } else if let Some((hash, name)) = line.split_once(' ') {
                let hash = u64::from_str_radix(hash, 16).unwrap();
                let section = sections.entry(machine.clone()).or_default();
                section.insert(name.to_owned(), hash);
            }
        }
        Table { sections }
    }

    pub fn machines(&self) -> Vec<String> {
        self.sections.keys().cloned().collect()
    }

    pub fn compare(&self, machine: &str, found: &Hashes) -> Verdict {
        let Some(frozen) = self.sections.get(machine) else {
            return Verdict::Unknown;
        };
        let mut lines = Vec::new();
        for (name, hash) in found {
            match frozen.get(name) {
                Some(before) if before == hash => {}
                Some(before) => lines.push(format!("{name}: {before:016x} became {hash:016x}")),
                None => lines.push(format!("{name}: not frozen yet")),
            }
        }
        let gone = frozen.keys().filter(|name| !found.contains_key(*name));
        lines.extend(gone.map(|name| format!("{name}: frozen, but no case any more")));
        match lines.is_empty() {
            true => Verdict::Same(found.len()),
            false => Verdict::Changed(lines),
        }
    }

    /// The same with this machine's hashes. Where they have changed, those of other machines are no longer true and go.
    pub fn with(mut self, machine: &str, found: &Hashes) -> Table {
        let has_changed = self.sections.get(machine).is_some_and(|frozen| {
            let mut both = frozen.iter().filter(|(name, _)| found.contains_key(*name));
            both.any(|(name, hash)| found[name] != *hash)
        });
        if has_changed {
            self.sections.clear();
        }
        self.sections.insert(machine.to_owned(), found.clone());
        self
    }

    pub fn write(&self) {
        std::fs::write(path(), self.text()).unwrap();
    }

    fn text(&self) -> String {
        let mut text = HEAD.to_owned();
        for (machine, hashes) in &self.sections {
            writeln!(text, "\n[{machine}]").unwrap();
            for (name, hash) in hashes {
                writeln!(text, "{hash:016x} {name}").unwrap();
            }
        }
        text
    }
}

fn hashes(pairs: &[(&str, u64)]) -> Hashes {
    let own = |(name, hash): &(&str, u64)| ((*name).to_owned(), *hash);
    pairs.iter().map(own).collect()
}

#[test]
fn a_table_reads_what_it_writes() {
    let table = Table::parse("").with("one, two", &hashes(&[("a case", 7), ("b", u64::MAX)]));
    assert_eq!(Table::parse(&table.text()).sections, table.sections);
}

#[test]
fn changed_new_and_missing_cases_are_named() {
    let table = Table::parse("").with("here", &hashes(&[("a", 1), ("b", 2)]));
    let Verdict::Changed(lines) = table.compare("here", &hashes(&[("a", 3), ("c", 4)])) else {
        panic!("a change passed unseen");
    };
    let expected = [
        "a: 0000000000000001 became",
        "c: not frozen",
        "b: frozen, but no",
    ];
    for (line, expected) in lines.iter().zip(expected) {
        assert!(line.starts_with(expected), "{line}");
    }
    assert_eq!(lines.len(), 3);
    assert!(matches!(
        table.compare("there", &hashes(&[])),
        Verdict::Unknown
    ));
}

#[test]
fn a_change_here_ends_what_was_true_elsewhere() {
    let table = Table::parse("").with("there", &hashes(&[("a", 5)]));
    let table = table.with("here", &hashes(&[("a", 1)]));
    assert_eq!(table.machines(), ["here", "there"]);
    let table = table.with("here", &hashes(&[("a", 1), ("new", 2)]));
    assert_eq!(table.machines(), ["here", "there"]);
    let table = table.with("here", &hashes(&[("a", 2)]));
    assert_eq!(table.machines(), ["here"]);
}
