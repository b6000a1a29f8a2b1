//! A mat laid on a mesh by its UV map: where a cylinder would put it, and refused where the map does not say.

use crate::exports;
use crate::folders;

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use exports::TEKSCAN;
use folders::{Folder, STUDY};
use thenar_recordings::study::{Data, PlacedSensel, Study};

/// A quarter of a cylinder of 10 mm about y, 20 mm long, unrolled to the unit square: u around from +z towards +x, v along y.
fn quarter(turns: f64) -> String {
    let (around, mut text) = (180, String::new());
    for k in 0..=around {
        let share = f64::from(k) / f64::from(around);
        let angle = turns * TAU * share;
        for v in [0.0, 1.0] {
            writeln!(
                text,
                "v {} {} {}",
                10.0 * angle.sin(),
                20.0 * v,
                10.0 * angle.cos()
            )
            .unwrap();
            writeln!(text, "vt {share} {v}").unwrap();
        }
    }
    for k in 0..around {
        let (a, b, c, d) = (2 * k + 1, 2 * k + 2, 2 * k + 3, 2 * k + 4);
        writeln!(text, "f {a}/{a} {c}/{c} {d}/{d} {b}/{b}").unwrap();
    }
    text
}

fn load(placing: &str, mesh: &str, export: &str) -> Result<Vec<Option<PlacedSensel>>, String> {
    let folder = Folder::new();
    folder.write("maps/mat.csv", export);
    folder.write("product.obj", mesh);
    let (before, after) = STUDY.split_once("sensels = \"sensels.csv\"\n").unwrap();
    let (setting, rest) = after.split_once("\n\n").unwrap();
    let placing = format!("[recordings.placing]\non = \"mesh\"\n{placing}");
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

const FILE: &str = "file = \"product.obj\"\n";

/// Two rows and three columns, mirrored, the first cell missing: on the quarter each column takes 30 degrees and each row 10 mm.
#[test]
fn sensels_lie_where_the_cylinder_is() {
    let placed = load(FILE, &quarter(0.25), TEKSCAN).unwrap();
    assert!(placed[0].is_none() && placed[1..].iter().all(Option::is_some));
    for (k, sensel) in placed.iter().enumerate().skip(1) {
        let (sensel, row, column) = (sensel.unwrap(), k / 3, 2 - k % 3);
        let angle = (column as f64 + 0.5) * PI / 6.0;
        let wanted = [
            10.0 * angle.sin(),
            5.0 + 10.0 * row as f64,
            10.0 * angle.cos(),
        ];
        // A chord of half a degree lies 1e-4 mm under the arc.
        let near = sensel
            .center_mm
            .iter()
            .zip(wanted)
            .all(|(a, b)| (a - b).abs() < 2e-4);
        assert!(near, "{k}: {sensel:?}");
        let normal = sensel.normal.unwrap();
        let turned = normal[0] * angle.sin() + normal[2] * angle.cos();
        assert!(
            turned > 0.9999 && normal[1].abs() < 1e-12,
            "{k}: {normal:?}"
        );
        // The maker's.
        assert_eq!(sensel.area_mm2, 20.0);
    }
}

/// A part of the map: the mat's columns run along the axis, its rows back around it.
#[test]
fn a_mat_may_lie_across_the_map() {
    let lie = "corner_uv = [0.9, 0.2]\ncolumns_uv = [0.0, 0.6]\nrows_uv = [-0.4, 0.0]\n";
    let placed = load(&format!("{FILE}{lie}"), &quarter(0.25), TEKSCAN).unwrap();
    for (k, sensel) in placed.iter().enumerate().skip(1) {
        let (row, column) = (k / 3, 2 - k % 3);
        let [_, along, _] = sensel.unwrap().center_mm;
        assert!((along - 20.0 * (0.2 + 0.6 * (column as f64 + 0.5) / 3.0)).abs() < 1e-9);
        let [x, _, z] = sensel.unwrap().center_mm;
        let around = x.atan2(z) / (0.5 * PI);
        assert!(
            (around - (0.9 - 0.4 * (row as f64 + 0.5) / 2.0)).abs() < 1e-5,
            "{k}: {around}"
        );
    }
}

/// Where the export states no areas they are those of the mat's patches on the mesh; together the whole quarter.
#[test]
fn areas_come_from_the_mesh_where_the_maker_states_none() {
    let table = "time_s,row,col,pressure_kpa\n0,0,0,3\n0,0,1,4\n0,1,0,5\n0,1,1,6\n";
    let placed = load(FILE, &quarter(0.25), table).unwrap();
    let whole: f64 = placed.iter().map(|sensel| sensel.unwrap().area_mm2).sum();
    assert!(
        (whole / (0.5 * PI * 10.0 * 20.0) - 1.0).abs() < 1e-4,
        "{whole}"
    );
}

/// A sensel of a mat must lie on the product, also one that reads zero throughout; only one that is missing lies nowhere.
#[test]
fn a_sensel_beside_every_chart_is_refused_whatever_it_reads() {
    let beyond = format!("{FILE}columns_uv = [2, 0]\n");
    let read = |cell: &str| {
        let table =
            format!("time_s,row,col,pressure_kpa\n0,0,0,3\n0,0,1,{cell}\n0,1,0,5\n0,1,1,{cell}\n");
        load(&beyond, &quarter(0.25), &table)
    };
    for cell in ["4", "0"] {
        let said = read(cell).unwrap_err();
        let wanted = "the sensel in row 0, column 1 lies at (1.5000, 0.2500) of the UV map, outside of every chart";
        assert!(said.contains(wanted), "{cell}: {said}");
    }
    let placed = read("").unwrap();
    let is_placed: Vec<bool> = placed.iter().map(Option::is_some).collect();
    assert_eq!(is_placed, [true, false, true, false]);
}

#[test]
fn places_that_the_map_does_not_say_are_refused() {
    let twice = format!(
        "{}{}",
        quarter(0.25),
        "v 0 0 99\nv 9 0 99\nv 0 9 99\nvt 0 0\nvt 1 0\nvt 0 1\nf -3/-3 -2/-2 -1/-1\n"
    );
    let bare = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let beyond = format!("{FILE}columns_uv = [2, 0]\n");
    let flat = format!("{FILE}columns_uv = [1, 1]\nrows_uv = [2, 2]\n");
    let text = format!("{FILE}corner_uv = [1, 0, 0]\n");
    for (placing, mesh, wanted) in [
        (
            beyond.as_str(),
            quarter(0.25),
            "lies at (1.6667, 0.7500) of the UV map, outside of every chart; check corner_uv",
        ),
        (FILE, twice, "of the UV map, where the charts of triangles"),
        (
            FILE,
            bare.into(),
            "product.obj, line 4: a face has no texture coordinates; unwrap the mesh",
        ),
        (
            flat.as_str(),
            quarter(0.25),
            "columns_uv and rows_uv span no area; give two directions",
        ),
        (
            text.as_str(),
            quarter(0.25),
            "is no list of two numbers; write it as [u, v]",
        ),
        (
            "file = \"skin.ply\"\n",
            quarter(0.25),
            "'skin.ply' is not in the study's folder",
        ),
        (
            "",
            quarter(0.25),
            "has no file; name the product's mesh, an OBJ with UVs",
        ),
        (
            FILE,
            "v 0 0 0\nvt 0 0\nf 1/1 1/2 1/1\n".into(),
            "a face uses texture coordinate 2, 1 were read before it",
        ),
    ] {
        let said = load(placing, &mesh, TEKSCAN).unwrap_err();
        assert!(said.contains(wanted), "{said}");
    }
    let said = load("file = \"regions.csv\"\n", "", TEKSCAN).unwrap_err();
    assert!(
        said.contains("not a mesh format that is known (.csv); save it as .obj with UVs"),
        "{said}"
    );
}
