//! Mesh files made of noise or damaged: a mesh that keeps its promises or one sentence, never a panic.

use crate::promises;
use crate::samples;

use proptest::prelude::*;
use samples::*;
use thenar_recordings::meshes::MeshFile;

/// A mesh that is read keeps its promises.
fn keeps_its_promises(result: Result<MeshFile, String>) {
    match result {
        Ok(mesh) => {
            assert!(!mesh.triangles.is_empty());
            promises::of_mesh(&mesh);
        }
        Err(message) => assert!(
            message.starts_with("a.") && message.contains("; ") && !message.contains('\n'),
            "{message}"
        ),
    }
}

fn damaged(bytes: Vec<u8>) -> impl Strategy<Value = Vec<u8>> {
    let length = bytes.len();
    (
        prop::collection::vec((0..length, any::<u8>()), 1..6),
        0..=length,
        any::<bool>(),
    )
        .prop_map(move |(changes, cut, is_cut)| {
            let mut bytes = bytes.clone();
            for (at, byte) in changes {
                bytes[at] = byte;
            }
            if is_cut {
                bytes.truncate(cut);
            }
            bytes
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        keeps_its_promises(obj(&String::from_utf8_lossy(&bytes)));
        keeps_its_promises(ply(&bytes));
        keeps_its_promises(stl(&bytes));
    }

    #[test]
    fn obj_like_text_is_read_or_refused(text in "((v|f|vn|#|g)( (-?[0-9]{1,3}(/[0-9]?){0,2}|[0-9.e+-]{1,5}|nan|inf)){0,5}(\n|\\\\\n)){0,12}") {
        keeps_its_promises(obj(&text));
    }

    #[test]
    fn damaged_files_are_read_or_refused(
        ascii_ply in damaged(ASCII_PLY.as_bytes().to_vec()),
        little in damaged(binary_ply(false)),
        big in damaged(binary_ply(true)),
        ascii in damaged(ascii_stl(&square()).into_bytes()),
        binary in damaged(binary_stl(&square())),
    ) {
        keeps_its_promises(ply(&ascii_ply));
        keeps_its_promises(ply(&little));
        keeps_its_promises(ply(&big));
        keeps_its_promises(stl(&ascii));
        keeps_its_promises(stl(&binary));
    }
}
