//! A study: a folder with `study.toml`, the recordings it names and what they were taken from.
//!
//! A recording of kind `indentation` may say which run of its file it is, and which column of a table is what, where the file does not say:
//!
//! ```toml
//! run = "Probe 2"            # of a workbook or a map with several runs
//!
//! [recordings.columns]
//! travel_mm = "-Position"    # name in the file; a minus before it turns the sign; the unit in the key where the file states none
//! force = "Fz"
//! ```
//!
//! A mat's sensels are placed by a table (`sensels = "sensels.csv"`: row, col or sensor, x_mm, y_mm, z_mm, area_mm2) or by how the
//! flat mat lies:
//!
//! ```toml
//! [recordings.placing]
//! on = "cylinder"            # or "plane" with origin_mm, columns, rows: the corner, and the directions in which they count
//! origin_mm = [0, 0, 0]      # point of the axis level with the edge before the first row
//! axis = [0, 1, 0]           # rows count along it
//! seam = [0, 0, 1]           # from the axis to the edge before the first column
//! diameter_mm = 48           # on which the sensels lie
//! turn = "right"             # columns go around by the right-hand rule; "left" against it
//! ```
//!
//! or on any mesh by its UV map, sensel by sensel:
//!
//! ```toml
//! [recordings.placing]
//! on = "mesh"
//! file = "product.obj"       # in skin coordinates at first touch, with texture coordinates (vt)
//! corner_uv = [0, 0]         # where the corner before the first row and column lies; the default
//! columns_uv = [1, 0]        # from there to the corner after the last column; the default
//! rows_uv = [0, 1]           # from there to the corner after the last row; the default
//! ```
//!
//! A sensel lies on the one triangle whose chart holds its center, and looks along that triangle's normal. Its area is the maker's; where
//! the file states none, that of its patch of the chart on the mesh.
//!
//! A grasp is a mat on a product that a whole hand holds. The skin is the posed hand, the indenter a mesh in skin coordinates as it is held,
//! and there is no site. The force trace has time_s, on the clock of the mat, and force_n.
//!
//! ```toml
//! [[recordings]]
//! name = "hold, 1"
//! kind = "grasp"
//! file = "hold_1.csv"        # time_s, row, col, pressure_kpa, or a maker's export
//! indenter = "handle"
//! force = "force_1.csv"      # optional
//! force_direction = [1, 0, 0] # across the cut of a product in two halves; without it the trace is the sum of all normal forces
//! protocol = "hold"          # repeats share it
//! ```
//!
//! A handprint is an image with its scale, placed as a mat is: looking at the inked side, its columns count from left to right and its
//! rows from the lower edge up, so `origin_mm` and `corner_uv` are where the image's lower left corner lies.
//!
//! ```toml
//! [[recordings]]
//! name = "grip, inked"
//! kind = "handprint"
//! file = "print.png"         # PNG, JPEG or TIFF; what is transparent is no paper, and nothing is known of it
//! dpi = 300                  # or mm_per_px, or marks_px = [[x, y], [x, y]] with marks_mm, their distance
//! force_n = 40               # how hard at most: or depth_mm, or motion = "press.csv"
//! ink_kpa = 0                # pressure above which ink is taken; 0, any touch, is the default
//! ink = "dark"               # or "light"; by default the paper is what most of its edge is
//! threshold = 0.5            # brightness between ink and paper, 0 to 1; by default Otsu's
//! paper_px = [0, 0, 2480, 3508] # the sheet in the image: left, top, right, bottom; by default all of it
//! mirrored = false           # true for an image that shows the print from behind
//! cell_mm = 2.5              # cells in which contact is compared; by default as long as the skin's edges
//! ```

mod places;
mod toml_tree;
mod place;
mod skin;
mod indenters;
mod sites;
mod data;
mod prints;
mod frames;
mod grasps;
mod indentation;
mod recordings;
mod instrument;

pub use data::Data;
pub use indenters::{Indenter, Shape};
pub use instrument::Instrument;
pub use places::seat::Seat;
pub use places::sensels::PlacedSensel;
pub use recordings::StudyRecording;
pub use sites::Site;
pub use skin::{StudyMaterial, StudySkin};

use crate::fault::Fault;
use crate::{RecordingError, plain_file};
use place::Folder;
use std::path::{Path, PathBuf};
use toml_tree::{Document, Section};

