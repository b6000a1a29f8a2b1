//! Builds the result of a press: arrays by vertex, region table, areas and peaks; sums of force are in `resultants`.

use thenar_surface::{Gap, Mesh, Product, Vec3};

use super::contact_area::{EdgeData, contact_areas};
use super::patch_peak::{Field, patch_peak};
use super::product_pressure::product_pressure;
use super::result::{Contact, Convergence, RegionResult, Residual};
use super::resultants::resultants;
use super::warning_rules::{CheckedFields, warnings_of};
use crate::interface::pulls::Adhesion;
use crate::interface::shear_result::shear_fields;
use crate::press::pressed::{Pressed, Travel};
use crate::skin::prepare::Skin;

/// Least posed area of a vertex relative to its rest area: posing must not turn a sliver into infinite pressure.
const LEAST_AREA_SHARE: f64 = 0.05;

/// Builds the result of a press after a travel of the product.
pub fn summarize(
    skin: &Skin,
    (posed, product): (&Mesh, &Product),
    pressed: &Pressed,
    travel: Travel,
) -> Contact {
    let fields = Fields::new(skin, posed, pressed);
    let touches: Vec<(f64, &Gap)> = pressed
        .solved
        .force
        .iter()
        .zip(&pressed.solved.touch)
        .filter(|(f, _)| **f > 0.0)
        .map(|(f, g)| (*f, g))
        .collect();
    let (product_pressure, product_force) = product_pressure(product, &touches, skin.spacing);
    let sums = resultants(pressed, &touches, travel.shift());
    let normal_force = sums.normal_force;
    // A sum of nothing is -0.
    let contact_area: f64 = 0.0
        + fields
            .contact_area
            .iter()
            .filter(|a| **a > 0.0)
            .sum::<f64>();
    let peak_pressure = fields.pressure.iter().filter(|p| **p > 0.0);
    let peak_pressure = peak_pressure.fold(0.0, |most, p| f64::max(most, *p));
    let patch_peak = fields.patch_peak(skin, posed);
    let regions = region_table(skin, pressed, &fields);
    let figures = CheckedFields {
        displacement: &fields.displacement,
        force: &fields.force,
        pressure: &fields.pressure,
        patch_peak,
    };
    let warnings = warnings_of(skin, (posed, product), pressed, &figures);
    let shear = shear_fields(skin, pressed, &fields.area);
    let solved = &pressed.solved;
    let load_balance = if normal_force > 0.0 {
        (product_force - normal_force).abs() / normal_force
    } else {
        0.0
    };
    Contact {
        displacement: by_given_vertex(skin, fields.displacement),
        nodal_force: force_by_vertex(skin, fields.force),
        pressure: by_given_vertex(skin, fields.pressure),
        gap: by_given_vertex(skin, fields.gap),
        normal: by_given_vertex(skin, fields.normal),
        total_force: sums.force,
        total_moment: sums.moment,
        center_of_pressure: sums.center_of_pressure,
        contact_area,
        peak_pressure,
        mean_pressure: if contact_area > 0.0 {
            normal_force / contact_area
        } else {
            0.0
        },
        patch_peak,
        regions,
        product_pressure,
        offset: travel.offset,
        direction: travel.direction,
        adhesion: adhesion_by_vertex(skin, &pressed.adhesion),
        shear,
        residual: Residual {
            complementarity: solved.complementarity,
            penetration_mm: solved.penetration,
            load_balance,
            far_field: solved.far_field,
        },
        convergence: Convergence {
            has_converged: pressed.has_converged(),
            ..solved.convergence
        },
        warnings,
        seconds: Vec::new(),
    }
}

/// Values by vertex of the mesh as given, from those by welded vertex.
pub(crate) fn by_given_vertex<T: Copy>(skin: &Skin, values: Vec<T>) -> Vec<T> {
    if skin.merged.merged() == 0 {
        return values;
    }
    let welded = skin.merged.merged_of.iter();
    welded.map(|&w| values[w as usize]).collect()
}

/// Nodal forces of the mesh as given: a merged vertex has none, its representative has all.
fn force_by_vertex(skin: &Skin, force: Vec<f64>) -> Vec<f64> {
    if skin.merged.merged() == 0 {
        return force;
    }
    let mut by_vertex = vec![0.0; skin.vertices()];
    for (&source, f) in skin.merged.source.iter().zip(&force) {
        by_vertex[source as usize] = *f;
    }
    by_vertex
}

/// Attraction of every vertex of the mesh as given, N; merged vertices bear none.
fn adhesion_by_vertex(skin: &Skin, adhesion: &Adhesion) -> Vec<f64> {
    let mut force = vec![0.0; skin.vertices()];
    for pull in &adhesion.pulls {
        let vertex = skin.sites.vertex[pull.site as usize] as usize;
        force[skin.merged.source[vertex] as usize] = pull.newton;
    }
    force
}

/// Sums of a press, without what only a full result needs.
pub struct Totals {
    /// Contact area by region, mm2.
    pub region_area: Vec<f64>,
    /// Normal force by region, N.
    pub region_force: Vec<f64>,
    /// Pressure (MPa) of the vertices in contact, by vertex of the mesh as given.
    pub pressure: Vec<(u32, f64)>,
}

