//! Wavefront OBJ: `v` and `f` lines; everything else (normals, groups, materials, curves) is passed over.

use super::mesh_file::{Charted, MeshFile, filled, position};
use super::polygons::{Faces, cut};
use crate::fault::{Fault, number, shown, words};
use std::borrow::Cow;

const AGAIN: &str = "export the mesh again";

/// Vertices with or without weight or colours; faces of three or more corners, with negative or positive indices.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile, Fault> {
    Ok(faces(bytes)?.0)
}

/// The mesh, and its faces as they stand in the file.
fn faces(bytes: &[u8]) -> Result<(MeshFile, Faces), Fault> {
    let mut mesh = MeshFile::default();
    let mut faces = Faces::default();
    let mut corners = Vec::new();
    let mut farthest = (0, 0);
    for (line, text) in lines(bytes) {
        let mut words = words(&text);
        match words.next() {
            Some(b"v") => mesh.positions.push(position(words, line, "vertex")?),
            Some(b"f") => {
                corners.clear();
                for word in words {
                    corners.push(
                        corner(word, mesh.positions.len())
                            .map_err(|problem| Fault::line(line, problem, AGAIN))?,
                    );
                }
                if corners.len() < 3 {
                    let problem =
                        format!("a face with {} corners, expected 3 or more", corners.len());
                    return Err(Fault::line(
                        line,
                        problem,
                        "delete loose edges and export again",
                    ));
                }
                let last = corners.iter().copied().max().unwrap_or(0);
                farthest = farthest.max((last, line));
                faces.push(&corners);
            }
            _ => {}
        }
    }
    let (last, line) = farthest;
    if line > 0 && last as usize >= mesh.positions.len() {
        let problem = format!(
            "a face uses vertex {}, the file has {}",
            u64::from(last) + 1,
            mesh.positions.len()
        );
        return Err(Fault::line(line, problem, AGAIN));
    }
    mesh.triangles = faces.triangles(&mesh.positions);
    Ok((mesh, faces))
}

/// The same with the texture coordinates (`vt`) of every corner.
pub(super) fn parse_charts(bytes: &[u8]) -> Result<Charted, Fault> {
    let (mesh, faces) = faces(bytes)?;
    let mesh = filled(mesh)?;
    let mut faces = faces.iter();
    let (mut coordinates, mut charts) = (Vec::<[f64; 2]>::new(), Vec::new());
    for (line, text) in lines(bytes) {
        let mut words = words(&text);
        let again = |problem: String| Fault::line(line, problem, AGAIN);
        match words.next() {
            Some(b"vt") => {
                let mut next = || words.next().map_or(Ok(0.0), number).map_err(again);
                coordinates.push([next()?, next()?]);
            }
            Some(b"f") => {
                let corner = |word: &[u8]| {
                    let second = word.split(|&byte| byte == b'/').nth(1).unwrap_or_default();
                    let bare = || {
                        let problem = "a face has no texture coordinates".to_string();
                        Fault::line(line, problem, "unwrap the mesh and export it with UVs")
                    };
                    let at = match second.is_empty() {
                        true => return Err(bare()),
                        false => self::corner(second, coordinates.len()).map_err(again)?,
                    };
                    let found = coordinates.get(at as usize).copied();
                    found.ok_or_else(|| {
                        again(format!(
                            "a face uses texture coordinate {}, {} were read before it",
                            at + 1,
                            coordinates.len()
                        ))
                    })
                };
                let corners: Vec<[f64; 2]> = words.map(corner).collect::<Result<_, _>>()?;
                let face = faces.next().unwrap_or_default();
                let triangles = cut(face, &mesh.positions).into_iter();
                charts.extend(triangles.map(|triangle| triangle.map(|k| corners[k])));
            }
            _ => {}
        }
    }
    match mesh.triangles.is_empty() {
        true => Err(Fault::file(
            "it holds no faces".into(),
            "export the surface",
        )),
        false => Ok(Charted { mesh, charts }),
    }
}

/// Numbered lines (from 1) with comments cut off and lines that end in a backslash joined.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let mut physical = bytes.split(|&byte| byte == b'\n').zip(1..);
    std::iter::from_fn(move || {
        let (text, line) = physical.next()?;
        let mut text = Cow::Borrowed(content(text));
        while let Some(open) = text.strip_suffix(b"\\") {
            let mut joined = open.to_vec();
            joined.push(b' ');
            joined.extend_from_slice(physical.next().map_or(&[][..], |(next, _)| content(next)));
            text = Cow::Owned(joined);
        }
        Some((line, text))
    })
}

fn content(line: &[u8]) -> &[u8] {
    line.split(|&byte| byte == b'#')
        .next()
        .unwrap_or(line)
        .trim_ascii_end()
}

/// Vertex number from 0 of one corner (`7`, `7/1`, `7//3`, `-2/...`), `seen` vertices having been read.
fn corner(word: &[u8], seen: usize) -> Result<u32, String> {
    let first = word.split(|&byte| byte == b'/').next().unwrap_or(word);
    let index = std::str::from_utf8(first)
        .ok()
        .and_then(|text| text.parse::<i64>().ok());
    let Some(index) = index else {
        return Err(format!("{} is not a vertex number", shown(word)));
    };
    let from_zero = match index {
        0 => return Err("a face uses vertex 0, OBJ counts from 1".into()),
        1.. => index - 1,
        _ => seen as i64 + index,
    };
    u32::try_from(from_zero)
        .ok()
        .filter(|&index| index != u32::MAX)
        .ok_or_else(|| format!("a face uses vertex {index}, {seen} were read before it"))
}
