//! A small study in a folder of its own, which goes when the test ends.
#![allow(clippy::unwrap_used, dead_code)]

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

static NUMBER: AtomicUsize = AtomicUsize::new(0);

pub const STUDY: &str = r#"[study]
title = "Index fingertip, subject 3"

[skin]
mesh = "skin.obj"
regions = "regions.csv"
[skin.materials.default]
g0_mpa = 0.005
g_lim_mpa = 0.09
d_lim_mm = 4
thickness_mm = "inf"
[skin.materials.pad]
g0_mpa = 0.006
thickness_mm = 7.0
fit = ["g0_mpa", "thickness_mm"]

[indenters.plate]
shape = "plane"
[indenters.rod]
shape = "cylinder"
radius_mm = 24.0
axis = [0.0, 2.0, 0.0]

[sites.pad]
point_mm = [0.5, 0.25, 0.1]
direction = [0.0, 0.0, -2.0]

[[recordings]]
name = "slow press"
kind = "indentation"
file = "slow.csv"
indenter = "plate"
site = "pad"
protocol = "slow"
subject = "3"
temperature_c = 23.5

[[recordings]]
name = "mat"
kind = "pressure_map"
file = "maps/mat.csv"
sensels = "sensels.csv"
motion = "slow.csv"
indenter = "rod"
site = "pad"

[[recordings]]
name = "scan"
kind = "scan"
mesh = "skin.obj"
at_time_s = 3.2
indenter = "plate"
site = "pad"

[instrument]
gain_percent = 5
pitch_mm = 1.27
"#;

const FILES: &[(&str, &str)] = &[
    ("skin.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n"),
    ("regions.csv", "vertex,region\n0,pad\n2,-1\n1,tip\n"),
    ("slow.csv", "time_s,depth_mm,force_n\n0,0,0\n0.5,1,2\n"),
    (
        "maps/mat.csv",
        "time_s,row,col,pressure_kpa\n0,0,0,3\n0,0,1,4\n1,0,0,\n1,0,1,5\n",
    ),
    (
        "sensels.csv",
        "row,col,x_mm,y_mm,z_mm,area_mm2\n0,1,1.27,0,0,1.6\n0,0,0,0,0,1.6\n",
    ),
];

/// A folder with the small study.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Folder {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path =
            std::env::temp_dir().join(format!("thenar_study_{}_{number}", std::process::id()));
        std::fs::create_dir_all(path.join("maps")).unwrap();
        let folder = Folder(path);
        folder.write("study.toml", STUDY);
        FILES
            .iter()
            .for_each(|(name, text)| folder.write(name, text));
        folder
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.0.join(name), text).unwrap();
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
