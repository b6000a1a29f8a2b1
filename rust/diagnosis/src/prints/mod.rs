//! Handprints compared with a contact: overlap of ink and simulated contact, with the pose of the paper as a fitted nuisance.
//!
//! A cell of the print is evidence of contact and never of pressure: it touched if at least half of it is inked, and touches in
//! simulation if at least half of it bears more than the pressure at which skin leaves ink. Overlap is what it is for mats: the area where both
//! touch over the area where either does; what the published "handprint overlap" divides by is not stated there.

pub(crate) mod contact_areas;
pub(crate) mod print_case;
pub(crate) mod print_region;
pub(crate) mod printed;
pub(crate) mod paper_sheet;
pub(crate) mod contact_raster;
pub(crate) mod paper_pose;
pub(crate) mod measures;
pub(crate) mod regions;
pub(crate) mod mismatch_patches;
pub(crate) mod compare_print;
pub(crate) mod study_prints;
pub(crate) mod single_print;

pub use print_case::Pressed;
pub use print_region::PrintRegion;
pub use printed::{PosePart, Printed};
pub use single_print::{StillPrint, compare_print};
