//! The prepared skin: built once from a rest mesh, regions and materials; effects and materials may be changed.

use thenar_surface::{Adjacency, Mesh, SkinDistance, Vec3, median_edge_length, vertex_areas};

use super::merged_vertices::MergedMesh;
use super::sites::Sites;
use super::tissue::{Place, Tissue};
use crate::far_field::hierarchy::{Hierarchy, SkinResponse};
use crate::history::tissue_memory::TissueMemory;
use crate::response::kernel_grid::RANGE_IN_THICKNESSES;
use crate::response::rows::Response;
use crate::workspace::Workspace;
use crate::{ActiveEffect, ContactError, Control, Material, Model, SkinInput};

/// Spacing below which the paper's r0 makes its matrix indefinite, mm.
pub(crate) const PAPER_SPACING: f64 = 0.8;

/// A prepared skin. Presses reuse its compliance rows; results depend on input alone unless a warm start is asked for.
#[derive(Debug, Clone)]
pub struct Skin {
    pub(crate) model: Model,
    /// Materials as given, by region.
    base: Vec<Material>,
    effects: Vec<ActiveEffect>,
    /// What the effects make of the materials and the response.
    pub(crate) tissue: Tissue,
    pub(crate) regions: Vec<i32>,
    region_names: Vec<String>,
    pub(crate) merged: MergedMesh,
    pub(crate) adjacency: Adjacency,
    pub(crate) metric: SkinDistance,
    /// Range of the metric, mm.
    range: f64,
    pub(crate) sites: Sites,
    pub(crate) rest_area: Vec<f64>,
    /// Median edge, mm.
    pub(crate) spacing: f64,
    pub(crate) response: Response,
    /// The hierarchy of a large skin, in place of response rows.
    pub(crate) hierarchy: Option<Hierarchy>,
    pub(crate) workspace: Workspace,
    /// Memory of the tissue, while a protocol is followed.
    pub(crate) history: Option<TissueMemory>,
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
        let workspace = Workspace::default();
        Ok(Skin {
            model,
            base: materials,
            effects: Vec::new(),
            tissue,
            range,
            regions,
            region_names,
            merged: welded,
            adjacency,
            metric,
            sites,
            rest_area,
            spacing,
            response,
            hierarchy,
            workspace,
            history: None,
            warnings,
        })
    }

    /// Sentences about the hand mesh, found while preparing.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Adds a sentence that every result repeats, such as what a caller assumed where nothing was given.
    pub fn note(&mut self, sentence: String) {
        self.warnings.push(sentence);
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

    /// Changes the materials, in place of those before. The response is prepared again only where they change it.
    ///
    /// # Errors
    /// [`ContactError::Material`] naming the region and the number, or `Cancelled`; the skin then stays as it was.
    pub fn set_materials(
        &mut self,
        materials: &[Material],
        control: &Control,
    ) -> Result<(), ContactError> {
        check_regions(
            &self.regions,
            (materials, &self.region_names),
            self.vertices(),
        )?;
        let before = std::mem::replace(&mut self.base, materials.to_vec());
        let changed = self.set_effects(self.effects.clone(), control);
        if changed.is_err() {
            self.base = before;
        }
        changed
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

    /// Switches effects on, in place of those before. The response is prepared again only where they change it.
    ///
    /// # Errors
    /// [`ContactError::Effect`] naming the effect, the number and what is admissible, or `Cancelled`; the skin then stays
    /// as it was.
    pub fn set_effects(
        &mut self,
        effects: Vec<ActiveEffect>,
        control: &Control,
    ) -> Result<(), ContactError> {
        for effect in &effects {
            effect.validate(self.model, (self.base.len(), self.vertices()))?;
        }
        let place = Place {
            sites: &self.sites,
            metric: &self.metric,
            source: &self.merged.source,
        };
        let tissue = Tissue::new(&self.base, &effects, &place)?;
        if tissue.geometry != self.tissue.geometry {
            control.step("preparing", 0.0)?;
            let range = range(self.model, tissue.thickest());
            if range > self.range {
                self.metric = SkinDistance::new(&self.merged.mesh, &self.adjacency, range);
                self.range = range;
            }
            self.response = Response::new(self.model, &tissue.geometry, &self.sites, &self.metric);
            self.hierarchy = Hierarchy::new(self.model, self.ground());
            self.workspace = Workspace::default();
        }
        (self.tissue, self.effects) = (tissue, effects);
        control.step("preparing", 1.0)
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
            "model paper: the vertex spacing is {spacing:.2} mm; below {PAPER_SPACING} mm the paper's r0 = 0.5 mm makes its \
             matrix indefinite and forces unreliable; use a coarser mesh or model layer"
        )
    })
}
