//! A study that says how its mat lies on the product: sensels get places, or the study is refused.

use crate::exports;
use crate::folders;

use exports::TEKSCAN;
use folders::{Folder, STUDY};
use thenar_recordings::study::{Data, PlacedSensel, Study};

const WRAPPED: &str = "[recordings.placing]\non = \"cylinder\"\norigin_mm = [0, 0, 10]\naxis = [0, 1, 0]\nseam = [0, 0, 1]\n\
    diameter_mm = 20\nturn = \"left\"\n";

fn load(placing: &str) -> Result<Vec<Option<PlacedSensel>>, String> {
    let folder = Folder::new();
    folder.write("maps/mat.csv", TEKSCAN);
    let (before, after) = STUDY.split_once("sensels = \"sensels.csv\"\n").unwrap();
    let (setting, rest) = after.split_once("\n\n").unwrap();
    folder.write(
        "study.toml",
        format!("{before}{setting}\n{placing}\n{rest}"),
    );
    let study = Study::load(folder.path()).map_err(|error| error.to_string())?;
    let Data::PressureMap { sensels, .. } = &study.recording("mat").unwrap().data else {
        panic!()
    };
    Ok(sensels.clone().unwrap())
}

/// Two rows 4 mm apart and three columns 5 mm apart, columns mirrored, the first cell of the first row without sensel.
#[test]
fn a_mat_around_a_cylinder_is_placed() {
    let placed = load(WRAPPED).unwrap();
    assert!(placed[0].is_none() && placed[1..].iter().all(Option::is_some));
    // Row 1, column 0 of a mirrored mat: 12.5 mm from the seam, against the right-hand rule about y.
    let (sensel, angle) = (placed[3].unwrap(), -12.5_f64 / 10.0);
    let expected = [10.0 * angle.sin(), 6.0, 10.0 + 10.0 * angle.cos()];
    assert!(
        sensel
            .center_mm
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-12),
        "{sensel:?} is not at {expected:?}"
    );
    let normal = sensel.normal.unwrap();
    assert!((normal[0] - angle.sin()).abs() < 1e-12 && normal[1] == 0.0 && sensel.area_mm2 == 20.0);
}

#[test]
fn placings_that_cannot_be_are_refused() {
    for (from, to, expected) in [
        (
            "diameter_mm = 20",
            "diameter_mm = 2",
            "the mat is 12.5 mm long and the cylinder 6.3 mm round, so it overlaps itself; check diameter_mm",
        ),
        (
            "seam = [0, 0, 1]",
            "seam = [0, 1, 1]",
            "axis and seam are not perpendicular; give directions at a right angle",
        ),
        (
            "\"cylinder\"",
            "\"cilinder\"",
            "a mat on 'cilinder' is not known; did you mean 'cylinder'?",
        ),
        (
            "turn = \"left\"",
            "turn = \"up\"",
            "turn 'up' is not known; give right",
        ),
        (
            "turn = \"left\"",
            "twist = 1",
            "'twist' is no key of [recording 'mat'.placing]; use one of",
        ),
        (
            "origin_mm = [0, 0, 10]\n",
            "",
            "[recording 'mat'.placing] has no origin_mm; give the mat's corner",
        ),
        (
            "diameter_mm = 20\n",
            "",
            "[recording 'mat'.placing] has no diameter_mm; give the diameter",
        ),
        (
            "[recordings.placing]",
            "sensels = \"sensels.csv\"\n[recordings.placing]",
            "recording 'mat' has both sensels and placing; leave one",
        ),
    ] {
        let message = load(&WRAPPED.replacen(from, to, 1)).unwrap_err();
        assert!(
            message.contains("study.toml, line ") && message.contains(expected),
            "{to:?} gave {message:?}"
        );
    }
    let folder = Folder::new();
    folder.write(
        "study.toml",
        STUDY
            .replace("sensels = \"sensels.csv\"\nmotion", "motion")
            .replace(
                "site = \"pad\"\n\n[[recordings]]\nname = \"scan\"",
                &format!("site = \"pad\"\n{WRAPPED}\n[[recordings]]\nname = \"scan\""),
            ),
    );
    let message = Study::load(folder.path()).unwrap_err().to_string();
    assert!(
        message.contains("the file states no pitch of its sensels; give sensels"),
        "{message}"
    );
}
