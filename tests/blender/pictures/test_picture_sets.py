"""Pictures by one button: files appear where said, numbers are the result's, and the user's file stays as it is."""

import json
import re
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import bpy
import numpy as np
import pytest
import stage as scenes
import whole_state
from thenar_blender.operators import computing
from thenar_blender.picture_sets import card, drawing, film, grip_and_print, operators, process, sizes
from thenar_blender.picture_sets import order as orders
from thenar_blender.picture_stage import facts, laying, pdf
from thenar_blender.picture_stage import page as pages
from thenar_blender.results import grades
from thenar_blender.scene.checks import Refusal

SMALL = {"height": 64, "samples": 1}


@pytest.fixture
def solved():
    """A ball pressed on a plate."""
    scenes.scene()
    return scenes.solve()


def texts(sheet):
    return [item.text for item in sheet.items if isinstance(item, pages.Text)]


def drawn(kind, **options):
    """The page of a picture of the open scene, drawn here: the scene is thrown away by the test."""
    order = orders.Order(kind, "x.png", **SMALL, **options)
    draw = {orders.GRIP: grip_and_print.draw, orders.CARD: card.draw}[kind]
    return draw(order, laying.gather(bpy.context), bpy.context)


def field(name):
    """Values of an attribute of the hand, read without the add-on."""
    data = bpy.context.scene.thenar.hand.data.attributes[name].data
    return np.array([entry.value for entry in data], dtype=np.float64)


def test_button_writes_a_picture_and_leaves_the_file_as_it_was(solved, tmp_path):
    before = whole_state.of_file()
    assert len(before) > 20
    path = tmp_path / "new folder" / "picture.png"
    assert bpy.ops.thenar.picture(kind=orders.GRIP, filepath=str(path), **SMALL) == {"FINISHED"}
    assert whole_state.differences(before, whole_state.of_file()) == []
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and int.from_bytes(data[16:20]) == 114 and int.from_bytes(data[20:24]) == 64
    assert list(path.parent.iterdir()) == [path], "nothing half written is left"


def test_button_draws_the_scene_that_is_open(solved, tmp_path):
    """Also where another one, which it shows as its background, is written with it and comes first."""
    other = bpy.data.scenes.new("A")
    bpy.context.scene.background_set = other
    path = tmp_path / "picture.png"
    assert bpy.ops.thenar.picture(kind=orders.GRIP, filepath=str(path), **SMALL) == {"FINISHED"}
    assert path.exists()


def test_state_is_compared_deeply_enough(solved):
    before = whole_state.of_file()
    bpy.context.scene.render.resolution_x += 1
    bpy.data.worlds.new("Left over")
    bpy.context.scene.objects[0].hide_render = True
    found = " ".join(whole_state.differences(before, whole_state.of_file()))
    assert "render" in found and "Left over" in found and "hide_render" in found


def test_cancel_ends_the_process_and_leaves_the_file_as_it_was(solved, tmp_path):
    before, path = whole_state.of_file(), tmp_path / "picture.png"
    steps = process.steps(bpy.context, orders.Order(orders.GRIP, str(path), height=240, samples=400))
    work, cancel, said = next(steps), threading.Event(), []
    outcome = []

    def run():
        try:
            work(cancel, lambda stage, share: said.append((stage, share)))
        except Refusal as error:
            outcome.append(str(error))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    until = time.monotonic() + 240.0
    while len(said) < 6 and time.monotonic() < until:
        time.sleep(0.05)
    shares = [share for stage, share in said if stage == "render"]
    assert len(shares) > 3 and shares == sorted(shares) and shares[-1] < 1.0, "progress is said while it renders"
    began = time.monotonic()
    cancel.set()
    thread.join(5.0)
    assert not thread.is_alive() and time.monotonic() - began < 2.0
    steps.close()
    assert outcome == ["the picture was cancelled"]
    assert whole_state.differences(before, whole_state.of_file()) == []
    assert not path.exists()


