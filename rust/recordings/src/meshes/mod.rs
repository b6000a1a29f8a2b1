//! Mesh files (OBJ, PLY, STL) and point clouds to vertices and triangles; knows nothing of units: numbers come out as written.

mod cloud;
mod mesh_file;
mod obj;
mod ply;
mod ply_header;
mod ply_values;
mod polygons;
mod stl;
mod weld;

use crate::fault::Fault;
use crate::{RecordingError, plain_file};
use mesh_file::filled;
use std::path::Path;

pub use mesh_file::{Charted, MeshFile};

/// Largest mesh file that is read, bytes. A 500,000-triangle ASCII STL is about 130 MB.
pub const LARGEST_FILE: u64 = 2 << 30;

/// The mesh formats that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Polygon file format, ASCII or binary of either byte order.
    Ply,
    /// Stereolithography, ASCII or binary.
    Stl,
}

impl Format {
    /// The format that a file name's ending says.
    pub fn of(file: &Path) -> Option<Format> {
        match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Format::Obj),
            "ply" => Some(Format::Ply),
            "stl" => Some(Format::Stl),
            _ => None,
        }
    }
}

/// Reads a mesh file; the format follows from the name's ending.
///
/// # Errors
/// [`RecordingError`] if the file cannot be read, is larger than [`LARGEST_FILE`], breaks its format, holds a number
/// that is not finite, an index without a vertex, or no triangle.
pub fn read(file: &Path) -> Result<MeshFile, RecordingError> {
    let format = known(file, Format::of(file), "save it as .obj, .ply or .stl")?;
    let bytes = bytes_of(file)?;
    parse(&bytes, format).map_err(|fault| fault.in_file(file))
}

/// Reads the points of a scan: a mesh, a mesh file without faces, or a table of x, y, z (`.csv`, `.txt`, `.xyz`), whose columns
/// are `x_mm`, `y_mm`, `z_mm` or, without names, the first three.
///
/// # Errors
/// As [`read`], but for faces, which need not be there.
pub fn read_points(file: &Path) -> Result<MeshFile, RecordingError> {
    let ending = file.extension().and_then(|ending| ending.to_str());
    let is_table = ending.is_some_and(|ending| {
        ["csv", "txt", "xyz"].contains(&ending.to_ascii_lowercase().as_str())
    });
    let format = match is_table {
        true => None,
        false => Some(known(
            file,
            Format::of(file),
            "save it as .ply, .obj, .stl, .csv or .xyz",
        )?),
    };
    let bytes = bytes_of(file)?;
    let points = match format {
        Some(format) => points(&bytes, format),
        None => cloud::parse(&bytes).and_then(filled),
    };
    points.map_err(|fault| fault.in_file(file))
}

/// Reads an OBJ with the texture coordinates of every corner.
///
/// # Errors
/// As [`read`], and for a corner without texture coordinates or another format, which has none.
pub fn read_charts(file: &Path) -> Result<Charted, RecordingError> {
    let format = Format::of(file).filter(|format| *format == Format::Obj);
    known(file, format, "save it as .obj with UVs")?;
    let charted = obj::parse_charts(&bytes_of(file)?);
    charted.map_err(|fault| fault.in_file(file))
}

fn known<T>(file: &Path, format: Option<T>, remedy: &'static str) -> Result<T, RecordingError> {
    format.ok_or_else(|| {
        let found = file
            .extension()
            .map_or("no ending".into(), |e| format!(".{}", e.display()));
        let problem = format!("not a mesh format that is known ({found})");
        Fault::file(problem, remedy).in_file(file)
    })
}

fn bytes_of(file: &Path) -> Result<Vec<u8>, RecordingError> {
    plain_file::bytes(file, LARGEST_FILE, "decimate the mesh")
}

/// Reads a mesh from the bytes of a file that is called `file` in messages.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], format: Format, file: &Path) -> Result<MeshFile, RecordingError> {
    parse(bytes, format).map_err(|fault| fault.in_file(file))
}

/// A mesh with or without faces.
fn points(bytes: &[u8], format: Format) -> Result<MeshFile, Fault> {
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        let problem = "the text is saved as UTF-16".to_string();
        return Err(Fault::line(1, problem, "save it as UTF-8"));
    }
    filled(match format {
        Format::Obj => obj::parse(bytes)?,
        Format::Ply => ply::parse(bytes)?,
        Format::Stl => stl::parse(bytes)?,
    })
}

fn parse(bytes: &[u8], format: Format) -> Result<MeshFile, Fault> {
    let mesh = points(bytes, format)?;
    if mesh.triangles.is_empty() {
        return Err(Fault::file(
            "it holds no faces".into(),
            "export the surface, not a point cloud or curve",
        ));
    }
    Ok(mesh)
}
