//! Elastic tables of every tool at its site, with and without effects that change the response.

use crate::forward::mesh::replay::{Place, Replay, thinnest};
use nalgebra::{DMatrix, DVector};
use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Control, Material};

use crate::errors::InferenceError;
use crate::forward::mesh::press_table::PressTable;
use crate::forward::tables::elastic_table::{Tabulated, Variant};
use crate::forward::tables::form_ways::WAYS;
use crate::forward::tables::sphere::{self, SphereTable};
use crate::forward::tables::stiff_skin;
use crate::forward::tables::table_presses::{ratios, tables};
use crate::interpolation::Table;
use crate::parameters::priors::{SHARED, SHARED_DEPTH, SHARED_FORM};

/// Thickness over the base's at which bone is tabulated.
const THICKNESSES: [f64; 5] = [0.6, 0.8, 1.0, 1.3, 1.8];
/// Poisson's ratios at which compressibility is tabulated, from the base's.
const POISSON: [f64; 3] = [0.49, 0.46, 0.4];
/// Depths at which a table is pressed, and at which what changes it: their ratio is smooth.
const RUNGS: usize = 30;
const FEWER: usize = 5;
// Each of the fewer depths is one of the others.
const _: () = assert!(RUNGS.is_multiple_of(FEWER));

/// All tables of a study.
#[derive(Debug, Clone)]
pub struct Elastic {
    /// By place.
    pub places: Vec<Tabulated>,
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
    /// By place: number of its site.
    pub site_of: Vec<usize>,
    /// Depth to which the forms that tools share were measured, mm.
    pub shared_depth: f64,
    /// Whether the study states how wide the bone is, in every region.
    pub is_bone_stated: bool,
}

impl Elastic {
    /// Presses every tool at its site, at the modulus `g_mpa`; `is_flat`: the skin is flat about every site.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub fn new(
        replay: &mut Replay,
        (g_mpa, is_flat): (f64, bool),
        control: &Control<'_>,
    ) -> Result<Elastic, InferenceError> {
        let mut elastic = Elastic {
            places: Vec::new(),
            variants: Vec::new(),
            limit_depth: replay.tissue.materials[0].d_lim_mm,
            drained: Vec::new(),
            studied: replay.places(),
            is_flat,
            site_of: Vec::new(),
            shared_depth: SHARED_DEPTH * thinnest(&replay.tissue.materials),
            is_bone_stated: sphere::has_width(&replay.tissue.materials),
        };
        elastic.add(replay, g_mpa, control)?;
        Ok(elastic)
    }

    /// Presses the tools that were placed since.
    ///
    /// # Errors
    /// As of `new`.
    pub fn add(
        &mut self,
        replay: &mut Replay,
        g_mpa: f64,
        control: &Control<'_>,
    ) -> Result<(), InferenceError> {
        let start = replay.tissue.materials.clone();
        let flat = flattened(&start, g_mpa);
        let (known, places) = (self.places.len(), replay.places());
        let at: Vec<usize> = (known..places).collect();
        self.site_of = sites(replay);
        let mut base = tables(replay, (&[], &flat, RUNGS), (&at, control))?;
        let spheres = sphere::known(replay, self.is_flat, (&at, &base, &flat));
        for (table, ball) in base.iter_mut().zip(&spheres) {
            if let Some(ball) = ball {
                table.force = ball.bare.iter().map(|force| force * g_mpa).collect();
            }
        }
        let mut added = Vec::new();
        let on = (&base[..], &spheres[..], &flat[..]);
        for planned in plan(&start[0]) {
            added.push(changed(replay, planned, on, (&at, control))?);
        }
        added.extend(stiff_skin::tabulate(replay, on, (&at, control))?);
        self.take(added);
        replay.set_effects(&[], control)?;
        let tabled = |(table, ball): (PressTable, &Option<SphereTable>)| Tabulated {
            is_exact: ball.is_some(),
            ..tabled(table, g_mpa)
        };
        self.places
            .extend(base.into_iter().zip(&spheres).map(tabled));
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

    /// The forms by which all tools at a site may be off alike, each of one standard deviation, by way.
    pub(crate) fn shared_form(&self) -> [[f64; WAYS]; SHARED] {
        match (self.is_bone_stated, self.is_flat) {
            (true, _) => SHARED_FORM[0],
            (false, false) => SHARED_FORM[1],
            (false, true) => [[0.0; WAYS]; SHARED],
        }
    }

    /// The variant of an effect, of that form.
    pub fn variant(&self, effect: Effect, form: usize) -> Option<&Variant> {
        let is_it = |v: &&Variant| v.effect == effect && v.form == form;
        self.variants.iter().find(is_it)
    }
}

/// By place, the number of the first place at the same site.
fn sites(replay: &Replay) -> Vec<usize> {
    let first = |place: &Place| replay.places.iter().position(|p| p.site == place.site);
    replay.places.iter().filter_map(first).collect()
}

/// What an effect changes of the base tables of these places: of known balls, and of others on the mesh.
fn changed(
    replay: &mut Replay,
    (effect, knots): (Effect, Vec<Knot>),
    (base, spheres, flat): (&[PressTable], &[Option<SphereTable>], &[Material]),
    (places, control): (&[usize], &Control<'_>),
) -> Result<Variant, InferenceError> {
    let mut log_ratio = vec![Vec::new(); places.len()];
    for (_, changed) in &knots {
        for (place, without) in base.iter().enumerate() {
            let Some(effect) = changed else {
                log_ratio[place].push(vec![0.0; without.roots.len()]);
                continue;
            };
            let exact = spheres[place].as_ref().and_then(|b| b.changed(effect));
            log_ratio[place].push(match exact {
                Some(logs) => logs,
                None => {
                    let how = (std::slice::from_ref(effect), flat, FEWER);
                    let pressed = tables(replay, how, (&places[place..=place], control))?;
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

fn tabled(table: PressTable, g_mpa: f64) -> Tabulated {
    let rungs = smoothed(
        &table.roots,
        table.force.iter().map(|f| f / g_mpa).collect(),
    );
    let radius = table
        .area
        .iter()
        .map(|a| (a.max(0.0) / std::f64::consts::PI).sqrt());
    let last = table.roots.last().copied().unwrap_or(0.0);
    Tabulated {
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
