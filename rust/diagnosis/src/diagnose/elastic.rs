//! Elastic answers of every tool at its site, with and without what changes the response: tables that screening looks up.

use nalgebra::{DMatrix, DVector};
use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Control, Material};

use super::balls::{self, Known};
use super::skins;
use crate::DiagnosisError;
use crate::fit::Fitting;
use crate::replay::{PressTable, Table};

/// Thickness over the base's at which bone is tabulated.
const THICKNESSES: [f64; 5] = [0.6, 0.8, 1.0, 1.3, 1.8];
/// Poisson's ratios at which compressibility is tabulated, from the base's.
const POISSON: [f64; 3] = [0.49, 0.46, 0.4];
/// Depths at which a table is pressed, and at which what changes it: their ratio is smooth.
const RUNGS: usize = 30;
const FEWER: usize = 5;
// Each of the fewer depths is one of the others.
const _: () = assert!(RUNGS.is_multiple_of(FEWER));

/// How a table was changed, and by how much at each of its knots.
#[derive(Debug, Clone)]
pub struct Variant {
    /// What changes it.
    pub effect: Effect,
    /// Which of the effect's tables: a stiff skin has one by thickness.
    pub form: usize,
    /// Coordinate of each knot: logarithm of the thickness over the base's, lost part of Poisson's ratio, number of the skin's modulus.
    pub knots: Vec<f64>,
    /// By place, knot and rung (as many as the base has): logarithm of the force over the base's.
    pub log_ratio: Vec<Vec<Vec<f64>>>,
}

/// A tool at a site: force for a modulus of 1 MPa, and contact radius, by the root of depth.
#[derive(Debug, Clone)]
pub struct Tabled {
    /// Roots of the depths, mm^0.5.
    pub roots: Vec<f64>,
    /// Force over the modulus, mm2.
    pub force: Table,
    /// The same at the rungs.
    pub rungs: Vec<f64>,
    /// Contact radius at the rungs, mm.
    pub radius: Vec<f64>,
    /// Deepest depth that was recorded, mm.
    pub deepest: f64,
    /// Whether its forces are known without the mesh.
    pub is_exact: bool,
}

/// All tables of a study.
#[derive(Debug, Clone)]
pub struct Elastic {
    /// By place.
    pub places: Vec<Tabled>,
    /// What changes them.
    pub variants: Vec<Variant>,
    /// Depth at which the modulus stops growing, mm.
    pub limit_depth: f64,
    /// By place: what tissue that gives up volume loses of the force, over the mean of the study's places; 1 where it is not known.
    pub drained: Vec<f64>,
    /// Number of places that the study's recordings use; others come after them.
    pub studied: usize,
    /// Whether the skin is flat about every site.
    pub is_flat: bool,
}

impl Elastic {
    /// Presses every tool at its site, at the modulus `g_mpa`; `is_flat`: the skin is flat about every site.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub fn new(
        fitting: &mut Fitting,
        (g_mpa, is_flat): (f64, bool),
        control: &Control<'_>,
    ) -> Result<Elastic, DiagnosisError> {
        let mut elastic = Elastic {
            places: Vec::new(),
            variants: Vec::new(),
            limit_depth: fitting.replay.tissue.materials[0].d_lim_mm,
            drained: Vec::new(),
            studied: fitting.replay.places(),
            is_flat,
        };
        elastic.add(fitting, g_mpa, control)?;
        Ok(elastic)
    }

    /// Presses the tools that were placed since.
    ///
    /// # Errors
    /// As of `new`.
    pub fn add(
        &mut self,
        fitting: &mut Fitting,
        g_mpa: f64,
        control: &Control<'_>,
    ) -> Result<(), DiagnosisError> {
        let start = fitting.replay.tissue.materials.clone();
        let flat = flattened(&start, g_mpa);
        let (known, places) = (self.places.len(), fitting.replay.places());
        let at: Vec<usize> = (known..places).collect();
        let mut base = tables(fitting, (&[], &flat, RUNGS), (&at, control))?;
        let balls = balls::known(fitting, self.is_flat, (&at, &base, &flat));
        for (table, ball) in base.iter_mut().zip(&balls) {
            if let Some(ball) = ball {
                table.force = ball.bare.iter().map(|force| force * g_mpa).collect();
            }
        }
        let mut added = Vec::new();
        let on = (&base[..], &balls[..], &flat[..]);
        for planned in plan(&start[0]) {
            added.push(changed(fitting, planned, on, (&at, control))?);
        }
        added.extend(skins::tabulate(fitting, on, (&at, control))?);
        self.take(added);
        fitting.replay.set_effects(&[], control)?;
        let tabled = |(table, ball): (PressTable, &Option<Known>)| Tabled {
            is_exact: ball.is_some(),
            ..tabled(table, g_mpa)
        };
        self.places.extend(base.into_iter().zip(&balls).map(tabled));
        self.drained = drained(&self.variants, (self.studied, places));
        Ok(())
    }

    /// Tables of places that come after those that are known.
    fn take(&mut self, added: Vec<Variant>) {
        match self.variants.is_empty() {
            true => self.variants = added,
            false => {
                let both = self.variants.iter_mut().zip(added);
                both.for_each(|(known, more)| known.log_ratio.extend(more.log_ratio));
            }
        }
    }

    /// The variant of an effect, of that form.
    pub fn variant(&self, effect: Effect, form: usize) -> Option<&Variant> {
        let is_it = |v: &&Variant| v.effect == effect && v.form == form;
        self.variants.iter().find(is_it)
    }
}

