//! Tables with a line of column names: CSV of a study, CSV and workbooks of testing machines.

mod names;
pub(crate) mod columns;
pub(crate) mod mapping;
pub(crate) mod head;
pub(crate) mod run;
pub(crate) mod curves;
pub(crate) mod maps;
pub(crate) mod sheet_text;
