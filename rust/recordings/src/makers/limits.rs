//! How large a mat can be; a header that states more is damaged.

use crate::fault::shown;

/// Most rows or columns of a mat; the largest on the market have 256.
pub(super) const WIDEST: usize = 4096;

/// Most cells of a mat, so that a damaged header cannot claim memory; the largest on the market have 65,536.
const MOST_CELLS: usize = 1 << 20;

/// A count of rows, columns or sensors that a header states.
pub(super) fn count(text: &str, what: &str) -> Result<usize, String> {
    match text.trim().parse::<usize>() {
        Ok(count) if (1..=WIDEST).contains(&count) => Ok(count),
        Ok(count) => Err(format!("{count} {what}, expected 1 to {WIDEST}")),
        Err(_) => Err(format!(
            "{} is not a number of {what}",
            shown(text.trim().as_bytes())
        )),
    }
}

/// Refuses a mat of more cells than any has.
pub(super) fn check_cells(rows: usize, columns: usize) -> Result<(), String> {
    match rows.saturating_mul(columns) <= MOST_CELLS {
        true => Ok(()),
        false => Err(format!(
            "{rows} x {columns} cells, expected {MOST_CELLS} at most"
        )),
    }
}
