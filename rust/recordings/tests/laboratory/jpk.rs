//! JPK archives: packed by other programs, maps, other sensors, no calibration.

use crate::makers::{near, read};
use std::path::Path;
use thenar_recordings::{Format, ReadOptions, read_bytes_with};

/// Samples of a curve.
const POINTS: i32 = 200;

/// The properties that the curves of an archive share; `unit` of the deflection is N or V, `sensor` an additional height.
fn shared(unit: &str, sensor: &str) -> String {
    let slot = |channel: u8, name: &str, base: &str, multiplier: &str, unit: &str| {
        let set = format!("lcd-info.{channel}.conversion-set.conversion.{name}");
        format!(
            "{set}.base-calibration-slot={base}\n{set}.scaling.type=linear\n{set}.scaling.multiplier={multiplier}\n{set}.scaling.offset=0\n\
             {set}.scaling.unit.unit={unit}\n"
        )
    };
    let head = |channel: u8, name: &str, multiplier: &str, last: &str| {
        let info = format!("lcd-info.{channel}");
        format!(
            "{info}.channel.name={name}\n{info}.encoder.type=signedinteger-limited\n{info}.encoder.scaling.type=linear\n\
             {info}.encoder.scaling.multiplier={multiplier}\n{info}.encoder.scaling.offset=0\n{info}.conversion-set.conversions.base=volts\n\
             {info}.conversion-set.conversions.default={last}\n{info}.conversion-set.conversion.volts.scaling.unit.unit=V\n"
        )
    };
    let last = if unit == "N" { "force" } else { "volts" };
    [
        head(0, "vDeflection", "1e-4", last),
        slot(0, "distance", "volts", "1e-7", "m"),
        slot(0, "force", "distance", "0.05", "N"),
        head(1, "height", "1e-9", "nominal"),
        slot(1, "nominal", "volts", "1", "m"),
        head(2, sensor, "1e-9", "nominal"),
        slot(2, "nominal", "volts", "1", "m"),
    ]
    .concat()
}

fn samples(of: impl Fn(i32) -> i32) -> Vec<u8> {
    (0..POINTS).flat_map(|k| of(k).to_be_bytes()).collect()
}

/// One curve: 0 to 4.95 nN over a piezo from 20 to 10.05 um; a sensor from 30 to 15.075 um.
pub fn curve(root: &str, sensor: Option<&str>) -> Vec<(String, Vec<u8>)> {
    let folder = format!("{root}segments/0/");
    let mut head = format!(
        "force-segment-header.num-points={POINTS}\nforce-segment-header.duration=1.0\n\
         force-segment-header.settings.segment-settings.style=extend\n"
    );
    let mut parts = vec![
        ("vDeflection", samples(|k| (k - 100).max(0) * 100)),
        ("height", samples(|k| 20_000 - 50 * k)),
    ];
    parts.extend(sensor.map(|name| (name, samples(|k| 30_000 - 75 * k))));
    let mut members = Vec::new();
    for (k, (name, bytes)) in parts.into_iter().enumerate() {
        head += &format!(
            "channel.{name}.data.file.name=channels/{name}.dat\nchannel.{name}.lcd-info.*={k}\n"
        );
        members.push((format!("{folder}channels/{name}.dat"), bytes));
    }
    members.insert(
        0,
        (
            format!("{folder}segment-header.properties"),
            head.into_bytes(),
        ),
    );
    members
}

pub fn archive(
    unit: &str,
    curves: &[Vec<(String, Vec<u8>)>],
    sensor: &str,
) -> Vec<(String, Vec<u8>)> {
    let mut members = vec![
        (
            "header.properties".to_string(),
            b"file-format-version=0.12\n".to_vec(),
        ),
        (
            "shared-data/header.properties".to_string(),
            shared(unit, sensor).into_bytes(),
        ),
    ];
    members.extend(curves.iter().flatten().cloned());
    members
}

#[test]
fn a_jpk_archive_may_be_packed_in_any_order_and_by_any_program() {
    let members = archive("N", &[curve("", None)], "x");
    let whole = read(&crate::sheets::zipped(&members));
    let force = whole.curves[0].channel("force_n").unwrap();
    assert_eq!((whole.format, force.len()), (Format::JpkArchive, 200));
    near(force[199], 4.95e-9);
    let mut turned = members.clone();
    turned.reverse();
    turned.insert(
        0,
        (
            "data-image.jpk-thumbnail".into(),
            (0..200_000_u32).map(|k| (k * 37 % 251) as u8).collect(),
        ),
    );
    assert_eq!(read(&crate::sheets::zipped(&turned)), whole);
    // Windows' separators, and a folder around everything.
    let backward = members.iter().map(|(name, bytes)| {
        (
            format!("my curve\\{}", name.replace('/', "\\")),
            bytes.clone(),
        )
    });
    assert_eq!(
        read(&crate::sheets::zipped(&backward.collect::<Vec<_>>())),
        whole
    );
}

#[test]
fn a_map_is_read_curve_by_curve() {
    let curves = ["index/0/", "index/1/", "index/10/", "index/2/"].map(|root| curve(root, None));
    let mut members = archive("N", &curves, "x");
    let bytes = crate::sheets::zipped(&members);
    let file = read(&bytes);
    let names: Vec<&str> = file
        .curves
        .iter()
        .map(|curve| curve.name.as_str())
        .collect();
    assert_eq!(names, ["curve 0", "curve 1", "curve 2", "curve 10"]);
    near(file.curves[3].channel("force_n").unwrap()[199], 4.95e-9);
    let run = |name: &str| {
        let options = ReadOptions {
            run: Some(name.into()),
            ..ReadOptions::default()
        };
        read_bytes_with(&bytes, Path::new("a"), &options)
    };
    assert_eq!(run("curve 10").unwrap().curves.len(), 1);
    let message = run("curve 3").unwrap_err().to_string();
    assert_eq!(
        message,
        "a: none of its 4 curves is called 'curve 3'; they are called curve 0 to curve 10"
    );
    // One curve of the map was never finished.
    members.retain(|(name, _)| name != "index/1/segments/0/channels/vDeflection.dat");
    let file = read(&crate::sheets::zipped(&members));
    assert_eq!(file.curves.len(), 3);
    assert!(
        file.notes[0].starts_with("curve 1 is left out: 'index/1/segments/0/chann"),
        "{:?}",
        file.notes
    );
}

#[test]
fn a_deflection_in_volts_is_no_force() {
    let curve = &read(&crate::sheets::zipped(&archive(
        "V",
        &[curve("", None)],
        "x",
    )))
    .curves[0];
    assert!(curve.channel("force_n").is_none() && curve.channel("travel_mm").is_none());
    assert_eq!(
        curve.unknown[0],
        "the force: the deflection is recorded in V, without the stiffness of its cantilever"
    );
}

#[test]
fn a_height_that_a_sensor_measured_comes_before_the_piezos() {
    for sensor in [
        "measuredHeight",
        "strainGaugeHeight",
        "capacitiveSensorHeight",
    ] {
        let curve = &read(&crate::sheets::zipped(&archive(
            "N",
            &[curve("", Some(sensor))],
            sensor,
        )))
        .curves[0];
        let travel = curve.channel("travel_mm").unwrap();
        // 14.925 um of height less 4.95 nN at 0.05 N/m.
        near(travel[199] - travel[0], 14.925e-3 - 0.099e-3);
        near(curve.channel("piezo_height_mm").unwrap()[199], 10.05e-3);
    }
}
