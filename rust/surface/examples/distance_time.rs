//! Times signed distances of 9,693 points on a product of about 20,200 triangles; the peer comparison runs it beside other libraries.
//!
//! `distance_time [POINTS.bin TRIANGLES.bin]`: raw little-endian f64, n x 3 and m x 9, mm; without arguments a hand-sized ball on a
//! cylinder. Prints the least CPU time of one thread (Linux; elsewhere the wall time), ms, as `name=value` lines.

use std::f64::consts::TAU;
use std::time::Instant;

use thenar_surface::{Adjacency, GapLimits, Mesh, Product, SkinDistance, Vec3, vertex_normals};

fn main() {
    // The pool is this thread alone, so that its CPU time is all there is.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build();
    match pool {
        Ok(pool) => pool.install(run),
        Err(_) => run(),
    }
}

fn run() {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let skin = ball(9693, 45.0, Vec3::new(55.0, 0.0, 50.0));
    let (points, product) = match files.as_slice() {
        [points, triangles] => (read(points), soup(&read(triangles))),
        _ => (skin.positions().to_vec(), handle()),
    };
    let normals = (files.is_empty()).then(|| vertex_normals(&skin));
    println!(
        "points={} triangles={}",
        points.len(),
        product.triangles().len()
    );
    best("prepare_ms", 4, || {
        Product::new(product.clone())
            .map(|p| p.warnings().len())
            .unwrap_or(0)
    });
    let Ok(product) = Product::new(product) else {
        return;
    };
    let full = GapLimits {
        cut_off_mm: f64::INFINITY,
        max_depth_mm: 15.0,
    };
    let cut = GapLimits {
        cut_off_mm: 8.0,
        ..full
    };
    best("full_ms", 10, || count(&product.gaps(&points, None, full)));
    best("cut_ms", 40, || count(&product.gaps(&points, None, cut)));
    let last: Vec<u32> = product
        .gaps(&points, None, cut)
        .iter()
        .map(|g| g.map_or(u32::MAX, |g| g.triangle))
        .collect();
    best("cut_hint_ms", 40, || {
        count(&product.gaps_along(&points, None, cut, &last))
    });
    if let Some(normals) = normals {
        best("cut_skin_ms", 40, || {
            count(&product.gaps_along(&points, Some(&normals), cut, &last))
        });
        best("skin_distance_ms", 5, || {
            SkinDistance::new(&skin, &Adjacency::new(&skin), 60.0).len()
        });
    }
}

fn count(gaps: &[Option<thenar_surface::Gap>]) -> usize {
    gaps.iter().flatten().count()
}

/// Least mean time of five rounds, each long enough for the kernel's account, which moves in ticks.
fn best(name: &str, times: usize, mut work: impl FnMut() -> usize) {
    let wall = Instant::now();
    let now = || cpu_seconds().unwrap_or_else(|| wall.elapsed().as_secs_f64());
    let mut least = f64::INFINITY;
    let mut found = 0;
    for _ in 0..5 {
        let start = now();
        for _ in 0..times {
            found = work();
        }
        least = least.min((now() - start) / times as f64);
    }
    println!("{name}={:.3} found={found}", least * 1e3);
}

/// Time this thread has run, by the kernel's account in nanoseconds.
fn cpu_seconds() -> Option<f64> {
    let account = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(account.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
}

fn read(path: &str) -> Vec<Vec3> {
    let bytes = std::fs::read(path).unwrap_or_default();
    let number = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap_or_default());
    let values: Vec<f64> = bytes.chunks_exact(8).map(number).collect();
    values
        .chunks_exact(3)
        .map(|c| Vec3::new(c[0], c[1], c[2]))
        .collect()
}

fn soup(corners: &[Vec3]) -> Mesh {
    let triangles = (0..corners.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    Mesh::new(corners.to_vec(), triangles).unwrap_or_else(|e| panic!("{e}"))
}

/// A ball of about `count` points by the golden angle would have no triangles; latitude and longitude do.
fn ball(count: usize, radius: f64, center: Vec3) -> Mesh {
    let rings = ((count as f64 / 2.0).sqrt() as u32).max(3);
    let sectors = count as u32 / (rings - 1);
    let place = |latitude: f64, longitude: f64| {
        center
            + radius
                * Vec3::new(
                    latitude.sin() * longitude.cos(),
                    latitude.sin() * longitude.sin(),
                    -latitude.cos(),
                )
    };
    grid(rings, sectors, |i, k| place(TAU / 2.0 * i, TAU * k))
}

/// A handle of 24 mm radius with a wave, 100 long, about 20,200 triangles.
fn handle() -> Mesh {
    grid(101, 101, |i, k| {
        let r = 24.0 * (1.0 - (2.0 * i - 1.0).powi(8)).max(0.0).sqrt()
            + 1.5 * (TAU * 5.0 * k).sin() * (TAU / 2.0 * i).sin();
        Vec3::new(r * (TAU * k).cos(), r * (TAU * k).sin(), 100.0 * i)
    })
}

/// A closed surface from two parameters in 0..1, the second periodic, with a pole at each end of the first.
fn grid(rings: u32, sectors: u32, place: impl Fn(f64, f64) -> Vec3) -> Mesh {
    let mut p = vec![place(0.0, 0.0)];
    for i in 1..rings {
        p.extend((0..sectors).map(|k| {
            place(
                f64::from(i) / f64::from(rings),
                f64::from(k) / f64::from(sectors),
            )
        }));
    }
    p.push(place(1.0, 0.0));
    let top = p.len() as u32 - 1;
    let at = |i: u32, k: u32| 1 + (i - 1) * sectors + k % sectors;
    let mut t = Vec::new();
    for k in 0..sectors {
        t.extend([
            [0, at(1, k + 1), at(1, k)],
            [top, at(rings - 1, k), at(rings - 1, k + 1)],
        ]);
        for i in 1..rings - 1 {
            let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
            t.extend([[a, b, d], [a, d, c]]);
        }
    }
    Mesh::new(p, t).unwrap_or_else(|e| panic!("{e}"))
}
