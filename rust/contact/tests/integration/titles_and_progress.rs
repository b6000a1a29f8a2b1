//! What a press says: regions by their names, and progress that tells how far a search is.

use crate::scenes;

use std::sync::Mutex;

use scenes::{Bench, lattice, paraboloid, press};
use thenar_contact::{
    ContactError, Control, ForceTarget, Material, Model, Press, Skin, SkinInput, Start, Unsolved,
};
use thenar_surface::Vec3;

fn named(thickness_mm: f64, names: &[&str]) -> Bench {
    let mesh = lattice(14.0, 1.3, 0.3);
    let halves = mesh.positions().iter().map(|p| i32::from(p.x > 0.0));
    let input = SkinInput {
        regions: halves.collect(),
        mesh,
        materials: vec![
            Material {
                thickness_mm,
                ..Material::finger_layer()
            };
            2
        ],
        model: Model::Layer,
    };
    let names = names.iter().map(|name| (*name).to_owned()).collect();
    Bench::from(Skin::prepare_named(input, names, &Control::none()).unwrap())
}

#[test]
fn warnings_and_errors_call_regions_by_their_names() {
    let said = press(
        &mut named(2.0, &["thumb", "index fingertip"]),
        &paraboloid(9.0, 1.5, 8.0),
    );
    for name in [
        "region 'thumb' is pressed",
        "region 'index fingertip' is pressed",
    ] {
        assert!(
            said.warnings
                .iter()
                .any(|w| w.to_string().starts_with(name)),
            "{:?}",
            said.warnings
        );
    }
    let numbered = press(&mut named(2.0, &["thumb"]), &paraboloid(9.0, 1.5, 8.0));
    assert!(
        numbered
            .warnings
            .iter()
            .any(|w| w.to_string().starts_with("region 1 is pressed"))
    );
    let product = paraboloid(9.0, 0.1, 7.0);
    let request = Press {
        product: &product,
        posed: None,
        force: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
        drag: None,
    };
    let refused = named(0.3, &["thumb", "index fingertip"]).press(&request, &Control::none());
    let sentence = refused.unwrap_err().to_string();
    assert!(
        sentence.starts_with("region 'index fingertip': around vertex"),
        "{sentence}"
    );
    let input = SkinInput {
        mesh: lattice(4.0, 1.0, 0.3),
        regions: vec![1; lattice(4.0, 1.0, 0.3).positions().len()],
        materials: vec![Material::finger()],
        model: Model::Layer,
    };
    let names = vec!["thumb".to_owned(), "web".to_owned()];
    let refused = Skin::prepare_named(input, names, &Control::none()).map(|_| ());
    assert!(
        matches!(&refused, Err(ContactError::MissingMaterial { title, .. }) if title == "region 'web'")
    );
}

#[test]
fn a_note_is_repeated_by_every_result() {
    let skin = named(7.0, &[]).skin;
    let mut skin = Bench::from(skin.with_note(Model::Layer.preset_note()));
    for depth in [0.5, 1.0] {
        let said = press(&mut skin, &paraboloid(9.0, depth, 8.0)).warnings;
        assert!(
            said[0].to_string().contains("preset finger_layer"),
            "{said:?}"
        );
    }
}

#[test]
fn progress_advances_through_a_search_for_a_force() {
    let told = Mutex::new(Vec::new());
    let control = Control {
        progress: &|stage: &str, share: f64| {
            if stage == "force" {
                told.lock().unwrap().push(share);
            }
        },
        ..Control::none()
    };
    let product = paraboloid(9.0, -3.0, 9.0);
    let force = Some(ForceTarget {
        newton: 1.5,
        direction: Some(Vec3::new(0.0, 0.0, -1.0)),
    });
    let request = Press {
        product: &product,
        posed: None,
        force,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
        drag: None,
    };
    named(7.0, &[]).press(&request, &control).unwrap();
    let told = told.into_inner().unwrap();
    println!("{told:?}");
    assert!(told.len() >= 4 && told.is_sorted());
    assert!(told[0] < 0.3 && *told.last().unwrap() > 0.9);
    let leap = told.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    assert!(leap < 0.5, "a leap of {leap}");
}
