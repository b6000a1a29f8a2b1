//! Coupling and displacement of a zone: by rows in memory, or by the far field of a large skin.

use crate::far_field::block_kernels::zeros;
use crate::far_field::{
    Clusters, DirectionalCoupling, FarFieldDisplacement, MOST_GIB, ZoneCoupling,
};
use crate::response::assembly::{Load, coupling, displacements};
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::{ContactError, Control};
use thenar_surface::Vec3;

impl Pressing<'_> {
    /// Makes the coupling between the sites of `zone` (ascending), or keeps the last one if it is the same.
    ///
    /// # Errors
    /// [`ContactError::TooLarge`] before memory is taken, or `Cancelled`.
    pub(crate) fn couple(&mut self, zone: &[u32], control: &Control) -> Result<(), ContactError> {
        let (skin, problem) = (self.skin, &mut self.workspace.problem);
        if problem.coupled_sites == zone && !zone.is_empty() {
            return Ok(());
        }
        control.step("response", 0.0)?;
        if let Some(hierarchy) = &skin.hierarchy {
            // What the last zone held is given back before the next is made.
            (problem.coupled, problem.coupled_sites) = (ZoneCoupling::default(), Vec::new());
            problem.coupled = ZoneCoupling::new(hierarchy, zone, skin.ground(), control)?;
        } else {
            skin.make_rows(zone, control)?;
            // Until it is made, it is that of no sites: its storage is used again.
            problem.coupled_sites.clear();
            coupling((&skin.response, &skin.sites), zone, &mut problem.coupling);
        }
        problem.coupled_sites = zone.to_vec();
        Ok(())
    }

    /// The far-field compliance that a large skin is solved with; None where the matrix in memory is used.
    pub(crate) fn far_field_compliance(&self) -> Option<DirectionalCoupling<'_>> {
        let workspace = &self.workspace;
        let is_large = self.skin.hierarchy.is_some();
        is_large
            .then(|| DirectionalCoupling::new(&workspace.problem.coupled, &workspace.problem.along))
    }

    /// Displacement of the skin under loads.
    ///
    /// # Errors
    /// [`ContactError::Cancelled`].
    pub(crate) fn displacement(
        &self,
        mut loads: Vec<Load>,
        control: &Control,
    ) -> Result<FarFieldDisplacement, ContactError> {
        let Some(hierarchy) = &self.skin.hierarchy else {
            return Ok(FarFieldDisplacement {
                field: displacements(&self.skin.response, &loads, &self.skin.sites),
                certificate: 0.0,
            });
        };
        loads.sort_by_key(|load| load.site);
        let sum = |same: &[Load]| Load {
            site: same[0].site,
            load: same.iter().map(|load| load.load).sum::<Vec3>(),
        };
        let loads: Vec<Load> = loads.chunk_by(|a, b| a.site == b.site).map(sum).collect();
        let zone = &self.workspace.problem.coupled_sites;
        let mut known = vec![None; self.skin.sites.len()];
        if !loads
            .iter()
            .all(|load| zone.binary_search(&load.site).is_ok())
        {
            let bearing: Vec<u32> = loads.iter().map(|load| load.site).collect();
            let clusters = Clusters::new(hierarchy, &bearing, self.skin.ground(), control)?;
            return hierarchy.displacement(
                (&loads, &clusters),
                &known,
                self.skin.ground(),
                control,
            );
        }
        // Within the zone the field is a product of the solver's own operator.
        let coupled = &self.workspace.problem.coupled;
        let mut fields = zeros(zone.len());
        let (mut from, to) = (vec![false; zone.len()], vec![true; zone.len()]);
        for load in &loads {
            let place = zone.partition_point(|site| *site < load.site);
            from[place] = true;
            (0..3).for_each(|axis| fields[axis][place] = load.load[axis]);
        }
        let [x, y, z] = coupled.times(&fields, (&from, &to));
        for (k, &site) in zone.iter().enumerate() {
            known[site as usize] = Some(Vec3::new(x[k], y[k], z[k]));
        }
        hierarchy.displacement(
            (&loads, &coupled.clusters),
            &known,
            self.skin.ground(),
            control,
        )
    }
}

impl Skin {
    /// Makes the rows of the response of the sites of `zone` that are missing.
    ///
    /// # Errors
    /// [`ContactError::TooLarge`] before memory is taken, or `Cancelled`.
    pub(crate) fn make_rows(&self, zone: &[u32], control: &Control) -> Result<(), ContactError> {
        let needed_gib = self.response.bytes(zone, &self.sites) / f64::from(1 << 30);
        if needed_gib > MOST_GIB {
            return Err(ContactError::TooLarge {
                vertices: zone.len(),
                needed_gib,
                limit_gib: MOST_GIB,
            });
        }
        for part in zone.chunks(512) {
            self.response.make_rows(part, &self.sites);
            control.check()?;
        }
        Ok(())
    }
}
