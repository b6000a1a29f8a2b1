//! Scan windows: discs on sensor and skin, and intervals of a protocol.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use crate::location::protocol_cells::{Cell, Cells, broad_groups, runs};
use crate::location::residual_sums::{CellSums, Channel};
use thenar_inference::observe::measured::{Mat, Measured};

/// Radii of discs in pitches of the sensor: one sensel, four neighbors, eight, and on.
const RADII: [f64; 5] = [0.0, 1.1, 1.6, 2.3, 3.2];
/// Largest radius of a disc, mm.
const LARGEST: f64 = 15.0;
/// Smallest radius that is stated, mm.
pub(crate) const SMALLEST: f64 = 1.5;

/// In which coordinates a disc stays where it is from pose to pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Coordinates {
    /// The same sensels in every pose; with one pose the same skin, too.
    Sensor,
    /// The same skin in every pose.
    Skin,
}

/// A round place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Disc {
    pub coordinates: Coordinates,
    /// Number of the sensor.
    pub sensor: usize,
    /// Number of the sensel in its middle.
    pub sensel: u32,
    /// Its center in the pose that the disc is drawn in, skin coordinates, mm.
    pub center: Vector3<f64>,
    /// mm.
    pub radius: f64,
}

/// One thing looked at: a sum of rows.
#[derive(Debug, Clone)]
pub(crate) struct ScanWindow {
    pub rows: Vec<u32>,
    /// Where; None: everywhere that the channel reads.
    pub disc: Option<Disc>,
    /// Number of its group of cells.
    pub group: usize,
}

/// A mat in all its poses.
pub(crate) struct Sensor {
    /// First recording that shows it.
    pub recording: usize,
    /// Centers of the sensels in every pose, mm.
    pub poses: Vec<Vec<Vector3<f64>>>,
    /// Pose of each cell that it recorded.
    pose_of: BTreeMap<usize, usize>,
    /// Median distance from a sensel to the next, mm.
    pub pitch: f64,
}

/// All looks.
pub(crate) struct ScanWindows {
    /// Atoms of each row.
    pub rows: Vec<Vec<u32>>,
    pub list: Vec<ScanWindow>,
    /// Cells of each group.
    pub groups: Vec<Vec<usize>>,
    pub sensors: Vec<Sensor>,
}

/// Everything worth a look, in a fixed order, nothing twice.
pub(crate) fn plan(measured: &[Measured], cells: &Cells, cell_sums: &CellSums) -> ScanWindows {
    let mut windows = ScanWindows {
        rows: Vec::new(),
        list: Vec::new(),
        groups: Vec::new(),
        sensors: sensors(measured, &cells.list),
    };
    let broad = broad_groups(&cells.list, measured);
    let mut narrow = broad.clone();
    narrow.extend(runs(&cells.list, measured.len()));
    let mut of_channel: BTreeMap<(Channel, Option<usize>), BTreeMap<usize, Vec<u32>>> =
        BTreeMap::new();
    for (at, cell_sum) in cell_sums.list.iter().enumerate() {
        let (kind, sensor) = match cell_sum.channel {
            Channel::Pressure(_) => (Channel::Pressure(0), windows.sensor_of(cell_sum.cell)),
            other => (other, None),
        };
        let by_cell = of_channel.entry((kind, sensor)).or_default();
        by_cell.entry(cell_sum.cell).or_default().push(at as u32);
    }
    for ((_, sensor), by_cell) in &of_channel {
        windows.everywhere(&narrow, by_cell);
        if let Some(sensor) = sensor {
            windows.discs(*sensor, &broad, (cell_sums, by_cell));
        }
    }
    windows
}

impl ScanWindows {
    fn sensor_of(&self, cell: usize) -> Option<usize> {
        let has = |sensor: &Sensor| sensor.pose_of.contains_key(&cell);
        self.sensors.iter().position(has)
    }

    /// One look per group at all atoms of a channel.
    fn everywhere(&mut self, groups: &BTreeSet<Vec<usize>>, by_cell: &BTreeMap<usize, Vec<u32>>) {
        for group in restricted(groups, by_cell) {
            let row = self.row(atoms_of(&group, by_cell));
            self.groups.push(group);
            self.list.push(ScanWindow {
                rows: vec![row],
                disc: None,
                group: self.groups.len() - 1,
            });
        }
    }

    fn row(&mut self, cell_sums: Vec<u32>) -> u32 {
        self.rows.push(cell_sums);
        (self.rows.len() - 1) as u32
    }

