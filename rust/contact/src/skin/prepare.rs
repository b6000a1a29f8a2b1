//! The prepared skin: built once from a rest mesh, regions and materials; never changed. Other effects or materials make another.

use std::sync::{Arc, OnceLock};

use thenar_surface::{Adjacency, Mesh, SkinDistance, Vec3, median_edge_length, vertex_areas};

use super::merged_vertices::MergedMesh;
use super::sites::Sites;
use super::tissue::{Place, Tissue};
use crate::far_field::hierarchy::{Hierarchy, SkinResponse};
use crate::interface::shear_kernel::ShearTables;
use crate::response::kernel_grid::RANGE_IN_THICKNESSES;
use crate::response::rows::{Response, extent};
use crate::{ActiveEffect, ContactError, Control, Material, Model, SkinInput};

/// Spacing below which the paper's r0 would make its matrix indefinite, mm.
pub(crate) const PAPER_SPACING: f64 = 0.8;

/// A prepared skin: what presses only read. What they write is in a [`Workspace`](crate::Workspace).
///
/// Any number of threads may press one skin at once, each with a workspace of its own, and get the bits that each gets alone.
/// Rows of the response are made when first needed, once for all of them.
///
/// Effects and materials are part of a skin. [`Skin::with_effects`] and [`Skin::with_materials`] make another one that shares
/// the prepared geometry with this one, and the response with its rows where the change leaves it as it is. They do not travel
/// with a press: they are composed and checked once, not in every press, and many workspaces can be on one response.
/// Copies share all of it.
#[derive(Debug, Clone)]
pub struct Skin {
    pub(crate) model: Model,
    /// Materials as given, by region.
    base: Vec<Material>,
    effects: Vec<ActiveEffect>,
    /// What the effects make of the materials and the response.
    pub(crate) tissue: Tissue,
    pub(crate) regions: Arc<[i32]>,
    region_names: Arc<[String]>,
    pub(crate) merged: Arc<MergedMesh>,
    pub(crate) adjacency: Arc<Adjacency>,
    pub(crate) metric: Arc<SkinDistance>,
    /// Range of the metric, mm.
    range: f64,
    pub(crate) sites: Arc<Sites>,
    pub(crate) rest_area: Arc<[f64]>,
    /// Median edge, mm.
    pub(crate) spacing: f64,
    pub(crate) response: Arc<Response>,
    /// The hierarchy of a large skin, in place of response rows.
    pub(crate) hierarchy: Option<Arc<Hierarchy>>,
    /// Kernels of shear of that response, once friction has needed them.
    shear: Arc<OnceLock<ShearTables>>,
    warnings: Vec<String>,
}

impl Skin {
    /// Prepares a hand: welds seams, numbers the skin, blends materials over creases, tabulates the kernel.
    ///
    /// # Errors
    /// [`ContactError`] naming the material, region or array that is wrong, or `Cancelled`.
    pub fn prepare(input: SkinInput, control: &Control) -> Result<Skin, ContactError> {
        Skin::prepare_named(input, Vec::new(), control)
    }

