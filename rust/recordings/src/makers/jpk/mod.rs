//! JPK force curves: the archives that the instruments save, with one curve or a map of them, and their export as text.

mod archive;
mod curve;
mod properties;
pub(super) mod text;

use crate::detection::Format;
use crate::fault::{Fault, shown};
use crate::recording_file::RecordingFile;
use archive::{Archive, REMEDY};
use properties::Properties;

pub(crate) use archive::is_jpk;

/// Reads all curves, or the one called `wanted`.
pub(crate) fn read(bytes: Vec<u8>, wanted: Option<&str>) -> Result<RecordingFile, Fault> {
    let mut archive = Archive::open(bytes)?;
    let roots = archive.curves();
    if roots.is_empty() {
        let problem = "the archive holds no segment with samples".to_string();
        return Err(Fault::file(problem, REMEDY));
    }
    let shared = match archive.shared() {
        Some(name) => archive.properties(&name)?,
        None => Properties::default(),
    };
    let is_map = roots.len() > 1;
    let (mut curves, mut held, mut notes) = (Vec::new(), 0, Vec::new());
    for (name, root) in &roots {
        if is_map && wanted.is_some_and(|wanted| wanted != name) {
            continue;
        }
        let read = archive
            .too_large(roots.len(), held)
            .map_or_else(|| curve::read(&mut archive, root, &shared), Err);
        let mut curve = match read {
            Ok(curve) => curve,
            Err(fault) if is_map && archive.too_large(roots.len(), held).is_none() => {
                notes.push(format!("{name} is left out: {}", fault.problem()));
                continue;
            }
            Err(fault) => return Err(fault),
        };
        held += curve.samples() * curve.channels.len();
        if is_map {
            curve.name.clone_from(name);
        }
        curves.push(curve);
    }
    if let Some(first) = notes.first().filter(|_| curves.is_empty()) {
        return Err(Fault::file(first.clone(), REMEDY));
    }
    if curves.is_empty() {
        let names: Vec<String> = roots.into_iter().map(|(name, _)| name).collect();
        let wanted = shown(wanted.unwrap_or("").as_bytes());
        let problem = format!("none of its {} curves is called {wanted}", names.len());
        return Err(Fault::file(
            problem,
            format!("they are called {} to {}", names[0], names[names.len() - 1]),
        ));
    }
    Ok(RecordingFile {
        notes,
        ..RecordingFile::of_curves(Format::JpkArchive, curves)
    })
}