    /// Discs on one sensor, for every group of cells.
    fn discs(
        &mut self,
        sensor: usize,
        groups: &BTreeSet<Vec<usize>>,
        (cell_sums, by_cell): (&CellSums, &BTreeMap<usize, Vec<u32>>),
    ) {
        let neighbors = Neighbors::new(&self.sensors[sensor]);
        for group in restricted(groups, by_cell) {
            let mut own: BTreeMap<(usize, u32), Vec<u32>> = BTreeMap::new();
            for cell_sum in atoms_of(&group, by_cell) {
                if let Channel::Pressure(sensel) = cell_sums.list[cell_sum as usize].channel {
                    let pose =
                        self.sensors[sensor].pose_of[&cell_sums.list[cell_sum as usize].cell];
                    own.entry((pose, sensel)).or_default().push(cell_sum);
                }
            }
            let rows: BTreeMap<(usize, u32), u32> = own
                .into_iter()
                .map(|(place, cell_sums)| (place, self.row(cell_sums)))
                .collect();
            self.groups.push(group);
            self.discs_of_group(sensor, &rows, &neighbors);
        }
    }

    fn discs_of_group(
        &mut self,
        sensor: usize,
        rows: &BTreeMap<(usize, u32), u32>,
        neighbors: &Neighbors,
    ) {
        let poses: BTreeSet<usize> = rows.keys().map(|(pose, _)| *pose).collect();
        let Some(&drawn) = poses.first() else { return };
        let seen: BTreeSet<u32> = rows.keys().map(|(_, sensel)| *sensel).collect();
        let mut known: BTreeSet<Vec<u32>> = BTreeSet::new();
        let mut add = |windows: &mut ScanWindows, mut found: Vec<u32>, disc: Disc| {
            found.sort_unstable();
            if !found.is_empty() && known.insert(found.clone()) {
                windows.list.push(ScanWindow {
                    rows: found,
                    disc: Some(disc),
                    group: windows.groups.len() - 1,
                });
            }
        };
        let many = poses.len() > 1;
        for radius in neighbors.radii.clone() {
            let disc = |coordinates, sensel: u32, center| Disc {
                coordinates,
                sensor,
                sensel,
                center,
                radius: radius.max(0.5 * neighbors.pitch).max(SMALLEST),
            };
            for &sensel in &seen {
                let within = neighbors.within((drawn, sensel), drawn, radius);
                let found = within
                    .flat_map(|j| poses.iter().filter_map(move |pose| rows.get(&(*pose, j))))
                    .copied()
                    .collect();
                let center = self.sensors[sensor].poses[drawn][sensel as usize];
                add(self, found, disc(Coordinates::Sensor, sensel, center));
            }
            for &(pose, sensel) in rows.keys().filter(|_| many) {
                // On the skin a sensel of one pose meets up to four of another: half a pitch is the least radius that finds one.
                let reach = radius.max(0.71 * neighbors.pitch);
                let found = poses
                    .iter()
                    .flat_map(|other| {
                        let within = neighbors.within((pose, sensel), *other, reach);
                        within.filter_map(move |j| rows.get(&(*other, j)))
                    })
                    .copied()
                    .collect();
                let center = self.sensors[sensor].poses[pose][sensel as usize];
                add(self, found, disc(Coordinates::Skin, sensel, center));
            }
        }
    }
}

/// Groups cut down to the cells that a channel has, each once.
fn restricted(
    groups: &BTreeSet<Vec<usize>>,
    by_cell: &BTreeMap<usize, Vec<u32>>,
) -> BTreeSet<Vec<usize>> {
    let cut = |group: &Vec<usize>| -> Vec<usize> {
        let has = |cell: &&usize| by_cell.contains_key(cell);
        group.iter().filter(has).copied().collect()
    };
    groups
        .iter()
        .map(cut)
        .filter(|group| !group.is_empty())
        .collect()
}

fn atoms_of(group: &[usize], by_cell: &BTreeMap<usize, Vec<u32>>) -> Vec<u32> {
    let cell_sums = group.iter().filter_map(|cell| by_cell.get(cell)).flatten();
    cell_sums.copied().collect()
}

/// What lies around a sensel: for each pose, sensels with their distance, nearest first.
type Around = Vec<Vec<(f64, u32)>>;

/// Distances between the sensels of all poses, sorted out once.
struct Neighbors {
    /// By pose and sensel.
    near: Vec<Vec<Around>>,
    radii: Vec<f64>,
    pitch: f64,
}