    /// [`Skin::prepare`] with names of the regions, by number, that warnings and errors use; regions without one are numbered.
    ///
    /// # Errors
    /// As [`Skin::prepare`].
    pub fn prepare_named(
        input: SkinInput,
        region_names: Vec<String>,
        control: &Control,
    ) -> Result<Skin, ContactError> {
        let SkinInput {
            mesh,
            mut regions,
            materials,
            model,
        } = input;
        let vertices = mesh.positions().len();
        if regions.is_empty() {
            regions = vec![0; vertices];
        }
        check_regions(&regions, (&materials, &region_names), vertices)?;
        control.step("preparing", 0.0)?;
        let (mesh, mut warnings) = audited(mesh)?;
        let welded = MergedMesh::new(&mesh).map_err(ContactError::Hand)?;
        let spacing = median_edge_length(&welded.mesh);
        if welded.merged() > 0 {
            warnings.push(format!(
                "the hand: {} vertices are nearer to another one than a quarter of the edges around them and bear nothing of \
                 their own; merge them by distance to be rid of this",
                welded.merged()
            ));
        }
        let welded_regions: Vec<i32> = welded.source.iter().map(|&v| regions[v as usize]).collect();
        let adjacency = Adjacency::new(&welded.mesh);
        control.step("preparing", 0.3)?;
        let thickest = materials.iter().map(|m| m.thickness_mm).fold(0.0, f64::max);
        let range = range(model, thickest);
        let metric = SkinDistance::new(&welded.mesh, &adjacency, range);
        control.step("preparing", 0.6)?;
        let sites = Sites::new(
            (&welded.mesh, &adjacency),
            &welded_regions,
            spacing,
            &metric,
        );
        if sites.len() == 0 {
            return Err(ContactError::NoSkin);
        }
        warnings.extend(model_warnings(model, spacing));
        control.step("preparing", 0.8)?;
        let tissue = Tissue::bare(&materials);
        let response = Response::new(model, &tissue.geometry, &sites, &metric);
        let ground = SkinResponse {
            response: &response,
            sites: &sites,
        };
        let hierarchy = Hierarchy::new(model, ground);
        control.step("preparing", 1.0)?;
        let rest_area = vertex_areas(&welded.mesh);
        Ok(Skin {
            model,
            base: materials,
            effects: Vec::new(),
            tissue,
            range,
            regions: regions.into(),
            region_names: region_names.into(),
            merged: Arc::new(welded),
            adjacency: Arc::new(adjacency),
            metric: Arc::new(metric),
            sites: Arc::new(sites),
            rest_area: rest_area.into(),
            spacing,
            response: Arc::new(response),
            hierarchy: hierarchy.map(Arc::new),
            shear: Arc::default(),
            warnings,
        })
    }

    /// Sentences about the hand mesh, found while preparing.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The same skin with a sentence that every result repeats, such as what a caller assumed where nothing was given.
    pub fn with_note(mut self, sentence: String) -> Skin {
        self.warnings.push(sentence);
        self
    }

    /// What sentences call a region: "region 3", or "region 'index fingertip'" where it has a name.
    pub fn region_title(&self, region: usize) -> String {
        title(&self.region_names, region)
    }

    /// Number of vertices of the mesh as given.
    pub fn vertices(&self) -> usize {
        self.regions.len()
    }

    /// The model chosen.
    pub fn model(&self) -> Model {
        self.model
    }

    /// Materials by region, as given.
    pub fn materials(&self) -> &[Material] {
        &self.base
    }

    /// The skin with these materials in place of its own. The response is prepared again only where they change it.
    ///
    /// # Errors
    /// [`ContactError::Material`] naming the region and the number, or `Cancelled`.
    pub fn with_materials(
        &self,
        materials: &[Material],
        control: &Control,
    ) -> Result<Skin, ContactError> {
        check_regions(
            &self.regions,
            (materials, &self.region_names),
            self.vertices(),
        )?;
        self.derived(materials.to_vec(), self.effects.clone(), control)
    }

    /// The effects switched on.
    pub fn effects(&self) -> &[ActiveEffect] {
        &self.effects
    }

    /// Soft tissue over bone under every vertex of the mesh as given, mm, with the effects that are switched on; infinite
    /// where the material knows no bone, NaN away from the skin.
    pub fn thickness(&self) -> Vec<f64> {
        let at = |&vertex: &u32| match self.sites.of_vertex[vertex as usize] {
            u32::MAX => f64::NAN,
            site if !self.sites.is_skin(site as usize) => f64::NAN,
            site => {
                let region = self.sites.home_region(site as usize) as usize;
                self.tissue.thickness(site as usize, region)
            }
        };
        self.merged.merged_of.iter().map(at).collect()
    }

    /// The skin with these effects in place of its own. The response is prepared again only where they change it.
    ///
    /// # Errors
    /// [`ContactError::Effect`] naming the effect, the number and what is admissible, or `Cancelled`.
    pub fn with_effects(
        &self,
        effects: Vec<ActiveEffect>,
        control: &Control,
    ) -> Result<Skin, ContactError> {
        self.derived(self.base.clone(), effects, control)
    }

    /// True if it has the response of another one, with all that was made of it.
    pub fn shares_response(&self, other: &Skin) -> bool {
        Arc::ptr_eq(&self.response, &other.response)
    }

