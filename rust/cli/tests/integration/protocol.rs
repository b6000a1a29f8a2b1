//! `thenar press --protocol --effects`: the table it writes, and what it refuses.

use crate::sheets;

use sheets::{column, refused, scene, stderr, thenar};

const PROTOCOL: &str = "time_s,depth_mm,force_n\n0,0,\n0.5,0.4,\n1,0.4,\n10,0.4,\n11,,0.05\n";
const EFFECTS: &str = "[[effect]]\nname = \"relaxation\"\namplitude = 0.5\ntime_3_s = 2\n\n\
                       [[effect]]\nname = \"stiffening_law\"\nlaw = \"power\"\nregions = [0]\n";

#[test]
fn a_protocol_writes_its_table_and_the_last_row_in_full() {
    let (folder, hand, product) = scene("protocol");
    let (protocol, effects) = (
        folder.file("p.csv", PROTOCOL),
        folder.file("e.toml", EFFECTS),
    );
    let run = |out: &str| {
        let out = folder.path(out);
        let words = [
            "press",
            &hand,
            &product,
            "--protocol",
            &protocol,
            "--effects",
            &effects,
            "--out",
            &out,
        ];
        let output = thenar(&words);
        assert!(output.status.success(), "{}", stderr(&output));
    };
    run("one");
    run("two");
    assert_eq!(
        folder.names("one"),
        [
            "product.csv",
            "protocol.csv",
            "summary.json",
            "vertices.csv"
        ]
    );
    for name in folder.names("one") {
        assert_eq!(
            folder.read(&format!("one/{name}")),
            folder.read(&format!("two/{name}")),
            "{name}"
        );
    }
    let table = folder.read("one/protocol.csv");
    let force = column(&table, "force_n");
    assert_eq!(column(&table, "time_s"), [0.0, 0.5, 1.0, 10.0, 11.0]);
    // The hold relaxes; ten seconds later the amplitude's half of what would be borne at once is left, or a little less.
    assert!(
        force[1] > force[2] && force[2] > 1.01 * force[3],
        "{force:?}"
    );
    assert!((force[4] - 0.05).abs() < 1e-4, "{force:?}");
    let vertices: f64 = column(&folder.read("one/vertices.csv"), "force_n")
        .iter()
        .sum();
    assert!((vertices - 0.05).abs() < 1e-4, "{vertices}");
}

#[test]
fn bad_protocols_and_effects_are_refused_with_their_line() {
    let (folder, hand, product) = scene("bad_protocols");
    let out = folder.path("out");
    let with = |option: &str, name: &str, text: &str, words: &str| {
        let file = folder.file(name, text);
        refused(
            &["press", &hand, &product, option, &file, "--out", &out],
            words,
        );
    };
    with(
        "--protocol",
        "a.csv",
        "time_s,depth\n0,1\n",
        "line 1: there is no column \"depth\"",
    );
    with(
        "--protocol",
        "b.csv",
        "time_s,depth_mm\n0,deep\n",
        "line 2: depth_mm is \"deep\"",
    );
    with(
        "--protocol",
        "c.csv",
        "time_s,depth_mm,force_n\n0,1,1\n",
        "line 2: give one of",
    );
    with(
        "--protocol",
        "d.csv",
        "time_s,depth_mm\n1,0\n1,1\n",
        "row 1: time_s is 1",
    );
    with("--protocol", "e.csv", "time_s,depth_mm\n", "no rows");
    with(
        "--protocol",
        "f.csv",
        "time_s,depth_mm\n0,0\n1,1e300\n",
        "depth_mm is 1e300, which is out of range",
    );
    with(
        "--effects",
        "a.toml",
        "[[effect]]\nname = \"magic\"\n",
        "there is no effect \"magic\"; there are bone",
    );
    with(
        "--effects",
        "b.toml",
        "[[effect]]\nname = \"bone\"\nthick = 3\n",
        "line 3: effect bone: there is no number",
    );
    with(
        "--effects",
        "c.toml",
        "[[effect]]\nname = \"bone\"\nthickness_mm = -3\n",
        "thickness_mm is -3, but must be from",
    );
    with(
        "--effects",
        "d.toml",
        "[[effect]]\nname = \"bone\"\nregions = [7]\n",
        "line 3: regions must be a list",
    );
    with(
        "--effects",
        "e.toml",
        "[bone]\nthickness_mm = 3\n",
        "line 1: each effect stands in a table",
    );
    with(
        "--effects",
        "f.toml",
        "[[effect]]\nname = \"stiffening_law\"\nlaw = \"cubic\"\n",
        "must be one of exponential",
    );
    let protocol = folder.file("p.csv", PROTOCOL);
    refused(
        &[
            "press",
            &hand,
            &product,
            "--protocol",
            &protocol,
            "--force",
            "1",
            "--out",
            &out,
        ],
        "cannot be used with",
    );
}

#[test]
fn a_slide_with_friction_writes_the_shear_that_the_product_bears() {
    let (folder, hand, product) = scene("slide");
    let slide = "time_s,depth_mm,slide_x_mm\n0,0.4,0\n1,0.4,0.05\n2,0.4,0.1\n";
    let effects = "[[effect]]\nname = \"friction\"\namplitude = 1\ncoefficient = 0.4\n";
    let words = [
        "press",
        &hand,
        &product,
        "--protocol",
        &folder.file("p.csv", slide),
        "--effects",
        &folder.file("e.toml", effects),
        "--out",
        &folder.path("out"),
    ];
    let output = thenar(&words);
    assert!(output.status.success(), "{}", stderr(&output));
    let shear = folder.read("out/shear.csv");
    let sum: f64 = column(&shear, "tx_n").iter().sum();
    let vertices = folder.read("out/vertices.csv");
    let normal: f64 = column(&vertices, "force_n").iter().sum();
    assert!(
        sum > 0.0 && sum <= 0.4 * normal * (1.0 + 1e-9),
        "{sum} {normal}"
    );
    // The product is dragged along x, and the skin holds it back.
    let on_product = column(&folder.read("out/protocol.csv"), "fx_n");
    assert!(
        on_product[2] < on_product[1] && on_product[1] < 0.0,
        "{on_product:?}"
    );
    assert!(
        column(&shear, "slip_margin")
            .iter()
            .all(|m| (0.0..=1.0).contains(m))
    );
}
