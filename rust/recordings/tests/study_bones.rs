//! A study states the bone under its tissue, or leaves it open.
#![allow(clippy::unwrap_used)]

mod folders;

use folders::{Folder, STUDY};
use thenar_recordings::study::Study;

/// The sample study, in whose second material `thickness_mm` is followed by these lines.
fn with(lines: &str) -> Folder {
    let folder = Folder::new();
    let stated = format!("thickness_mm = 7.0\n{lines}");
    folder.write(
        "study.toml",
        STUDY.replacen("thickness_mm = 7.0", &stated, 1),
    );
    folder
}

#[test]
fn the_bone_is_read_where_it_is_stated() {
    let folder = with("bone_half_width_mm = 2.5\nbone_half_length_mm = \"inf\"");
    let study = Study::load(folder.path()).unwrap();
    let bone = |k: usize| {
        let material = &study.skin.materials[k];
        (material.bone_half_width_mm, material.bone_half_length_mm)
    };
    assert_eq!(
        [bone(0), bone(1)],
        [(None, None), (Some(2.5), Some(f64::INFINITY))]
    );
}

#[test]
fn a_bone_without_a_width_is_refused() {
    for (lines, expected) in [
        (
            "bone_half_length_mm = 9.0",
            "bone_half_length_mm stands without bone_half_width_mm; state half the width of the bone too, or leave both out",
        ),
        (
            "bone_half_width_mm = 0.0",
            "bone_half_width_mm is 0; give a number above zero, or \"inf\" for bone without end",
        ),
    ] {
        let message = Study::load(with(lines).path()).unwrap_err().to_string();
        assert!(message.ends_with(expected), "{message}");
    }
}
