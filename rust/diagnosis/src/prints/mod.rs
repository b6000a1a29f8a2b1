//! A handprint beside a contact: where ink and simulated contact overlap, with the pose of the paper as a fitted nuisance.
//!
//! A cell of the print is evidence of contact and never of pressure: it touched if at least half of it is inked, and touches in
//! simulation if at least half of it bears more than the pressure at which skin leaves ink. Overlap is what it is for mats: the area where both
//! touch over the area where either does; what the published "handprint overlap" divides by is not stated there.

mod sheet;
mod field;
mod fitting;
mod measures;
mod regions;
mod patches;
mod studied;
mod still;

use crate::Mat;
use crate::comparison::{Measure, WorstPlace};
use field::Field;
use fitting::{Cells, Fitted, best};
use nalgebra::Vector3;
use sheet::Sheet;

pub use regions::PrintRegion;
pub use still::{StillPrint, compare_print};
pub(crate) use studied::{Studied, add_prints};

pub(crate) use thenar_recordings::handprint::TOUCHED_FROM;

/// A print is called mirrored if its overlap is so much larger when it is turned about.
const MUCH_BETTER: f64 = 0.1;
/// Standard deviation of where a paper that was laid by hand lies, mm and rad (5 degrees), where the study does not say.
const LAID: (f64, f64) = (3.0, 0.087);
/// kPa in 1 MPa.
const KPA: f64 = 1e3;

/// A contact as it was solved, in the product's frame; a value per vertex of the skin.
#[derive(Debug, Clone, Copy)]
pub struct Pressed<'a> {
    /// Positions in contact, mm.
    pub positions: &'a [Vector3<f64>],
    /// Area of each vertex, mm2.
    pub areas: &'a [f64],
    /// Normal force, N.
    pub force_n: &'a [f64],
}

impl Pressed<'_> {
    /// Whether skin leaves ink at a vertex: it presses, and with more than that on the mean of its area.
    fn inks(&self, vertex: usize, ink_kpa: f64) -> bool {
        let (force, area) = (self.force_n[vertex], self.areas[vertex]);
        force > 0.0 && KPA * force > ink_kpa * area
    }
}

/// A print and what it is compared with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PrintCase<'a> {
    /// Its cells as they are said to lie, with rows and columns.
    pub mat: &'a Mat,
    /// Share of ink by cell; NaN where nothing is known.
    pub inked: &'a [f64],
    /// Pressure above which skin leaves ink, kPa.
    pub ink_kpa: f64,
    /// The contact.
    pub pressed: Pressed<'a>,
    /// The contact with the parameters at which a fit began.
    pub before: Option<Pressed<'a>>,
    /// Standard deviation of where the paper lies, mm; None: as laid by hand.
    pub position_mm: Option<f64>,
    /// Region of every vertex, -1 for none, and their names; empty: one region.
    pub regions: (&'a [i32], &'a [String]),
}

/// One number of the paper's pose with its 90 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PosePart {
    /// mm or rad.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Contact that was recorded, that is simulated, and that is both, mm2.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Areas {
    recorded: f64,
    simulated: f64,
    both: f64,
}

impl Areas {
    fn add(&mut self, area: f64, [is_recorded, is_simulated]: [bool; 2]) {
        let of = |is: bool| if is { area } else { 0.0 };
        self.recorded += of(is_recorded);
        self.simulated += of(is_simulated);
        self.both += of(is_recorded && is_simulated);
    }

    /// Both over either; NaN where neither is.
    fn overlap(&self) -> f64 {
        self.both / (self.recorded + self.simulated - self.both)
    }
}

/// 1 where ink is alone, -1 where simulated contact is alone, 0 where both are or neither.
fn residual([is_recorded, is_simulated]: [bool; 2]) -> f64 {
    f64::from(i8::from(is_recorded) - i8::from(is_simulated))
}

/// A print beside its simulation; lists have a value per cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Printed {
    /// Share of ink; NaN where nothing is known.
    pub recorded: Vec<f64>,
    /// Share in simulated contact, the paper in its fitted pose.
    pub simulated: Vec<f64>,
    /// The same with the paper as it is said to lie.
    pub as_laid: Vec<f64>,
    /// Pressure above which skin leaves ink, kPa.
    pub ink_kpa: f64,
    /// How far the paper lies along its columns and its rows from where it is said to (mm), and how it is turned about the middle of the ink
    /// (rad, from columns to rows).
    pub pose: [PosePart; 3],
    /// Overlap in the best pose of the print seen from behind.
    pub mirrored_overlap: f64,
    /// True if that is much better: the image then shows the print from behind.
    pub is_mirrored: bool,
    /// By region of the skin, where there are several.
    pub regions: Vec<PrintRegion>,
    /// Residual by vertex of the skin: 1 inked alone, -1 simulated alone, 0 both or neither, NaN where nothing is known.
    pub on_skin: Vec<f64>,
    /// Part of the simulated force that presses beside the paper.
    pub beside: f64,
    /// True if the pose lies at the end of what is sought: the paper may lie farther off.
    pub is_at_end: bool,
    /// Patches on which only one of the two touches, the largest first.
    pub worst: Vec<WorstPlace>,
}

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
    let cell_of = regions::cell_of(case, &sheet, (&cells, &fitted));
    let (on_skin, beside) = regions::on_skin(case, &cell_of);
    let mut printed = Printed {
        recorded: case.inked.to_vec(),
        ink_kpa: case.ink_kpa,
        pose: fitted.parts,
        is_mirrored: mirrored_overlap > overlap + MUCH_BETTER,
        mirrored_overlap,
        regions: regions::by_region(case, &on_skin),
        on_skin,
        beside,
        is_at_end: fitted.is_at_end(sd),
        worst: Vec::new(),
        simulated,
        as_laid,
    };
    printed.worst = patches::patches(case, &sheet, (&printed.by_cell(), &cell_of));
    let started = before.unwrap_or_else(|| printed.as_laid.clone());
    let table = measures::table(case.mat, &printed, &started);
    Some((printed, table))
}

impl Printed {
    /// Residual by cell, as by vertex: 1 inked alone, -1 simulated alone, 0 both or neither, NaN where nothing is known.
    pub fn by_cell(&self) -> Vec<f64> {
        let cells = self.recorded.iter().zip(&self.simulated);
        let one = |(recorded, simulated): (&f64, &f64)| match recorded.is_nan() {
            true => f64::NAN,
            false => residual([recorded, simulated].map(|share| *share >= TOUCHED_FROM)),
        };
        cells.map(one).collect()
    }

    /// What a designer reads first.
    pub(crate) fn sentence(&self, table: &[Measure]) -> String {
        measures::sentence(self, table)
    }
}

impl Fitted {
    /// Shift and turn.
    fn pose(&self) -> [f64; 3] {
        self.parts.map(|part| part.value)
    }

    /// Whether a number lies at the end of what was sought, given standard deviations of shift and turn.
    fn is_at_end(&self, (shift, turn): (f64, f64)) -> bool {
        let reached = self.pose().into_iter().zip([shift, shift, turn]);
        reached
            .into_iter()
            .any(|(value, sd)| value.abs() > 0.98 * fitting::MOST * sd)
    }
}
