//! Tables with a line of column names: plain CSV of a study, and CSV of testing machines.

pub(crate) mod columns;
pub(crate) mod curves;
pub(crate) mod maps;
