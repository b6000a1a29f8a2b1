//! Files cut anywhere, of another kind, of noise or too large: one clear sentence, in bounded time and memory.

use crate::exports;

use exports::*;
use std::path::Path;
use thenar_recordings::{LARGEST_TEXT, read, read_bytes};

#[test]
fn every_prefix_of_every_text_is_read_or_refused_in_one_sentence() {
    for (name, bytes) in texts() {
        for end in 0..bytes.len() {
            if let Err(message) = export(&bytes[..end]) {
                let is_sentence = message.starts_with("a.txt, line ")
                    && message.contains("; ")
                    && !message.contains('\n');
                assert!(
                    is_sentence || message.starts_with("a.txt: "),
                    "{name} cut at {end}: {message:?}"
                );
            }
        }
    }
}

#[test]
fn archives_that_are_damaged_or_of_another_kind_are_refused() {
    for bytes in [jpk_archive(), workbook()] {
        for end in 4..bytes.len() {
            let message = export(&bytes[..end]).unwrap_err();
            assert!(
                message.starts_with("a.txt: ") && message.contains("; "),
                "{message}"
            );
        }
    }
    let message = export(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1").unwrap_err();
    assert!(
        message.starts_with("a.txt: the workbook cannot be opened (")
            && message.ends_with("; save the workbook again as .xlsx, or the sheet as CSV"),
        "{message}"
    );
    let message = export(&zipped(&[("readme.txt", b"nothing")])).unwrap_err();
    assert_eq!(
        message,
        "a.txt: this is a zip archive, and neither a workbook nor a JPK force curve; unpack it, and name the recording in it"
    );
}

#[test]
fn what_is_no_recording_is_refused_at_once() {
    assert_eq!(
        export(b"").unwrap_err(),
        "a.txt, line 1: the file is empty; export the recording again"
    );
    let unknown = "a.txt, line 1: this is no recording format that is known";
    assert!(export(b"\n\n\n").unwrap_err().starts_with(unknown));
    assert!(export(b"hello\nworld\n").unwrap_err().starts_with(unknown));
    assert_eq!(
        export(b"0.1,2.5,3\n0.2,2.6,4\n0.3,2.7,5\n").unwrap_err(),
        "a.txt, line 1: its rows hold numbers, and no line names the columns and their units; \
         put a line of names before them, such as time_s,travel_mm,force_n"
    );
    assert!(
        export(b"\xFF\xFEt\0i\0")
            .unwrap_err()
            .contains("saved as UTF-16; save it as UTF-8")
    );
    let message = read(Path::new("/nowhere/a.csv")).unwrap_err().to_string();
    assert!(
        message.starts_with("/nowhere/a.csv: cannot be read (No such file"),
        "{message}"
    );
    let message = read(Path::new(env!("CARGO_MANIFEST_DIR")))
        .unwrap_err()
        .to_string();
    assert!(
        message.ends_with("it is a folder; name a measurement file in it"),
        "{message}"
    );
}

#[test]
fn a_gigabyte_of_noise_is_refused_without_reading_it() {
    let folder = std::env::temp_dir().join(format!("thenar_noise_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let noise: Vec<u8> = (0..1_u64 << 17)
        .map(|k| (k.wrapping_mul(6_364_136_223_846_793_005) >> 33) as u8)
        .collect();
    for (name, head) in [
        ("noise", &b""[..]),
        (
            "movie",
            b"DATA_TYPE MOVIE\nROWS 4\nCOLS 4\nUNITS raw\nASCII_DATA @@\n\nFrame 1\n",
        ),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, [head, &noise].concat()).unwrap();
        // The rest is a hole in the file, which reads as zeros.
        std::fs::OpenOptions::new()
            .write(true)
            .open(&path)
            .unwrap()
            .set_len(1 << 30)
            .unwrap();
        let start = std::time::Instant::now();
        let message = read(&path).unwrap_err().to_string();
        assert!(
            message.contains(", line ") && start.elapsed().as_secs_f64() < 2.0,
            "{message}"
        );
    }
    let path = folder.join("huge");
    std::fs::write(&path, TEKSCAN).unwrap();
    std::fs::OpenOptions::new()
        .write(true)
        .open(&path)
        .unwrap()
        .set_len(LARGEST_TEXT + 1)
        .unwrap();
    let message = read(&path).unwrap_err().to_string();
    assert!(
        message.ends_with("are read; export a shorter part of the recording"),
        "{message}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn an_endless_line_is_refused() {
    let mut text = b"DATA_TYPE MOVIE\nCOMMENTS:\n".to_vec();
    text.resize(3 << 20, b'x');
    let message = read_bytes(&text, Path::new("a.txt"))
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "a.txt, line 3: the line is longer than 1048576 bytes; this is not an export as text; export it again"
    );
}

#[test]
fn a_header_that_claims_a_huge_mat_is_refused() {
    let text = TEKSCAN
        .replace("ROWS 2", "ROWS 4096")
        .replace("COLS 3", "COLS 4096");
    let message = export(text.as_bytes()).unwrap_err();
    assert!(
        message.starts_with("a.txt, line 20: 4096 x 4096 cells, expected 1048576 at most; "),
        "{message}"
    );
}
