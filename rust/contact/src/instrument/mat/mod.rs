//! A mat of sensels on any surface and its reading of a contact: the mean pressure over each sensel.

pub mod contact_loads;
pub mod layout;
pub mod placement;

use thenar_surface::Vec3;

use crate::ContactError;
use crate::instrument::mat::layout::{SensorGrid, WAYS};
use crate::instrument::mat::placement::{Placement, Spot};

/// kPa in 1 MPa.
const KPA: f64 = 1e3;
/// A load farther off the mat than this many pitches is not read.
const REACH: f64 = 2.0;
/// Half side of the footprint of a load without area, mm.
const POINT: f64 = 1e-6;
/// Most sensels of a mat.
const MOST: usize = 16_384;
/// How far a distance between sensels may be corrected for curvature.
const MOST_STRETCH: f64 = 2.0;

/// Where the sensels of a mat lie, in the frame of the product, or of the skin if it is worn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MatLayout {
    /// Centers, mm, any number in any order; cells that are missing are left out.
    pub centers: Vec<Vec3>,
    /// Normals, any length but 0; empty: those of the planes through the neighbors, of either sign.
    pub normals: Vec<Vec3>,
    /// Areas, mm2.
    pub areas: Vec<f64>,
    /// The mat's first direction, roughly; None: towards the nearest neighbor of the sensel in the middle. The second is
    /// normal x first.
    pub along: Option<Vec3>,
}

/// A force on the mat that acts over a small area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLoad {
    /// Middle, mm.
    pub position: Vec3,
    /// N, normal to the surface.
    pub force_n: f64,
    /// mm2, such as the area of the skin's vertex; 0 is a point.
    pub area_mm2: f64,
}

/// A mat of sensels, flat or wrapped around anything.
///
/// Sensels are rectangles with their own areas and the proportions of the mat's pitches. Where sensels lie side by side no
/// force is lost between them; what falls beside the mat, into a gap, or on a missing cell is not read.
#[derive(Debug, Clone, PartialEq)]
pub struct Mat {
    centers: Vec<Vec3>,
    areas: Vec<f64>,
    lie: SensorGrid,
}

impl Mat {
    /// Lays the mat out.
    ///
    /// # Errors
    /// [`ContactError::Mat`] if there is no sensel, or one is not finite, has no area or no normal, or lies on another.
    pub fn new(layout: MatLayout) -> Result<Mat, ContactError> {
        let normals = check(&layout)?;
        let MatLayout {
            centers,
            areas,
            along,
            ..
        } = layout;
        let lie = SensorGrid::new(&centers, &normals, &areas, along);
        Ok(Mat {
            centers,
            areas,
            lie,
        })
    }

    /// Number of sensels.
    pub fn len(&self) -> usize {
        self.centers.len()
    }

    /// True if there are none; no mat is.
    pub fn is_empty(&self) -> bool {
        self.centers.is_empty()
    }

    /// Centers, mm.
    pub fn centers(&self) -> &[Vec3] {
        &self.centers
    }

    /// Unit normals.
    pub fn normals(&self) -> &[Vec3] {
        &self.lie.normals
    }

    /// Areas, mm2.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// The mat's two directions at each sensel.
    pub fn axes(&self) -> &[[Vec3; 2]] {
        &self.lie.axes
    }

    /// Place of each sensel on the unrolled mat, mm from its middle.
    pub fn flat(&self) -> &[[f64; 2]] {
        &self.lie.flat
    }

    /// Usual distance of neighbors in the two directions, mm.
    pub fn pitch_mm(&self) -> [f64; 2] {
        self.lie.pitch
    }

