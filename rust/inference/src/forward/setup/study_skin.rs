//! The study's skin as the contact model takes it.

use thenar_contact::{Control, Material, Model, Skin, SkinInput, Workspace};
use thenar_recordings::study::{StudyMaterial, StudySkin};
use thenar_surface::{Mesh, Vec3};

use crate::errors::InferenceError;

/// Name of the one region of a study without regions.
pub(crate) const ONE_REGION: &str = "default";

/// A prepared skin and what the study says of its regions.
#[derive(Debug, Clone)]
pub struct Tissue {
    /// The skin.
    pub skin: Skin,
    /// Scratch of its presses, but for those that several threads do at once.
    pub workspace: Workspace,
    /// Names by region.
    pub regions: Vec<String>,
    /// Materials where the fit starts, by region.
    pub materials: Vec<Material>,
    /// Parameters that a fit may change, by region.
    pub fitted: Vec<Vec<String>>,
    /// Diagonal of the skin's box, mm.
    pub extent: f64,
    /// What a reader should be told.
    pub notes: Vec<String>,
}

/// Prepares the skin with the contact model `Layer`; what the study does not give of a material is the fingertip's.
///
/// # Errors
/// [`InferenceError::Skin`], or what the contact model says of regions and materials.
pub fn tissue(study: &StudySkin, control: &Control<'_>) -> Result<Tissue, InferenceError> {
    let positions = study.mesh.positions.clone();
    let mesh =
        Mesh::new(positions.clone(), study.mesh.triangles.clone()).map_err(InferenceError::Skin)?;
    let regions = match study.region_names.as_slice() {
        [] => vec![ONE_REGION.to_owned()],
        names => names.to_vec(),
    };
    let given = |region: &String| {
        let of = |name: &str| study.materials.iter().find(|m| m.region == name);
        of(region).or_else(|| of(ONE_REGION))
    };
    let fitted = regions
        .iter()
        .map(|region| match given(region) {
            Some(material) => material.fit.clone(),
            None => vec!["g0_mpa".into(), "g_lim_mpa".into()],
        })
        .collect();
    let materials: Vec<Material> = regions
        .iter()
        .map(|region| material(given(region)))
        .collect();
    let mut notes = Vec::new();
    if study.materials.is_empty() {
        notes.push(
            "no materials were given: all skin is taken as a fingertip's, 7.1 mm over bone without end; give regions and a \
             material for each, since a palm is thicker and stiffer at first touch"
                .to_owned(),
        );
    }
    let (low, high) = positions.iter().fold(
        (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
        |(low, high), p| (low.inf(p), high.sup(p)),
    );
    let input = SkinInput {
        mesh,
        regions: study.regions.clone(),
        materials: materials.clone(),
        model: Model::Layer,
    };
    let skin = Skin::prepare_named(input, regions.clone(), control)
        .map_err(InferenceError::of_contact("the study's skin"))?;
    Ok(Tissue {
        skin,
        workspace: Workspace::default(),
        regions,
        materials,
        fitted,
        extent: (high - low).norm(),
        notes,
    })
}

fn material(given: Option<&StudyMaterial>) -> Material {
    // A study finds its moduli itself: one line by region over bone without end, and nothing else that bends the curve.
    let mut material = Material {
        g0_mpa: 0.0098,
        g_lim_mpa: 0.029,
        ..Material::default()
    };
    let Some(given) = given else {
        return material;
    };
    let take = |place: &mut f64, value: Option<f64>| *place = value.unwrap_or(*place);
    take(&mut material.g0_mpa, given.g0_mpa);
    take(&mut material.g_lim_mpa, given.g_lim_mpa);
    take(&mut material.d_lim_mm, given.d_lim_mm);
    take(&mut material.thickness_mm, given.thickness_mm);
    take(&mut material.bone_half_width_mm, given.bone_half_width_mm);
    take(&mut material.bone_half_length_mm, given.bone_half_length_mm);
    material
}
