//! Grasps of a study: what is read of them, and what is refused with its remedy.

#[path = "../folders/mod.rs"]
mod folders;

use folders::Folder;
use thenar_recordings::Study;
use thenar_recordings::study::Data;

const SKIN: &str = "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n";
const HANDLE: &str = "v 0 0 1\nv 0 10 1\nv 10 0 1\nv 0 0 9\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
const MAT: &str = "time_s,row,col,pressure_kpa\n0,0,0,10\n0,0,1,20\n0.5,0,0,11\n0.5,0,1,21\n";
const SENSELS: &str = "row,col,x_mm,y_mm,z_mm,area_mm2\n0,0,1,1,1,25\n0,1,6,1,1,25\n";
const FORCE: &str = "time_s,force_n\n0,1.0\n0.5,1.1\n";

fn study(of_recording: &str) -> Folder {
    let folder = Folder::new();
    for (name, text) in [
        ("skin.obj", SKIN),
        ("handle.obj", HANDLE),
        ("mat.csv", MAT),
        ("sensels.csv", SENSELS),
        ("force.csv", FORCE),
        ("press.csv", "time_s,depth_mm\n0,0\n1,1\n"),
    ] {
        folder.write(name, text.as_bytes());
    }
    let text = format!(
        "[skin]\nmesh = \"skin.obj\"\n[indenters.handle]\nshape = \"mesh\"\nfile = \"handle.obj\"\n[indenters.ball]\nshape = \"sphere\"\nradius_mm = 5\n\
         [[recordings]]\nname = \"hold\"\nkind = \"grasp\"\nfile = \"mat.csv\"\n{of_recording}"
    );
    folder.write("study.toml", text.as_bytes());
    folder
}

#[test]
fn a_grasp_has_frames_places_and_a_trace_and_no_site() {
    let folder = study(
        "indenter = \"handle\"\nsensels = \"sensels.csv\"\nforce = \"force.csv\"\nforce_direction = [0, 0, 2]\n",
    );
    let study = Study::load(folder.path()).expect("it is whole");
    assert!(study.has_grasps() && study.recordings[0].site.is_empty());
    let Data::Grasp {
        map,
        sensels,
        force,
        force_direction,
    } = &study.recordings[0].data
    else {
        panic!("it is a grasp");
    };
    assert_eq!((map.frames(), sensels.len()), (2, 2));
    assert_eq!(force_direction, &Some([0.0, 0.0, 1.0]));
    let force = force.as_ref().and_then(|curve| curve.channel("force_n"));
    assert_eq!(force, Some(&[1.0, 1.1][..]));
}

#[test]
fn what_a_grasp_lacks_is_said_with_the_remedy() {
    for (of_recording, words) in [
        (
            "indenter = \"handle\"\n",
            "say where the mat lies on the product",
        ),
        (
            "indenter = \"ball\"\nsensels = \"sensels.csv\"\n",
            "is not a mesh; give the held product as shape = \"mesh\"",
        ),
        (
            "indenter = \"handle\"\nsensels = \"sensels.csv\"\nforce = \"press.csv\"\n",
            "the force trace lacks time or force; add columns time_s",
        ),
        (
            "indenter = \"handle\"\nsensels = \"sensels.csv\"\nforce_direction = [0, 0, 0]\n",
            "points nowhere",
        ),
        (
            "indenter = \"handle\"\nsensels = \"sensels.csv\"\nsite = \"pad\"\n",
            "site",
        ),
    ] {
        let error = Study::load(study(of_recording).path()).expect_err(of_recording);
        assert!(error.to_string().contains(words), "{error}");
    }
}
