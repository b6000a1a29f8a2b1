//! Comparison of one handprint with one contact that was solved elsewhere; only the paper's pose is fitted.

use nalgebra::Vector3;

use crate::comparison::compare_fit::compare_fit;
use crate::comparison::result::{Compared, Comparison};
use crate::prints::compare_print::compare;
use crate::prints::print_case::{Pressed, PrintCase};
use thenar_inference::errors::InferenceError;
use thenar_inference::fit::result::Fit;
use thenar_inference::observe::measured::{Mat, Measured};

/// A print, the paper as it lies, and the contact it is compared with; all in one frame of coordinates, mm.
#[derive(Debug, Clone)]
pub struct StillPrint<'a> {
    /// Name of the recording.
    pub name: &'a str,
    /// Name of the product.
    pub product: &'a str,
    /// Name of the hand.
    pub hand: &'a str,
    /// The contact.
    pub pressed: Pressed<'a>,
    /// Cells of the paper as they lie on the product, with rows and columns.
    pub mat: Mat,
    /// Share of ink by cell; NaN where nothing is known.
    pub inked: &'a [f64],
    /// Pressure above which skin leaves ink, kPa.
    pub ink_kpa: f64,
    /// Region of every vertex and their names; empty: one region.
    pub regions: (&'a [i32], &'a [String]),
    /// What cannot be known, a sentence each.
    pub unknown: Vec<String>,
}

/// Compares a print with a contact.
///
/// # Errors
/// [`InferenceError::NothingMeasured`] if the print shows no contact, or its cells are not numbered.
pub fn compare_print(still: StillPrint<'_>) -> Result<Comparison, InferenceError> {
    let found = compare(&PrintCase {
        mat: &still.mat,
        inked: still.inked,
        ink_kpa: still.ink_kpa,
        pressed: still.pressed,
        before: None,
        position_mm: None,
        regions: still.regions,
    });
    let Some((printed, mut table)) = found else {
        return Err(InferenceError::NothingMeasured {
            recordings: 1,
            reasons: format!(
                "'{}': no cell of it is half inked, or its cells have no rows and columns",
                still.name
            ),
        });
    };
    table.iter_mut().for_each(|row| row.before = f64::NAN);
    let measured = measured(&still);
    let note =
        "Nothing but the paper's pose was fitted: the simulation is the contact as it was solved.";
    let fit = Fit::of_nothing(vec![measured], vec![note.to_string()]);
    let positions: &[Vector3<f64>] = still.pressed.positions;
    Ok(compare_fit(&Compared {
        title: &format!("{} on {}", still.hand, still.product),
        skin: positions,
        sites: &[],
        fit: &fit,
        location: None,
        prints: &[Some((printed, table))],
    }))
}

fn measured(still: &StillPrint<'_>) -> Measured {
    Measured {
        name: still.name.to_string(),
        protocol: still.name.to_string(),
        indenter: still.product.to_string(),
        site: still.hand.to_string(),
        moments: Vec::new(),
        samples: Vec::new(),
        mat: Some(still.mat.clone()),
        scan: None,
        is_calibrated: true,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: still.unknown.clone(),
    }
}
