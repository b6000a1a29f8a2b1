//! Soft tissue between a posed skin and the bone under it.

use thenar_surface::Vec3;

use crate::ReferenceError;

/// Soft tissue of a posed hand, free of stress before the press.
#[derive(Debug, Clone)]
pub struct Tissue {
    /// Skin vertices (n), mm, in the posture that is pressed.
    pub skin: Vec<Vec3>,
    /// Skin triangles (m), turned outward.
    pub triangles: Vec<[u32; 3]>,
    /// Point of the bone under every skin vertex (n), mm; the tissue is bonded to it.
    pub bone: Vec<Vec3>,
    /// Skin vertices (n) whose tissue does not move: rims, nails, creases.
    pub is_held: Vec<bool>,
    /// Skin vertices (n) that the product can touch; it passes through the others.
    pub can_touch: Vec<bool>,
    /// Shear modulus at small strain at every skin vertex (n), MPa.
    pub shear_modulus_mpa: Vec<f64>,
    /// Exponent b of the stiffening, 0 for neo-Hookean tissue: `W = mu / (2 b) (exp(b (I1 - 3)) - 1)`, I1 at constant volume
    /// (Fung; Demiray 1972).
    /// At every skin vertex (n).
    pub stiffening: Vec<f64>,
}

impl Tissue {
    /// Checks that the arrays fit each other and hold admissible numbers.
    ///
    /// # Errors
    /// [`ReferenceError::Tissue`] naming the array and the index.
    pub fn check(&self) -> Result<(), ReferenceError> {
        let n = self.skin.len();
        let lengths = [
            ("bone", self.bone.len()),
            ("is_held", self.is_held.len()),
            ("can_touch", self.can_touch.len()),
            ("shear_modulus_mpa", self.shear_modulus_mpa.len()),
            ("stiffening", self.stiffening.len()),
        ];
        for (name, length) in lengths {
            if length != n {
                return Err(error(
                    format!("array `{name}`"),
                    format!("{length} values"),
                    "give one value for every skin vertex",
                ));
            }
        }
        for (name, points) in [("skin", &self.skin), ("bone", &self.bone)] {
            if let Some(i) = points.iter().position(|p| !p.iter().all(|x| x.abs() < 1e6)) {
                return Err(error(
                    format!("array `{name}`, vertex {i}"),
                    format!("{:?}", points[i].as_slice()),
                    "give coordinates between -1e6 and 1e6 mm",
                ));
            }
        }
        if let Some(t) = self
            .triangles
            .iter()
            .position(|t| t.iter().any(|v| *v as usize >= n))
        {
            return Err(error(
                format!("triangle {t}"),
                format!("{:?}", self.triangles[t]),
                "name skin vertices only",
            ));
        }
        let modulus = |g: &f64| *g > 0.0 && *g < 1e3;
        if let Some(i) = self.shear_modulus_mpa.iter().position(|g| !modulus(g)) {
            return Err(error(
                format!("shear modulus at vertex {i}"),
                format!("{} MPa", self.shear_modulus_mpa[i]),
                "give a number above 0 and below 1000 MPa",
            ));
        }
        let exponent = |b: &f64| (0.0..=20.0).contains(b);
        if let Some(i) = self.stiffening.iter().position(|b| !exponent(b)) {
            return Err(error(
                format!("stiffening at vertex {i}"),
                format!("{}", self.stiffening[i]),
                "give a number from 0 to 20",
            ));
        }
        Ok(())
    }
}

fn error(what: String, found: String, remedy: &'static str) -> ReferenceError {
    ReferenceError::Tissue {
        what,
        found,
        remedy,
    }
}
