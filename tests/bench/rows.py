"""The rows of the benchmark: each measures Thenar and a reference in one run; both must give the same answer."""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import results
import thenar
from bench.peers import debian, lemke, problems, siconos
from bench.timing import cpu_ms, once_ms

TARGET = Path(__file__).parents[2] / "target"
CUT_MM = 8.0


@dataclass
class Row:
    """One line of the table. `ratio` is how many times faster, or how many times as long, see `wanted`."""

    what: str
    reference: str
    ours_ms: float
    reference_ms: float
    ratio: float
    wanted: str
    is_met: bool | None
    note: str = ""

    def as_dict(self):
        """For bench.json; what was not measured is null."""
        return {name: None if value != value else value for name, value in asdict(self).items()}

    def as_figure(self):
        """For RESULTS.md."""
        measured = f"{self.ratio:.2f}x ({self.ours_ms:.2f} ms, reference {self.reference_ms:.2f} ms)"
        return results.Figure(f"{self.what}, against {self.reference}", self.wanted, measured, self.is_met)


def faster(what, reference, times, wanted, note=""):
    """A row that wants Thenar `wanted` times faster than the reference."""
    ours, theirs = times
    ratio = theirs / ours
    return Row(what, reference, ours, theirs, ratio, f">= {wanted:g}x faster", ratio >= wanted, note)


def at_most(what, reference, times, wanted, note=""):
    """A row that wants Thenar to cost at most `wanted` times the reference."""
    ours, theirs = times
    ratio = ours / theirs
    return Row(what, reference, ours, theirs, ratio, f"<= {wanted:g}x the cost", ratio <= wanted, note)


def left_out(what, reference, why):
    """A row that could not be measured."""
    return Row(what, reference, float("nan"), float("nan"), float("nan"), "", None, why)


def dense_rows():
    """The dense problem of the paper's largest region, cold."""
    what = f"dense problem, N = {problems.VERTICES}, {problems.CONTACTS} contacts, cold"
    if not hasattr(thenar, "solve_complementarity"):
        return [left_out(what, "", "this build has no thenar.solve_complementarity")]
    matrix, gap = problems.palm()
    force = thenar.solve_complementarity(matrix, gap)
    if int((force > 0.0).sum()) != problems.CONTACTS:
        raise AssertionError(f"{int((force > 0.0).sum())} contacts instead of {problems.CONTACTS}")
    ours = cpu_ms(lambda: thenar.solve_complementarity(matrix, gap), 21)
    rows = []
    try:
        solve = siconos.prepare(siconos.load(TARGET), matrix, gap)
        agree(solve(), force)
        rows.append(faster(what, "siconos lexicolemke (Debian)", (ours, cpu_ms(solve, 5)), 100))
    except siconos.Unavailable as reason:
        rows.append(left_out(what, "siconos lexicolemke", str(reason)))
    agree(lemke.solve(matrix, gap), force)
    rows.append(faster(what, lemke.name(), (ours, cpu_ms(lambda: lemke.solve(matrix, gap), 5)), 20))
    return rows


def agree(theirs, ours):
    """Both solvers must have found the same forces."""
    difference = np.abs(theirs - ours).max() / ours.max()
    if difference > 1e-7:
        raise AssertionError(f"forces differ by {difference:.1e} of the largest")


def load_open3d():
    """The module Open3D, which asks for libusb even where no sensor is."""
    try:
        import open3d
    except ModuleNotFoundError:
        raise
    except (ImportError, OSError):
        debian.load(TARGET / "libusb", ["libusb-1.0-0"], "libusb-1.0.so.0")
        import open3d
    return open3d


def distance_rows(hand):
    """Signed distance of the grasping hand's points to the handle, in full and with a cut."""
    (vertices, triangles), points = hand.handle, hand.posed
    product = thenar.Product(vertices, triangles)
    full = cpu_ms(lambda: product.gap_mm(points))
    cut = cpu_ms(lambda: product.gap_mm(points, cut_off_mm=CUT_MM))
    what = f"signed distance, {len(points):,} points, {len(triangles):,} triangles"
    try:
        open3d = load_open3d()
    except (ImportError, OSError, debian.Unavailable) as error:
        return [left_out(what, "Open3D", str(error).splitlines()[0])]
    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(vertices.astype(np.float32), triangles.astype(np.uint32))
    query = open3d.core.Tensor(points.astype(np.float32))

    def theirs():
        return scene.compute_signed_distance(query, nthreads=1).numpy()

    distance = product.gap_mm(points)["gap_mm"]
    worst = np.abs(theirs() - distance).max()
    if worst > 1e-3:
        raise AssertionError(f"distances differ from Open3D's by {worst:.1e} mm")
    time = cpu_ms(theirs)
    near = int((np.abs(distance) < CUT_MM).sum())
    return [
        faster(f"{what}, in full", "Open3D", (full, time), 2),
        faster(f"{what}, {CUT_MM:g} mm cut", "Open3D in full", (cut, time), 5, f"{near:,} points within the cut"),
    ]


def press_rows(hand):
    """A warm press of the whole hand on the handle, beside its own distance query and its preparation."""
    product = thenar.Product(*hand.handle)

    def prepare():
        return thenar.Skin(hand.rest, hand.triangles, regions=hand.regions, materials=hand.materials)

    preparation, skin = cpu_ms(prepare, 3), prepare()
    poses = [hand.posed, hand.posed + [0.0, 0.0, 0.05]]
    turn = iter(range(10**9))
    cold_ms, contact = once_ms(lambda: skin.press(product, posed_vertices_mm=poses[1]))

    def press():
        return skin.press(product, posed_vertices_mm=poses[next(turn) % 2], warm_start=True)

    warm = cpu_ms(press, 15)
    query = cpu_ms(lambda: product.gap_mm(poses[1], cut_off_mm=CUT_MM), 15)
    full = cpu_ms(lambda: product.gap_mm(poses[1]), 15)
    note = (
        f"{int(contact.in_contact.sum())} contacts, {contact.force_n.sum():.0f} N, deepest "
        f"{-contact.gap_mm.min():.1f} mm; cold press {cold_ms:.1f} ms; the same query in full {full:.1f} ms"
    )
    what = f"warm press, {len(hand.rest):,} vertices, posture moved 0.05 mm"
    query_name = f"its own distance query, {CUT_MM:g} mm cut"
    return [
        at_most(what, query_name, (warm, query), 3, note),
        at_most(f"preparation, {len(hand.rest):,} vertices", query_name, (preparation, query), 20),
    ]
