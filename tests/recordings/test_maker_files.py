"""Makers' files in Python: the arrays are those that a second reader, written here with numpy alone, finds."""

import numpy as np
import pytest
import thenar

ISCAN = "finger_pressure_iscan/iscan_test.csv"


def test_iscan_cells_agree_with_a_second_reader(shared):
    lines = (shared / ISCAN).read_text("latin-1").splitlines()
    starts = [k for k, line in enumerate(lines) if line.startswith("Frame ")]
    cells = [[line.replace("B", "nan").split(",") for line in lines[k + 1 : k + 29]] for k in starts]
    expected = np.array(cells, dtype=float).reshape(309, 784)
    map = thenar.read_recording(shared / ISCAN).maps[0]
    assert np.array_equal(map.counts, expected, equal_nan=True)
    stated = [float(lines[k].split("Raw Sum=,,")[1]) for k in starts]
    assert np.array_equal(np.nansum(map.counts, axis=1), stated)
    assert (map.grid, map.pressure_kpa, map.force_n) == ((28, 28), None, None)


def test_pliance_force_is_sum_of_pressure_times_area(shared):
    map = thenar.read_recording(shared / "plantar_pressure_exports/pliance_test.asc").maps[0]
    assert np.allclose(map.force_n, map.pressure_kpa @ map.area_mm2 * 1e-3)
    assert map.force_n.max() == pytest.approx(230.6, abs=0.05)
    [check] = map.checks
    assert check.agrees and check.compared == 281 and check.largest_difference < 0.01


def test_what_cannot_be_known_is_said(shared):
    sources = {
        ISCAN: "no calibration is in the file",
        "skin_indent_force_ramp/target_0400mN.ddf": "shape and size of the tip",
        "afm_gel_and_soft_matrix/polymer_gel_creep.jpk-force": "no modulus without assuming one",
        "plantar_pressure_exports/xsensor_data.csv": "which cells lie outside",
    }
    for name, expected in sources.items():
        file = thenar.read_recording(shared / name)
        assert any(expected in text for each in [*file.maps, *file.curves] for text in each.unknown), name


def test_faults_are_recording_errors(tmp_path):
    (tmp_path / "a.csv").write_text("time_s,depth_mm,force_n\n0,0,0\n0,1,2\n")
    with pytest.raises(thenar.RecordingError, match=r"a\.csv, line 3: time does not increase: 0 s follows 0 s; sort"):
        thenar.read_recording(tmp_path / "a.csv")
    with pytest.raises(thenar.RecordingError, match=r"b\.csv: cannot be read \(No such file"):
        thenar.read_recording(str(tmp_path / "b.csv"))
    for wrong in (3, None, np.zeros(3), b"\xff", "a\0b"):
        with pytest.raises(thenar.RecordingError):
            thenar.read_recording(wrong)
