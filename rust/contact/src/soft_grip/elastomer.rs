//! What a product is covered with.

use crate::ContactError;
use crate::response::bonded_layer::Layer;

/// A soft layer bonded to the rigid core of a product; linear elastic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastomer {
    /// Over the rigid core, mm; infinite for a half space. 0 is rigid.
    pub thickness_mm: f64,
    /// Young's modulus, MPa.
    pub youngs_mpa: f64,
    /// Poisson's ratio, 0 to 0.5.
    pub poisson_ratio: f64,
}

impl Elastomer {
    /// Young's modulus (MPa) of a rubber of this hardness on the scale Shore A, 20 to 80:
    /// `E = 0.0981 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S))` (Gent, Rubber Chemistry and Technology 31 (1958) 896).
    ///
    /// Hardness and modulus are different properties; for other rubbers E may be 1.5 times more or less.
    pub fn youngs_of_shore_a(hardness: f64) -> f64 {
        0.0981 * (56.0 + 7.62336 * hardness) / (0.137505 * (254.0 - 2.54 * hardness))
    }

    /// Whether it yields at all.
    pub fn is_soft(&self) -> bool {
        self.thickness_mm > 0.0
    }

    /// # Errors
    /// [`ContactError::Elastomer`] naming the number that is not admissible; `index` counts the product's elastomers.
    pub fn validate(&self, index: usize) -> Result<(), ContactError> {
        let fault = |name, found, expected| {
            Err(ContactError::Elastomer {
                index,
                name,
                found,
                expected,
            })
        };
        if self.thickness_mm != 0.0 && (self.thickness_mm < 0.05 || self.thickness_mm.is_nan()) {
            return fault(
                "thickness_mm",
                self.thickness_mm,
                "0 (rigid), or 0.05 or more",
            );
        }
        if !(1e-3..=1e5).contains(&self.youngs_mpa) {
            return fault("youngs_mpa", self.youngs_mpa, "0.001 to 100000");
        }
        if !(0.0..=0.5).contains(&self.poisson_ratio) {
            return fault("poisson_ratio", self.poisson_ratio, "0 to 0.5");
        }
        Ok(())
    }

    /// The layer of its response.
    pub(super) fn layer(&self) -> Layer {
        Layer {
            thickness: self.thickness_mm,
            poisson_ratio: self.poisson_ratio,
        }
    }

    /// `(1 - nu) / (2 pi G) = (1 - nu^2) / (pi E)`, mm2/N: how far a point yields by a force, times their distance.
    pub(super) fn compliance(&self) -> f64 {
        (1.0 - self.poisson_ratio.powi(2)) / (std::f64::consts::PI * self.youngs_mpa)
    }
}

/// The soft layers of a product.
#[derive(Debug, Clone, PartialEq)]
pub struct SoftGrip {
    /// Elastomers by number.
    pub elastomers: Vec<Elastomer>,
    /// Elastomer of every vertex of the product; negative where it is rigid.
    pub of_vertex: Vec<i32>,
}

impl SoftGrip {
    /// The elastomer at a vertex, where it yields.
    pub fn at(&self, vertex: u32) -> Option<usize> {
        let index = usize::try_from(self.of_vertex[vertex as usize]).ok()?;
        self.elastomers[index].is_soft().then_some(index)
    }

    /// Whether any vertex yields.
    pub fn is_soft(&self) -> bool {
        (0..self.of_vertex.len() as u32).any(|vertex| self.at(vertex).is_some())
    }

    /// # Errors
    /// [`ContactError::GripCount`] or [`ContactError::Elastomer`] where it does not fit a product of so many vertices.
    pub fn validate(&self, vertices: usize) -> Result<(), ContactError> {
        if self.of_vertex.len() != vertices {
            return Err(ContactError::GripCount {
                found: self.of_vertex.len(),
                expected: vertices,
            });
        }
        for (index, elastomer) in self.elastomers.iter().enumerate() {
            elastomer.validate(index)?;
        }
        let count = self.elastomers.len();
        match self.of_vertex.iter().position(|&e| e >= count as i32) {
            None => Ok(()),
            Some(vertex) => Err(ContactError::UnknownElastomer {
                vertex,
                elastomer: self.of_vertex[vertex],
                count,
            }),
        }
    }
}
