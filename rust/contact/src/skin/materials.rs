//! Materials of the skin and their published presets.

use super::parameters::{PARAMETERS, ParameterId, parameter};
use crate::ContactError;

/// The paper's swelling beside the contact, `a exp(-(r - b)^2 / (2 c^2))` (Xie Eq. 5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swelling {
    /// a0, mm/N.
    pub height_mm_per_n: f64,
    /// b, mm.
    pub radius_mm: f64,
    /// c, mm.
    pub width_mm: f64,
}

/// Soft tissue of one region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Shear modulus at first touch, MPa.
    pub g0_mpa: f64,
    /// Shear modulus at `d_lim_mm` and beyond, MPa.
    pub g_lim_mpa: f64,
    /// Penetration at which the modulus stops growing, mm.
    pub d_lim_mm: f64,
    /// Soft tissue over bone, mm; infinite gives a half space. Model `Layer` only.
    pub thickness_mm: f64,
    /// Poisson's ratio, 0 to 0.5.
    pub poisson_ratio: f64,
    /// Growth b of the modulus with the strain of a place (`W = G / (2 b) (exp(b (I1 - 3)) - 1)`); 0 without. Model `Layer` only.
    pub stiffening: f64,
    /// Half the width of the bone under the tissue, mm; infinite for bone without end. Model `Layer` only.
    pub bone_half_width_mm: f64,
    /// Half the length of that bone, mm; infinite for a long one. Model `Layer` only.
    pub bone_half_length_mm: f64,
    /// Reach of the active zone, mm. Model `Paper` only.
    pub zone_mm: f64,
    /// Swelling beside the contact. Model `Paper` only.
    pub swelling: Swelling,
}

impl Default for Material {
    fn default() -> Self {
        let value = |id| parameter(id).default;
        Material {
            g0_mpa: value(ParameterId::G0),
            g_lim_mpa: value(ParameterId::GLim),
            d_lim_mm: value(ParameterId::DLim),
            thickness_mm: value(ParameterId::Thickness),
            poisson_ratio: value(ParameterId::PoissonRatio),
            stiffening: value(ParameterId::Stiffening),
            bone_half_width_mm: value(ParameterId::BoneHalfWidth),
            bone_half_length_mm: value(ParameterId::BoneHalfLength),
            zone_mm: value(ParameterId::Zone),
            swelling: Swelling {
                height_mm_per_n: value(ParameterId::SwellingHeight),
                radius_mm: value(ParameterId::SwellingRadius),
                width_mm: value(ParameterId::SwellingWidth),
            },
        }
    }
}

impl Material {
    /// Fingertip as published for the half-space model: G0 5 kPa, Glim 90 kPa (middle of 70 to 120), dlim 4 mm
    /// (Xie 4.1, Table 2).
    pub fn finger() -> Self {
        Material::default()
    }

    /// Palm as published for the half-space model: G0 27.5 kPa (middle of 5 to 50), Glim 60 kPa (middle of 40 to 80),
    /// dlim 7 mm (Xie 4.1, Table 2).
    pub fn palm() -> Self {
        Material {
            g0_mpa: 0.0275,
            g_lim_mpa: 0.06,
            d_lim_mm: 7.0,
            thickness_mm: 13.4,
            zone_mm: 17.5,
            swelling: Swelling {
                height_mm_per_n: 3.0,
                radius_mm: 15.0,
                width_mm: 2.5,
            },
            ..Material::default()
        }
    }

    /// Fingertip over bone, for the layer model.
    ///
    /// A solid of this tissue (the reference solve), shaped as a pad of radius 8 mm on a plate, needs the force of
    /// [`Material::finger`] on a half space within 19 % from 1 mm to dlim; `tests/proof/deep_pads/test_presets.py` repeats the comparison.
    /// Bone: 7 mm wide and 18 mm long, about a distal phalanx; ours.
    pub fn finger_layer() -> Self {
        Material {
            g0_mpa: 0.023,
            g_lim_mpa: 0.023,
            stiffening: 0.5,
            bone_half_width_mm: 3.5,
            bone_half_length_mm: 9.0,
            ..Material::finger()
        }
    }

    /// Other pads of a finger, for the layer model: [`Material::finger_layer`] over a bone that goes on beyond the contact.
    pub fn phalanx_layer() -> Self {
        Material {
            bone_half_width_mm: 4.5,
            bone_half_length_mm: f64::INFINITY,
            ..Material::finger_layer()
        }
    }

    /// Palm over bone, for the layer model: matched to [`Material::palm`] like [`Material::finger_layer`], with a pad of
    /// radius 40 mm. Its published half space softens against any solid over bone: the force is met within 42 % only, and in
    /// the middle of the depths.
    pub fn palm_layer() -> Self {
        Material {
            g0_mpa: 0.0132,
            g_lim_mpa: 0.0132,
            bone_half_width_mm: 25.0,
            bone_half_length_mm: 25.0,
            ..Material::palm()
        }
    }

    /// Shear modulus at the region's largest penetration, MPa (Xie Eq. 3); held at Glim beyond dlim.
    pub fn shear_modulus(&self, max_penetration: f64) -> f64 {
        let share = (max_penetration / self.d_lim_mm).clamp(0.0, 1.0);
        self.g0_mpa + (self.g_lim_mpa - self.g0_mpa) * share
    }

    /// Checks every number against the parameter table.
    ///
    /// # Errors
    /// [`ContactError::Material`] naming `name`, the number and what is admissible.
    pub fn validate(&self, name: &str) -> Result<(), ContactError> {
        for (row, value) in PARAMETERS.iter().zip(self.values()) {
            if !(value >= row.low && value <= row.high) {
                let expected = expected(row.name);
                return Err(ContactError::Material {
                    material: name.to_owned(),
                    name: row.name,
                    found: value,
                    expected,
                });
            }
        }
        Ok(())
    }

    /// The numbers in the order of [`ParameterId`].
    pub fn values(&self) -> [f64; PARAMETERS.len()] {
        let Swelling {
            height_mm_per_n,
            radius_mm,
            width_mm,
        } = self.swelling;
        [
            self.g0_mpa,
            self.g_lim_mpa,
            self.d_lim_mm,
            self.thickness_mm,
            self.poisson_ratio,
            self.stiffening,
            self.bone_half_width_mm,
            self.bone_half_length_mm,
            self.zone_mm,
            height_mm_per_n,
            radius_mm,
            width_mm,
        ]
    }
}

fn expected(name: &str) -> &'static str {
    match name {
        "poisson_ratio" => "from 0 to 0.5",
        "swelling_height_mm_per_n" | "swelling_radius_mm" => "0 or more, at most 1000",
        "stiffening" => "from 0 to 3",
        "bone_half_width_mm" | "bone_half_length_mm" => {
            "at least 0.05 mm (inf for bone without end)"
        }
        "thickness_mm" => "at least 0.05 mm (inf for a half space)",
        "g0_mpa" | "g_lim_mpa" => "positive: from 1e-6 to 1e4 MPa",
        "zone_mm" => "from 0.1 to 1000 mm",
        _ => "positive: from 0.001 to 1000 mm",
    }
}
