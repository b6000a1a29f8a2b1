//! Random numbers from a seed, and damage that misleads readers.
#![allow(dead_code)]

/// Pieces that mislead readers.
const PIECES: &[&[u8]] = &[
    b"nan",
    b"1e999",
    b"-1",
    b"99999999999999999999",
    b",",
    b"\t",
    b"\n",
    b"\r",
    b"\xff",
    b"\x00",
    b"Frame ",
    b"SENSOR,",
    b"Rows,4096\n",
    b"ROWS 4096\n",
    b"time[secs]",
    b"Force",
    b"#",
    b"\"",
    b";",
    b"B",
    b"0",
    b"4294967296",
    b"1,5",
    b"@@",
];

/// SplitMix64 (Steele, Lea & Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// Bytes changed, a piece put in, a part cut out, doubled or moved.
    pub fn damage(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(4) {
            let (at, other) = (self.below(bytes.len() + 1), self.below(bytes.len() + 1));
            let (start, end) = (at.min(other), at.max(other));
            match self.below(6) {
                0 if at < bytes.len() => bytes[at] = self.next() as u8,
                1 => drop(bytes.splice(at..at, PIECES[self.below(PIECES.len())].iter().copied())),
                2 => drop(bytes.drain(start..end.min(start + 40))),
                3 => {
                    let part = bytes[start..end.min(start + 200)].to_vec();
                    drop(bytes.splice(at..at, part));
                }
                4 => bytes.truncate(at.max(bytes.len() / 2)),
                _ => {
                    let digit = b"0123456789.,-e"[self.below(14)];
                    if let Some(byte) = bytes[start..].iter_mut().find(|byte| byte.is_ascii_digit())
                    {
                        *byte = digit;
                    }
                }
            }
        }
    }
}
