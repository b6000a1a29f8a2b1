//! The table of material parameters: name, symbol, unit, default, range, source. It stands here and nowhere else.

/// One number of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name in Python, TOML and Blender, with its unit.
    pub name: &'static str,
    /// Symbol in the literature.
    pub symbol: &'static str,
    /// Unit, as written in documents ("1" for none).
    pub unit: &'static str,
    /// Value where none is given (fingertip).
    pub default: f64,
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
    /// What it means, in one line.
    pub meaning: &'static str,
    /// Where default and meaning come from.
    pub source: &'static str,
}

/// Index of a parameter in [`PARAMETERS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterId {
    /// Shear modulus at first touch, MPa.
    G0,
    /// Shear modulus at `d_lim_mm` and beyond, MPa.
    GLim,
    /// Penetration at which the modulus stops growing, mm.
    DLim,
    /// Thickness of soft tissue over bone, mm.
    Thickness,
    /// Poisson's ratio.
    PoissonRatio,
    /// Growth of the modulus with depth over thickness at a place.
    Stiffening,
    /// Half the width of the bone under the tissue, mm.
    BoneHalfWidth,
    /// Half the length of that bone, mm.
    BoneHalfLength,
    /// Reach of the active zone around colliding vertices (paper model), mm.
    Zone,
    /// Swelling height a0 (paper model), mm/N.
    SwellingHeight,
    /// Swelling radius b (paper model), mm.
    SwellingRadius,
    /// Swelling width c (paper model), mm.
    SwellingWidth,
}

/// Every material parameter, in the order of [`ParameterId`].
pub const PARAMETERS: [Parameter; 12] = [
    Parameter {
        name: "g0_mpa",
        symbol: "G0",
        unit: "MPa",
        default: 0.005,
        low: 1e-6,
        high: 1e4,
        meaning: "shear modulus at first touch",
        source: "Xie 4.1 (fingertip 5 kPa, palm 5 to 50 kPa)",
    },
    Parameter {
        name: "g_lim_mpa",
        symbol: "Glim",
        unit: "MPa",
        default: 0.09,
        low: 1e-6,
        high: 1e4,
        meaning: "shear modulus at the limiting penetration and beyond",
        source: "Xie 4.1 (fingertip 70 to 120 kPa, palm 40 to 80 kPa)",
    },
    Parameter {
        name: "d_lim_mm",
        symbol: "dlim",
        unit: "mm",
        default: 4.0,
        low: 1e-3,
        high: 1e3,
        meaning: "penetration at which the modulus stops growing",
        source: "Xie Eq. 3 (fingertip 4 mm, palm 7 mm)",
    },
    Parameter {
        name: "thickness_mm",
        symbol: "h",
        unit: "mm",
        default: 7.1,
        low: 0.05,
        high: f64::INFINITY,
        meaning: "soft tissue over bone; inf gives a half space",
        source: "the bonded layer's bulge is deepest at 1.12 h; Xie Table 2 puts it at 8 mm (finger) and 15 mm (palm)",
    },
    Parameter {
        name: "poisson_ratio",
        symbol: "nu",
        unit: "1",
        default: 0.5,
        low: 0.0,
        high: 0.5,
        meaning: "Poisson's ratio; 0.5 keeps volume",
        source: "Xie Eq. 4",
    },
    Parameter {
        name: "stiffening",
        symbol: "b",
        unit: "1",
        default: 0.0,
        low: 0.0,
        high: 3.0,
        meaning: "growth of the modulus with the strain of a place; 0 for none, layer model",
        source: "b of W = G/(2b) (exp(b(I1-3)) - 1) (Fung; Demiray 1972)",
    },
    Parameter {
        name: "bone_half_width_mm",
        symbol: "w",
        unit: "mm",
        default: f64::INFINITY,
        low: 0.05,
        high: f64::INFINITY,
        meaning: "half the width of the bone under the tissue; inf for bone without end, layer model",
        source: "tissue gives way at the sides of a narrow bone; fitted to solids of pads over bones",
    },
    Parameter {
        name: "bone_half_length_mm",
        symbol: "l",
        unit: "mm",
        default: f64::INFINITY,
        low: 0.05,
        high: f64::INFINITY,
        meaning: "half the length of a bone of finite width under the tissue; inf for a long bone, layer model",
        source: "as bone_half_width_mm",
    },
    Parameter {
        name: "zone_mm",
        symbol: "",
        unit: "mm",
        default: 12.5,
        low: 0.1,
        high: 1e3,
        meaning: "reach of the active zone around colliding vertices, paper model",
        source: "Xie 3.2.3: 5 rings (finger), 7 rings (palm) of 2.5 mm",
    },
    Parameter {
        name: "swelling_height_mm_per_n",
        symbol: "a0",
        unit: "mm/N",
        default: 2.0,
        low: 0.0,
        high: 1e3,
        meaning: "height of the swelling beside the contact per newton, paper model",
        source: "Xie Table 2 (finger 2, palm 3)",
    },
    Parameter {
        name: "swelling_radius_mm",
        symbol: "b",
        unit: "mm",
        default: 8.0,
        low: 0.0,
        high: 1e3,
        meaning: "distance of the swelling from the force, paper model",
        source: "Xie Table 2 (finger 8, palm 15)",
    },
    Parameter {
        name: "swelling_width_mm",
        symbol: "c",
        unit: "mm",
        default: 2.0,
        low: 1e-3,
        high: 1e3,
        meaning: "width of the swelling, paper model",
        source: "Xie Table 2 (finger 2, palm 2.5)",
    },
];

/// The table's row of one parameter.
pub fn parameter(id: ParameterId) -> &'static Parameter {
    &PARAMETERS[id as usize]
}