/// Sums up a press.
pub fn totals(skin: &Skin, posed: &Mesh, pressed: &Pressed) -> Totals {
    let fields = Fields::new(skin, posed, pressed);
    let table = region_table(skin, pressed, &fields);
    let pressed = skin.merged.merged_of.iter().enumerate();
    Totals {
        region_area: table.iter().map(|row| row.area).collect(),
        region_force: table.iter().map(|row| row.force).collect(),
        pressure: pressed
            .map(|(v, &w)| (v as u32, fields.pressure[w as usize]))
            .filter(|(_, p)| *p > 0.0)
            .collect(),
    }
}

/// Fields by welded vertex.
struct Fields {
    displacement: Vec<Vec3>,
    force: Vec<f64>,
    pressure: Vec<f64>,
    gap: Vec<f64>,
    normal: Vec<Vec3>,
    area: Vec<f64>,
    contact_area: Vec<f64>,
}

impl Fields {
    fn new(skin: &Skin, posed: &Mesh, pressed: &Pressed) -> Self {
        let n = posed.positions().len();
        let (sites, solved) = (&skin.sites, &pressed.solved);
        let mut displacement = vec![Vec3::zeros(); n];
        for (site, u) in solved.displacement.iter().enumerate() {
            displacement[sites.vertex[site] as usize] = *u;
        }
        let area: Vec<f64> = pressed
            .detection
            .areas
            .iter()
            .zip(&*skin.rest_area)
            .map(|(now, rest)| now.max(LEAST_AREA_SHARE * rest))
            .collect();
        let gap = pressed.detection.distances.clone();
        let (mut force, mut pressure, mut normal) =
            (vec![0.0; n], vec![0.0; n], vec![Vec3::zeros(); n]);
        let mut slack = gap.clone();
        let mut modulus = vec![0.0; n];
        for (k, &site) in solved.zone.iter().enumerate() {
            let vertex = sites.vertex[site as usize] as usize;
            slack[vertex] = solved.slack[k].max(0.0);
            if solved.force[k] > 0.0 {
                force[vertex] = solved.force[k];
                pressure[vertex] = solved.force[k] / area[vertex];
                normal[vertex] = solved.touch[k].normal;
                let material = &skin.tissue.materials[sites.region[site as usize] as usize];
                modulus[vertex] =
                    2.0 * pressed.modulus_at[site as usize] / (1.0 - material.poisson_ratio);
            }
        }
        if !pressed.adhesion.pulls.is_empty() {
            // The law that places the edge between vertices is that of contact without attraction.
            slack.fill(f64::NAN);
        }
        let edge = EdgeData {
            posed: posed.positions(),
            displacement: &displacement,
            pressure: &pressure,
            slack: &slack,
            contact_modulus: &modulus,
        };
        let contact_area = contact_areas(posed.triangles(), edge);
        Fields {
            displacement,
            force,
            pressure,
            gap,
            normal,
            area,
            contact_area,
        }
    }

    fn patch_peak(&self, skin: &Skin, posed: &Mesh) -> f64 {
        let around = |v: usize| {
            let neighbors = skin.adjacency.neighbors(v);
            let sum: f64 = neighbors.iter().map(|&n| self.pressure[n as usize]).sum();
            (sum + self.pressure[v]) / (neighbors.len() + 1) as f64
        };
        let smooth: Vec<(u32, f64)> = (0..self.force.len())
            .filter(|&v| self.force[v] > 0.0)
            .map(|v| (v as u32, around(v)))
            .collect();
        let most = smooth.iter().fold(0.0, |most, s| f64::max(most, s.1));
        let centers: Vec<u32> = smooth
            .iter()
            .filter(|s| s.1 >= 0.5 * most)
            .map(|s| s.0)
            .collect();
        let field = Field {
            adjacency: &skin.adjacency,
            positions: posed.positions(),
            area: &self.area,
            force: &self.force,
        };
        patch_peak(&centers, field)
    }
}

fn region_table(skin: &Skin, pressed: &Pressed, fields: &Fields) -> Vec<RegionResult> {
    let mut table: Vec<RegionResult> = (0..skin.tissue.materials.len())
        .map(|index| RegionResult {
            index,
            force: 0.0,
            area: 0.0,
            peak: 0.0,
            mean: 0.0,
            max_penetration: pressed.detection.max_penetration[index],
            shear_modulus: pressed.shear_modulus[index],
        })
        .collect();
    // Only skin that is pressed has an area of contact.
    for &site in &pressed.solved.zone {
        let region = skin.sites.region[site as usize];
        let vertex = skin.sites.vertex[site as usize] as usize;
        if region >= 0 && fields.force[vertex] > 0.0 {
            let row = &mut table[region as usize];
            row.force += fields.force[vertex];
            row.area += fields.contact_area[vertex];
            row.peak = row.peak.max(fields.pressure[vertex]);
        }
    }
    for row in &mut table {
        row.mean = if row.area > 0.0 {
            row.force / row.area
        } else {
            0.0
        };
    }
    table
}
