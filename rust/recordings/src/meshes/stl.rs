//! STL, ASCII and binary. Normals and attributes are passed over; equal corners become one vertex.

use super::mesh_file::{MeshFile, position};
use super::weld::Weld;
use crate::fault::{Fault, Place, shown, words};
use nalgebra::Vector3;

const HEADER: usize = 84;
const FACET: usize = 50;
const AGAIN: &str = "export the mesh again";

/// What exporters write in place of a count that they do not know.
const NO_COUNT: [usize; 2] = [0, u32::MAX as usize];
/// So many bytes without a zero are text.
const TEXT: usize = 1024;
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Binary if the length fits the count in the header, else ASCII if it begins with `solid`, else binary by the length where the count is one
/// that says nothing, or where more bytes follow than it needs.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let declared = bytes
        .get(80..HEADER)
        .map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize);
    if declared.is_some_and(|count| length(count, FACET) == Some(bytes.len())) {
        return binary(&bytes[HEADER..], FACET);
    }
    let first = bytes.trim_ascii_start().get(..5);
    let is_solid = first.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    // Binary files may begin with that word too.
    let is_text = !bytes[..bytes.len().min(TEXT)].contains(&0);
    if is_solid && (is_text || bytes.len() < HEADER + FACET) {
        return ascii(bytes);
    }
    let Some(count) = declared else {
        let problem = format!("{} bytes are too few for an STL file", bytes.len());
        return Err(Fault::at(Place::Byte(bytes.len()), problem, AGAIN));
    };
    let (facets, left) = (
        (bytes.len() - HEADER) / FACET,
        (bytes.len() - HEADER) % FACET,
    );
    if NO_COUNT.contains(&count) && facets > 0 {
        let note = format!(
            "the STL's header counts {count} triangles; all {facets} that the file has room for are read"
        );
        return noted(binary(&bytes[HEADER..bytes.len() - left], FACET)?, note);
    }
    // Attribute bytes behind each facet, as many as its last two bytes say.
    let payload = bytes.get(HEADER + 48..HEADER + FACET);
    let stride = FACET + payload.map_or(0, |size| u16::from_le_bytes([size[0], size[1]]) as usize);
    if stride > FACET && length(count, stride) == Some(bytes.len()) {
        return binary(&bytes[HEADER..], stride);
    }
    match length(count, FACET) {
        Some(needed) if needed < bytes.len() => {
            let note = format!(
                "{} bytes behind the STL's {count} triangles are passed over",
                bytes.len() - needed
            );
            noted(binary(&bytes[HEADER..needed], FACET)?, note)
        }
        _ => Err(Fault::at(
            Place::Byte(80),
            format!("the header counts {count} triangles, the file has room for {facets}"),
            "the file is cut short or not an STL; export it again",
        )),
    }
}

/// Length of a file of so many facets of `stride` bytes, if a file can be so long.
fn length(facets: usize, stride: usize) -> Option<usize> {
    facets.checked_mul(stride)?.checked_add(HEADER)
}

fn noted(mesh: MeshFile, note: String) -> Result<MeshFile, Fault> {
    Ok(MeshFile {
        notes: vec![note],
        ..mesh
    })
}

/// Facets of `stride` bytes each, which begin behind the header.
fn binary(bytes: &[u8], stride: usize) -> Result<MeshFile, Fault> {
    let mut weld = Weld::default();
    let mut triangles = Vec::with_capacity(bytes.len() / stride);
    for (facet, start) in bytes.chunks_exact(stride).zip((HEADER..).step_by(stride)) {
        let mut triangle = [0; 3];
        for (corner, number) in triangle.iter_mut().enumerate() {
            let offset = 12 + 12 * corner;
            let axis = |axis: usize| {
                let at = offset + 4 * axis;
                f64::from(f32::from_le_bytes([
                    facet[at],
                    facet[at + 1],
                    facet[at + 2],
                    facet[at + 3],
                ]))
            };
            let position = Vector3::new(axis(0), axis(1), axis(2));
            if !position.iter().all(|value| value.is_finite()) {
                let problem = format!(
                    "corner {} of triangle {} is not finite",
                    corner + 1,
                    triangles.len()
                );
                return Err(Fault::at(Place::Byte(start + offset), problem, AGAIN));
            }
            *number = weld.number(position).ok_or_else(too_many)?;
        }
        triangles.push(triangle);
    }
    Ok(MeshFile {
        positions: weld.positions,
        triangles,
        notes: Vec::new(),
    })
}

fn ascii(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let mut weld = Weld::default();
    let mut triangles = Vec::new();
    let mut corners = Vec::with_capacity(3);
    let mut open = None;
    for (text, line) in bytes.split(|&byte| byte == b'\n').zip(1..) {
        let mut words = words(text);
        let Some(first) = words.next() else { continue };
        if first.eq_ignore_ascii_case(b"facet") {
            if open.is_some() {
                return Err(Fault::line(
                    line,
                    "a facet begins before the last one ended".into(),
                    AGAIN,
                ));
            }
            open = Some(line);
        } else if first.eq_ignore_ascii_case(b"vertex") {
            let position = position(words, line, "corner")?;
            corners.push(weld.number(position).ok_or_else(too_many)?);
        } else if first.eq_ignore_ascii_case(b"endfacet") {
            let [a, b, c] = corners[..] else {
                return Err(Fault::line(
                    line,
                    format!("a facet with {} corners, expected 3", corners.len()),
                    AGAIN,
                ));
            };
            triangles.push([a, b, c]);
            corners.clear();
            open = None;
        } else if ![&b"solid"[..], b"outer", b"endloop", b"endsolid"]
            .iter()
            .any(|known| first.eq_ignore_ascii_case(known))
            && open.is_some()
        {
            return Err(Fault::line(
                line,
                format!("{} is not a word of an STL facet", shown(first)),
                AGAIN,
            ));
        }
    }
    if let Some(line) = open {
        return Err(Fault::line(
            line,
            "a facet that does not end".into(),
            "the file is cut short; export it again",
        ));
    }
    Ok(MeshFile {
        positions: weld.positions,
        triangles,
        notes: Vec::new(),
    })
}

fn too_many() -> Fault {
    Fault::file(
        "it holds more vertices than can be numbered".into(),
        "decimate the mesh",
    )
}