    /// Sensels beside a sensel, at most four.
    pub fn neighbors(&self, sensel: usize) -> impl Iterator<Item = usize> + '_ {
        self.lie.neighbors(sensel)
    }

    /// What the mat reads: mean pressure over each sensel, kPa.
    pub fn read(&self, loads: &[PointLoad]) -> Vec<f64> {
        self.read_at(loads, &Placement::default())
    }

    /// What the mat reads where it lies otherwise than it should, kPa.
    pub fn read_at(&self, loads: &[PointLoad], placement: &Placement) -> Vec<f64> {
        self.read_located((loads, &self.locate(loads)), placement)
    }

    /// Where loads lie on the mat as it should be; None off it, and without force.
    pub fn locate(&self, loads: &[PointLoad]) -> Vec<Option<Spot>> {
        let spot = |load: &PointLoad| match load.force_n != 0.0 {
            true => self.spot(&load.position),
            false => None,
        };
        loads.iter().map(spot).collect()
    }

    /// The same as [`Mat::read_at`] of loads that were located before, which does not depend on the placement.
    pub fn read_located(
        &self,
        (loads, spots): (&[PointLoad], &[Option<Spot>]),
        placement: &Placement,
    ) -> Vec<f64> {
        let mut force = vec![0.0; self.len()];
        for (load, spot) in loads.iter().zip(spots) {
            let Some(mut spot) = *spot else {
                continue;
            };
            if !placement.is_none() {
                spot = placement.moved((&self.lie, &self.centers), spot);
            }
            self.share(&spot, load, &mut force);
        }
        force
            .iter()
            .zip(&self.areas)
            .map(|(f, a)| KPA * f / a)
            .collect()
    }

    /// Force on the mat by a reading in kPa, N.
    pub fn force_n(&self, frame: &[f64]) -> f64 {
        frame
            .iter()
            .zip(&self.areas)
            .map(|(p, a)| p * a / KPA)
            .sum()
    }

    /// Area of the sensels that read more than `threshold_kpa`, mm2.
    pub fn area_mm2(&self, frame: &[f64], threshold_kpa: f64) -> f64 {
        let reads = frame
            .iter()
            .zip(&self.areas)
            .filter(|(p, _)| **p > threshold_kpa);
        reads.map(|(_, a)| a).sum()
    }

    /// A reading as loads on the sensels, for a mat that is then moved.
    pub fn loads_of(&self, frame: &[f64]) -> Vec<PointLoad> {
        let load = |((center, area), p): ((&Vec3, &f64), &f64)| PointLoad {
            position: *center,
            force_n: p * area / KPA,
            area_mm2: *area,
        };
        self.centers
            .iter()
            .zip(&self.areas)
            .zip(frame)
            .map(load)
            .collect()
    }

    /// From one sensel to another along the mat, in its two directions, mm.
    fn apart(&self, from: usize, to: usize) -> [f64; 2] {
        self.lie.apart(&self.centers, (from, to))
    }

    /// Where a place lies along the mat; None off it.
    fn spot(&self, position: &Vec3) -> Option<Spot> {
        let mut nearest = (f64::INFINITY, 0);
        for (k, center) in self.centers.iter().enumerate() {
            let distance = (center - position).norm_squared();
            if distance < nearest.0 {
                nearest = (distance, k);
            }
        }
        let sensel = nearest.1;
        let off = (position - self.centers[sensel]).dot(&self.lie.normals[sensel]);
        let is_near = off.abs() <= REACH * self.lie.pitch[0].max(self.lie.pitch[1]);
        let at = [0, 1].map(|axis| self.along((sensel, position), axis));
        is_near.then_some(Spot { sensel, at })
    }

    /// How far along one direction a place is from its sensel, mm: beside or over a bent mat what is seen in the tangent
    /// plane is scaled so that sensel and neighbor agree.
    fn along(&self, (sensel, position): (usize, &Vec3), axis: usize) -> f64 {
        let seen = |from: usize| (position - self.centers[from]).dot(&self.lie.axes[from][axis]);
        let here = seen(sensel);
        let ways = || {
            WAYS.iter()
                .zip(&self.lie.beside[sensel])
                .filter(|((a, _), _)| *a == axis)
        };
        let ahead = ways()
            .filter(|((_, sign), _)| sign * here >= 0.0)
            .find_map(|(_, k)| *k);
        let Some(other) = ahead.or_else(|| ways().find_map(|(_, k)| *k)) else {
            return here;
        };
        let stretch = self.apart(sensel, other as usize)[axis] / (here - seen(other as usize));
        if stretch.is_finite() {
            here * stretch.clamp(1.0 / MOST_STRETCH, MOST_STRETCH)
        } else {
            here
        }
    }

    /// Adds a load's force to the sensels that its footprint overlaps.
    fn share(&self, spot: &Spot, load: &PointLoad, force: &mut [f64]) {
        let half = (0.5 * load.area_mm2.sqrt()).max(POINT);
        let (from, off) = (self.centers[spot.sensel], spot.at[0].hypot(spot.at[1]));
        let mut shares: Vec<(usize, f64)> = Vec::new();
        let reach = |sides: &[f64; 2]| off + 0.75 * (sides[0] + sides[1]) + 1.5 * half;
        let farthest = reach(&self.lie.largest);
        for sensel in self.lie.within(spot.sensel, farthest) {
            let (sides, reach) = (&self.lie.sides[sensel], reach(&self.lie.sides[sensel]));
            if (self.centers[sensel] - from).norm_squared() > reach * reach
                || self.lie.normals[sensel].dot(&self.lie.normals[spot.sensel]) <= 0.0
            {
                continue;
            }
            let apart = self.apart(spot.sensel, sensel);
            let overlap = |axis: usize| {
                let (x, cell) = (spot.at[axis] - apart[axis], 0.5 * sides[axis]);
                ((x + half).min(cell) - (x - half).max(-cell)).max(0.0) / (2.0 * half)
            };
            let share = overlap(0) * overlap(1);
            if share > 0.0 {
                shares.push((sensel, share));
            }
        }
        let covered: f64 = shares.iter().map(|s| s.1).sum();
        for (sensel, share) in shares {
            force[sensel] += load.force_n * share / covered.max(1.0);
        }
    }
}