impl Variant {
    /// Knot below a coordinate, and the share of the way to the next.
    pub fn between(&self, at: f64) -> (usize, f64) {
        let last = self.knots.len() - 2;
        let k = self
            .knots
            .partition_point(|knot| *knot <= at)
            .clamp(1, last + 1)
            - 1;
        (
            k,
            (at - self.knots[k]) / (self.knots[k + 1] - self.knots[k]),
        )
    }
}

/// What an effect changes of the base tables of these places: of known balls, and of others on the mesh.
fn changed(
    fitting: &mut Fitting,
    (effect, knots): (Effect, Vec<Knot>),
    (base, balls, flat): (&[PressTable], &[Option<Known>], &[Material]),
    (places, control): (&[usize], &Control<'_>),
) -> Result<Variant, DiagnosisError> {
    let mut log_ratio = vec![Vec::new(); places.len()];
    for (_, changed) in &knots {
        for (place, without) in base.iter().enumerate() {
            let Some(effect) = changed else {
                log_ratio[place].push(vec![0.0; without.roots.len()]);
                continue;
            };
            let exact = balls[place].as_ref().and_then(|b| b.changed(effect));
            log_ratio[place].push(match exact {
                Some(logs) => logs,
                None => {
                    let how = (std::slice::from_ref(effect), flat, FEWER);
                    let pressed = tables(fitting, how, (&places[place..=place], control))?;
                    ratios(&pressed[0], without)
                }
            });
        }
    }
    Ok(Variant {
        effect,
        form: 0,
        knots: knots.into_iter().map(|(knot, _)| knot).collect(),
        log_ratio,
    })
}

/// By place, part of the force that is lost with the smallest Poisson's ratio, over the mean of those studied.
fn drained(variants: &[Variant], (studied, places): (usize, usize)) -> Vec<f64> {
    let softer = variants
        .iter()
        .find(|v| v.effect == Effect::Compressibility);
    let lost = |place: usize| {
        let ratio = softer.and_then(|v| v.log_ratio[place].last()?.last().copied());
        1.0 - libm::exp(ratio.unwrap_or(0.0))
    };
    let all: Vec<f64> = (0..places).map(lost).collect();
    let mean = all[..studied].iter().sum::<f64>() / studied.max(1) as f64;
    let over = |lost: &f64| {
        if mean > 0.0 {
            (lost / mean).max(0.05)
        } else {
            1.0
        }
    };
    all.iter().map(over).collect()
}

/// Coordinate of a knot, and what is switched on there; None: the base.
type Knot = (f64, Option<ActiveEffect>);

/// Effects to tabulate, by effect and knot.
fn plan(base: &Material) -> Vec<(Effect, Vec<Knot>)> {
    let mut all = Vec::new();
    let with = |effect: Effect, number: usize, value: f64| {
        let mut active = ActiveEffect::new(effect, 1.0);
        active.shape[number] = value;
        active
    };
    if base.thickness_mm.is_finite() {
        let knot = |share: &f64| {
            let changed = with(Effect::Bone, 0, base.thickness_mm * share);
            (libm::log(*share), (*share != 1.0).then_some(changed))
        };
        all.push((Effect::Bone, THICKNESSES.iter().map(knot).collect()));
    }
    let given_up = POISSON
        .iter()
        .filter(|nu| **nu < base.poisson_ratio - 0.005);
    let mut knots: Vec<Knot> = vec![(0.0, None)];
    knots.extend(given_up.map(|nu| {
        let lost = base.poisson_ratio - nu;
        (lost, Some(with(Effect::Compressibility, 0, *nu)))
    }));
    if knots.len() > 1 {
        all.push((Effect::Compressibility, knots));
    }
    all
}

/// Materials with one modulus at every depth: that of the first region, the others in proportion.
fn flattened(start: &[Material], g_mpa: f64) -> Vec<Material> {
    let scale = g_mpa / start[0].g0_mpa;
    let one = |m: &Material| Material {
        g0_mpa: m.g0_mpa * scale,
        g_lim_mpa: m.g0_mpa * scale,
        ..*m
    };
    start.iter().map(one).collect()
}

/// The tools of these places pressed with effects, materials and a number of depths.
///
/// # Errors
/// What the contact model says of a press, or `Cancelled`.
pub fn tables(
    fitting: &mut Fitting,
    (effects, materials, rungs): (&[ActiveEffect], &[Material], usize),
    (places, control): (&[usize], &Control<'_>),
) -> Result<Vec<PressTable>, DiagnosisError> {
    fitting.replay.set_effects(effects, control)?;
    places
        .iter()
        .map(|&at| {
            control.check().map_err(|_| DiagnosisError::Cancelled)?;
            fitting.replay.ladder((at, rungs), materials, control)
        })
        .collect()
}

/// Logarithm of one table's force over another's at the latter's rungs; at first touch, where both vanish, as at the first rung.
pub fn ratios(with: &PressTable, without: &PressTable) -> Vec<f64> {
    let stride = (without.roots.len() - 1) / (with.roots.len() - 1);
    let one = |(k, a): (usize, &f64)| {
        let b = without.force[k * stride];
        if *a > 0.0 && b > 0.0 {
            libm::log(a / b)
        } else {
            f64::NAN
        }
    };
    let mut few: Vec<f64> = with.force.iter().enumerate().map(one).collect();
    for k in (0..few.len()).rev() {
        if few[k].is_nan() {
            few[k] = few.get(k + 1).copied().unwrap_or(0.0);
        }
    }
    let smooth = Table::new(&with.roots, few);
    without.roots.iter().map(|root| smooth.at(*root)).collect()
}

fn tabled(table: PressTable, g_mpa: f64) -> Tabled {
    let rungs = smoothed(
        &table.roots,
        table.force.iter().map(|f| f / g_mpa).collect(),
    );
    let radius = table
        .area
        .iter()
        .map(|a| (a.max(0.0) / std::f64::consts::PI).sqrt());
    let last = table.roots.last().copied().unwrap_or(0.0);
    Tabled {
        force: Table::new(&table.roots, rungs.clone()),
        radius: smoothed(&table.roots, radius.collect()),
        deepest: last * last,
        rungs,
        roots: table.roots,
        is_exact: false,
    }
}

/// Values above none as a smooth function of the root of depth: `ln v = c0 + c1 ln x + c2 x + c3 x^2 + c4 x^3`.
///
/// A mesh answers in steps, as vertex after vertex comes to bear; a smooth tool on smooth skin does not. Values that no such
/// function meets within [`STEPS`], as of a tool with edges, stay as they are.
fn smoothed(roots: &[f64], values: Vec<f64>) -> Vec<f64> {
    let last = roots.last().copied().unwrap_or(0.0);
    let columns = |root: f64| {
        let x = root / last;
        [1.0, libm::log(x), x, x * x, x * x * x]
    };
    let kept: Vec<usize> = (0..roots.len())
        .filter(|&k| roots[k] >= FEW * last && values[k] > 0.0)
        .collect();
    if kept.len() < 10 {
        return values;
    }
    // The further in, the more vertices bear, and the smaller a step is against the whole.
    let weight = |k: usize| roots[k] / last;
    let matrix = DMatrix::from_fn(kept.len(), 5, |i, j| {
        weight(kept[i]) * columns(roots[kept[i]])[j]
    });
    let side = DVector::from_fn(kept.len(), |i, _| {
        weight(kept[i]) * libm::log(values[kept[i]])
    });
    let Ok(found) = matrix.svd(true, true).solve(&side, 1e-10) else {
        return values;
    };
    let at = |root: f64| {
        let log: f64 = columns(root)
            .iter()
            .zip(found.iter())
            .map(|(a, b)| a * b)
            .sum();
        libm::exp(log)
    };
    let off = |k: &usize| (weight(*k) * libm::log(values[*k] / at(roots[*k]))).powi(2);
    let rms = (kept.iter().map(off).sum::<f64>() / kept.len() as f64).sqrt();
    if rms > STEPS || found[1] <= 0.0 {
        return values;
    }
    let one = |root: &f64| if *root > 0.0 { at(*root) } else { 0.0 };
    roots.iter().map(one).collect()
}

/// Part of the deepest root of depth below which too few vertices bear to say how a table goes on.
const FEW: f64 = 0.12;
/// Largest weighted rms step that a mesh is taken for the cause of.
const STEPS: f64 = 0.03;

/// Rung below a depth, and the share of the way to the next, along the root of depth.
pub fn rung(table: &Tabled, depth: f64) -> (usize, f64) {
    let last = table.roots.len() - 1;
    let root = depth.max(0.0).sqrt();
    let next = table.roots.partition_point(|r| *r <= root).clamp(1, last);
    let share = (root - table.roots[next - 1]) / (table.roots[next] - table.roots[next - 1]);
    (next - 1, share.min(1.0))
}

/// Contact radius at a depth, mm.
pub fn radius(table: &Tabled, depth: f64) -> f64 {
    let (k, share) = rung(table, depth);
    table.radius[k] * (1.0 - share) + table.radius[k + 1] * share
}
