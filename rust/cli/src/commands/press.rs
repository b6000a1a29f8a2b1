//! `thenar press`: reads the meshes, presses, writes the results.

use crate::arguments::{ModelName, PressArguments};
use crate::fault::Fault;
use crate::regions::RegionTable;
use crate::results::Output;
use crate::{effects, interrupt, materials, protocol, regions, results, threads};
use serde_json::{Value, json};
use std::path::Path;
use thenar_contact::{
    Contact, Control, ForceTarget, Keep, Model, Press, Run, Skin, SkinInput, Start, Unsolved,
    Workspace,
};
use thenar_recordings::meshes::{self, MeshFile};
use thenar_surface::{Mesh, Product, Vec3};

/// Reads, presses, writes, and tells what came out on the terminal.
///
/// # Errors
/// One sentence; then nothing was written.
pub fn run(arguments: &PressArguments) -> Result<(), Fault> {
    interrupt::watch()?;
    threads::use_only(arguments.threads)?;
    let control = Control {
        cancelled: &interrupt::is_cancelled,
        progress: &|_, _| {},
    };
    let (contact, regions, table) = press(arguments, &control)?;
    let [vertices, product] = results::tables(&contact);
    let summary = results::summary(&contact, &regions, said(arguments));
    let mut outputs = vec![vertices, product];
    outputs.extend(table);
    outputs.extend(results::shear_table(&contact));
    outputs.push(summary);
    interrupt::writing(|| results::write(&arguments.out, &outputs))?;
    crate::terminal::write(&report(&contact, &regions, &arguments.out));
    Ok(())
}

/// The contact, at the last row of a protocol if there is one, and then the protocol's table.
fn press(
    arguments: &PressArguments,
    control: &Control,
) -> Result<(Contact, RegionTable, Option<Output>), Fault> {
    let model = match arguments.model {
        ModelName::Layer => Model::Layer,
        ModelName::Paper => Model::Paper,
    };
    let hand = scaled(&arguments.hand, arguments)?;
    let regions = match &arguments.regions {
        Some(file) => regions::read(file, hand.positions.len())?,
        None => RegionTable::single(hand.positions.len()),
    };
    let materials = match &arguments.materials {
        Some(file) => materials::read(file, model, &regions)?,
        None => materials::presets(model, &regions),
    };
    let product = scaled(&arguments.product, arguments)?;
    let posed = arguments
        .posed
        .as_ref()
        .map(|file| scaled(file, arguments))
        .transpose()?;
    control.check()?;
    let notes = [(&arguments.hand, &hand), (&arguments.product, &product)].map(|(file, read)| {
        let say = |note: &String| format!("{}: {note}", file.display());
        read.notes.iter().map(say).collect::<Vec<String>>()
    });
    let product = mesh(product, &arguments.product)?;
    let product = Product::new(product).map_err(|error| named(&arguments.product, &error))?;
    let input = SkinInput {
        mesh: mesh(hand, &arguments.hand)?,
        regions: regions.regions.clone(),
        materials,
        model,
    };
    let mut skin = Skin::prepare_named(input, regions.names.clone(), control)?;
    let assumed = arguments.materials.is_none().then(|| model.preset_note());
    for note in notes.concat().into_iter().chain(assumed) {
        skin = skin.with_note(note);
    }
    if let Some(file) = &arguments.effects {
        skin = skin.with_effects(effects::read(file, &regions)?, control)?;
    }
    let mut workspace = Workspace::default();
    let mut pressing = workspace.on(&skin);
    let posed = posed.as_ref().map(|posed| posed.positions.as_slice());
    let direction = arguments.direction.map(Vec3::from);
    if let Some(file) = &arguments.protocol {
        let run = Run {
            product: &product,
            posed,
            protocol: &protocol::read(file, direction)?,
            keep: Keep::Totals,
        };
        let course = pressing.run(&run, control)?;
        let table = protocol::table(&course);
        return Ok((course.last, regions, Some(table)));
    }
    let press = Press {
        product: &product,
        posed,
        force: arguments
            .force
            .map(|newton| ForceTarget { newton, direction }),
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::kept_if(arguments.keep_unsolved),
    };
    Ok((pressing.press(&press, control)?, regions, None))
}

fn scaled(file: &Path, arguments: &PressArguments) -> Result<MeshFile, Fault> {
    let mut mesh = meshes::read(file)?;
    let millimeters = arguments.unit.millimeters();
    mesh.positions
        .iter_mut()
        .for_each(|position| *position *= millimeters);
    Ok(mesh)
}

fn mesh(read: MeshFile, file: &Path) -> Result<Mesh, Fault> {
    Mesh::new(read.positions, read.triangles).map_err(|error| named(file, &error))
}

fn named(file: &Path, error: &thenar_surface::MeshError) -> Fault {
    Fault::Input(format!("{}: {error}", file.display()))
}

/// What was asked, for the summary.
fn said(arguments: &PressArguments) -> Value {
    let name = |path: &Path| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    json!({
        "hand": name(&arguments.hand),
        "product": name(&arguments.product),
        "posed": arguments.posed.as_deref().map(name),
        "regions": arguments.regions.as_deref().map(name),
        "materials": arguments.materials.as_deref().map(name),
        "model": match arguments.model { ModelName::Layer => "layer", ModelName::Paper => "paper" },
        "force_n": arguments.force,
        "direction": arguments.direction,
        "protocol": arguments.protocol.as_deref().map(name),
        "effects": arguments.effects.as_deref().map(name),
    })
}

fn report(contact: &Contact, regions: &RegionTable, out: &Path) -> String {
    let mut text = format!(
        "{:>20} {:>10} {:>10} {:>10} {:>8}\n",
        "region", "force N", "area mm2", "peak kPa", "dmax mm"
    );
    for row in contact.regions.iter().filter(|row| row.force > 0.0) {
        let (name, peak) = (regions.name(row.index), 1e3 * row.peak);
        text += &format!(
            "{name:>20} {:>10.3} {:>10.1} {peak:>10.2} {:>8.2}\n",
            row.force, row.area, row.max_penetration
        );
    }
    let force: f64 = contact.nodal_force.iter().sum();
    let peak = 1e3 * contact.peak_pressure;
    text += &format!(
        "{:>20} {force:>10.3} {:>10.1} {peak:>10.2}\n",
        "all", contact.contact_area
    );
    text += &format!("{:>20} {:>10}\n", "grade", contact.grade().name());
    for warning in &contact.warnings {
        text += &format!("note: {warning}\n");
    }
    text + &format!("written to {}\n", out.display())
}
