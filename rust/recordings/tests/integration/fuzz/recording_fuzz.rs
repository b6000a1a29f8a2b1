//! 120,000 damaged exports over all readers: a recording that keeps its promises or one sentence, never a panic.

use crate::exports;
use crate::promises;
use crate::random;

use exports::*;
use random::Random;

/// Damaged files per format of text, and per archive.
const TEXTS: usize = 8_000;
const ARCHIVES: usize = 4_000;

/// Reads damaged copies of a file and counts those that were read.
fn survive(name: &str, bytes: &[u8], count: usize) -> usize {
    let mut random = Random(
        name.bytes()
            .fold(1, |seed, byte| seed * 31 + u64::from(byte)),
    );
    let mut read = 0;
    for _ in 0..count {
        let mut damaged = bytes.to_vec();
        random.damage(&mut damaged);
        match export(&damaged) {
            Ok(file) => {
                promises::of_recording(&file);
                read += 1;
            }
            Err(message) => {
                let is_sentence = message.starts_with("a.txt")
                    && message.contains("; ")
                    && !message.contains(['\n', '\r']);
                assert!(is_sentence && message.len() < 500, "{name}: {message:?}");
            }
        }
    }
    read
}

#[test]
fn damaged_texts_are_read_or_refused() {
    for (name, bytes) in texts() {
        let read = survive(name, &bytes, TEXTS);
        assert!(
            (TEXTS / 50..TEXTS - TEXTS / 50).contains(&read),
            "{name}: {read} of {TEXTS} were read, the damage proves little"
        );
    }
}

#[test]
fn damaged_archives_are_read_or_refused() {
    let read = survive("jpk archive", &jpk_archive(), ARCHIVES)
        + survive("workbook", &workbook(), ARCHIVES);
    assert!(read < 2 * ARCHIVES);
}

/// Damage inside the members, which the checksums of the archive do not hide.
#[test]
fn damaged_members_are_read_or_refused() {
    let mut random = Random(7);
    for bytes in [jpk_archive(), workbook()] {
        let mut members = Vec::new();
        let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
        for k in 0..archive.len() {
            let mut member = archive.by_index(k).unwrap();
            let mut contents = Vec::new();
            std::io::Read::read_to_end(&mut member, &mut contents).unwrap();
            members.push((member.name().unwrap().to_string(), contents));
        }
        for _ in 0..ARCHIVES {
            let mut changed = members.clone();
            let at = random.below(changed.len());
            random.damage(&mut changed[at].1);
            let parts: Vec<(&str, &[u8])> = changed
                .iter()
                .map(|(name, bytes)| (name.as_str(), bytes.as_slice()))
                .collect();
            if let Ok(file) = export(&zipped(&parts)) {
                promises::of_recording(&file);
            }
        }
    }
}

#[test]
fn bytes_at_random_are_refused() {
    let mut random = Random(3);
    for _ in 0..8_000 {
        let length = random.below(400);
        let bytes: Vec<u8> = (0..length).map(|_| random.next() as u8).collect();
        let message = export(&bytes).unwrap_err();
        assert!(
            message.starts_with("a.txt") && !message.contains(['\n', '\r']),
            "{message:?}"
        );
    }
}