/// Checks a layout; returns unit normals.
fn check(layout: &MatLayout) -> Result<Vec<Vec3>, ContactError> {
    let refuse = |problem: String| Err(ContactError::Mat { problem });
    let n = layout.centers.len();
    if n == 0 || n > MOST {
        return refuse(format!("it has {n} sensels; give 1 to {MOST}"));
    }
    if layout.areas.len() != n || !(layout.normals.is_empty() || layout.normals.len() == n) {
        return refuse(format!(
            "{n} centers, {} areas and {} normals; give one of each per sensel, or no normals",
            layout.areas.len(),
            layout.normals.len()
        ));
    }
    let is_finite = |v: &Vec3| v.iter().all(|c| c.is_finite());
    if let Some(k) = layout.centers.iter().position(|c| !is_finite(c)) {
        return refuse(format!(
            "the center of sensel {k} is not finite; leave missing cells out"
        ));
    }
    if let Some(k) = layout
        .areas
        .iter()
        .position(|a| !(*a > 0.0 && a.is_finite()))
    {
        return refuse(format!(
            "sensel {k} has an area of {} mm2; give one above 0",
            layout.areas[k]
        ));
    }
    let unit = |v: &Vec3| v.try_normalize(1e-12).filter(is_finite);
    let normals: Option<Vec<Vec3>> = layout.normals.iter().map(unit).collect();
    let Some(normals) = normals else {
        let k = layout
            .normals
            .iter()
            .position(|v| unit(v).is_none())
            .unwrap_or(0);
        return refuse(format!(
            "the normal of sensel {k} has no direction; give the surface's there"
        ));
    };
    if layout.along.as_ref().is_some_and(|v| unit(v).is_none()) {
        return refuse(
            "its first direction is zero or not finite; give a vector along it, or none".to_owned(),
        );
    }
    if normals.is_empty() && n < 3 {
        return refuse(format!("{n} sensels span no plane; give their normals"));
    }
    check_apart(&layout.centers)?;
    Ok(normals)
}

fn check_apart(centers: &[Vec3]) -> Result<(), ContactError> {
    let mut order: Vec<usize> = (0..centers.len()).collect();
    let key = |k: usize| (centers[k].x, centers[k].y, centers[k].z);
    order.sort_by(|a, b| {
        let (a, b) = (key(*a), key(*b));
        a.0.total_cmp(&b.0)
            .then(a.1.total_cmp(&b.1))
            .then(a.2.total_cmp(&b.2))
    });
    match order
        .windows(2)
        .find(|pair| centers[pair[0]] == centers[pair[1]])
    {
        None => Ok(()),
        Some(pair) => Err(ContactError::Mat {
            problem: format!(
                "sensels {} and {} lie on the same place; leave one out",
                pair[0], pair[1]
            ),
        }),
    }
}
