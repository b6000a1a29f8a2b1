//! The last active zone and its linear problem: coupling, compliance and their storage, reused while the zone stays.

use thenar_surface::Vec3;

use crate::far_field::ZoneCoupling;
use crate::solve::row_runs::RowRuns;

/// The last active zone and its linear problem.
#[derive(Debug, Clone, Default)]
pub struct ZoneProblem {
    /// Zone of the last press.
    pub zone: Vec<u32>,
    /// Sites that were solved last, the zone or the part of it that was not reused.
    pub coupled_sites: Vec<u32>,
    /// Their coupling `K`, 1/mm; rows in memory.
    pub coupling: RowRuns<f32>,
    /// Their compliance, mm/N, kept for its storage.
    pub compliance: RowRuns<f32>,
    /// In a large skin, their coupling by near and far blocks.
    pub coupled: ZoneCoupling,
    /// In a large skin, response weight times press direction of each.
    pub along: Vec<Vec3>,
}
