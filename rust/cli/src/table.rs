//! CSV files that a person wrote: opened, with their column names, and their faults in a sentence.

use crate::fault::Fault;
use std::fs::File;
use std::path::Path;

/// A CSV file whose first line was read.
pub struct Table {
    /// Names of the columns, without a byte-order mark.
    pub columns: Vec<String>,
    reader: csv::Reader<File>,
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
            .from_path(file)
            .map_err(|error| fault(&told, &error))?;
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
