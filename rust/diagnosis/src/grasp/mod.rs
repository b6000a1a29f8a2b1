//! Diagnosis of grasps: a whole hand on a product, read by a mat over a hold.

mod verdict;
mod grasp_findings;
mod notes;

pub(crate) use verdict::diagnose_grasps;
