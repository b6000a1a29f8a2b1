//! What screening can add to the base model: mechanisms with their free numbers, and the variants that are tried.

use thenar_contact::effects::Effect;

/// A mechanism as screening models it; its free numbers stand in the vector of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// Name in the catalogue.
    pub effect: Effect,
    /// How it acts.
    pub acts: Acts,
}

/// How a mechanism acts on the force.
#[derive(Debug, Clone, PartialEq)]
pub enum Acts {
    /// Load that fades by a clock; shares by branch are free. Periods in s, or in s at the contact radius `reference_mm`.
    Fades {
        /// What drives it.
        clock: Clock,
        /// Periods of the branches.
        periods: Vec<f64>,
    },
    /// Stiffness lost with loading travel (mm) and regained in rest (s); the share is free.
    Softens {
        /// Travel after which 63 % is lost, mm.
        travel_mm: f64,
        /// Time without load after which 63 % has come back, s.
        recovery_s: f64,
    },
    /// Skin that clings takes off a force in proportion to the area that was touched, once the tool has left by some way, and until
    /// it lets go; the force on the largest contact is free, over the study's largest force.
    Clings {
        /// Way out over which the grip builds up, over the largest depth.
        builds: f64,
        /// Depth at which it lets go, over the largest depth; negative: above the skin.
        lets_go: f64,
    },
    /// A tabulated change of the response; its coordinate is free.
    Tabled,
    /// The modulus grows as an exponential of this measure; its rate is free.
    Stiffens(Measure),
    /// Later recordings of the session read more or less by a factor; its logarithm is free.
    GainStep {
        /// First recording of the session that reads otherwise.
        from: usize,
    },
    /// One force more or less everywhere, N.
    Offset,
    /// A force that creeps from each recording's start as log(1 + t / time); its size is free, N.
    Drifts {
        /// s.
        time_s: f64,
    },
    /// Readings bend over below a ceiling; its logarithm is free.
    Saturates,
    /// Readings below a floor are none; the floor over the smallest peak is free.
    Blind,
    /// The stage travels further than the tool, by this much per newton.
    Yields,
    /// The force is stamped late, s.
    Late,
}

/// What makes a load fade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clock {
    /// Time.
    Time,
    /// Time over the contact radius squared; periods are those at this radius, mm.
    Area {
        /// mm.
        reference_mm: f64,
    },
    /// Travel, mm.
    Travel,
}

/// With what a modulus grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Depth over the study's largest.
    Depth,
    /// Contact radius over the largest that a tool of the study reaches, per tool radius: the strain a/R, over its largest.
    Strain,
}

impl Mechanism {
    /// Number of free numbers.
    pub fn count(&self) -> usize {
        match &self.acts {
            Acts::Fades { periods, .. } => periods.len(),
            _ => 1,
        }
    }

    /// Numbers that a fit can make use of: shares of neighboring branches stand for each other, and none is below 0.
    pub fn price(&self) -> usize {
        self.count().min(3)
    }

    /// True for what a single loading at one speed can show: there, time and depth grow together.
    pub fn shows_in_loading(&self) -> bool {
        matches!(
            self.acts,
            Acts::Tabled
                | Acts::Stiffens(_)
                | Acts::Offset
                | Acts::Saturates
                | Acts::Blind
                | Acts::Yields
        )
    }

    /// True for what belongs to the instrument.
    pub fn is_instrument(&self) -> bool {
        self.effect.entry().is_instrument()
    }
}

/// What the scales of a study are, from which variants are chosen.
#[derive(Debug, Clone, Copy)]
pub struct Scales {
    /// Largest depth, mm.
    pub deepest: f64,
    /// Contact radius between those that the tools reach (their geometric mean), mm.
    pub radius: f64,
    /// Smallest peak force and largest, N.
    pub forces: (f64, f64),
    /// Whether the response can be tabulated with another thickness.
    pub has_bone: bool,
    /// Whether some tools are spheres, so that strain means something.
    pub has_strain: bool,
}

/// Periods of the branches of a spectrum in time, s: less than a decade apart over what recordings show.
const TIMES_S: [f64; 5] = [0.04, 0.2, 1.0, 5.0, 25.0];
/// Periods of a spectrum in travel, over the largest depth.
const TRAVELS: [f64; 2] = [0.08, 0.4];

/// Depths at which skin lets go, over the largest depth: before the tool is out, as it leaves, above the skin, and not at all.
const LETS_GO: [f64; 4] = [0.12, 0.0, -0.1, -10.0];

/// Every mechanism that is tried alone, with its variants; the order decides ties.
pub fn singles(scales: Scales) -> Vec<Mechanism> {
    let mut all = instrument();
    let deepest = scales.deepest;
    let fades = |effect, clock, periods: Vec<f64>| Mechanism {
        effect,
        acts: Acts::Fades { clock, periods },
    };
    all.push(fades(Effect::Relaxation, Clock::Time, TIMES_S.to_vec()));
    let clock = Clock::Area {
        reference_mm: scales.radius,
    };
    all.push(fades(Effect::Drainage, clock, TIMES_S.to_vec()));
    let travels = TRAVELS.iter().map(|t| t * deepest).collect();
    all.push(fades(Effect::RateIndependentLoss, Clock::Travel, travels));
    for travel in [0.25, 0.8, 2.5] {
        all.push(Mechanism {
            effect: Effect::CycleSoftening,
            acts: Acts::Softens {
                travel_mm: travel * deepest,
                recovery_s: 60.0,
            },
        });
    }
    let one = |effect, acts| Mechanism { effect, acts };
    for builds in [0.08, 0.25] {
        let clings = LETS_GO.map(|lets_go| one(Effect::Adhesion, Acts::Clings { builds, lets_go }));
        all.extend(clings);
    }
    if scales.has_bone {
        all.push(one(Effect::Bone, Acts::Tabled));
    }
    all.push(one(Effect::Compressibility, Acts::Tabled));
    all.push(one(Effect::StiffSkin, Acts::Tabled));
    if scales.has_strain {
        all.push(one(Effect::StiffeningLaw, Acts::Stiffens(Measure::Strain)));
    }
    all.push(one(Effect::StiffeningLaw, Acts::Stiffens(Measure::Depth)));
    all
}

fn instrument() -> Vec<Mechanism> {
    let one = |effect, acts| Mechanism { effect, acts };
    let mut all = vec![one(Effect::Offset, Acts::Offset)];
    all.extend([1.0, 6.0].map(|time_s| one(Effect::Drift, Acts::Drifts { time_s })));
    all.push(one(Effect::Saturation, Acts::Saturates));
    all.push(one(Effect::Threshold, Acts::Blind));
    all.push(one(Effect::FixtureCompliance, Acts::Yields));
    all.push(one(Effect::Timing, Acts::Late));
    all
}
