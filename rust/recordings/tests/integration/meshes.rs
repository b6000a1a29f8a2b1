//! Mesh files: what the formats allow is read, what they forbid is refused by name, place and remedy.

use crate::samples;

use std::path::Path;
use thenar_recordings::meshes::read;

use samples::*;

#[test]
fn obj_quads_colours_groups_and_negative_indices_give_the_same_square() {
    let plain = "v 0 0 0\nv 2 0 0\nv 2 1 .5\nv 0 1 .5\nf 1 2 3 4\n";
    let rich = "# made by hand\no palm\nv 0 0 0 1 0.5 0.2\r\nv 2 0 0 1 1 1\nv 2 1 5e-1\nvn 0 0 1\nvt 0 0\ng a b\nusemtl skin\n\
                v 0 1 \\\n 0.5\nf -4/1/1 -3//1 -2/1 4 # last\n";
    assert_eq!(obj(plain), Ok(square()));
    assert_eq!(obj(rich), Ok(square()));
}

#[test]
fn obj_faces_may_come_before_their_vertices() {
    assert_eq!(
        obj("f 1 2 3 4\nv 0 0 0\nv 2 0 0\nv 2 1 .5\nv 0 1 .5"),
        Ok(square())
    );
}

#[test]
fn obj_faults_name_file_line_and_remedy() {
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let cases = [
        (
            "v 0 0 0\nv 1 nan 0\n",
            "a.obj, line 2: 'nan' is not a finite number; give",
        ),
        (
            "v 1 1e999 0\n",
            "a.obj, line 1: '1e999' is not a finite number",
        ),
        (
            "v 1 2\n",
            "a.obj, line 1: a vertex with 2 coordinates, expected 3; export",
        ),
        ("v 1 x 3\n", "a.obj, line 1: 'x' is not a number"),
        (
            &format!("{three}f 1 2 9\n"),
            "a.obj, line 4: a face uses vertex 9, the file has 3; export",
        ),
        (
            &format!("{three}f 1 2 -4\n"),
            "a.obj, line 4: a face uses vertex -4, 3 were read before it",
        ),
        (
            &format!("{three}f 0 1 2\n"),
            "a.obj, line 4: a face uses vertex 0, OBJ counts from 1",
        ),
        (
            &format!("{three}f 1 2\n"),
            "a.obj, line 4: a face with 2 corners, expected 3 or more; delete",
        ),
        (
            &format!("{three}f 1 2 b/1\n"),
            "a.obj, line 4: 'b/1' is not a vertex number",
        ),
        (three, "a.obj: it holds no faces; export the surface"),
        ("", "a.obj: it holds no vertices"),
    ];
    for (text, expected) in cases {
        let message = obj(text).unwrap_err();
        assert!(message.starts_with(expected), "{text:?} gave {message:?}");
    }
}

#[test]
fn ply_of_every_encoding_gives_the_same_square() {
    assert_eq!(ply(ASCII_PLY.as_bytes()), Ok(square()));
    assert_eq!(ply(&binary_ply(false)), Ok(square()));
    assert_eq!(ply(&binary_ply(true)), Ok(square()));
}

#[test]
fn ply_faults_name_file_place_and_remedy() {
    let changed = |from: &str, to: &str| ply(ASCII_PLY.replace(from, to).as_bytes()).unwrap_err();
    let cases = [
        (
            changed("ply\r", "plx\r"),
            "a.ply, line 1: the file does not begin with 'ply'",
        ),
        (
            changed("ascii", "utf8"),
            "a.ply, line 2: 'utf8' is not a PLY format",
        ),
        (
            changed("vertex 4", "vertex four"),
            "a.ply, line 3: 'four' is not a count of elements",
        ),
        (
            changed("float y", "float q"),
            "a.ply, line 3: a vertex needs x, y and z, each once",
        ),
        (
            changed("float y", "half y"),
            "a.ply, line 5: 'half' is not a PLY type",
        ),
        (
            changed("vertex 4", "vertex 4000000000"),
            "a.ply, line 3: 4000000000 elements 'vertex' do not fit",
        ),
        (
            changed("2 1 0.5", "2 inf 0.5"),
            "a.ply, line 12: 'inf' is not a finite number",
        ),
        (
            changed("4 0 1 2 3", "4 0 1 2 -3"),
            "a.ply, line 14: -3 is not a count or vertex number",
        ),
        (
            changed("4 0 1 2 3", "4 0 1 2 7"),
            "a.ply, line 7: triangle 1 is [0, 2, 7], the file has 4 vertices",
        ),
        (
            changed("4 0 1 2 3", "2 0 1"),
            "a.ply, line 14: a face with 2 corners",
        ),
        (
            changed("4 0 1 2 3", "4 0 1"),
            "a.ply, line 15: the file ends before its last value",
        ),
        (
            changed("end_header", "comment"),
            "a.ply, line 10: '0' is not a word of a PLY header",
        ),
        (changed("face 1", "face 0"), "a.ply: it holds no faces"),
        (
            changed("element face", "element tristrips"),
            "a.ply, line 7: triangle strips are not read; export faces",
        ),
    ];
    for (message, expected) in cases {
        assert!(
            message.starts_with(expected),
            "expected {expected:?}, got {message:?}"
        );
    }
    let whole = binary_ply(false);
    let cut = ply(&whole[..whole.len() - 6]).unwrap_err();
    assert!(
        cut.contains(", byte ") && cut.contains("cut short"),
        "{cut}"
    );
    let mut not_a_number = whole.clone();
    let start = not_a_number.len() - 4 - 17 - 7 - 4 * 17;
    not_a_number[start + 1..start + 9].copy_from_slice(&f64::NAN.to_le_bytes());
    let message = ply(&not_a_number).unwrap_err();
    assert!(
        message.contains(&format!("byte {}: vertex 0 is not finite", start + 1)),
        "{message}"
    );
}

