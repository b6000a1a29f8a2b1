//! Text files as numbered lines, one at a time: any line end, UTF-8 (with or without a mark) or Windows-1252.

use crate::fault::Fault;
use std::io::{BufRead, ErrorKind};

/// Longest line that is read, bytes. A frame of 10,000 sensels on one line takes 80 kB.
pub(crate) const LONGEST_LINE: usize = 1 << 20;

/// One line without its end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line<'a> {
    /// From 1, as an editor counts.
    pub number: usize,
    pub text: &'a str,
}

impl Line<'_> {
    pub fn fault(&self, problem: String, remedy: &'static str) -> Fault {
        Fault::line(self.number, problem, remedy)
    }
}

/// The lines of a file; holds one of them at a time.
///
/// A line ends with LF, CR LF or CR; a CR after LF, and a CR before CR LF, are passed over (both come out of instruments
/// and of programs that translated line ends twice). Empty lines of a file with CR alone are not counted.
pub(crate) struct Lines<'a> {
    source: Box<dyn BufRead + 'a>,
    bytes: Vec<u8>,
    decoded: String,
    number: usize,
    follows_feed: bool,
    is_held: bool,
    has_end: bool,
}

impl<'a> Lines<'a> {
    pub fn new(source: impl BufRead + 'a) -> Lines<'a> {
        Lines {
            source: Box::new(source),
            bytes: Vec::new(),
            decoded: String::new(),
            number: 0,
            follows_feed: false,
            is_held: false,
            has_end: true,
        }
    }

    /// The next line; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<Line<'_>>, Fault> {
        if !std::mem::take(&mut self.is_held) {
            if !self.fill()? {
                return Ok(None);
            }
            self.number += 1;
            if self.number == 1 && self.bytes.starts_with(b"\xEF\xBB\xBF") {
                self.bytes.drain(..3);
            }
        }
        let number = self.number;
        let text = match std::str::from_utf8(&self.bytes) {
            Ok(text) => text,
            Err(_) => {
                let (text, _) = encoding_rs::WINDOWS_1252.decode_without_bom_handling(&self.bytes);
                self.decoded = text.into_owned();
                &self.decoded
            }
        };
        Ok(Some(Line { number, text }))
    }

    /// The next line that holds more than blanks and `padding`.
    pub fn next_filled(&mut self, padding: &[char]) -> Result<Option<Line<'_>>, Fault> {
        loop {
            let is_empty = match self.next()? {
                None => return Ok(None),
                Some(line) => line
                    .text
                    .chars()
                    .all(|c| c.is_whitespace() || padding.contains(&c)),
            };
            if !is_empty {
                self.hold();
                return self.next();
            }
        }
    }

    /// Gives the last line again at the next call.
    pub fn hold(&mut self) {
        self.is_held = true;
    }

    /// Number of the last line that was given.
    pub fn number(&self) -> usize {
        self.number
    }

    /// Whether the last line that was given ended with a line end; the last of a file that is cut off within it does not.
    pub fn has_end(&self) -> bool {
        self.has_end
    }

    /// The fault of a file that ends although `missing` should follow.
    pub fn ended(&self, missing: &str) -> Fault {
        Fault::line(
            self.number.max(1),
            format!("the file ends where {missing} should follow"),
            "it is cut short; export it again",
        )
    }

    /// Reads the bytes of the next line; false at the end of the file.
    fn fill(&mut self) -> Result<bool, Fault> {
        self.bytes.clear();
        let mut has_begun = false;
        loop {
            let Some(next) = waiting(self.source.as_mut(), self.number + 1)? else {
                self.has_end = !has_begun;
                return Ok(has_begun);
            };
            (has_begun, self.has_end) = (true, true);
            let end = memchr::memchr2(b'\n', b'\r', next);
            let (taken, found) = (end.unwrap_or(next.len()), end.map(|at| next[at]));
            self.bytes.extend_from_slice(&next[..taken]);
            self.source.consume(taken + usize::from(found.is_some()));
            if self.bytes.len() > LONGEST_LINE {
                let problem = format!("the line is longer than {LONGEST_LINE} bytes");
                return Err(Fault::line(
                    self.number + 1,
                    problem,
                    "this is not an export as text; export it again",
                ));
            }
            match found {
                Some(b'\n') => {
                    self.follows_feed = true;
                    return Ok(true);
                }
                Some(_) => {
                    if self.feed_follows()? {
                        self.follows_feed = true;
                        return Ok(true);
                    }
                    let is_stray = self.bytes.is_empty() && self.follows_feed;
                    self.follows_feed = false;
                    if !is_stray {
                        return Ok(true);
                    }
                }
                None => {}
            }
        }
    }

    /// After a CR: passes over more of them and over the LF that belongs to them.
    fn feed_follows(&mut self) -> Result<bool, Fault> {
        loop {
            let byte = waiting(self.source.as_mut(), self.number + 1)?.map(|chunk| chunk[0]);
            match byte {
                Some(b'\r') => self.source.consume(1),
                Some(b'\n') => {
                    self.source.consume(1);
                    return Ok(true);
                }
                _ => return Ok(false),
            }
        }
    }
}

/// Bytes that wait, at least one; `None` at the end of the file.
fn waiting(source: &mut dyn BufRead, line: usize) -> Result<Option<&[u8]>, Fault> {
    while let Err(error) = source.fill_buf() {
        if error.kind() != ErrorKind::Interrupted {
            let problem = format!("reading stopped ({error})");
            return Err(Fault::line(
                line,
                problem,
                "check the disk and copy the file again",
            ));
        }
    }
    let chunk = source.fill_buf().unwrap_or(&[]);
    Ok((!chunk.is_empty()).then_some(chunk))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn all(bytes: &[u8]) -> Vec<(usize, String)> {
        let mut lines = Lines::new(std::io::BufReader::with_capacity(2, bytes));
        let mut found = Vec::new();
        while let Some(line) = lines.next().unwrap() {
            found.push((line.number, line.text.to_string()));
        }
        found
    }

    fn numbered(texts: &[&str]) -> Vec<(usize, String)> {
        (1..)
            .zip(texts.iter().map(|text| text.to_string()))
            .collect()
    }

    #[test]
    fn every_line_end_is_one() {
        for end in ["\n", "\r\n", "\n\r", "\r\r\n"] {
            let text = ["a", "", "b"].join(end);
            assert_eq!(all(text.as_bytes()), numbered(&["a", "", "b"]), "{end:?}");
        }
        assert_eq!(all(b"a\rb\r\rc"), numbered(&["a", "b", "c"]));
        assert_eq!(all(b"a\r\n\rb\nc\r"), numbered(&["a", "b", "c"]));
        assert_eq!(all(b""), []);
    }

    #[test]
    fn marks_and_latin_letters_are_decoded() {
        assert_eq!(
            all(b"\xEF\xBB\xBFcm\xC2\xB2\ncm\xB2 \xB5m"),
            numbered(&["cm²", "cm² µm"])
        );
    }

    #[test]
    fn an_endless_line_is_refused_without_holding_it() {
        let fault = Lines::new(std::io::BufReader::new(std::io::repeat(b'x')))
            .next()
            .unwrap_err();
        assert!(format!("{fault:?}").contains("longer than 1048576 bytes"));
    }
}
