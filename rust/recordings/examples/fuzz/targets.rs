//! The readers, each as a function of bytes; whether it read them. What is read must keep its promises, or it panics.

use crate::{folders, promises, seeds};
use std::path::Path;
use thenar_recordings::handprint::{Handprint, PrintOptions, Scale};
use thenar_recordings::meshes::{self, Format, MeshFile};
use thenar_recordings::{Columns, ReadOptions, RecordingError, Study, read_bytes_with};

/// Longest message, bytes; names and paths are cut before.
const LONGEST_MESSAGE: usize = 4_000;

/// Reads bytes; whether it could.
pub type Read = Box<dyn Fn(&[u8]) -> bool>;

/// A reader and its inputs.
pub struct Target {
    pub name: &'static str,
    pub corpus: Vec<Vec<u8>>,
    /// Edges that were reached, as `coverage` notes them.
    pub seen: Vec<u8>,
    /// Longest seed, bytes.
    pub longest: usize,
    pub read: Read,
}

/// Every reader; those that want files write them under `out`.
pub fn all(out: &Path) -> Vec<Target> {
    let mut targets = vec![
        target(
            "recording",
            seeds::recordings(),
            recording(ReadOptions::default()),
        ),
        target(
            "recording with columns",
            seeds::recordings(),
            recording(named()),
        ),
    ];
    for (name, format) in [
        ("mesh obj", Format::Obj),
        ("mesh ply", Format::Ply),
        ("mesh stl", Format::Stl),
    ] {
        let read =
            move |bytes: &[u8]| sound_mesh(meshes::read_bytes(bytes, format, Path::new("a")));
        targets.push(target(name, seeds::meshes(), Box::new(read)));
    }
    for (name, file) in [("points csv", "points.csv"), ("points ply", "points.ply")] {
        let file = out.join(file);
        let read = move |bytes: &[u8]| {
            std::fs::write(&file, bytes).unwrap();
            sound_points(meshes::read_points(&file))
        };
        targets.push(target(name, seeds::meshes(), Box::new(read)));
    }
    let charted = out.join("charts.obj");
    let charts = move |bytes: &[u8]| {
        std::fs::write(&charted, bytes).unwrap();
        sentence(meshes::read_charts(&charted)).is_some_and(|found| {
            assert_eq!(found.charts.len(), found.mesh.triangles.len());
            true
        })
    };
    targets.push(target(
        "charts",
        vec![seeds::OBJ.as_bytes().to_vec()],
        Box::new(charts),
    ));
    targets.push(target("handprint", seeds::images(), handprint(out)));
    for name in ["study.toml", "sensels.csv", "regions.csv"] {
        targets.push(study(name));
    }
    targets
}

fn target(name: &'static str, corpus: Vec<Vec<u8>>, read: Read) -> Target {
    let longest = corpus.iter().map(Vec::len).max().unwrap_or(0);
    Target {
        name,
        corpus,
        seen: Vec::new(),
        longest,
        read,
    }
}

fn named() -> ReadOptions {
    let mut columns = Columns::default();
    for (key, header) in [
        ("travel_mm", "-Extension"),
        ("force_n", "Fz"),
        ("time_s", "Time"),
    ] {
        columns.add(key, header).unwrap();
    }
    ReadOptions { columns, run: None }
}

fn recording(options: ReadOptions) -> Read {
    Box::new(
        move |bytes| match sentence(read_bytes_with(bytes, Path::new("a"), &options)) {
            Some(file) => {
                promises::of_recording(&file);
                true
            }
            None => false,
        },
    )
}

/// The value, or nothing where the refusal is one sentence with a remedy.
fn sentence<T>(result: Result<T, RecordingError>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(error) => {
            let message = error.to_string();
            let is_sentence = message.contains("; ") && !message.contains(['\n', '\r', '\u{1b}']);
            assert!(
                is_sentence && message.len() < LONGEST_MESSAGE,
                "no sentence: {message:?}"
            );
            None
        }
    }
}

fn sound_points(result: Result<MeshFile, RecordingError>) -> bool {
    sentence(result).is_some_and(|mesh| {
        promises::of_mesh(&mesh);
        !mesh.positions.is_empty()
    })
}

fn sound_mesh(result: Result<MeshFile, RecordingError>) -> bool {
    let has_faces = |mesh: &MeshFile| assert!(!mesh.triangles.is_empty());
    sound_points(result.inspect(has_faces))
}

fn handprint(out: &Path) -> Read {
    let file = out.join("print");
    let options = PrintOptions {
        scale: Scale::MmPerPixel(0.8),
        cell_mm: 3.0,
        threshold: None,
        ink: None,
        paper_px: None,
        is_mirrored: false,
    };
    Box::new(move |bytes| {
        std::fs::write(&file, bytes).unwrap();
        sentence(Handprint::read(&file, &options)).is_some_and(|print| {
            assert_eq!(print.inked.len(), print.cells[0] * print.cells[1]);
            assert!(
                print
                    .inked
                    .iter()
                    .all(|share| share.is_nan() || (0.0..=1.0 + 1e-9).contains(share))
            );
            true
        })
    })
}

/// One file of a study's folder damaged, the others sound.
fn study(name: &'static str) -> Target {
    let folder = folders::Folder::new();
    let corpus = vec![std::fs::read(folder.path().join(name)).unwrap()];
    let read = move |bytes: &[u8]| {
        folder.write(name, bytes);
        sentence(Study::load(folder.path())).is_some_and(|study| {
            assert!(!study.recordings.is_empty() && !study.skin.mesh.triangles.is_empty());
            true
        })
    };
    target(name, corpus, Box::new(read))
}