#[test]
fn an_element_without_properties_and_a_huge_count_does_not_hang() {
    let text = ASCII_PLY.replace(
        "element face",
        "element nothing 18446744073709551615\r\nelement face",
    );
    assert_eq!(ply(text.as_bytes()), Ok(square()));
}

#[test]
fn stl_of_both_kinds_welds_equal_corners() {
    assert_eq!(stl(&binary_stl(&square())), Ok(square()));
    assert_eq!(stl(ascii_stl(&square()).as_bytes()), Ok(square()));
    let minus_zero = ascii_stl(&square()).replacen("vertex 0e0 0 0", "vertex -0.0 0 -0", 1);
    assert_eq!(stl(minus_zero.as_bytes()).unwrap().positions.len(), 4);
}

#[test]
fn stl_faults_name_file_place_and_remedy() {
    let text = ascii_stl(&square());
    let changed = |from: &str, to: &str| stl(text.replacen(from, to, 1).as_bytes()).unwrap_err();
    let cases = [
        (
            changed("vertex 2e0 0 0", "vertex 2e0 nan 0"),
            "a.stl, line 5: 'nan' is not a finite number",
        ),
        (
            changed("vertex 2e0 0 0", "vertex 2e0 0"),
            "a.stl, line 5: a corner with 2 coordinates",
        ),
        (
            changed("      vertex 2e0 0 0\n", ""),
            "a.stl, line 7: a facet with 2 corners, expected 3",
        ),
        (
            changed("vertex", "vortex"),
            "a.stl, line 4: 'vortex' is not a word of an STL facet",
        ),
        (
            changed("  endfacet\n", ""),
            "a.stl, line 8: a facet begins before the last one ended",
        ),
        (
            stl(&text.as_bytes()[..text.len() - 40]).unwrap_err(),
            "a.stl, line 9: a facet that does not end; the file is cut",
        ),
        (
            stl(b"nothing").unwrap_err(),
            "a.stl, byte 7: 7 bytes are too few for an STL file",
        ),
        (
            stl(b"solid x\nendsolid x\n").unwrap_err(),
            "a.stl: it holds no vertices",
        ),
    ];
    for (message, expected) in cases {
        assert!(
            message.starts_with(expected),
            "expected {expected:?}, got {message:?}"
        );
    }
    let mut bytes = binary_stl(&square());
    bytes[84 + 12..84 + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(
        stl(&bytes)
            .unwrap_err()
            .starts_with("a.stl, byte 96: corner 1 of triangle 0 is not finite")
    );
    bytes[0] = b'x';
    bytes.pop();
    assert!(
        stl(&bytes)
            .unwrap_err()
            .starts_with("a.stl, byte 80: the header counts 2 triangles, the file has room for 1")
    );
}

/// Whole triangles are read whatever the header counts; a byte order mark does not make text binary.
#[test]
fn stl_with_a_wrong_count_or_bytes_behind_is_read_with_a_note() {
    let whole = binary_stl(&square());
    let counted = |count: u32| {
        let mut bytes = whole.clone();
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        stl(&bytes)
    };
    for count in [0, u32::MAX] {
        let mesh = counted(count).unwrap();
        assert_eq!(mesh.triangles, square().triangles);
        assert!(
            mesh.notes[0].contains(&format!("counts {count} triangles")),
            "{:?}",
            mesh.notes
        );
    }
    assert!(
        counted(3)
            .unwrap_err()
            .contains("counts 3 triangles, the file has room for 2")
    );
    let mesh = stl(&[&whole[..], b"colours"].concat()).unwrap();
    assert_eq!(mesh.triangles, square().triangles);
    assert!(
        mesh.notes[0].starts_with("7 bytes behind"),
        "{:?}",
        mesh.notes
    );
    let (head, facets) = whole.split_at(84);
    let fat = facets
        .chunks(50)
        .flat_map(|facet| [&facet[..48], &4u16.to_le_bytes()[..], b"rgba"].concat());
    let fat = stl(&[head, &fat.collect::<Vec<u8>>()].concat());
    assert_eq!(fat, Ok(square()));
    let marked = [b"\xef\xbb\xbf", ascii_stl(&square()).as_bytes()].concat();
    assert_eq!(stl(&marked), Ok(square()));
}

#[test]
fn files_that_are_not_there_or_of_another_kind_are_named() {
    let message = read(Path::new("/nowhere/hand.obj"))
        .unwrap_err()
        .to_string();
    assert!(
        message.starts_with("/nowhere/hand.obj: cannot be read (No such file"),
        "{message}"
    );
    let message = read(Path::new("hand.fbx")).unwrap_err().to_string();
    assert_eq!(
        message,
        "hand.fbx: not a mesh format that is known (.fbx); save it as .obj, .ply or .stl"
    );
    let message = read(Path::new("/tmp")).unwrap_err().to_string();
    assert_eq!(
        message,
        "/tmp: not a mesh format that is known (no ending); save it as .obj, .ply or .stl"
    );
}

/// A ring of corners about the middle whose radius jumps: concave at random, never crossing itself; the sheet is bent a little.
fn star(count: usize, seed: u64, bend: f64) -> Vec<[f64; 3]> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count)
        .map(|k| {
            let (s, c) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
            let r = 0.2 + 3.0 * random();
            [r * c, r * s, bend * random()]
        })
        .collect()
}

