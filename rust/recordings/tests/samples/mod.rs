//! A square in every format, and readers that give messages.
#![allow(clippy::unwrap_used)]

use nalgebra::Vector3;
use std::path::Path;
use thenar_recordings::meshes::{Format, MeshFile, read_bytes};

pub const SQUARE: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [2.0, 0.0, 0.0],
    [2.0, 1.0, 0.5],
    [0.0, 1.0, 0.5],
];
pub const HALVES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

pub fn square() -> MeshFile {
    MeshFile {
        positions: SQUARE.map(Vector3::from).to_vec(),
        triangles: HALVES.to_vec(),
        notes: Vec::new(),
    }
}

pub fn obj(text: &str) -> Result<MeshFile, String> {
    read_bytes(text.as_bytes(), Format::Obj, Path::new("a.obj")).map_err(|error| error.to_string())
}

pub fn ply(bytes: &[u8]) -> Result<MeshFile, String> {
    read_bytes(bytes, Format::Ply, Path::new("a.ply")).map_err(|error| error.to_string())
}

pub fn stl(bytes: &[u8]) -> Result<MeshFile, String> {
    read_bytes(bytes, Format::Stl, Path::new("a.stl")).map_err(|error| error.to_string())
}

pub fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment none\nelement vertex 4\nproperty uchar red\nproperty double x\n\
         property float y\nproperty float z\nelement edge 1\nproperty short a\nproperty list uchar int b\n\
         element face 1\nproperty list uchar uint vertex_indices\nproperty float quality\nend_header\n"
    )
    .into_bytes();
    let f32s = |value: f64| {
        if big {
            (value as f32).to_be_bytes()
        } else {
            (value as f32).to_le_bytes()
        }
    };
    for [x, y, z] in SQUARE {
        bytes.push(7);
        bytes.extend(if big {
            x.to_be_bytes()
        } else {
            x.to_le_bytes()
        });
        bytes.extend(f32s(y));
        bytes.extend(f32s(z));
    }
    bytes.extend([0, 9, 1, 1, 2, 3, 4]);
    bytes.push(4);
    for index in 0..4u32 {
        bytes.extend(if big {
            index.to_be_bytes()
        } else {
            index.to_le_bytes()
        });
    }
    bytes.extend(f32s(0.25));
    bytes
}

pub const ASCII_PLY: &str = "ply\r\nformat ascii 1.0\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n\
    element face 1\r\nproperty list uchar int vertex_index\r\nend_header\r\n0 0 0\r\n2 0 0\r\n2 1 0.5\r\n0 1 0.5\r\n4 0 1 2 3\r\n";

pub fn binary_stl(mesh: &MeshFile) -> Vec<u8> {
    let mut bytes = b"solid but binary all the same".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        bytes.extend([0; 12]);
        for corner in triangle {
            bytes.extend(
                mesh.positions[*corner as usize]
                    .iter()
                    .flat_map(|value| (*value as f32).to_le_bytes()),
            );
        }
        bytes.extend([0; 2]);
    }
    bytes
}

pub fn ascii_stl(mesh: &MeshFile) -> String {
    let mut text = "solid square\n".to_string();
    for triangle in &mesh.triangles {
        text += "  facet normal 0 0 1\n    outer loop\n";
        for corner in triangle {
            let p = mesh.positions[*corner as usize];
            text += &format!("      vertex {:e} {} -0\n", p.x, p.y)
                .replace("-0\n", &format!("{}\n", p.z));
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid square\n"
}
