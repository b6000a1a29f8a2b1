//! Grasps: a mat on a product that a whole hand holds, explained by posture, tissue and instrument.

pub mod hold;
pub mod product_maps;
pub mod regional_fit;
pub mod time_course;
pub mod cell_faults;
pub mod linear_evidence;
pub mod channels;
pub mod causes;
pub mod explain;
pub mod as_fit;
