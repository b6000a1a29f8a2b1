//! A flat mat laid on a plane or wrapped around a cylinder: where each of its sensels comes to lie, and which way it looks.
//!
//! A mat that bends keeps its lengths, so a distance along it becomes an arc of the same length (it does not stretch).

use super::sensels::PlacedSensel;
use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, Sensel};
use crate::study::indenters::unit_vector;
use crate::study::toml_tree::{Section, nearest};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Largest cosine between two directions that are meant to be perpendicular.
const SKEW: f64 = 1e-3;

/// What a mat lies on. Positions in mm, skin coordinates.
#[derive(Debug, Clone, PartialEq)]
pub enum Seat {
    /// A plane.
    Plane {
        /// Corner of the mat before its first row and column.
        origin: Vector3<f64>,
        /// Unit vector in which columns count.
        columns: Vector3<f64>,
        /// Unit vector in which rows count, perpendicular to `columns`; the mat looks to `columns` x `rows`.
        rows: Vector3<f64>,
    },
    /// A cylinder, with the mat looking outward.
    Cylinder {
        /// Point of the axis at the height of the mat's edge before its first row.
        origin: Vector3<f64>,
        /// Unit vector along the axis, in which rows count.
        axis: Vector3<f64>,
        /// Unit vector from the axis to the mat's edge before its first column.
        seam: Vector3<f64>,
        /// Radius on which the sensels lie, mm.
        radius: f64,
        /// 1 if columns count around the axis by the right-hand rule, -1 if against it.
        turn: f64,
    },
}

impl Seat {
    /// Places every sensel of a map, in its order; `None` for a cell that is missing in every frame.
    ///
    /// # Errors
    /// What is wrong and its remedy: the file states no pitch or no areas, or the mat is longer than the cylinder is round.
    pub fn place(
        &self,
        map: &PressureMap,
    ) -> Result<Vec<Option<PlacedSensel>>, (String, &'static str)> {
        let flat = flat_centers(map)?;
        if let Seat::Cylinder { radius, .. } = self {
            let width = flat.iter().map(|[x, _]| *x).fold(0.0, f64::max);
            let around = 2.0 * PI * radius;
            if width > around {
                let problem = format!(
                    "the mat is {width:.1} mm long and the cylinder {around:.1} mm round, so it overlaps itself"
                );
                return Err((problem, "check diameter_mm, or cut the mat's last columns"));
            }
        }
        let area = |sensel: &Sensel| {
            sensel
                .area_mm2
                .ok_or(("the file states no area of its sensels".to_string(), GIVE))
        };
        let mut placed = Vec::with_capacity(flat.len());
        for (k, ([x, y], sensel)) in flat.iter().zip(&map.sensels).enumerate() {
            let is_missing = (0..map.frames()).all(|frame| map.frame(frame)[k].is_nan());
            let (center, normal) = self.at(*x, *y);
            placed.push(match is_missing {
                true => None,
                false => Some(PlacedSensel {
                    center_mm: center.into(),
                    normal: Some(normal.into()),
                    area_mm2: area(sensel)?,
                }),
            });
        }
        Ok(placed)
    }

    /// Position and outward normal of the point `x` mm along the columns and `y` mm along the rows of the flat mat.
    fn at(&self, x: f64, y: f64) -> (Vector3<f64>, Vector3<f64>) {
        match self {
            Seat::Plane {
                origin,
                columns,
                rows,
            } => (origin + columns * x + rows * y, columns.cross(rows)),
            Seat::Cylinder {
                origin,
                axis,
                seam,
                radius,
                turn,
            } => {
                let angle = turn * x / radius;
                let outward = seam * angle.cos() + axis.cross(seam) * angle.sin();
                (origin + axis * y + outward * *radius, outward)
            }
        }
    }
}

const GIVE: &str = "give sensels = \"sensels.csv\" instead";

