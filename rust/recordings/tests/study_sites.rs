//! A site is a place of the skin that has tissue.
#![allow(clippy::unwrap_used)]

mod folders;

use folders::Folder;
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