    fn derived(
        &self,
        base: Vec<Material>,
        effects: Vec<ActiveEffect>,
        control: &Control,
    ) -> Result<Skin, ContactError> {
        for effect in &effects {
            effect.validate(self.model, (base.len(), self.vertices()))?;
        }
        let place = Place {
            sites: &self.sites,
            metric: &self.metric,
            source: &self.merged.source,
        };
        let tissue = Tissue::new(&base, &effects, &place)?;
        let mut skin = self.clone();
        if tissue.geometry != self.tissue.geometry {
            control.step("preparing", 0.0)?;
            let range = range(self.model, tissue.thickest());
            if range > self.range {
                let metric = SkinDistance::new(&self.merged.mesh, &self.adjacency, range);
                (skin.metric, skin.range) = (Arc::new(metric), range);
            }
            let response = Response::new(self.model, &tissue.geometry, &self.sites, &skin.metric);
            skin.response = Arc::new(response);
            skin.hierarchy = Hierarchy::new(self.model, skin.ground()).map(Arc::new);
            skin.shear = Arc::default();
        }
        (skin.base, skin.effects, skin.tissue) = (base, effects, tissue);
        control.step("preparing", 1.0)?;
        Ok(skin)
    }

    /// Kernels of shear of its response.
    pub(crate) fn shear_tables(&self) -> &ShearTables {
        let tables = || ShearTables::new(self.response.layers(), extent(&self.sites));
        self.shear.get_or_init(tables)
    }

    pub(crate) fn ground(&self) -> SkinResponse<'_> {
        SkinResponse {
            response: &self.response,
            sites: &self.sites,
        }
    }

    /// The welded mesh in a posture given for the mesh as given.
    ///
    /// # Errors
    /// [`ContactError::PosedCount`] or [`ContactError::PosedNotFinite`].
    pub(crate) fn posed(&self, posed: Option<&[Vec3]>) -> Result<Mesh, ContactError> {
        let Some(posed) = posed else {
            return Ok(self.merged.mesh.clone());
        };
        if posed.len() != self.regions.len() {
            return Err(ContactError::PosedCount {
                found: posed.len(),
                expected: self.regions.len(),
            });
        }
        if let Some(vertex) = posed.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            return Err(ContactError::PosedNotFinite { vertex });
        }
        let positions = self
            .merged
            .source
            .iter()
            .map(|&v| posed[v as usize])
            .collect();
        self.merged
            .mesh
            .with_positions(positions)
            .map_err(ContactError::Hand)
    }
}

/// Turns a hand that is inside out, and says what is odd about it. Open edges are not: a hand may end at its wrist.
fn audited(mesh: Mesh) -> Result<(Mesh, Vec<String>), ContactError> {
    let mut audit = mesh.audit();
    let is_inside_out = audit.is_inside_out();
    audit.boundary_edges = 0;
    let warnings = audit.warnings("the hand");
    if !is_inside_out {
        return Ok((mesh, warnings));
    }
    let turned = mesh
        .triangles()
        .iter()
        .map(|t| [t[0], t[2], t[1]])
        .collect();
    let mesh = Mesh::new(mesh.positions().to_vec(), turned).map_err(ContactError::Hand)?;
    Ok((mesh, warnings))
}

/// Range of distances along the skin that the response needs, mm.
fn range(model: Model, thickest: f64) -> f64 {
    match model {
        Model::Paper => f64::INFINITY,
        Model::Layer => RANGE_IN_THICKNESSES * thickest,
    }
}

fn check_regions(
    regions: &[i32],
    (materials, names): (&[Material], &[String]),
    vertices: usize,
) -> Result<(), ContactError> {
    if regions.len() != vertices {
        return Err(ContactError::RegionCount {
            found: regions.len(),
            expected: vertices,
        });
    }
    for (index, material) in materials.iter().enumerate() {
        material.validate(&format!("of {}", title(names, index)))?;
    }
    match regions.iter().copied().max() {
        Some(most) if most < 0 => Err(ContactError::NoSkin),
        Some(most) if most as usize >= materials.len() => Err(ContactError::MissingMaterial {
            region: most,
            title: title(names, most as usize),
            materials: materials.len(),
        }),
        _ => Ok(()),
    }
}

fn title(names: &[String], region: usize) -> String {
    match names.get(region).filter(|name| !name.is_empty()) {
        Some(name) => format!("region '{name}'"),
        None => format!("region {region}"),
    }
}

fn model_warnings(model: Model, spacing: f64) -> Option<String> {
    (model == Model::Paper && spacing < PAPER_SPACING).then(|| {
        format!(
            "model paper: the vertex spacing is {spacing:.2} mm; below {PAPER_SPACING} mm the paper's r0 = 0.5 mm would \
             make its matrix indefinite, so that half the spacing is taken for r0 instead"
        )
    })
}