/// File in the folder that describes the study.
pub const STUDY_FILE: &str = "study.toml";
/// Tables of the description.
const TABLES: &[&str] = &[
    "study",
    "skin",
    "indenters",
    "sites",
    "recordings",
    "instrument",
];
/// Largest description that is read, bytes: 30,000 recordings take about 5 MB, and parsing
/// takes up to 80 times as much memory.
const LARGEST_STUDY: u64 = 12 << 20;

/// Recordings, and the skin, tools and places they were taken with. mm, N, s, kPa for maps, MPa for moduli.
#[derive(Debug, Clone)]
pub struct Study {
    /// The folder that was loaded.
    pub folder: PathBuf,
    /// Title, empty if there is none.
    pub title: String,
    /// The skin before it was touched.
    pub skin: StudySkin,
    /// Tools, by name.
    pub indenters: Vec<Indenter>,
    /// Places of first touch, by name.
    pub sites: Vec<Site>,
    /// Recordings, in the order of the file.
    pub recordings: Vec<StudyRecording>,
    /// The instrument's data sheet, if given.
    pub instrument: Option<Instrument>,
    /// What a reader should be told, a sentence each.
    pub warnings: Vec<String>,
}

impl Study {
    /// Loads the study in `folder` with every file that it names.
    ///
    /// # Errors
    /// [`RecordingError`] that names file, line and remedy: a file that is missing, damaged or outside the folder, a key or a unit
    /// that is not known, time that does not increase, NaN, a site off the skin, an indenter or site that is not defined.
    pub fn load(folder: &Path) -> Result<Study, RecordingError> {
        let file = folder.join(STUDY_FILE);
        let text = read_text(folder, &file)?;
        let here = |fault: Fault| fault.in_file(&file);
        let document = Document::parse(&text).map_err(here)?;
        document.root().only(TABLES).map_err(here)?;
        let mut root = document.root();
        let folder = Folder::new(folder, &file)?;
        let mut about = root.section("study").map_err(here)?;
        let title = match about.as_mut() {
            Some(about) => about.text("title").map_err(here)?.unwrap_or_default(),
            None => String::new(),
        };
        about.map_or(Ok(()), Section::finish).map_err(here)?;
        let instrument = instrument::read(&mut root).map_err(here)?;
        let indenters = indenters::read(&mut root, &folder)?;
        let skin = skin::read(&mut root, &folder)?;
        let sites = sites::read(&mut root, &skin).map_err(here)?;
        let recordings = recordings::read(&mut root, (&indenters, &sites, &skin.mesh), &folder)?;
        let warnings = recordings
            .iter()
            .flat_map(StudyRecording::warnings)
            .collect();
        Ok(Study {
            folder: folder.path().to_path_buf(),
            title,
            skin,
            indenters,
            sites,
            recordings,
            instrument,
            warnings,
        })
    }

    /// Whether it holds grasps.
    pub fn has_grasps(&self) -> bool {
        let is_grasp = |each: &StudyRecording| matches!(each.data, Data::Grasp { .. });
        self.recordings.iter().any(is_grasp)
    }

    /// The recording of a name.
    pub fn recording(&self, name: &str) -> Option<&StudyRecording> {
        self.recordings
            .iter()
            .find(|recording| recording.name == name)
    }
}

/// Whether the file a link names lies outside of the folder, or nowhere.
fn leaves(folder: &Path, link: &Path) -> bool {
    match (folder.canonicalize(), link.canonicalize()) {
        (Ok(folder), Ok(file)) => !file.starts_with(folder),
        _ => true,
    }
}

fn read_text(folder: &Path, file: &Path) -> Result<String, RecordingError> {
    if !folder.is_dir() {
        let fault = Fault::file(
            "it is no folder".into(),
            "name the folder that holds study.toml",
        );
        return Err(fault.in_file(folder));
    }
    if std::fs::symlink_metadata(file).is_ok_and(|about| about.is_symlink()) && leaves(folder, file)
    {
        let problem = "it is a link that leaves the study's folder".to_string();
        return Err(Fault::file(problem, "copy the file into the folder").in_file(file));
    }
    let bytes = plain_file::bytes(
        file,
        LARGEST_STUDY,
        "keep measurements in files of their own",
    )?;
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_string()),
        Err(error) => {
            let line = 1 + bytes[..error.valid_up_to()]
                .iter()
                .filter(|byte| **byte == b'\n')
                .count();
            Err(Fault::line(
                line,
                "the text is not UTF-8".into(),
                "save the file as UTF-8",
            )
            .in_file(file))
        }
    }
}
