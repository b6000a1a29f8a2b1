//! The values behind a PLY header, one after the other, from text or from bytes of either order.

use super::ply_header::{Encoding, Header, Scalar};
use crate::fault::{Fault, Place, number, shown};

const CUT: &str = "the file is cut short; export it again";

/// Walks over the values; knows where it stands for messages.
pub(super) struct Values<'a> {
    bytes: &'a [u8],
    encoding: Encoding,
    at: usize,
    line: usize,
    /// Where the last value began.
    last: Place,
}

impl<'a> Values<'a> {
    pub fn new(bytes: &'a [u8], header: &Header) -> Values<'a> {
        Values {
            bytes,
            encoding: header.encoding,
            at: header.bytes,
            line: header.lines + 1,
            last: Place::File,
        }
    }

    /// Bytes not yet walked over; every value still to come takes at least one.
    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The line, if more stands on it behind the value read last: rows of a text end with their line.
    pub fn unread_line(&self) -> Option<usize> {
        let mut rest = self.bytes[self.at..].iter();
        let next = rest.find(|byte| !matches!(byte, b' ' | b'\t'))?;
        let is_text = matches!(self.encoding, Encoding::Ascii);
        (is_text && !next.is_ascii_whitespace()).then_some(self.line)
    }

    /// A fault at the value read last.
    pub fn fault(&self, problem: String, remedy: &'static str) -> Fault {
        Fault::at(self.last, problem, remedy)
    }

    /// The next value as it is written, finite or not.
    pub fn next(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        match self.encoding {
            Encoding::Ascii => self.next_word(),
            Encoding::Little => self.next_bytes(scalar, |_| {}),
            Encoding::Big => self.next_bytes(scalar, <[u8]>::reverse),
        }
    }

    /// The next value as a count or index: whole and not negative.
    pub fn next_whole(&mut self, scalar: Scalar) -> Result<u32, Fault> {
        let value = self.next(scalar)?;
        if value < 0.0 || value.fract() != 0.0 || value >= f64::from(u32::MAX) {
            return Err(self.fault(
                format!("{value} is not a count or vertex number"),
                "export the mesh again",
            ));
        }
        Ok(value as u32)
    }

    fn next_word(&mut self) -> Result<f64, Fault> {
        while let Some(byte) = self
            .bytes
            .get(self.at)
            .filter(|byte| byte.is_ascii_whitespace())
        {
            self.line += usize::from(*byte == b'\n');
            self.at += 1;
        }
        self.last = Place::Line(self.line);
        let rest = &self.bytes[self.at..];
        let length = rest
            .iter()
            .position(|byte| byte.is_ascii_whitespace())
            .unwrap_or(rest.len());
        if length == 0 {
            return Err(self.fault("the file ends before its last value".into(), CUT));
        }
        self.at += length;
        number(&rest[..length]).map_err(|_| {
            let problem = format!("{} is not a finite number", shown(&rest[..length]));
            self.fault(problem, "export the mesh again")
        })
    }

    fn next_bytes(&mut self, scalar: Scalar, order: fn(&mut [u8])) -> Result<f64, Fault> {
        self.last = Place::Byte(self.at);
        let size = scalar.size();
        let Some(stored) = self.bytes.get(self.at..self.at + size) else {
            return Err(self.fault("the file ends before its last value".into(), CUT));
        };
        self.at += size;
        let mut raw = [0; 8];
        raw[..size].copy_from_slice(stored);
        order(&mut raw[..size]);
        Ok(value(scalar, raw))
    }
}

/// A number from its bytes, least significant first.
fn value(scalar: Scalar, raw: [u8; 8]) -> f64 {
    let [a, b, c, d, ..] = raw;
    match scalar {
        Scalar::I8 => f64::from(a as i8),
        Scalar::U8 => f64::from(a),
        Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
        Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
        Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
        Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
        Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        Scalar::F64 => f64::from_le_bytes(raw),
    }
}
