//! JPK archive: a zip of properties and numbers, in any order, with one curve or one per point of a map.

use super::properties::Properties;
use crate::fault::{Fault, shown};
use crate::text::fields::MOST_VALUES;
use std::collections::BTreeMap;
use std::io::{Cursor, Read};

/// Most that is unpacked of one archive, bytes.
const LARGEST_UNPACKED: usize = 512 << 20;
pub(super) const REMEDY: &str =
    "the file is damaged or of a version that is not known; export it as text from JPK's program";
const SEGMENT: &str = "segments/0/segment-header.properties";
const SHARED: &str = "shared-data/header.properties";

/// An opened archive; names have slashes, whatever program packed it.
pub(super) struct Archive {
    zip: zip::ZipArchive<Cursor<Vec<u8>>>,
    places: BTreeMap<String, usize>,
    unpacked: usize,
}

/// Whether a zip's list of contents names the parts of a force curve; a zip that is neither that nor a workbook is refused.
pub(crate) fn is_jpk(bytes: &[u8]) -> Result<bool, Fault> {
    let archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| unopened(&error))?;
    let names: Vec<String> = archive
        .file_names()
        .flatten()
        .map(|name| slashed(&name))
        .collect();
    if names.iter().any(|name| name.ends_with("header.properties")) {
        return Ok(true);
    }
    if names.iter().any(|name| name == "xl/workbook.xml") {
        return Ok(false);
    }
    let (problem, remedy) = match names
        .iter()
        .any(|name| name == "content.xml" || name == "xl/workbook.bin")
    {
        true => (
            "this is a workbook of another kind (.ods or .xlsb)",
            "save it as .xlsx",
        ),
        false => (
            "this is a zip archive, and neither a workbook nor a JPK force curve",
            "unpack it, and name the recording in it",
        ),
    };
    Err(Fault::file(problem.into(), remedy))
}

fn unopened(error: &zip::result::ZipError) -> Fault {
    let problem = format!("the archive cannot be opened ({error})");
    Fault::file(
        problem,
        "it is cut short or damaged; copy or export it again",
    )
}

fn slashed(name: &str) -> String {
    name.replace('\\', "/")
}

impl Archive {
    pub fn open(bytes: Vec<u8>) -> Result<Archive, Fault> {
        let zip = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| unopened(&error))?;
        let mut places = BTreeMap::new();
        for k in 0..zip.len() {
            if let Some(Ok(name)) = zip.name_for_index(k) {
                places.insert(slashed(&name), k);
            }
        }
        Ok(Archive {
            zip,
            places,
            unpacked: 0,
        })
    }

    /// Name and folder of each curve, in the order of the map.
    pub fn curves(&self) -> Vec<(String, String)> {
        let roots = self
            .places
            .keys()
            .filter_map(|name| name.strip_suffix(SEGMENT));
        let mut roots: Vec<(u64, &str)> = roots
            .filter(|root| root.is_empty() || root.ends_with('/'))
            .map(|root| (number(root), root))
            .collect();
        roots.sort_unstable();
        let named = |(number, root): (u64, &str)| (format!("curve {number}"), root.to_string());
        roots.into_iter().map(named).collect()
    }

    /// The properties that all curves share.
    pub fn shared(&self) -> Option<String> {
        let names = self.places.keys().filter(|name| name.ends_with(SHARED));
        names.min_by_key(|name| name.len()).cloned()
    }

    pub fn has(&self, name: &str) -> bool {
        self.places.contains_key(name)
    }

    pub fn properties(&mut self, name: &str) -> Result<Properties, Fault> {
        let bytes = self.member(name)?;
        Ok(Properties::of(&String::from_utf8_lossy(&bytes)))
    }

    /// The bytes of a file inside the archive.
    pub fn member(&mut self, name: &str) -> Result<Vec<u8>, Fault> {
        let missing = || inside(name, "is not there".into());
        let place = *self.places.get(name).ok_or_else(missing)?;
        let opened = self
            .zip
            .by_index(place)
            .map_err(|error| inside(name, format!("cannot be unpacked ({error})")))?;
        let left = LARGEST_UNPACKED.saturating_sub(self.unpacked);
        let mut bytes = Vec::new();
        let reading = opened.take(left as u64 + 1).read_to_end(&mut bytes);
        reading.map_err(|error| inside(name, format!("cannot be unpacked ({error})")))?;
        self.unpacked = self.unpacked.saturating_add(bytes.len());
        if bytes.len() > left {
            let problem = format!("the archive unpacks to more than {LARGEST_UNPACKED} bytes");
            return Err(Fault::file(
                problem,
                "export fewer curves, or give run as the one to read",
            ));
        }
        Ok(bytes)
    }

    /// The fault of a map that is too large to be read at once.
    pub fn too_large(&self, curves: usize, held: usize) -> Option<Fault> {
        (held > MOST_VALUES || self.unpacked > LARGEST_UNPACKED).then(|| {
            Fault::file(
                format!("its {curves} curves are more than can be read at once"),
                "give run as the one to read, such as 'curve 0'",
            )
        })
    }
}

/// The number of the folder of a curve, `index/12/`; 0 for the only one.
fn number(root: &str) -> u64 {
    let last = root.trim_end_matches('/').rsplit('/').next();
    last.and_then(|last| last.parse().ok()).unwrap_or(0)
}

/// The fault of one file in the archive.
pub(super) fn inside(member: &str, problem: String) -> Fault {
    Fault::file(
        format!("{} in the archive: {problem}", shown(member.as_bytes())),
        REMEDY,
    )
}
