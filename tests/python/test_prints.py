"""`thenar.Print`, `place_mat` of one, `compare_print`, and prints of a study: arrays, regions, refusals."""

import json
import struct
import zlib

import numpy as np
import pytest
import thenar


def write_png(path, gray):
    """An 8-bit gray PNG of an array (height, width)."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width = gray.shape
    lines = b"".join(b"\0" + row.tobytes() for row in gray.astype(np.uint8))
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    body = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)
    return path


def inked(is_ink, side_mm=24.0, pixel_mm=0.1):
    """Brightness of a sheet about the origin, dark where `is_ink(x, y)` in mm, y upward."""
    count = round(side_mm / pixel_mm)
    places = (np.arange(count) + 0.5) * pixel_mm - side_mm / 2
    x, y = np.meshgrid(places, places[::-1])
    return np.where(is_ink(x, y), 40, 230)


def half_disc(x, y):
    """Of radius 7 mm, above y = -2 and without its upper right."""
    return (np.hypot(x, y) < 7) & (y > -2) & ~((x > 1) & (y > 3))


@pytest.fixture
def grid():
    """A flat skin of vertices 1 mm apart, its triangles, and 10 kPa where the half disc is."""
    side = np.arange(41) - 20.0
    x, y = np.meshgrid(side, side)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    corner = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
    triangles = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + 42], axis=1),
            np.stack([corner, corner + 42, corner + 41], axis=1),
        ]
    )
    return vertices, triangles, np.where(half_disc(vertices[:, 0], vertices[:, 1]), 0.01, 0.0)


def laid(print_):
    return thenar.place_mat(print_, "plane", origin_mm=(-12, -12, 0), rows=(0, 1, 0), columns=(1, 0, 0))


def overlap(comparison):
    return next(row.simulated for row in comparison.recordings[0].measures if row.name == "overlap")


def test_a_print_is_read_in_cells(tmp_path):
    path = write_png(tmp_path / "print.png", inked(lambda x, y: np.hypot(x - 3, y + 2) < 5))
    read = thenar.Print.read(path, mm_per_px=0.1, cell_mm=1.0)
    assert read.cells == (24, 24) and read.size_px == (240, 240) and read.ink == "dark"
    area = np.pi * 25
    assert read.inked_mm2 == pytest.approx(area, rel=5e-3) and read.inked.sum() == pytest.approx(area, rel=5e-3)
    rows, columns = np.divmod(np.arange(576), 24)
    center = [(read.inked * (number + 0.5 - 12)).sum() / area for number in (columns, rows)]
    assert np.allclose(center, (3, -2), atol=0.05), "rows count from the lower edge"
    same = thenar.Print.read(str(path), marks_px=((0, 0), (30, 40)), marks_mm=5.0, cell_mm=1.0)
    assert np.array_equal(same.inked, read.inked)


def test_a_print_is_compared_with_a_contact(tmp_path, grid):
    moved = inked(lambda x, y: half_disc(x + 1.5, y - 0.5))
    print_ = thenar.Print.read(write_png(tmp_path / "print.png", moved), dpi=254, cell_mm=1.0)
    regions = (grid[0][:, 0] > 0).astype(int).tolist()
    comparison = thenar.compare_print(
        print_, laid(print_), *grid, ink_kpa=1.0, regions=regions, region_names=["left", "right"], name="ink"
    )
    assert overlap(comparison) > 0.8, "vertices 1 mm apart tell the edge to half of that"
    found = comparison.recordings[0].print
    value, low, high = found.columns_mm
    assert value == pytest.approx(1.5, abs=0.4) and low < value < high
    assert found.rows_mm[0] == pytest.approx(-0.5, abs=0.4) and not found.is_mirrored
    assert [row.name for row in found.regions] == ["left", "right"]
    assert found.print_residual.shape == (len(grid[0]),) and found.recorded_share.shape == (576,)
    assert set(np.unique(found.print_residual[np.isfinite(found.print_residual)])) <= {-1.0, 0.0, 1.0}
    told = json.loads(comparison.to_json())["recordings"][0]["print"]
    assert told["is_mirrored"] is False and told["pose"]["columns_mm"]["value"] == value
    assert "orange: inked alone" in comparison.report_html()


def test_patches_name_their_vertices(tmp_path, grid):
    """The ink lacks all that lies right of x = 3 mm, a cap of the half disc."""
    lacking = inked(lambda x, y: half_disc(x, y) & (x < 3))
    print_ = thenar.Print.read(write_png(tmp_path / "print.png", lacking), dpi=254, cell_mm=1.0)
    comparison = thenar.compare_print(print_, laid(print_), *grid)
    worst, *_ = comparison.recordings[0].worst
    assert worst.quantity == "Contact area" and worst.measured == 0.0 and worst.residual == -worst.simulated
    missing = np.flatnonzero(half_disc(grid[0][:, 0], grid[0][:, 1]) & (grid[0][:, 0] > 3))
    assert worst.residual == pytest.approx(-len(missing), rel=0.3), "the pose may make up for a part"
    assert np.isin(worst.vertices, missing).mean() > 0.7
    told = json.loads(comparison.to_json())["recordings"][0]
    assert told["worst"][0]["vertices"] == worst.vertices.tolist() and told["print"]["is_at_end"] is False


def test_an_image_from_behind_is_turned_about(tmp_path, grid):
    path = write_png(tmp_path / "print.png", inked(lambda x, y: half_disc(-x, y)))
    seen = thenar.Print.read(path, dpi=254, cell_mm=1.0)
    first = thenar.compare_print(seen, laid(seen), *grid)
    turned = thenar.Print.read(path, dpi=254, cell_mm=1.0, mirrored=True)
    second = thenar.compare_print(turned, laid(turned), *grid)
    assert first.recordings[0].print.is_mirrored and not second.recordings[0].print.is_mirrored
    assert overlap(second) == pytest.approx(first.recordings[0].print.mirrored_overlap, abs=0.03)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({}, "give one scale of the print"),
        ({"dpi": 254, "mm_per_px": 0.1}, "give one scale of the print"),
        ({"dpi": 254, "cell_mm": 0.0}, "a cell of 0.000 mm is 0.0 pixels wide, and 3 are needed"),
        ({"dpi": 254, "cell_mm": float("nan")}, "a cell of NaN mm"),
        ({"dpi": 254, "threshold": 200}, "the threshold is 200; give a brightness, 0 black to 1 white"),
        ({"dpi": 254, "ink": "blue"}, "ink 'blue' is not known; give"),
        ({"dpi": float("nan")}, "the image has no scale"),
        ({"dpi": 254, "paper_px": (900, 900, 950, 950)}, "no pixel of the 240 x 240 is paper"),
    ],
)
def test_what_is_no_reading_is_refused(tmp_path, options, sentence):
    path = write_png(tmp_path / "print.png", inked(half_disc))
    with pytest.raises(thenar.RecordingError, match=sentence):
        thenar.Print.read(path, **options)


def test_what_does_not_belong_together_is_refused(tmp_path, grid):
    path = write_png(tmp_path / "print.png", inked(half_disc))
    fine, coarse = (thenar.Print.read(path, dpi=254, cell_mm=side) for side in (1.0, 2.0))
    with pytest.raises(thenar.RecordingError, match="it has 144 cells and the print 576"):
        thenar.compare_print(fine, laid(coarse), *grid)
    with pytest.raises(thenar.RecordingError, match="regions: it has 2 entries"):
        thenar.compare_print(fine, laid(fine), *grid, regions=[0, 1], region_names=["a", "b"])
    with pytest.raises(thenar.RecordingError, match="ink_kpa"):
        thenar.compare_print(fine, laid(fine), *grid, ink_kpa=-1.0)
    blank = thenar.Print.read(write_png(tmp_path / "b.png", inked(half_disc)), dpi=254, cell_mm=1.0, threshold=0.0)
    with pytest.raises(thenar.RecordingError, match="no cell of it is half inked"):
        thenar.compare_print(blank, laid(blank), *grid)


STUDY = """
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = 0.01
g_lim_mpa = 0.01
thickness_mm = "inf"
[indenters.ball]
shape = "sphere"
radius_mm = 20.0
[sites.middle]
point_mm = [0.0, 0.0, 0.0]
direction = [0.0, 0.0, -1.0]
[[recordings]]
name = "ink"
kind = "handprint"
file = "print.png"
dpi = 254
depth_mm = 1.0
indenter = "ball"
site = "middle"
[recordings.placing]
on = "plane"
origin_mm = [-12, -12, 0]
columns = [1, 0, 0]
rows = [0, 1, 0]
"""


def test_a_study_of_a_print_alone_is_compared(tmp_path, grid):
    """A ball on a half space: pi R d inked, and a study without anything to fit."""
    lines = ["v {} {} {}".format(*vertex) for vertex in grid[0]] + [
        "f {} {} {}".format(*(triangle + 1)) for triangle in grid[1]
    ]
    (tmp_path / "skin.obj").write_text("\n".join(lines) + "\n")
    write_png(tmp_path / "print.png", inked(lambda x, y: np.hypot(x, y) < np.sqrt(20.0)))
    (tmp_path / "study.toml").write_text(STUDY)
    study = thenar.Study.load(tmp_path)
    recording = study.recording("ink")
    assert recording.kind == "handprint" and recording.depth_mm == 1.0
    assert recording.print.cell_mm == pytest.approx(1.0) and recording.sensels.center_mm.shape == (576, 3)
    told = []
    comparison = thenar.compare(study, lambda stage, share: told.append(share))
    assert told == sorted(told) and told[-1] == 1.0
    area = next(row for row in comparison.recordings[0].measures if row.name == "area_mm2")
    assert area.measured == pytest.approx(np.pi * 20, rel=0.06) and area.simulated == pytest.approx(np.pi * 20, rel=0.2)
    assert overlap(comparison) > 0.8 and comparison.estimates == []
    assert comparison.sentence.startswith("The handprint")
