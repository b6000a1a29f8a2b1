//! Damaged descriptions of studies: loaded or refused in one sentence, never a panic.

use crate::folders;
use crate::random;

use folders::{Folder, STUDY};
use random::Random;
use thenar_recordings::study::Study;

const CASES: usize = 1_000;

#[test]
fn damaged_studies_are_loaded_or_refused() {
    let (folder, mut random, mut loaded) = (Folder::new(), Random(11), 0);
    for _ in 0..CASES {
        let mut bytes = STUDY.as_bytes().to_vec();
        random.damage(&mut bytes);
        folder.write("study.toml", bytes);
        match Study::load(folder.path()) {
            Ok(study) => {
                assert!(!study.recordings.is_empty() && !study.skin.mesh.triangles.is_empty());
                loaded += 1;
            }
            Err(error) => {
                let message = error.to_string();
                assert!(
                    message.contains("; ") && !message.contains(['\n', '\r']),
                    "{message:?}"
                );
            }
        }
    }
    assert!(
        (CASES / 50..CASES - CASES / 50).contains(&loaded),
        "{loaded} of {CASES} were loaded"
    );
}

/// Found by damaged files at random: the remedy listed names of any length.
#[test]
fn names_of_regions_of_any_length_leave_the_message_short() {
    let folder = Folder::new();
    let name = "x".repeat(5_000);
    folder.write(
        "regions.csv",
        format!("vertex,region\n0,{name}\n2,-1\n1,tip\n"),
    );
    let message = Study::load(folder.path()).unwrap_err().to_string();
    assert!(
        message.contains("'pad'") && message.len() < 1_500,
        "{message}"
    );
}
