//! Sensels whose normals a study does not give: on the tool they look out of it, off it back along the travel, and it is said.

use crate::scenes;

use nalgebra::Vector3;
use scenes::{add_map, material, pad, study};
use thenar_contact::Control;
use thenar_inference::Fitting;
use thenar_recordings::study::{Data, PlacedSensel, Shape};

const RADIUS_MM: f64 = 10.0;

#[test]
fn sensels_without_normals_look_out_of_the_tool_they_lie_on() {
    let ball = Shape::Sphere {
        radius_mm: RADIUS_MM,
    };
    let mut study = study(
        pad(8.0, 7.0, 1.5),
        material(0.01, 0.01, 7.0),
        vec![("plate", ball)],
    );
    add_map(
        &mut study,
        ("1", "mat"),
        (2, 1.5),
        (&[0.0, 1.0], &[0.5, 1.0]),
    );
    // The ball touches the site at the origin from above.
    let out = [Vector3::new(0.6, 0.0, -0.8), Vector3::new(0.0, -0.8, -0.6)];
    let on_ball = out.map(|out| Vector3::z() * RADIUS_MM + out * RADIUS_MM);
    let places = [
        on_ball[0],
        on_ball[1],
        Vector3::x() * 40.0,
        Vector3::y() * 3.0,
    ];
    let given = [None, None, None, Some([0.0, 1.0, 0.0])];
    let sensel = |(center, normal): (Vector3<f64>, Option<[f64; 3]>)| {
        Some(PlacedSensel {
            center_mm: center.into(),
            normal,
            area_mm2: 2.25,
        })
    };
    let Data::PressureMap { sensels, .. } = &mut study.recordings[0].data else {
        panic!("no map")
    };
    *sensels = Some(places.into_iter().zip(given).map(sensel).collect());
    let fitting = Fitting::new(&study, &Control::none()).unwrap();
    let measured = &fitting.measured()[0];
    let wanted = [out[0], out[1], Vector3::z(), Vector3::y()];
    for (normal, wanted) in measured.mat.as_ref().unwrap().normals.iter().zip(wanted) {
        assert!(normal.angle(&wanted) < 0.02, "{normal:?} for {wanted:?}");
    }
    for told in [
        "sensels of which the study gives no normals (2) are taken to look out of the tool",
        "sensels without normals that lie off the tool (1) are taken to look back",
    ] {
        let unknown = &measured.unknown;
        assert!(unknown.iter().any(|u| u.starts_with(told)), "{unknown:?}");
    }
}