fn obj_of(corners: &[[f64; 3]]) -> String {
    let mut text = String::new();
    corners
        .iter()
        .for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
    text += "f";
    (1..=corners.len()).for_each(|k| text += &format!(" {k}"));
    text + "\n"
}

/// Twice the area of a ring of corners seen from above.
fn doubled_area(ring: &[[f64; 3]]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
        .sum()
}

#[test]
fn concave_faces_are_covered_once_and_keep_their_sides() {
    for seed in 0..400 {
        let count = 4 + (seed as usize % 14);
        let mut corners = star(count, seed + 1, if seed % 2 == 0 { 0.0 } else { 0.05 });
        if seed % 3 == 0 {
            // A corner on a straight side, which a neighbor shares.
            let [a, b] = [corners[0], corners[1]];
            corners.insert(1, [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0));
        }
        let mesh = obj(&obj_of(&corners)).unwrap();
        assert_eq!(mesh.triangles.len(), corners.len() - 2, "{corners:?}");
        // As many triangles as there must be, all turned as the face is, whose areas add up to its own: nothing is covered twice.
        let areas = mesh
            .triangles
            .iter()
            .map(|t| doubled_area(&t.map(|k| corners[k as usize])));
        let (sum, least) = areas.fold((0.0, f64::MAX), |(sum, least), a| (sum + a, a.min(least)));
        assert!(
            (sum - doubled_area(&corners)).abs() < 1e-9 && least > -1e-9,
            "{corners:?}: {sum}, {least}"
        );
        for k in 0..corners.len() as u32 {
            let side = [k, (k + 1) % corners.len() as u32];
            let holds = |t: &&[u32; 3]| (0..3).any(|s| [t[s], t[(s + 1) % 3]] == side);
            assert_eq!(
                mesh.triangles.iter().filter(holds).count(),
                1,
                "{side:?} of {corners:?}"
            );
        }
    }
}

#[test]
fn concave_faces_of_ply_are_those_of_obj() {
    let corners = star(9, 5, 0.0);
    let mut text = "ply\nformat ascii 1.0\nelement vertex 9\nproperty double x\nproperty double y\nproperty double z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        .to_owned();
    corners
        .iter()
        .for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    text += "9 0 1 2 3 4 5 6 7 8\n";
    assert_eq!(ply(text.as_bytes()), obj(&obj_of(&corners)));
}