impl Neighbors {
    fn new(sensor: &Sensor) -> Neighbors {
        let pitch = sensor.pitch;
        let fits = |radius: &f64| *radius <= LARGEST || *radius == 0.0;
        let radii: Vec<f64> = RADII.iter().map(|r| r * pitch).filter(fits).collect();
        let reach = radii.iter().fold(0.71 * pitch, |most, r| most.max(*r));
        let around = |center: &Vector3<f64>, pose: &Vec<Vector3<f64>>| {
            let mut near: Vec<(f64, u32)> = (0u32..)
                .zip(pose)
                .map(|(sensel, other)| ((other - center).norm(), sensel))
                .filter(|(distance, _)| *distance <= reach)
                .collect();
            near.sort_by(|one, two| one.0.total_cmp(&two.0).then(one.1.cmp(&two.1)));
            near
        };
        let poses = &sensor.poses;
        let of_center = |center: &Vector3<f64>| poses.iter().map(|p| around(center, p)).collect();
        let near = poses
            .iter()
            .map(|pose| pose.iter().map(of_center).collect())
            .collect();
        Neighbors { near, radii, pitch }
    }

    /// Sensels of pose `other` within `radius` of a sensel of a pose.
    fn within(
        &self,
        (pose, sensel): (usize, u32),
        other: usize,
        radius: f64,
    ) -> impl Iterator<Item = u32> + '_ {
        self.near[pose][sensel as usize][other]
            .iter()
            .take_while(move |(distance, _)| *distance <= radius + 1e-9)
            .map(|(_, sensel)| *sensel)
    }
}

/// The mats of a study: recordings whose sensels bear the same numbers are of one mat, in as many poses as their centers differ.
fn sensors(measured: &[Measured], cells: &[Cell]) -> Vec<Sensor> {
    let mut sensors: Vec<Sensor> = Vec::new();
    for (at, cell) in cells.iter().enumerate() {
        let one = &measured[cell.recording];
        let Some(mat) = one.mat.as_ref().filter(|mat| !mat.centers.is_empty()) else {
            continue;
        };
        let same = |sensor: &Sensor| {
            let other = &measured[sensor.recording];
            let places = other
                .mat
                .as_ref()
                .map(|mat| (&mat.places, mat.centers.len()));
            places == Some((&mat.places, mat.centers.len()))
                && other.is_calibrated == one.is_calibrated
        };
        let which = sensors.iter().position(same).unwrap_or_else(|| {
            sensors.push(Sensor {
                recording: cell.recording,
                poses: Vec::new(),
                pose_of: BTreeMap::new(),
                pitch: pitch(mat),
            });
            sensors.len() - 1
        });
        sensors[which].place(at, mat, cell.slide);
    }
    sensors
}

impl Sensor {
    /// Where a sensel lies in a cell, if this mat recorded it.
    pub(crate) fn place_of(&self, cell: usize, sensel: u32) -> Option<Vector3<f64>> {
        let pose = self.pose_of.get(&cell)?;
        self.poses[*pose].get(sensel as usize).copied()
    }

    /// Centers in the pose in which a sensel lies at `center`.
    pub(crate) fn pose_at(&self, center: Vector3<f64>, sensel: u32) -> &[Vector3<f64>] {
        let apart = |pose: &&Vec<Vector3<f64>>| (pose[sensel as usize] - center).norm();
        let nearest = self
            .poses
            .iter()
            .min_by(|a, b| apart(a).total_cmp(&apart(b)));
        nearest.map_or(&[], Vec::as_slice)
    }

    fn place(&mut self, cell: usize, mat: &Mat, slide: Vector3<f64>) {
        let centers: Vec<Vector3<f64>> = mat.centers.iter().map(|c| c + slide).collect();
        let close = |pose: &Vec<Vector3<f64>>| {
            let apart = pose
                .iter()
                .zip(&centers)
                .map(|(one, two)| (one - two).norm());
            apart.fold(0.0, f64::max) <= 0.25 * self.pitch
        };
        let pose = self.poses.iter().position(close).unwrap_or_else(|| {
            self.poses.push(centers.clone());
            self.poses.len() - 1
        });
        self.pose_of.insert(cell, pose);
    }
}

/// Median distance from a sensel to the next; from the area for a single one.
fn pitch(mat: &Mat) -> f64 {
    let nearest = |at: usize| {
        let others = mat
            .centers
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != at);
        let distances = others.map(|(_, center)| (center - mat.centers[at]).norm());
        distances.fold(f64::INFINITY, f64::min)
    };
    let mut all: Vec<f64> = (0..mat.centers.len()).map(nearest).collect();
    all.sort_by(f64::total_cmp);
    let middle = all[all.len() / 2];
    if middle.is_finite() && middle > 0.0 {
        middle
    } else {
        mat.areas.first().map_or(1.0, |area| area.sqrt()).max(1e-3)
    }
}
