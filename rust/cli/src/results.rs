//! The files of a press: vertices.csv, product.csv and summary.json, whole or not at all, the same bytes every run.

use crate::fault::Fault;
use crate::regions::RegionTable;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use thenar_contact::{Contact, RegionResult, Warning};

const KPA_PER_MPA: f64 = 1e3;

/// A file to be written: its name and what it holds.
pub struct Output {
    pub name: &'static str,
    pub text: String,
}

/// vertices.csv and product.csv.
pub fn tables(contact: &Contact) -> [Output; 2] {
    let mut vertices = "index,dx_mm,dy_mm,dz_mm,pressure_kpa,force_n,in_contact\n".to_owned();
    for (index, displacement) in contact.displacement.iter().enumerate() {
        let (pressure, force) = (
            contact.pressure[index] * KPA_PER_MPA,
            contact.nodal_force[index],
        );
        let (x, y, z, touches) = (
            displacement.x,
            displacement.y,
            displacement.z,
            u8::from(force > 0.0),
        );
        let _ = writeln!(vertices, "{index},{x},{y},{z},{pressure},{force},{touches}");
    }
    let mut product = "index,pressure_kpa\n".to_owned();
    for (index, pressure) in contact.product_pressure.iter().enumerate() {
        let _ = writeln!(product, "{index},{}", pressure * KPA_PER_MPA);
    }
    [
        Output {
            name: "vertices.csv",
            text: vertices,
        },
        Output {
            name: "product.csv",
            text: product,
        },
    ]
}

/// shear.csv, where friction acted.
pub fn shear_table(contact: &Contact) -> Option<Output> {
    let shear = contact.shear.as_ref()?;
    let mut text =
        "index,tx_n,ty_n,tz_n,traction_kpa,slip_x_mm,slip_y_mm,slip_z_mm,slip_margin,is_sticking\n"
            .to_owned();
    let touching = (0..shear.force.len()).filter(|&i| !shear.margin[i].is_nan());
    for i in touching {
        let (force, slip, margin) = (shear.force[i], shear.slip[i], shear.margin[i]);
        let (traction, sticks) = (
            shear.traction[i] * KPA_PER_MPA,
            u8::from(shear.is_sticking[i]),
        );
        let _ = writeln!(
            text,
            "{i},{},{},{},{traction},{},{},{},{margin},{sticks}",
            force.x, force.y, force.z, slip.x, slip.y, slip.z
        );
    }
    Some(Output {
        name: "shear.csv",
        text,
    })
}

/// summary.json; `run` says what was pressed. It holds no times, so that the same input gives the same bytes.
pub fn summary(contact: &Contact, regions: &RegionTable, run: Value) -> Output {
    let row = |row: &RegionResult| {
        json!({
            "index": row.index,
            "name": regions.name(row.index),
            "force_n": row.force,
            "area_mm2": row.area,
            "peak_mpa": row.peak,
            "mean_mpa": row.mean,
            "dmax_mm": row.max_penetration,
            "g_mpa": row.shear_modulus,
        })
    };
    let summary = json!({
        "schema": 1,
        "version": env!("CARGO_PKG_VERSION"),
        "run": run,
        "force_n": contact.nodal_force.iter().sum::<f64>(),
        "total_force_n": contact.total_force.as_slice(),
        "total_moment_nmm": contact.total_moment.as_slice(),
        "center_of_pressure_mm": contact.center_of_pressure.as_slice(),
        "contact_area_mm2": contact.contact_area,
        "peak_pressure_mpa": contact.peak_pressure,
        "mean_pressure_mpa": contact.mean_pressure,
        "patch_peak_mpa": contact.patch_peak,
        "offset_mm": contact.offset,
        "direction": contact.direction.as_slice(),
        "regions": contact.regions.iter().map(row).collect::<Vec<_>>(),
        "residual": {
            "complementarity": contact.residual.complementarity,
            "penetration_mm": contact.residual.penetration_mm,
            "load_balance": contact.residual.load_balance,
        },
        "convergence": {
            "has_converged": contact.convergence.has_converged,
            "passes": contact.convergence.passes,
            "pivots": contact.convergence.pivots,
            "cg_steps": contact.convergence.cg_steps,
        },
        "grade": contact.grade().name(),
        "reason": contact.reason().map(Warning::to_string),
        "warnings": contact.warnings.iter().map(Warning::to_string).collect::<Vec<_>>(),
    });
    Output {
        name: "summary.json",
        text: format!("{summary:#}\n"),
    }
}

/// Writes every file beside its place, then moves all into place; summary.json, the last, says that the others are whole.
///
/// # Errors
/// The folder cannot be made or written to; then no file of this run is left.
pub fn write(folder: &Path, outputs: &[Output]) -> Result<(), Fault> {
    let cannot = |path: &Path, error: std::io::Error| {
        Fault::Other(format!(
            "{}: cannot be written ({error}); choose another --out or free the disk",
            path.display()
        ))
    };
    fs::create_dir_all(folder).map_err(|error| cannot(folder, error))?;
    let aside = |output: &Output| folder.join(format!(".{}.{}", output.name, std::process::id()));
    let clear = || {
        outputs
            .iter()
            .for_each(|output| drop(fs::remove_file(aside(output))))
    };
    let written: Result<(), (PathBuf, std::io::Error)> = outputs.iter().try_for_each(|output| {
        let path = aside(output);
        let mut file = fs::File::create(&path).map_err(|error| (path.clone(), error))?;
        file.write_all(output.text.as_bytes())
            .and_then(|()| file.sync_all())
            .map_err(|error| (path, error))
    });
    let moved = written.and_then(|()| {
        outputs.iter().try_for_each(|output| {
            let path = folder.join(output.name);
            fs::rename(aside(output), &path).map_err(|error| (path, error))
        })
    });
    moved.map_err(|(path, error)| {
        clear();
        cannot(&path, error)
    })
}
