//! Writes a hand as OBJ and prints its figures: `dump OUT.obj [spacing_mm [percentile [male|female [mcp,pip,dip,thumb]]]]`.

use std::fmt::Write;
use thenar_hand::{Hand, HandShape, JointTurn, Sex};
use thenar_surface::Vec3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let out = arguments
        .get(1)
        .ok_or("usage: dump OUT.obj [spacing_mm [percentile [male|female [mcp,pip,dip,thumb]]]]")?;
    let mut shape = HandShape::default();
    if let Some(spacing) = arguments.get(2) {
        shape.spacing_mm = spacing.parse()?;
    }
    if let Some(percentile) = arguments.get(3) {
        shape.percentile = percentile.parse()?;
    }
    if arguments.get(4).is_some_and(|sex| sex == "female") {
        shape.sex = Sex::Female;
    }
    let start = std::time::Instant::now();
    let hand = shape.build()?;
    println!(
        "{} vertices, {} triangles, {:.2} s",
        hand.mesh.positions().len(),
        hand.mesh.triangles().len(),
        start.elapsed().as_secs_f64()
    );
    print_quality(&hand, shape.spacing_mm);
    let angles: Vec<f64> = match arguments.get(5) {
        Some(list) => list.split(',').map(str::parse).collect::<Result<_, _>>()?,
        None => Vec::new(),
    };
    std::fs::write(out, obj(&hand, &closed(&hand, &angles))?)?;
    std::fs::write(
        format!("{out}.regions"),
        hand.regions
            .iter()
            .map(|r| format!("{r}\n"))
            .collect::<String>(),
    )?;
    Ok(())
}

/// The skin with the fingers' joints at the given anatomical flexions (degrees: MCP, PIP, DIP), and all of the thumb's turned by a fourth.
fn closed(hand: &Hand, angles: &[f64]) -> Vec<Vec3> {
    let mut turns = vec![JointTurn::default(); hand.bones.len()];
    for (bone, turn) in hand.bones.iter().zip(&mut turns) {
        let parts = ["_proximal", "_middle", "_distal"];
        let part = parts.iter().position(|part| bone.name.ends_with(part));
        if bone.name.starts_with("thumb") {
            turn.flexion = angles.get(3).map_or(0.0, |angle| angle.to_radians());
        } else if let Some(angle) = part.and_then(|part| angles.get(part)) {
            turn.flexion = angle.to_radians() - bone.rest_flexion;
        }
    }
    hand.posed(&turns)
}

fn obj(hand: &Hand, positions: &[Vec3]) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for p in positions {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for t in hand.mesh.triangles() {
        writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1)?;
    }
    Ok(text)
}

fn print_quality(hand: &Hand, spacing: f64) {
    let p = hand.mesh.positions();
    let audit = hand.mesh.audit();
    println!(
        "closed {}, parts {}, volume {:.1} cm3",
        audit.is_closed(),
        audit.parts,
        audit.signed_volume_mm3 / 1000.0
    );
    let (mut angles, mut edges) = (Vec::new(), Vec::new());
    for t in hand.mesh.triangles() {
        for k in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|i| t[(k + i) % 3] as usize);
            angles.push((p[b] - p[a]).angle(&(p[c] - p[a])).to_degrees());
            if a < b && hand.regions[a] >= 0 && hand.regions[b] >= 0 {
                edges.push((p[b] - p[a]).norm() / spacing);
            }
        }
    }
    angles.sort_by(f64::total_cmp);
    edges.sort_by(f64::total_cmp);
    let good = edges.iter().filter(|e| (0.6..=1.6).contains(*e)).count();
    println!(
        "smallest angles {:?}, below 30: {}",
        &angles[..5],
        angles.iter().filter(|a| **a < 30.0).count()
    );
    println!(
        "palmar edges: median {:.3} of spacing, {:.2} % within 0.6 to 1.6",
        edges[edges.len() / 2],
        100.0 * good as f64 / edges.len() as f64
    );
    for (k, name) in hand.region_names.iter().enumerate() {
        print!(
            "{name} {}  ",
            hand.regions.iter().filter(|r| **r == k as i32).count()
        );
    }
    println!();
}