def test_process_ends_with_the_one_who_asked(solved, tmp_path):
    """As when Blender crashes while a picture is rendered: its end of the pipe closes."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"), copy=True)
    order = orders.Order(orders.GRIP, str(tmp_path / "x.png"), height=1080, samples=500)
    order.scene = "Scene"
    call = [sys.executable, "-m", "thenar_blender", "picture", str(tmp_path / "a.blend"), "--order"]
    child = subprocess.Popen([*call, orders.to_text(order)], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    while process.MARK not in child.stdout.readline().decode():
        assert child.poll() is None
    child.stdin.close()
    assert child.wait(60.0) == 1
    child.stdout.close()


def test_error_in_the_process_is_one_sentence_and_leaves_the_file_as_it_was(solved, tmp_path):
    bpy.context.scene.thenar.hand.data.attributes.remove(bpy.context.scene.thenar.hand.data.attributes["pressure_kpa"])
    before = whole_state.of_file()
    with pytest.raises(RuntimeError, match=r"Error: There is no pressure yet; press Solve first"):
        bpy.ops.thenar.picture(kind=orders.GRIP, filepath=str(tmp_path / "x.png"), **SMALL)
    assert whole_state.differences(before, whole_state.of_file()) == []
    assert list(tmp_path.iterdir()) == []


def test_nobodys_file_is_replaced(solved, tmp_path):
    path = tmp_path / "mine.png"
    path.write_text("mine")
    with pytest.raises(RuntimeError, match="exists already"):
        bpy.ops.thenar.picture(kind=orders.GRIP, filepath=str(path), **SMALL)
    assert path.read_text() == "mine"
    (tmp_path / "card.pdf").write_text("mine too")
    with pytest.raises(RuntimeError, match=r"card\.pdf' exists already"):
        bpy.ops.thenar.picture(kind=orders.CARD, filepath=str(tmp_path / "card.png"), **SMALL)
    first = orders.free_path(tmp_path, orders.GRIP, "A/b: c")
    first.write_text("")
    second = orders.free_path(tmp_path, orders.GRIP, "A/b: c")
    assert first.parent == second.parent == tmp_path and first != second and not second.exists()


def test_unsaved_file_asks_for_a_folder(solved):
    with pytest.raises(RuntimeError, match="never saved"):
        bpy.ops.thenar.picture(kind=orders.GRIP)
    chosen = bpy.context.scene.thenar_pictures
    assert not operators.has_folder(chosen), "the panel says so before the button is pressed"
    chosen.folder = tempfile.gettempdir()
    assert operators.has_folder(chosen)


@pytest.mark.parametrize("change", [{"kind": "PORTRAIT"}, {"height": 3}, {"target": "x.tiff"}])
def test_what_cannot_be_made_is_refused(change):
    with pytest.raises(Refusal):
        orders.check(orders.Order(**({"kind": orders.GRIP, "target": "x.png"} | change)))


def test_poll_says_what_is_missing():
    assert not bpy.ops.thenar.picture.poll()
    scenes.scene()
    with pytest.raises(RuntimeError, match="press Solve first"):
        bpy.ops.thenar.picture(kind=orders.GRIP)
    assert issubclass(operators.THENAR_OT_picture, computing.Computing), "a button's run has progress and Esc"


def test_numbers_on_the_pages_are_those_of_the_fields(solved):
    force, pressure = field("contact_force_n"), field("pressure_kpa")
    wanted = {f"{force.sum():.1f} N", f"{solved.area_mm2 / 100.0:.1f} cm²", f"{pressure.max():.0f} kPa"}
    for kind in (orders.GRIP, orders.CARD):
        assert wanted <= set(texts(drawn(kind))), kind
        scenes.solve()


def test_bars_are_as_long_as_their_forces(solved):
    solved.fingers.clear()
    for name, force in (("thumb", 10.0), ("index", 5.0), ("palm", 0.0)):
        row = solved.fingers.add()
        row.name, row.force_n = name, force
    sheet = drawn(orders.CARD)
    assert {"Thumb", "10.0 N", "5.0 N", "0.0 N"} <= set(texts(sheet))
    bars = [item.box[2] for item in sheet.items if isinstance(item, pages.Box) and item.color == card.BAR]
    assert len(bars) == 2 and bars[1] / bars[0] == pytest.approx(0.5)


def test_grade_and_stale_result_stand_on_the_picture(solved):
    solved.grade, solved.reason = grades.DO_NOT, "the skin is torn"
    for kind in (orders.GRIP, orders.CARD):
        sheet = drawn(kind, is_stale=True)
        said = [item for item in sheet.items if isinstance(item, pages.Text)]
        loud = {item.text for item in said if item.color == pages.ALARM}
        assert {"Do not use", "Do not use: the skin is torn", facts.STALE} <= loud, kind


def test_stale_is_found_by_the_button(solved, tmp_path):
    order = orders.Order(orders.GRIP, str(tmp_path / "x.png"), **SMALL)
    fresh = process.steps(bpy.context, order)
    next(fresh)
    assert not order.is_stale
    fresh.close()
    bpy.context.scene.thenar.product.location.z += 0.003
    bpy.context.view_layer.update()
    stale = process.steps(bpy.context, order)
    next(stale)
    assert order.is_stale
    stale.close()


def test_long_titles_end_before_the_numbers(solved):
    solved.product_name = "Handle of a very long name, " * 6
    said = [item for item in drawn(orders.GRIP).items if isinstance(item, pages.Text)]
    title = next(item for item in said if item.text == solved.product_name)
    first = min(item.place[0] - pages.width_of(item.text, item.size) for item in said if item.text.endswith(" N"))
    assert title.place[0] + pages.width_of(title.text, title.size) <= first


def test_product_that_hangs_on_the_hand_stays_where_it_is():
    hand, product = scenes.scene()
    sleeve = scenes.pad("Sleeve")
    sleeve.parent = hand
    product.parent = hand
    hand.location.x += 0.01
    bpy.context.view_layer.update()
    place = scenes.evaluated(product)
    sizes._take_out(bpy.context, hand)
    assert [obj.name for obj in bpy.context.scene.objects] == ["Plate"]
    np.testing.assert_allclose(scenes.evaluated(product), place, atol=1e-3)


def test_command_writes_the_same(solved, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    from thenar_blender.terminal import command_line

    call = ["picture", str(tmp_path / "a.blend"), "--kind", "comfort_card", "--out", str(tmp_path / "card.png")]
    assert command_line.main([*call, "--height", "64", "--samples", "1"]) == 0
    assert (tmp_path / "card.png").exists() and (tmp_path / "card.pdf").read_bytes().startswith(b"%PDF-1.4")
    assert command_line.main(call) == 2, "it exists"


def test_film_lasts_four_seconds_and_turns_once(solved, tmp_path):
    path = tmp_path / "turn.mp4"
    order = orders.Order(orders.TURN, str(path), rate=2, **SMALL)
    shares = []
    order.tell = lambda stage, share: shares.append(share)
    assert drawing.draw(order, bpy.context) == [path]
    assert shares == sorted(shares) and len(shares) > 8
    assert path.read_bytes()[4:8] == b"ftyp" and [*tmp_path.iterdir()] == [path]
    clip = bpy.data.movieclips.load(str(path))
    assert clip.frame_duration == 8 and clip.fps == pytest.approx(2.0) and tuple(clip.size) == (114, 64)


def test_film_opens_in_another_reader(solved, tmp_path):
    reader = pytest.importorskip("av")
    order = orders.Order(orders.TURN, str(tmp_path / "turn.mp4"), rate=2, **SMALL)
    drawing.draw(order, bpy.context)
    with reader.open(str(tmp_path / "turn.mp4")) as film:
        stream = film.streams.video[0]
        assert stream.codec_context.name == "h264" and float(stream.duration * stream.time_base) == pytest.approx(4.0)
        frames = [frame.to_ndarray(format="rgb24") for frame in film.decode(stream)]
    assert len(frames) == 8 and all(frame.std() > 5.0 for frame in frames)


def test_without_ffmpeg_a_film_is_numbered_pictures(solved, tmp_path, monkeypatch):
    monkeypatch.setattr(film, "has_ffmpeg", lambda: False)
    made = drawing.draw(orders.Order(orders.TURN, str(tmp_path / "turn.mp4"), rate=1, **SMALL), bpy.context)
    assert [path.name for path in made] == [f"turn-{number:04}.png" for number in range(1, 5)]
    assert sorted(tmp_path.iterdir()) == made


def page_of_pdf():
    sheet = pages.Page(1240.0, 1754.0, (1.0, 1.0, 1.0))
    sheet.text((80.0, 1600.0), 40.0, r"57.8 cm² (a \ b) · mean")
    sheet.text((1160.0, 900.0, "right"), 40.0, "握り")
    sheet.box((80.0, 80.0, 310.0, 20.0), (1.0, 0.0, 0.0))
    sheet.picture((100.0, 200.0, 400.0, 300.0), np.linspace(0.0, 1.0, 30 * 40 * 3).reshape(30, 40, 3))
    return sheet


def test_pdf_opens_in_another_reader(tmp_path):
    reader = pytest.importorskip("pypdf")
    pdf.save(tmp_path / "x.pdf", page_of_pdf())
    found = reader.PdfReader(tmp_path / "x.pdf", strict=True).pages
    assert len(found) == 1
    assert found[0].extract_text().strip() == r"57.8 cm² (a \ b) · mean"
    assert float(found[0].mediabox.width) == pytest.approx(595.28)


def test_pdf_shows_what_the_page_shows(tmp_path):
    reader = pytest.importorskip("pymupdf")
    sheet = page_of_pdf()
    pdf.save(tmp_path / "x.pdf", sheet)
    shown = reader.open(tmp_path / "x.pdf")[0].get_pixmap(matrix=reader.Matrix(1240 / 595.28, 1240 / 595.28))
    assert not reader.TOOLS.mupdf_warnings()
    rows = np.frombuffer(shown.samples, np.uint8).reshape(shown.height, shown.width, 3)[::-1] / 255.0
    assert tuple(rows[90, 200]) == (1.0, 0.0, 0.0) and tuple(rows[90, 60]) == (1.0, 1.0, 1.0)
    wanted = sheet.items[-1].pixels
    for row, column in ((3, 3), (15, 20), (27, 36)):
        seen = rows[205 + 10 * row, 105 + 10 * column]
        np.testing.assert_allclose(seen, wanted[row, column], atol=1.5 / 255.0)
    assert (rows[890:960, 1060:1160].min(axis=2) < 0.5).sum() > 100, "letters that Helvetica lacks are drawn"


def test_pdf_of_a_card_holds_the_numbers(solved, tmp_path):
    reader = pytest.importorskip("pypdf")
    wanted = {f"{solved.force_n:.1f} N", f"{solved.peak_kpa:.0f} kPa"}
    pdf.save(tmp_path / "card.pdf", drawn(orders.CARD))
    lines = set(reader.PdfReader(tmp_path / "card.pdf", strict=True).pages[0].extract_text().splitlines())
    assert wanted <= lines


def test_places_in_a_pdf_are_where_its_table_says(tmp_path):
    """The table of objects, read here as the format says it is written (ISO 32000-1, 7.5.4)."""
    data = pdf.written(page_of_pdf())
    start = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", data)[1])
    rows = re.findall(rb"(\d{10}) 00000 n \n", data[start:])
    assert rows and all(data[int(row) :].startswith(b"%d 0 obj\n" % number) for number, row in enumerate(rows, 1))
    assert all(
        int(size) == len(body) for size, body in re.findall(rb"/Length (\d+) >>\nstream\n(.*?)\nendstream", data, re.S)
    )


def test_order_survives_its_text():
    order = orders.Order(orders.CARD, "a.png", 300, 3, True, True, "Scene")
    again = orders.from_text(orders.to_text(order))
    assert json.loads(orders.to_text(again)) == json.loads(orders.to_text(order))
    assert [path.suffix for path in orders.targets(again)] == [".png", ".pdf"] and Path(again.target).name == "a.png"


def test_hands_of_a_card_hold_the_product_by_the_kind_of_the_middle_one(solved, tmp_path, monkeypatch):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "card.blend"))
    asked = []

    def as_it_stands(context, shape, kind):
        asked.append((shape["percentile"], kind))
        context.scene.thenar_grasps.found.add().kind = "PINCH"
        return laying.gather(context)

    monkeypatch.setattr(sizes, "_solved", as_it_stands)
    order = orders.Order(orders.CARD, "x.png", **SMALL)
    found = sizes.drawn(order, bpy.context, (200.0, 200.0), orders.Progress(order))
    assert asked[0] == (50.0, "AUTO")
    assert sorted(asked[1:]) == [(5.0, "PINCH"), (95.0, "PINCH")]
    assert [hand.percentile for hand in found] == [5, 50, 95]


def test_hand_of_a_card_has_the_numbers_of_the_buttons(blender_scene_of_a_bar, tmp_path, monkeypatch):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "bar.blend"))
    monkeypatch.setattr(sizes, "PERCENTILES", (50,))
    order = orders.Order(orders.CARD, "x.png", **SMALL)
    found = sizes.drawn(order, bpy.context, (200.0, 200.0), orders.Progress(order))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "bar.blend"))
    bpy.ops.thenar.fit_grasp(strength="FIRM")
    bpy.ops.thenar.solve()
    result = bpy.context.scene.thenar.result
    assert found[0].summary.startswith(f"{result.force_n:.1f} N")
    assert found[0].problem == "" and found[0].pixels.shape[2] == 3


@pytest.fixture
def blender_scene_of_a_bar():
    """A made hand and a round bar of 34 mm."""
    from handles import grasping, shapes

    bpy.ops.thenar.make_hand(percentile=50.0)
    bar = shapes.revolved(np.array([0.0, 17.0, 17.0, 0.0]), np.array([-70.0, -70.0, 70.0, 70.0]), 48)
    bpy.context.scene.thenar.product = grasping._add(bar, (0, 0, 0))