/// Centers on the flat mat, mm from its corner: as the file states them, or by row, column and pitch; mirrored mats are turned back.
fn flat_centers(map: &PressureMap) -> Result<Vec<[f64; 2]>, (String, &'static str)> {
    if let Some(stated) = map
        .sensels
        .iter()
        .map(|sensel| sensel.center_mm)
        .collect::<Option<Vec<_>>>()
    {
        return Ok(stated);
    }
    let Some([row_pitch, column_pitch]) = map.pitch_mm else {
        return Err(("the file states no pitch of its sensels".into(), GIVE));
    };
    let steps = steps(map)?;
    let center = |[column, row]: [f64; 2]| [column_pitch * column, row_pitch * row];
    Ok(steps.centers.into_iter().map(center).collect())
}

/// A flat mat counted in cells: centers from its corner along columns and rows, and the number of columns and rows.
pub(in crate::study) struct Steps {
    pub centers: Vec<[f64; 2]>,
    pub count: [f64; 2],
}

/// Counts a map's cells; mirrored mats are turned back.
pub(in crate::study) fn steps(map: &PressureMap) -> Result<Steps, (String, &'static str)> {
    let places: Option<Vec<[u32; 2]>> = map.sensels.iter().map(|sensel| sensel.place).collect();
    let places = places.ok_or((
        "the file does not number rows and columns".to_string(),
        GIVE,
    ))?;
    let range = |axis: usize| {
        let numbers = || places.iter().map(|place| place[axis]);
        (numbers().min().unwrap_or(0), numbers().max().unwrap_or(0))
    };
    let (rows, columns) = (range(0), range(1));
    let along =
        |number: u32, (first, last): (u32, u32), is_mirrored: Option<bool>| match is_mirrored {
            Some(true) => f64::from(last - number) + 0.5,
            _ => f64::from(number - first) + 0.5,
        };
    let [rows_mirrored, columns_mirrored] = map.is_mirrored;
    let step = |[row, column]: &[u32; 2]| {
        [
            along(*column, columns, columns_mirrored),
            along(*row, rows, rows_mirrored),
        ]
    };
    let count = |(first, last): (u32, u32)| f64::from(last - first) + 1.0;
    Ok(Steps {
        centers: places.iter().map(step).collect(),
        count: [count(columns), count(rows)],
    })
}

