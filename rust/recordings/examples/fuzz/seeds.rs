//! Where the damage begins: small files of every format, and the heads of the real ones that lie next to the repository.

use crate::{exports, inked};
use image::{DynamicImage, ImageFormat};
use std::path::{Path, PathBuf};

/// Longest part of a real text that is taken, bytes.
const HEAD: usize = 6_000;
/// Largest archive that is taken, bytes.
const LARGEST: usize = 40_000;

pub const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nv 0.3 0.4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\nf -5/1 -4/2 -1/3\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0 255\n1 0 0 0\n1 1 0 9\n0 1 0 7\n3 0 1 2\n4 0 1 2 3\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
const CLOUD: &str = "x_mm,y_mm,z_mm\n0,0,0\n1,0,0.5\n2,1e-3,0\n";

/// Measurement files.
pub fn recordings() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = exports::texts()
        .into_iter()
        .map(|(_, bytes)| bytes)
        .collect();
    all.extend([exports::jpk_archive(), exports::workbook()]);
    for folder in ["recordings", "trouble", "studies/pad_1"] {
        for file in files(&shared().join(folder)) {
            let is_mesh = ["obj", "stl", "ply", "npz", "py", "toml"]
                .iter()
                .any(|ending| file.extension().is_some_and(|found| found == *ending));
            if !is_mesh {
                all.extend(part(&file));
            }
        }
    }
    all
}

pub fn meshes() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = [OBJ, PLY, STL, CLOUD]
        .map(|text| text.as_bytes().to_vec())
        .into();
    for is_big in [false, true] {
        let header = PLY.split_inclusive("end_header\n").next().unwrap();
        let order = if is_big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let mut bytes = header.replace("ascii", order).into_bytes();
        bytes.extend([0_u8; 4 * 17]);
        bytes.extend([
            3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3,
        ]);
        all.push(bytes);
    }
    let mut binary = vec![b' '; 80];
    binary.extend(2_u32.to_le_bytes());
    for k in 0..24_u8 {
        binary.extend(f32::from(k % 5).to_le_bytes());
        if k % 12 == 11 {
            binary.extend([0, 0]);
        }
    }
    all.push(binary);
    for file in files(&shared().join("trouble")) {
        if file
            .extension()
            .is_some_and(|ending| ending == "obj" || ending == "stl")
        {
            all.extend(part(&file));
        }
    }
    all
}

pub fn images() -> Vec<Vec<u8>> {
    let small = image::imageops::thumbnail(&inked::drawn(30, 220), 48, 32);
    let gray = DynamicImage::ImageLuma8(small);
    let shades = [
        gray.clone(),
        DynamicImage::ImageRgba8(gray.to_rgba8()),
        DynamicImage::ImageLuma16(gray.to_luma16()),
    ];
    let mut all = Vec::new();
    for image in &shades {
        all.push(inked::bytes(image, ImageFormat::Png));
        all.push(inked::bytes(image, ImageFormat::Tiff));
    }
    all.push(inked::bytes(&gray, ImageFormat::Jpeg));
    all
}

fn shared() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared")
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    let Ok(entries) = std::fs::read_dir(folder) else {
        return all;
    };
    for entry in entries.flatten() {
        match entry.path() {
            path if path.is_dir() => all.extend(files(&path)),
            path => all.push(path),
        }
    }
    all.sort();
    all
}

/// The whole of an archive that is small, the head of a text.
fn part(file: &Path) -> Option<Vec<u8>> {
    let mut bytes = std::fs::read(file).ok()?;
    let is_text = !bytes.starts_with(b"PK");
    if !is_text && bytes.len() > LARGEST {
        return None;
    }
    if is_text && bytes.len() > HEAD {
        let end = bytes[..HEAD].iter().rposition(|byte| *byte == b'\n');
        bytes.truncate(end.map_or(HEAD, |end| end + 1));
    }
    Some(bytes)
}
