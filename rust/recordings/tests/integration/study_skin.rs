//! What a study says of its skin: a site is a place that has tissue, and the bone is stated or left open.

use crate::folders;

use folders::{Folder, STUDY};
use thenar_recordings::study::Study;

/// The tool would press nothing, and every force would be laid to the parameters.
#[test]
fn a_site_where_the_skin_has_no_region_is_refused() {
    let folder = Folder::new();
    let apart = "v 8 8 0\nv 9 8 0\nv 8 9 0\n";
    folder.write(
        "skin.obj",
        format!("v 0 0 0\nv 2 0 0\nv 0 2 0\n{apart}f 1 2 3\nf 4 5 6\n"),
    );
    let regions =
        |first: &str| format!("vertex,region\n0,{first}\n1,none\n2,-1\n3,pad\n4,tip\n5,pad\n");
    folder.write("regions.csv", regions("-1"));
    let message = message(&folder);
    let expected = "study.toml, line 24: [sites.pad] lies where the skin has no region, which counts as no skin: vertices 0, 1 and 2; \
                    give a point within a region";
    assert!(message.starts_with(expected), "{message}");
    folder.write("regions.csv", regions("tip"));
    Study::load(folder.path()).unwrap();
}

fn message(folder: &Folder) -> String {
    let error = Study::load(folder.path()).unwrap_err().to_string();
    error.replace(&format!("{}/", folder.path().display()), "")
}

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
