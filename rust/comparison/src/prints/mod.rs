//! Handprints compared with a contact: overlap of ink and simulated contact, with the pose of the paper as a fitted nuisance.
//!
//! A cell of the print is evidence of contact and never of pressure: it touched if at least half of it is inked, and touches in
//! simulation if at least half of it bears more than the pressure at which skin leaves ink. Overlap is what it is for mats: the area where both
//! touch over the area where either does; what the published "handprint overlap" divides by is not stated there.

pub mod contact_areas;
pub mod print_case;
pub mod print_region;
pub mod printed;
pub mod paper_sheet;
pub mod contact_raster;
pub mod paper_pose;
pub mod measures;
pub mod regions;
pub mod mismatch_patches;
pub mod compare_print;
pub mod study_prints;
pub mod single_print;

pub use print_case::Pressed;
pub use print_region::PrintRegion;
pub use printed::{PosePart, Printed};
pub use single_print::{StillPrint, compare_print};
