//! An input damaged: bytes and pieces, lines, numbers, parts of another input; in archives the members, packed again.

use crate::random::Random;
use std::io::{Cursor, Read, Write};

/// Numbers at the ends of what types hold.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "1e999",
    "65536",
    "2147483648",
    "4294967295",
    "9223372036854775808",
    "18446744073709551616",
    "1,000",
    "0x10",
    "1e",
    ".",
    "-",
    "+5",
    "inf",
    "NaN",
];
/// Most that a member is unpacked to, bytes.
const MOST_UNPACKED: u64 = 1 << 20;

/// One of the inputs, damaged.
pub fn damaged(corpus: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let input = &corpus[random.below(corpus.len())];
    let other = &corpus[random.below(corpus.len())];
    let is_archive = input.starts_with(b"PK\x03\x04");
    if is_archive
        && random.below(4) > 0
        && let Some(packed) = in_members(input, other, random)
    {
        return packed;
    }
    let mut bytes = input.clone();
    plain(&mut bytes, other, random);
    bytes
}

fn plain(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..=random.below(2) {
        match random.below(9) {
            0 => random.damage(bytes),
            2 => lines(bytes, random),
            1 | 3 => number(bytes, random),
            4 => splice(bytes, other, random),
            5 => field(bytes, random),
            6 => {
                for _ in 0..random.below(8) {
                    let at = random.below(bytes.len());
                    if let Some(byte) = bytes.get_mut(at) {
                        *byte ^= 1 << random.below(8);
                    }
                }
            }
            _ => word(bytes, random),
        }
    }
}

/// A line doubled many times, moved, or taken out.
fn lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut all: Vec<Vec<u8>> = bytes
        .split(|byte| *byte == b'\n')
        .map(<[u8]>::to_vec)
        .collect();
    let (at, to) = (random.below(all.len()), random.below(all.len()));
    match random.below(4) {
        0 => drop(all.remove(at)),
        1 => all.swap(at, to),
        2 => all.insert(to, all[at].clone()),
        _ => {
            let copies = vec![all[at].clone(); 1 << random.below(8)];
            drop(all.splice(to..to, copies));
        }
    }
    *bytes = all.join(&b'\n');
}

/// A number put for another.
fn number(bytes: &mut Vec<u8>, random: &mut Random) {
    let from = random.below(bytes.len());
    let is_part = |byte: &u8| byte.is_ascii_digit() || b".-+eE".contains(byte);
    let Some(start) = bytes[from..].iter().position(u8::is_ascii_digit) else {
        return;
    };
    let start = from + start;
    let length = bytes[start..]
        .iter()
        .take_while(|byte| is_part(byte))
        .count();
    let new = NUMBERS[random.below(NUMBERS.len())].bytes();
    drop(bytes.splice(start..start + length, new));
}

/// A part of another input.
fn splice(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let (a, b) = (random.below(other.len() + 1), random.below(other.len() + 1));
    let part = other[a.min(b)..a.max(b)]
        .iter()
        .take(1 << random.below(13))
        .copied();
    let at = random.below(bytes.len() + 1);
    let until = (at + random.below(64)).min(bytes.len());
    drop(bytes.splice(at..until, part.collect::<Vec<_>>()));
}

/// A separator or a mark of text put for another.
fn field(bytes: &mut [u8], random: &mut Random) {
    const MARKS: &[u8] = b",;\t \"'[]()=:/#<>&.|\r\n\x0c\x00\xff\xb5\xb2";
    let new = MARKS[random.below(MARKS.len())];
    let from = random.below(bytes.len());
    if let Some(byte) = bytes[from..].iter_mut().find(|byte| MARKS.contains(byte)) {
        *byte = new;
    }
}

/// A word copied over another place.
fn word(bytes: &mut Vec<u8>, random: &mut Random) {
    let from = random.below(bytes.len());
    let is_part = |byte: &&u8| byte.is_ascii_alphanumeric() || **byte == b'_';
    let part: Vec<u8> = bytes[from..].iter().take_while(is_part).copied().collect();
    let at = random.below(bytes.len() + 1);
    drop(bytes.splice(at..at, part));
}

/// Members of an archive damaged, renamed, left out or doubled.
fn in_members(input: &[u8], other: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let mut members = unpacked(input)?;
    if members.is_empty() {
        return None;
    }
    for _ in 0..=random.below(3) {
        let at = random.below(members.len());
        match random.below(10) {
            0 => drop(members.remove(at)),
            1 => members[at].0 = members[random.below(members.len())].0.clone(),
            2 => {
                let mut name = members[at].0.clone().into_bytes();
                number(&mut name, random);
                members[at].0 = String::from_utf8_lossy(&name).into_owned();
            }
            3 => members[at].1 = members[random.below(members.len())].1.clone(),
            4 => {
                if let Some(more) = unpacked(other).filter(|more| !more.is_empty()) {
                    members.push(more[random.below(more.len())].clone());
                }
            }
            _ => {
                let (_, bytes) = &mut members[at];
                let other = bytes.clone();
                plain(bytes, &other, random);
            }
        }
        if members.is_empty() {
            return None;
        }
    }
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in &members {
        // A name that stands twice is refused by the writer: the second is left out.
        if writer
            .start_file(name.as_str(), zip::write::SimpleFileOptions::default())
            .is_ok()
        {
            writer.write_all(bytes).ok()?;
        }
    }
    Some(writer.finish().ok()?.into_inner())
}

fn unpacked(input: &[u8]) -> Option<Vec<(String, Vec<u8>)>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(input)).ok()?;
    let mut members = Vec::new();
    for k in 0..archive.len() {
        let member = archive.by_index(k).ok()?;
        let name = member.name().ok()?.to_string();
        let mut bytes = Vec::new();
        member.take(MOST_UNPACKED).read_to_end(&mut bytes).ok()?;
        members.push((name, bytes));
    }
    Some(members)
}
