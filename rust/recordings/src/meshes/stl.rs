//! STL, ASCII and binary. Normals and attributes are passed over; equal corners become one vertex.

use super::weld::Weld;
use super::{MeshFile, position};
use crate::fault::{Fault, Place, shown, words};
use nalgebra::Vector3;

const HEADER: usize = 84;
const FACET: usize = 50;
const AGAIN: &str = "export the mesh again";

/// Binary if the length fits the count in the header, else ASCII if it begins with `solid`.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let declared = bytes
        .get(80..HEADER)
        .map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize);
    let fits = declared.is_some_and(|count| {
        count
            .checked_mul(FACET)
            .and_then(|size| size.checked_add(HEADER))
            == Some(bytes.len())
    });
    if fits {
        return binary(bytes);
    }
    if bytes
        .trim_ascii_start()
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
    {
        return ascii(bytes);
    }
    let Some(count) = declared else {
        let problem = format!("{} bytes are too few for an STL file", bytes.len());
        return Err(Fault::at(Place::Byte(bytes.len()), problem, AGAIN));
    };
    let whole = (bytes.len() - HEADER) / FACET;
    let problem = format!("the header counts {count} triangles, the file has room for {whole}");
    Err(Fault::at(
        Place::Byte(80),
        problem,
        "the file is cut short or not an STL; export it again",
    ))
}

fn binary(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let mut weld = Weld::default();
    let mut triangles = Vec::with_capacity((bytes.len() - HEADER) / FACET);
    for (facet, start) in bytes[HEADER..]
        .chunks_exact(FACET)
        .zip((HEADER..).step_by(FACET))
    {
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
    })
}

fn too_many() -> Fault {
    Fault::file(
        "it holds more vertices than can be numbered".into(),
        "decimate the mesh",
    )
}
