//! Files that would take all memory, all time, or never end.

use crate::jpk::{archive, curve};
use crate::makers::refused;
use std::path::Path;

#[test]
fn archives_that_grow_beyond_all_bounds_are_refused_in_time() {
    let started = std::time::Instant::now();
    // 60 channels of 16 MiB of zeros: 960 MiB in a file of 1 MB.
    let zeros = vec![0_u8; 16 << 20];
    let curves = (0..60).map(|k| {
        let mut curve = curve(&format!("index/{k}/"), None);
        curve[1].1.clone_from(&zeros);
        curve
    });
    let bytes = crate::sheets::zipped(&archive("N", &curves.collect::<Vec<_>>(), "x"));
    let message = refused(&bytes);
    assert!(message.starts_with("a: "), "{message}");
    // A list of 15 million empty texts: 64 MB, 100 kB packed.
    let mut texts = String::from("<sst>");
    texts.extend(std::iter::repeat_n("<si/>", 15_000_000));
    let bytes = crate::sheets::zipped(&[
        ("xl/workbook.xml".to_string(), b"<workbook/>".to_vec()),
        ("xl/sharedStrings.xml".to_string(), texts.into_bytes()),
    ]);
    assert!(
        refused(&bytes).starts_with(
            "a: all of the workbook but its sheets unpacks to 75000016 bytes, more than"
        ),
        "{}",
        refused(&bytes)
    );
    assert!(started.elapsed().as_secs() < 60);
}

/// Found by damaged files at random: the rows up to the claimed one were written as 4 GiB of line ends.
#[test]
fn a_cell_that_claims_a_row_beyond_all_sheets_is_refused_at_once() {
    let sheets = [(
        "Probe 1",
        crate::tables::under(&[&["time_s", "force_n", "travel_mm", "x_mm"]]),
    )];
    let mut members = Vec::new();
    let mut archive =
        zip::ZipArchive::new(std::io::Cursor::new(crate::sheets::workbook(&sheets))).unwrap();
    for k in 0..archive.len() {
        let mut member = archive.by_index(k).unwrap();
        let mut text = String::new();
        std::io::Read::read_to_string(&mut member, &mut text).unwrap();
        let text = text.replace("\"B4\"", "\"B4294967295\"");
        members.push((member.name().unwrap().to_string(), text));
    }
    let started = std::time::Instant::now();
    let message = refused(&crate::sheets::zipped(&members));
    assert!(
        message.contains("sheet 'Probe 1': a cell claims row 4294967295, and a sheet has 1048576"),
        "{message}"
    );
    assert!(started.elapsed().as_secs_f64() < 1.0);
}

#[cfg(unix)]
#[test]
fn pipes_devices_and_links_out_of_the_folder_are_refused_at_once() {
    let folder = std::env::temp_dir().join(format!("thenar_pipes_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let pipe = folder.join("study.toml");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let ending =
        "it is a pipe or a device, not a file; save what it gives to a file, and name that";
    for message in [
        thenar_recordings::read(&pipe).unwrap_err().to_string(),
        thenar_recordings::read(Path::new("/dev/zero"))
            .unwrap_err()
            .to_string(),
        thenar_recordings::study::Study::load(&folder)
            .unwrap_err()
            .to_string(),
    ] {
        assert!(message.ends_with(ending), "{message}");
    }
    std::fs::remove_file(&pipe).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &pipe).unwrap();
    let message = thenar_recordings::study::Study::load(&folder)
        .unwrap_err()
        .to_string();
    assert!(
        message.ends_with(
            "it is a link that leaves the study's folder; copy the file into the folder"
        ),
        "{message}"
    );
    let mesh = folder.join("skin.obj");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&mesh)
            .status()
            .unwrap()
            .success()
    );
    assert!(
        thenar_recordings::meshes::read(&mesh)
            .unwrap_err()
            .to_string()
            .ends_with(ending)
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

/// A PNG that ends where its pixels begin: width and height, 8 bits of gray.
fn png(width: u32, height: u32) -> Vec<u8> {
    let mut part = b"IHDR".to_vec();
    part.extend(width.to_be_bytes());
    part.extend(height.to_be_bytes());
    part.extend([8, 0, 0, 0, 0]);
    let mut sum = u32::MAX;
    for byte in &part {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = if sum & 1 == 1 {
                sum >> 1 ^ 0xEDB8_8320
            } else {
                sum >> 1
            };
        }
    }
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(part);
    bytes.extend((!sum).to_be_bytes());
    bytes.extend(b"\0\x10\0\0IDAT\x78\x01");
    bytes
}

#[test]
fn image_of_more_pixels_than_are_read_is_refused_by_its_head() {
    use thenar_recordings::handprint::{Handprint, PrintOptions, Scale};
    let options = PrintOptions {
        scale: Scale::MmPerPixel(0.1),
        cell_mm: 1.0,
        threshold: None,
        ink: None,
        paper_px: None,
        is_mirrored: false,
    };
    let file = std::env::temp_dir().join(format!("thenar_pixels_{}.png", std::process::id()));
    for (width, height, is_too_large) in
        [(9_000, 9_000, true), (40_000, 10, true), (300, 200, false)]
    {
        std::fs::write(&file, png(width, height)).unwrap();
        let message = Handprint::read(&file, &options).unwrap_err().to_string();
        assert_eq!(
            message.contains("more than 80000000 of them"),
            is_too_large,
            "{message}"
        );
    }
    std::fs::remove_file(&file).unwrap();
}
