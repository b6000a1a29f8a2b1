//! A reader for each maker's format; each keeps what the file says and invents nothing.

mod afm_workshop;
mod aurora;
mod emed;
mod footscan;
mod insole_logger;
pub(crate) mod jpk;
mod limits;
mod mach1;
mod optics11;
mod pedar;
mod pliance;
mod tekscan;
mod tekscan_header;
mod xsensor;
mod xsensor_block;

use crate::detection::Format;
use crate::fault::Fault;
use crate::recording_file::RecordingFile;
use crate::text::lines::Lines;

pub(crate) use afm_workshop::FIRST as AFM_WORKSHOP;
pub(crate) use mach1::read as mach1;

/// Reads a text of a maker's format; tables are read elsewhere.
pub(crate) fn read_text(format: Format, lines: &mut Lines) -> Result<RecordingFile, Fault> {
    let maps = |maps| RecordingFile::of_maps(format, maps);
    let curves = |curves| RecordingFile::of_curves(format, curves);
    match format {
        Format::Tekscan => tekscan::read(lines),
        Format::Pedar => pedar::read(lines).map(maps),
        Format::Pliance => pliance::read(lines).map(maps),
        Format::Emed => emed::read(lines).map(maps),
        Format::Xsensor => xsensor::read(lines).map(maps),
        Format::Footscan => footscan::read(lines).map(maps),
        Format::InsoleLogger => insole_logger::read(lines).map(maps),
        Format::Aurora => aurora::read(lines).map(curves),
        Format::Optics11 => optics11::read(lines).map(curves),
        Format::AfmWorkshop => afm_workshop::read(lines).map(curves),
        Format::JpkText => jpk::text::read(lines).map(curves),
        Format::Mach1
        | Format::JpkArchive
        | Format::Workbook
        | Format::CurveTable
        | Format::MapTable => Err(Fault::file(
            format!("{} is no maker's text", format.name()),
            "report this",
        )),
    }
}
