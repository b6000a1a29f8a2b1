//! The catalogue entry of an effect: names, shape numbers with sources, checks, and the signs it leaves in recordings.

/// An effect of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Effect {
    /// Soft tissue of another thickness over bone.
    Bone,
    /// Tissue that gives up volume.
    Compressibility,
    /// A thin stiff skin over soft pulp.
    StiffSkin,
    /// Regions that answer each other's forces only in part.
    RegionCoupling,
    /// Another growth of the modulus.
    StiffeningLaw,
    /// A place where the tissue is stiffer or softer.
    Inclusion,
    /// Stiffness that falls with use and recovers in rest.
    CycleSoftening,
    /// Force that fades with time.
    Relaxation,
    /// Fluid that leaves the pressed tissue.
    Drainage,
    /// Energy lost per cycle at any speed.
    RateIndependentLoss,
    /// Skin that sticks to the product and slips over it.
    Friction,
    /// Skin that clings to the product.
    Adhesion,
    /// A fixture that yields in series with the skin.
    FixtureCompliance,
    /// A mat that lies beside where it is said to lie.
    Misregistration,
    /// Sensels that pass part of their reading on.
    Crosstalk,
    /// Readings too large or too small by a factor.
    Gain,
    /// A zero point that is not at zero.
    Offset,
    /// Readings that wander with time.
    Drift,
    /// Readings that stop at a ceiling.
    Saturation,
    /// Readings below a floor that are shown as nothing.
    Threshold,
    /// Sensels that show nothing.
    DeadCells,
    /// A channel whose clock is behind.
    Timing,
}

impl Effect {
    /// Its place in the catalogue, and so in the order of composition.
    pub fn place(self) -> usize {
        self as usize
    }
}

/// When an effect acts, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Bone, layers and what ties regions together: shapes the response.
    Geometry,
    /// How stiff the tissue is, by place and depth.
    Stiffening,
    /// What the tissue remembers of earlier steps.
    History,
    /// Forces between skin and product.
    Interface,
    /// What a sensor makes of the result.
    Instrument,
}

/// One number that shapes an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeNumber {
    /// Name in Python, TOML and reports, with its unit.
    pub name: &'static str,
    /// Unit, as written in documents ("1" for none).
    pub unit: &'static str,
    /// Value where none is given.
    pub default: f64,
    /// Smallest and largest admissible value.
    pub admissible: [f64; 2],
    /// Smallest and largest value credible for a hand.
    pub physiological: [f64; 2],
    /// What it means, in one line.
    pub meaning: &'static str,
    /// Where default and range come from.
    pub source: &'static str,
}

/// A choice between forms of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// Name in Python and TOML.
    pub name: &'static str,
    /// What can be chosen; the first is the default.
    pub options: &'static [&'static str],
    /// What it decides, in one line.
    pub meaning: &'static str,
}

/// Something that can be seen in recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Sign {
    /// Force at held depth falls with time.
    ForceFallsInHold,
    /// Force at held depth stays as it is.
    ForceStaysInHold,
    /// Force at equal depth is larger in faster presses.
    ForceGrowsWithRate,
    /// Curves at different speeds lie on one another.
    SpeedDoesNotMatter,
    /// The time scale is the same for every contact size.
    ClockIsFixed,
    /// The time scale grows as the contact's area.
    ClockGrowsWithArea,
    /// Loading and unloading enclose a loop.
    LoopIsOpen,
    /// Loading and unloading are one curve.
    LoopIsClosed,
    /// Area at equal depth differs from the base model's.
    AreaChanges,
    /// Area at equal depth is the base model's.
    AreaStays,
    /// Force at equal depth is larger than the base model's.
    ForceIsLarger,
    /// Force at equal depth is smaller than the base model's.
    ForceIsSmaller,
    /// Force grows faster with depth, the larger contact over thickness.
    StiffensWithContactSize,
    /// Force grows with depth otherwise than linearly in the modulus.
    CurveBends,
    /// Differs from place to place on the skin, and moves with the skin.
    BelongsToThePlace,
    /// Matters only where the contact crosses a border of regions.
    BelongsToTheCrease,
    /// Skin beside the contact rises by less than the dent's volume.
    VolumeIsLost,
    /// Small tools feel stiffer than large ones of the same shape.
    SmallToolsFeelStiffer,
    /// Later cycles need less force than the first.
    LaterCyclesAreSofter,
    /// What earlier cycles took away comes back in rest.
    RestRestores,
    /// A force along the surface of the product.
    TangentialForce,
    /// The force pulls on the way out.
    ForcePulls,
    /// Contact without load, or before it.
    AreaAtZeroForce,
    /// Turns round with the direction of sliding.
    FollowsSliding,
    /// Readings are off by one factor.
    ScalesReadings,
    /// Readings are off by one amount, without contact too.
    ShiftsReadings,
    /// Channels that should tell the same do not: the sum of the map and the load cell.
    ChannelsDisagree,
    /// Readings wander without contact, or under a dead weight.
    TrendsWithoutContact,
    /// No reading is above one ceiling, whatever presses.
    ClipsAtCeiling,
    /// No reading lies between nothing and a floor.
    SilentBelowFloor,
    /// The map is blurred under a rigid stamp too.
    BlursTheMap,
    /// Belongs to the same sensels at every pose: moves with the mat, not with the skin.
    MovesWithTheMat,
    /// The force on the mat is what it was.
    ForceStays,
    /// Travel is lost in proportion to force, whatever is pressed.
    YieldsToForceOnly,
    /// A channel shows later what another shows now, by one time at all speeds.
    LagsBehind,
}

/// A sign that must hold in data if the effect is at work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Consequence {
    /// What can be tested.
    pub sign: Sign,
    /// The same in words, for the report.
    pub sentence: &'static str,
}

/// A check of shape numbers and painted values; says what is wrong.
pub type Check = fn(shape: &[f64], painted: &[f64]) -> Result<(), String>;

/// What the catalogue says of one effect.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Name in Python, TOML and findings.
    pub name: &'static str,
    /// When it acts.
    pub stage: Stage,
    /// What it is, in one sentence.
    pub meaning: &'static str,
    /// What amplitude 1 means.
    pub amplitude: &'static str,
    /// Largest admissible amplitude; the smallest is 0.
    pub most: f64,
    /// Numbers that shape it, in the order of [`crate::ActiveEffect::shape`].
    pub shape: &'static [ShapeNumber],
    /// Forms to choose from.
    pub choices: &'static [Choice],
    /// Whether values can be painted per vertex instead, and of what.
    pub painted: Option<&'static str>,
    /// Checks shape numbers and painted values (empty: none) beyond the range of each; None where the ranges say it all.
    pub check: Option<Check>,
    /// Signs that must hold in data if it is at work.
    pub consequences: &'static [Consequence],
    /// Where the model comes from.
    pub source: &'static str,
}

impl Entry {
    /// True if it acts on readings, false if it acts on the skin.
    pub fn is_instrument(&self) -> bool {
        self.stage == Stage::Instrument
    }

    /// "tissue" or "instrument", as in findings.
    pub fn kind(&self) -> &'static str {
        if self.is_instrument() {
            "instrument"
        } else {
            "tissue"
        }
    }
}
