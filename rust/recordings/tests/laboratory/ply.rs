//! Rows of a PLY text against what its header says of them.

use std::path::Path;
use thenar_recordings::meshes::{Format, MeshFile, read_bytes};

fn ply(bytes: &[u8]) -> Result<MeshFile, String> {
    read_bytes(bytes, Format::Ply, Path::new("a.ply")).map_err(|error| error.to_string())
}

#[test]
fn a_row_of_a_face_that_is_longer_than_the_header_says_names_both_lines() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 2 0.5 0.25\n3 0 2 3 2 0.5 0.25\n";
    let message = ply(text.as_bytes()).unwrap_err();
    assert!(
        message.contains(
            "line 14: the row of a face holds more values than the header names from line 7 on"
        ),
        "{message}"
    );
    // Values that stand on one line, as many as the header says, are no fault.
    let wrapped = text
        .replace(" 2 0.5 0.25\n3", " 3")
        .replace(" 2 0.5 0.25", "");
    assert_eq!(ply(wrapped.as_bytes()).unwrap().triangles.len(), 2);
}
