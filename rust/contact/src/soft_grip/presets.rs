//! Grips that are common.

use super::elastomer::Elastomer;

/// How the stiffness of a preset is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// By hardness on the scale Shore A.
    ShoreA(f64),
    /// Young's modulus, MPa.
    Youngs(f64),
}

/// A common grip. Compounds differ: measure yours where it matters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GripPreset {
    /// As it leaves the library.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    /// How stiff.
    pub stiffness: Stiffness,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Where the numbers are from.
    pub source: &'static str,
}

impl GripPreset {
    /// Young's modulus, MPa.
    pub fn youngs_mpa(&self) -> f64 {
        match self.stiffness {
            Stiffness::ShoreA(hardness) => Elastomer::youngs_of_shore_a(hardness),
            Stiffness::Youngs(modulus) => modulus,
        }
    }
}

const BY_GENT: &str =
    "typical hardness; E by Gent (1958) from Shore A, 1.5 times more or less by compound";

/// From hard to soft.
pub const GRIP_PRESETS: [GripPreset; 5] = [
    GripPreset {
        name: "cork",
        title: "Cork",
        stiffness: Stiffness::Youngs(13.0),
        poisson_ratio: 0.1,
        source: "Gibson, Easterling and Ashby, Proc. R. Soc. A 377 (1981) 99: natural cork, 13 +- 5 MPa across the radial \
                 direction; linear to about 5 % strain",
    },
    GripPreset {
        name: "tpe",
        title: "TPE, 60 Shore A",
        stiffness: Stiffness::ShoreA(60.0),
        poisson_ratio: 0.49,
        source: BY_GENT,
    },
    GripPreset {
        name: "rubber",
        title: "Rubber, 50 Shore A",
        stiffness: Stiffness::ShoreA(50.0),
        poisson_ratio: 0.49,
        source: BY_GENT,
    },
    GripPreset {
        name: "eva_foam",
        title: "EVA Foam",
        stiffness: Stiffness::Youngs(2.1),
        poisson_ratio: 0.0,
        source: "Verdejo and Mills, J. Biomech. 37 (2004) 1379: midsole foam, initial shear modulus 1.05 MPa; nu taken as 0, as of foams",
    },
    GripPreset {
        name: "silicone",
        title: "Silicone, 30 Shore A",
        stiffness: Stiffness::ShoreA(30.0),
        poisson_ratio: 0.49,
        source: BY_GENT,
    },
];
