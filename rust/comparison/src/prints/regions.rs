//! Ink and simulated contact by vertex of the skin and by region of the hand.

use thenar_recordings::handprint::TOUCHED_FROM;

use crate::prints::contact_areas::{Areas, residual};
use crate::prints::paper_pose::{Cells, Fitted};
use crate::prints::paper_sheet::Sheet;
use crate::prints::print_case::PrintCase;
use crate::prints::print_region::PrintRegion;

/// The cell on which each vertex comes to lie, the paper in its fitted pose.
pub fn cell_of(
    case: &PrintCase<'_>,
    sheet: &Sheet,
    (cells, fitted): (&Cells, &Fitted),
) -> Vec<Option<usize>> {
    let pose = fitted.pose();
    let cell = |position| {
        let (at, _) = sheet.spot(position)?;
        let mut images = sheet.images(at).into_iter();
        images.find_map(|at| sheet.cell(cells.back(at, &pose)))
    };
    case.pressed.positions.iter().map(cell).collect()
}

/// Residual by vertex as [`crate::prints::Printed::on_skin`], and the part of the force that presses beside the paper.
pub fn on_skin(case: &PrintCase<'_>, cell_of: &[Option<usize>]) -> (Vec<f64>, f64) {
    let (mut all, mut beside) = (0.0, 0.0);
    let mut at_vertex = |(vertex, cell): (usize, &Option<usize>)| {
        let inked = cell.map_or(f64::NAN, |cell| case.inked[cell]);
        let force = case.pressed.force_n[vertex].max(0.0);
        all += force;
        if inked.is_nan() {
            beside += force;
            return f64::NAN;
        }
        residual([inked >= TOUCHED_FROM, presses(case, vertex)])
    };
    let residual = cell_of.iter().enumerate().map(&mut at_vertex).collect();
    (residual, if all > 0.0 { beside / all } else { 0.0 })
}

fn presses(case: &PrintCase<'_>, vertex: usize) -> bool {
    case.pressed.inks(vertex, case.ink_kpa)
}

/// Areas and overlap of every region that either shows; none where there is one region.
pub fn by_region(case: &PrintCase<'_>, on_skin: &[f64]) -> Vec<PrintRegion> {
    let (regions, names) = case.regions;
    if names.len() < 2 || regions.len() != on_skin.len() {
        return Vec::new();
    }
    let of = |(number, name): (usize, &String)| {
        let mut areas = Areas::default();
        for (vertex, residual) in on_skin.iter().enumerate() {
            if residual.is_nan() || usize::try_from(regions[vertex]) != Ok(number) {
                continue;
            }
            let is_pressed = presses(case, vertex);
            let is_inked = *residual > 0.0 || *residual == 0.0 && is_pressed;
            areas.add(case.pressed.areas[vertex], [is_inked, is_pressed]);
        }
        PrintRegion {
            name: name.clone(),
            recorded_mm2: areas.recorded,
            simulated_mm2: areas.simulated,
            overlap: areas.overlap(),
        }
    };
    let all = names.iter().enumerate().map(of);
    all.filter(|region| region.recorded_mm2 + region.simulated_mm2 > 0.0)
        .collect()
}