/// Reads the table `placing` of a recording.
pub(in crate::study) fn read(section: &mut Section) -> Result<Seat, Fault> {
    let Some(entry) = section.get("on") else {
        return Err(section.needs("on", "give plane, cylinder or mesh"));
    };
    let kind = entry.text()?;
    if kind != "plane" && kind != "cylinder" {
        let problem = format!("a mat on {} is not known", shown(kind.as_bytes()));
        return Err(Fault::line(
            entry.line,
            problem,
            nearest(&kind, &["plane", "cylinder"]),
        ));
    }
    let Some(origin) = section.vector("origin_mm")? else {
        return Err(section.needs(
            "origin_mm",
            "give the mat's corner, or the point of the axis level with it, as [x, y, z]",
        ));
    };
    let origin = Vector3::from(origin);
    let mut pair = |first, second| -> Result<[Vector3<f64>; 2], Fault> {
        let pair = [unit_vector(section, first)?, unit_vector(section, second)?].map(Vector3::from);
        match pair[0].dot(&pair[1]).abs() < SKEW {
            true => Ok(pair),
            false => Err(section.fault(
                format!("{first} and {second} are not perpendicular"),
                "give directions at a right angle",
            )),
        }
    };
    if kind == "plane" {
        let [columns, rows] = pair("columns", "rows")?;
        return Ok(Seat::Plane {
            origin,
            columns,
            rows,
        });
    }
    let [axis, seam] = pair("axis", "seam")?;
    let Some(diameter) = section.positive("diameter_mm")? else {
        return Err(section.needs("diameter_mm", "give the diameter on which the sensels lie"));
    };
    let turn = match section.text("turn")?.as_deref() {
        None | Some("right") => 1.0,
        Some("left") => -1.0,
        Some(other) => {
            let problem = format!("turn {} is not known", shown(other.as_bytes()));
            return Err(section.fault(
                problem,
                "give right (columns by the right-hand rule about the axis) or left",
            ));
        }
    };
    Ok(Seat::Cylinder {
        origin,
        axis,
        seam,
        radius: 0.5 * diameter,
        turn,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::pressure_map::{PressureUnit, grid_sensels};
    use crate::source::Source;

    fn mat(rows: usize, columns: usize) -> PressureMap {
        let sensels = grid_sensels([3, 5], [rows, columns], Some(1.5));
        let mut map = PressureMap::new(Source::default(), PressureUnit::Kilopascal, sensels);
        map.pitch_mm = Some([2.0, 1.0]);
        map.values = vec![1.0; rows * columns];
        map
    }

    fn cylinder(radius: f64, turn: f64) -> Seat {
        Seat::Cylinder {
            origin: Vector3::new(1.0, 2.0, 3.0),
            axis: Vector3::z(),
            seam: Vector3::x(),
            radius,
            turn,
        }
    }

    #[test]
    fn a_plane_keeps_the_mat() {
        let seat = Seat::Plane {
            origin: Vector3::zeros(),
            columns: Vector3::y(),
            rows: Vector3::z(),
        };
        let placed = seat.place(&mat(2, 3)).unwrap();
        let last = placed[5].unwrap();
        assert_eq!(
            (last.center_mm, last.normal, last.area_mm2),
            ([0.0, 2.5, 3.0], Some([1.0, 0.0, 0.0]), 1.5)
        );
    }

    #[test]
    fn a_quarter_of_the_way_round_is_a_quarter_turn() {
        // 40 columns of 1 mm around a circle of 40 mm: the center of column 9.5 would lie at 90 degrees.
        let radius = 40.0 / (2.0 * PI);
        for turn in [1.0, -1.0] {
            let placed = cylinder(radius, turn).place(&mat(1, 40)).unwrap();
            for (k, sensel) in placed.iter().enumerate() {
                let (center, angle) = (
                    sensel.unwrap().center_mm,
                    turn * (k as f64 + 0.5) / 40.0 * 2.0 * PI,
                );
                let expected = [1.0 + radius * angle.cos(), 2.0 + radius * angle.sin(), 4.0];
                assert!(
                    center
                        .iter()
                        .zip(expected)
                        .all(|(a, b)| (a - b).abs() < 1e-12),
                    "{k}: {center:?}"
                );
            }
        }
        let (problem, _) = cylinder(0.9 * radius, 1.0).place(&mat(1, 40)).unwrap_err();
        assert!(
            problem.starts_with("the mat is 39.5 mm long and the cylinder 36.0 mm round"),
            "{problem}"
        );
    }

    #[test]
    fn on_a_cylinder_of_no_curvature_the_mat_is_flat() {
        let (radius, map) = (1e7, mat(4, 6));
        let flat = Seat::Plane {
            origin: Vector3::new(1.0 + radius, 2.0, 3.0),
            columns: Vector3::y(),
            rows: Vector3::z(),
        };
        let pairs = cylinder(radius, 1.0)
            .place(&map)
            .unwrap()
            .into_iter()
            .zip(flat.place(&map).unwrap());
        for (bent, flat) in pairs.map(|(bent, flat)| (bent.unwrap(), flat.unwrap())) {
            let apart = Vector3::from(bent.center_mm) - Vector3::from(flat.center_mm);
            assert!(apart.norm() < 1e-5, "{apart:?}");
        }
    }

    #[test]
    fn a_mirrored_mat_is_turned_back_and_missing_cells_have_no_place() {
        let mut map = mat(1, 3);
        map.is_mirrored = [Some(false), Some(true)];
        map.values[1] = f64::NAN;
        let seat = Seat::Plane {
            origin: Vector3::zeros(),
            columns: Vector3::x(),
            rows: Vector3::y(),
        };
        let placed = seat.place(&map).unwrap();
        let at: Vec<_> = placed
            .iter()
            .map(|place| place.map(|place| place.center_mm[0]))
            .collect();
        assert_eq!(at, [Some(2.5), None, Some(0.5)]);
    }
}
