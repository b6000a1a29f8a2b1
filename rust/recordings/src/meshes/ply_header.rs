//! The header of a PLY file: encoding, elements, properties.

use crate::fault::{Fault, shown, words};

const AGAIN: &str = "export the mesh again";

/// How the values behind the header are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// Type of one stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub name: Vec<u8>,
    /// Type of the count, for a list.
    pub count: Option<Scalar>,
    pub item: Scalar,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub name: Vec<u8>,
    pub count: usize,
    pub properties: Vec<Property>,
    /// Line of the header that declares it.
    pub line: usize,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Bytes and lines that the header takes.
    pub bytes: usize,
    pub lines: usize,
}

impl Scalar {
    fn named(word: &[u8]) -> Option<Scalar> {
        Some(match word {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }
}

/// Reads up to and with `end_header`.
pub(super) fn parse(bytes: &[u8]) -> Result<Header, Fault> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let (mut start, mut line) = (0, 0);
    loop {
        line += 1;
        let Some(length) = bytes[start..].iter().position(|&byte| byte == b'\n') else {
            return Err(Fault::line(
                line,
                "the header does not end with end_header".into(),
                AGAIN,
            ));
        };
        let text = &bytes[start..start + length];
        start += length + 1;
        let mut words = words(text);
        let first = words.next();
        if line == 1 {
            if first != Some(b"ply") {
                return Err(Fault::line(
                    1,
                    "the file does not begin with 'ply'".into(),
                    "check that it is a PLY file",
                ));
            }
            continue;
        }
        match first {
            Some(b"format") => encoding = Some(encoding_of(words.next(), line)?),
            Some(b"element") => elements.push(element(words.next(), words.next(), line)?),
            Some(b"property") => {
                let Some(element) = elements.last_mut() else {
                    return Err(Fault::line(
                        line,
                        "a property before the first element".into(),
                        AGAIN,
                    ));
                };
                element.properties.push(property(words, line)?);
            }
            Some(b"end_header") => {
                let encoding = encoding
                    .ok_or_else(|| Fault::line(line, "the header names no format".into(), AGAIN))?;
                return Ok(Header {
                    encoding,
                    elements,
                    bytes: start,
                    lines: line,
                });
            }
            Some(b"comment" | b"obj_info") | None => {}
            Some(other) => {
                return Err(Fault::line(
                    line,
                    format!("{} is not a word of a PLY header", shown(other)),
                    AGAIN,
                ));
            }
        }
    }
}

fn encoding_of(word: Option<&[u8]>, line: usize) -> Result<Encoding, Fault> {
    match word {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::Little),
        Some(b"binary_big_endian") => Ok(Encoding::Big),
        other => {
            let problem = format!("{} is not a PLY format", shown(other.unwrap_or_default()));
            Err(Fault::line(
                line,
                problem,
                "save it as ascii, binary_little_endian or binary_big_endian",
            ))
        }
    }
}

fn element(name: Option<&[u8]>, count: Option<&[u8]>, line: usize) -> Result<Element, Fault> {
    let counted = count
        .and_then(|word| std::str::from_utf8(word).ok())
        .and_then(|text| text.parse().ok());
    let (Some(name), Some(count)) = (name, counted) else {
        let problem = format!(
            "{} is not a count of elements",
            shown(count.unwrap_or_default())
        );
        return Err(Fault::line(line, problem, AGAIN));
    };
    Ok(Element {
        name: name.to_vec(),
        count,
        properties: Vec::new(),
        line,
    })
}

fn property<'a>(mut words: impl Iterator<Item = &'a [u8]>, line: usize) -> Result<Property, Fault> {
    let scalar = |word: Option<&[u8]>| {
        let word = word.unwrap_or_default();
        Scalar::named(word)
            .ok_or_else(|| Fault::line(line, format!("{} is not a PLY type", shown(word)), AGAIN))
    };
    let first = words.next();
    let (count, item) = if first == Some(b"list") {
        (Some(scalar(words.next())?), scalar(words.next())?)
    } else {
        (None, scalar(first)?)
    };
    let name = words
        .next()
        .ok_or_else(|| Fault::line(line, "a property without a name".into(), AGAIN))?;
    Ok(Property {
        name: name.to_vec(),
        count,
        item,
    })
}
