//! CSV files that a person wrote: opened, with their column names, and their faults in a sentence.

use crate::fault::Fault;
use std::io::Cursor;
use std::path::Path;
use thenar_recordings::plain_file;

/// Largest file of settings that is read, bytes.
const LARGEST: u64 = 64 << 20;

/// What to do about a larger one.
const REMEDY: &str = "a table of settings holds a line for each; look at what it is";

fn bytes(file: &Path) -> Result<Vec<u8>, Fault> {
    plain_file::bytes(file, LARGEST, REMEDY).map_err(|error| Fault::Input(error.to_string()))
}

/// The text of a file that a person wrote.
///
/// # Errors
/// A file that cannot be read, is none, is too large or is not UTF-8.
pub fn text(file: &Path) -> Result<String, Fault> {
    String::from_utf8(bytes(file)?)
        .map_err(|error| Fault::Input(format!("{}: cannot be read ({error})", file.display())))
}

/// A CSV file whose first line was read.
pub struct Table {
    /// Names of the columns, without a byte-order mark.
    pub columns: Vec<String>,
    reader: csv::Reader<Cursor<Vec<u8>>>,
    /// File and what it must be, for sentences.
    told: (String, &'static str),
}

impl Table {
    /// Opens `file`, which must be what `expected` says ("a CSV of vertex,region").
    ///
    /// # Errors
    /// Names the file and what it must be.
    pub fn open(file: &Path, expected: &'static str) -> Result<Table, Fault> {
        let told = (file.display().to_string(), expected);
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(Cursor::new(bytes(file)?));
        let headers = reader.headers().map_err(|error| fault(&told, &error))?;
        let bare = |name: &str| name.trim_start_matches('\u{feff}').to_owned();
        let columns = headers.iter().map(bare).collect();
        Ok(Table {
            columns,
            reader,
            told,
        })
    }

    /// Each record with its line.
    pub fn records(
        &mut self,
    ) -> impl Iterator<Item = Result<(u64, csv::StringRecord), Fault>> + '_ {
        let told = &self.told;
        self.reader.records().map(move |record| {
            let record = record.map_err(|error| fault(told, &error))?;
            Ok((record.position().map_or(0, csv::Position::line), record))
        })
    }
}

fn fault((file, expected): &(String, &str), error: &csv::Error) -> Fault {
    Fault::Input(format!("{file}: {error}; it must be {expected}"))
}
