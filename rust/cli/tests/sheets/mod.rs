//! Meshes made in the test, a folder of its own for every test, and a way to run the binary.
#![allow(dead_code, clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A folder below cargo's, empty at the start.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Folder {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    /// A file with this text; its path.
    pub fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }

    pub fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
    }

    /// Names of all files below `name`, sorted; hidden ones too.
    pub fn names(&self, name: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.join(name)).into_iter().flatten();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

/// `thenar` with these words.
pub fn thenar(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_thenar"))
        .args(words)
        .output()
        .unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// One OBJ quad sheet of `count` by `count` vertices at z = 0 around the origin, facing +z; lengths times `scale`.
pub fn sheet(count: usize, spacing: f64, scale: f64) -> String {
    let mut text = String::new();
    let half = (count - 1) as f64 / 2.0;
    for (i, j) in (0..count * count).map(|k| (k / count, k % count)) {
        text += &format!(
            "v {} {} 0\n",
            (i as f64 - half) * spacing * scale,
            (j as f64 - half) * spacing * scale
        );
    }
    for (i, j) in (0..(count - 1) * (count - 1)).map(|k| (k / (count - 1), k % (count - 1))) {
        let first = i * count + j + 1;
        text += &format!(
            "f {} {} {} {}\n",
            first,
            first + count,
            first + count + 1,
            first + 1
        );
    }
    text
}

/// A closed box as an ASCII PLY of quads, from z = `bottom` up; half width 3 mm; lengths times `scale`.
pub fn block(bottom: f64, scale: f64) -> String {
    let header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n\
                  element face 6\nproperty list uchar int vertex_indices\nend_header\n";
    let mut text = header.to_owned();
    for corner in 0..8 {
        let side = |bit: usize| {
            if corner >> bit & 1 == 1 {
                3.0 * scale
            } else {
                -3.0 * scale
            }
        };
        let z = if corner >> 2 & 1 == 1 {
            (bottom + 4.0) * scale
        } else {
            bottom * scale
        };
        text += &format!("{} {} {z}\n", side(0), side(1));
    }
    text + "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n"
}

/// A sheet and a block that dips 0.4 mm into it.
pub fn scene(name: &str) -> (Folder, String, String) {
    let folder = Folder::new(name);
    let hand = folder.file("hand.obj", &sheet(13, 1.0, 1.0));
    let product = folder.file("block.ply", &block(-0.4, 1.0));
    (folder, hand, product)
}

/// Exit code 2, one sentence that holds `words`, nothing written.
pub fn refused(arguments: &[&str], words: &str) {
    let output = thenar(arguments);
    let sentence = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{sentence}");
    assert!(
        sentence.contains(words),
        "expected {words:?} in {sentence:?}"
    );
    assert!(
        sentence.starts_with("thenar: ")
            && sentence.ends_with('\n')
            && sentence.lines().count() == 1,
        "{sentence:?}"
    );
    assert!(output.stdout.is_empty());
    let out = arguments
        .iter()
        .position(|word| *word == "--out")
        .map(|place| arguments[place + 1]);
    assert!(
        out.is_none_or(|out| !std::path::Path::new(out).exists()),
        "something was written"
    );
}

/// The numbers of one column of a CSV text.
pub fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|header| header == name)
        .unwrap();
    lines
        .map(|line| line.split(',').nth(place).unwrap().parse().unwrap())
        .collect()
}
