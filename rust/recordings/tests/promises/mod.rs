//! What a reader promises of everything that it reads, however damaged the file was.
#![allow(dead_code)]

use thenar_recordings::RecordingFile;
use thenar_recordings::meshes::MeshFile;

/// What a recording promises to whoever uses it.
pub fn of_recording(file: &RecordingFile) {
    assert!(!file.maps.is_empty() || !file.curves.is_empty());
    for map in &file.maps {
        assert!(map.frames() > 0 && map.values.len() == map.frames() * map.sensels.len());
        assert!(map.values.iter().all(|value| !value.is_infinite()));
        if let Some(times) = &map.time_s {
            assert!(times.len() == map.frames() && times.windows(2).all(|pair| pair[0] < pair[1]));
        }
        assert!(
            map.channels
                .iter()
                .all(|channel| channel.values.len() == map.frames())
        );
        assert!(map.clipped_count() <= map.values.len());
        assert!(
            map.grid()
                .is_none_or(|grid| grid.rows * grid.columns == map.sensels.len())
        );
        assert!(map.force_n(0).is_none_or(|force| !force.is_nan()));
    }
    for curve in &file.curves {
        assert!(curve.samples() > 0 && !curve.channels.is_empty());
        assert!(
            curve
                .channels
                .iter()
                .all(|channel| channel.values.len() == curve.samples())
        );
        assert!(
            curve
                .segments
                .iter()
                .all(|part| part.start <= part.end && part.end <= curve.samples())
        );
    }
}

/// What a mesh or a cloud of points promises.
pub fn of_mesh(mesh: &MeshFile) {
    assert!(
        mesh.positions
            .iter()
            .all(|p| p.iter().all(|value| value.is_finite()))
    );
    assert!(
        mesh.triangles
            .iter()
            .flatten()
            .all(|index| (*index as usize) < mesh.positions.len())
    );
}
