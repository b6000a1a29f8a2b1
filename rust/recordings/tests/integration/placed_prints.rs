//! Handprints of a study: placed through the doors that mats go through, or refused in a sentence.

use crate::folders;
use crate::inked;

use folders::{Folder, STUDY};
use image::{DynamicImage, ImageFormat};
use inked::{bytes, drawn};
use thenar_recordings::handprint::Handprint;
use thenar_recordings::study::{Data, PlacedSensel, Study};

const PRINT: &str = "[[recordings]]\nname = \"ink\"\nkind = \"handprint\"\nfile = \"a.png\"\nmm_per_px = 0.1\ncell_mm = 1\n\
    force_n = 20\nindenter = \"plate\"\nsite = \"pad\"\n";
const FLAT: &str = "[recordings.placing]\non = \"plane\"\norigin_mm = [1, 2, 3]\ncolumns = [1, 0, 0]\nrows = [0, 1, 0]\n";

type Cells = Vec<Option<PlacedSensel>>;

fn load(recording: &str, files: &[(&str, &str)]) -> Result<(Handprint, Option<Cells>), String> {
    let folder = Folder::new();
    folder.write(
        "a.png",
        bytes(&DynamicImage::ImageLuma8(drawn(30, 220)), ImageFormat::Png),
    );
    files
        .iter()
        .for_each(|(name, text)| folder.write(name, text));
    let (before, _) = STUDY.split_once("[[recordings]]").unwrap();
    folder.write("study.toml", format!("{before}{recording}"));
    let mut study = Study::load(folder.path()).map_err(|error| error.to_string())?;
    match study.recordings.remove(0).data {
        Data::Handprint { print, sensels, .. } => Ok((*print, sensels)),
        other => panic!("{other:?}"),
    }
}

/// Through the doors that mats go through: the lower left corner lies at the origin, looking to columns x rows.
#[test]
fn prints_are_placed_as_mats_are() {
    let (print, placed) = load(&format!("{PRINT}{FLAT}"), &[]).unwrap();
    let placed = placed.unwrap();
    let cell = placed[9 * 40 + 13].unwrap();
    assert_eq!(
        (cell.center_mm, cell.normal),
        ([14.5, 11.5, 3.0], Some([0.0, 0.0, 1.0]))
    );
    assert!(
        cell.area_mm2 == 1.0
            && placed.len() == print.inked.len()
            && print.inked[9 * 40 + 13] == 1.0
    );
    // Around a cylinder of 20 mm by its seam: 13.5 mm along it.
    let around = "[recordings.placing]\non = \"cylinder\"\norigin_mm = [0, 0, 0]\naxis = [0, 1, 0]\nseam = [0, 0, 1]\ndiameter_mm = 20\n";
    let (_, placed) = load(&format!("{PRINT}{around}"), &[]).unwrap();
    let [x, y, z] = placed.unwrap()[9 * 40 + 13].unwrap().center_mm;
    let off = (x - 10.0 * 1.35f64.sin()).abs() + (y - 9.5).abs() + (z - 10.0 * 1.35f64.cos()).abs();
    assert!(off < 1e-12, "{x}, {y}, {z}");
    assert!(load(PRINT, &[]).unwrap().1.is_none());
}

/// A picture in the UV map of a product that fills the left half of it: cells beside it are no product where they are blank, and are
/// refused where they are inked.
#[test]
fn blank_cells_beside_a_chart_lie_nowhere() {
    let plate = |width: f64| {
        format!(
            "v 0 0 5\nv 40 0 5\nv 40 24 5\nv 0 24 5\nvt 0 0\nvt {width} 0\nvt {width} 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
        )
    };
    let on = "[recordings.placing]\non = \"mesh\"\nfile = \"p.obj\"\n";
    let (_, placed) = load(&format!("{PRINT}{on}"), &[("p.obj", &plate(0.5))]).unwrap();
    let placed = placed.unwrap();
    assert_eq!(placed.iter().flatten().count(), 24 * 20);
    let [x, y, _] = placed[9 * 40 + 13].unwrap().center_mm;
    assert!((x - 27.0).abs() < 1e-9 && (y - 9.5).abs() < 1e-9);
    let told = load(&format!("{PRINT}{on}"), &[("p.obj", &plate(0.2))]).unwrap_err();
    assert!(
        told.contains("the sensel in row ") && told.contains("outside of every chart"),
        "{told}"
    );
}

#[test]
fn prints_of_a_study_are_refused_in_a_sentence() {
    for (from, to, expected) in [
        (
            "mm_per_px = 0.1\n",
            "",
            "has no scale; give dpi as the scanner has it",
        ),
        (
            "mm_per_px = 0.1\n",
            "mm_per_px = 0.1\ndpi = 254\n",
            "has more than one scale; give one of dpi",
        ),
        (
            "mm_per_px = 0.1\n",
            "marks_px = [[0, 0], [100, 0]]\n",
            "has no marks_mm; give the distance",
        ),
        (
            "mm_per_px = 0.1\n",
            "marks_px = [0, 0]\nmarks_mm = 1\n",
            "marks_px",
        ),
        (
            "force_n = 20\n",
            "force_n = 20\ndepth_mm = 1\n",
            "says more than once how hard it was pressed; give one of",
        ),
        (
            "force_n = 20\n",
            "ink_kpa = -1\n",
            "ink_kpa is -1; give a pressure from 0 on, kPa",
        ),
        (
            "force_n = 20\n",
            "ink = \"blue\"\n",
            "ink 'blue' is not known; ",
        ),
        (
            "force_n = 20\n",
            "threshold = 128\n",
            "threshold is 128; give a brightness, 0 black to 1 white",
        ),
        (
            "force_n = 20\n",
            "paper_px = [1, 2, 3]\n",
            "paper_px is no list of 4 numbers",
        ),
        (
            "force_n = 20\n",
            "ink_pka = 2\n",
            "'ink_pka' is no key of recording 'ink'; did you mean 'ink_kpa'?",
        ),
    ] {
        let told = load(&PRINT.replace(from, to), &[]).unwrap_err();
        assert!(
            told.contains("study.toml, line ") && told.contains(expected),
            "{told}"
        );
    }
}
