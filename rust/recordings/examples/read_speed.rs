//! Time to read a 309-frame, 28 x 28 export, and its ratio to splitting the same bytes into numbers with `csv` alone.
//!
//! `cargo run --release -p thenar-recordings --example read_speed`

use std::path::Path;
use std::time::Instant;
use thenar_recordings::read_bytes;

const FRAMES: usize = 309;
const SIDE: usize = 28;
const RUNS: usize = 21;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let export = export();
    let ours = median(|| {
        let file = read_bytes(export.as_bytes(), Path::new("export"))?;
        Ok(file.maps[0].values.len())
    })?;
    let reference = median(|| {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .from_reader(export.as_bytes());
        let mut record = csv::ByteRecord::new();
        let mut numbers = 0;
        while reader.read_byte_record(&mut record)? {
            let parsed = record
                .iter()
                .filter_map(|field| std::str::from_utf8(field).ok()?.parse::<f64>().ok());
            numbers += parsed.filter(|value| value.is_finite()).count();
        }
        Ok(numbers)
    })?;
    println!(
        "export of {FRAMES} frames of {SIDE} x {SIDE} cells, {} bytes",
        export.len()
    );
    println!(
        "read in {:.2} ms; csv alone {:.2} ms; ratio {:.2}",
        1e3 * ours,
        1e3 * reference,
        ours / reference
    );
    Ok(())
}

/// Median wall time of a run, s.
fn median(
    mut run: impl FnMut() -> Result<usize, Box<dyn std::error::Error>>,
) -> Result<f64, Box<dyn std::error::Error>> {
    let mut times = Vec::new();
    for _ in 0..RUNS {
        let start = Instant::now();
        std::hint::black_box(run()?);
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok(times[RUNS / 2])
}

fn export() -> String {
    let mut text = format!(
        "DATA_TYPE MOVIE\nROWS {SIDE}\nCOLS {SIDE}\nSECONDS_PER_FRAME 0.1\nUNITS raw\nASCII_DATA @@\n"
    );
    for frame in 1..=FRAMES {
        text += &format!("\nFrame {frame}\n");
        for row in 0..SIDE {
            let cells: Vec<String> = (0..SIDE)
                .map(|column| ((frame * 7 + row * 31 + column * 17) % 256).to_string())
                .collect();
            text += &(cells.join(",") + "\n");
        }
    }
    text + "@@\n"
}
