//! Comparison of one handprint with a contact: overlap of ink and simulated contact, the paper's pose fitted.
//!
//! A cell of the print is evidence of contact and never of pressure: it touched if at least half of it is inked, and touches in
//! simulation if at least half of it bears more than the pressure at which skin leaves ink. Overlap is what it is for mats: the area where both
//! touch over the area where either does; what the published "handprint overlap" divides by is not stated there.

use crate::comparison::quantities::Measure;
use crate::prints::contact_raster::Field;
use crate::prints::paper_pose::{Cells, Fitted, best};
use crate::prints::paper_sheet::Sheet;
use crate::prints::print_case::PrintCase;
use crate::prints::printed::Printed;

/// A print is called mirrored if its overlap is so much larger when it is turned about.
const MUCH_BETTER: f64 = 0.1;
/// Standard deviation of where a paper that was laid by hand lies, mm and rad (5 degrees), where the study does not say.
const LAID: (f64, f64) = (3.0, 0.087);

/// What a print shows against a contact, and its table of measures; None for cells without rows and columns, and for a print of which no
/// cell touched.
pub(crate) fn compare(case: &PrintCase<'_>) -> Option<(Printed, Vec<Measure>)> {
    let sheet = Sheet::new(case.mat)?;
    let cells = Cells::new(&sheet, case.mat, case.inked)?;
    let field = Field::of(&sheet, &case.pressed, case.ink_kpa);
    let sd = (case.position_mm.unwrap_or(LAID.0), LAID.1);
    let fitted = best(&cells, &field, sd);
    let turned = cells.mirrored(&sheet);
    let mirrored = turned.map(|turned| {
        let back = best(&turned, &field, sd);
        turned.overlap(&turned.shares(&field, &back.pose()))
    });
    let simulated = cells.shares(&field, &fitted.pose());
    let as_laid = cells.shares(&field, &[0.0; 3]);
    let overlap = cells.overlap(&simulated);
    let mirrored_overlap = mirrored.unwrap_or(f64::NAN);
    let before = case
        .before
        .map(|pressed| cells.shares(&Field::of(&sheet, &pressed, case.ink_kpa), &[0.0; 3]));
    let cell_of = crate::prints::regions::cell_of(case, &sheet, (&cells, &fitted));
    let (on_skin, beside) = crate::prints::regions::on_skin(case, &cell_of);
    let mut printed = Printed {
        recorded: case.inked.to_vec(),
        ink_kpa: case.ink_kpa,
        pose: fitted.parts,
        is_mirrored: mirrored_overlap > overlap + MUCH_BETTER,
        mirrored_overlap,
        regions: crate::prints::regions::by_region(case, &on_skin),
        on_skin,
        beside,
        is_at_end: fitted.is_at_end(sd),
        worst: Vec::new(),
        simulated,
        as_laid,
    };
    printed.worst =
        crate::prints::mismatch_patches::patches(case, &sheet, (&printed.by_cell(), &cell_of));
    let started = before.unwrap_or_else(|| printed.as_laid.clone());
    let table = crate::prints::measures::table(case.mat, &printed, &started);
    Some((printed, table))
}

impl Fitted {
    /// Shift and turn.
    pub(crate) fn pose(&self) -> [f64; 3] {
        self.parts.map(|part| part.value)
    }

    /// Whether a number lies at the end of what was sought, given standard deviations of shift and turn.
    fn is_at_end(&self, (shift, turn): (f64, f64)) -> bool {
        let reached = self.pose().into_iter().zip([shift, shift, turn]);
        reached
            .into_iter()
            .any(|(value, sd)| value.abs() > 0.98 * crate::prints::paper_pose::MOST * sd)
    }
}
