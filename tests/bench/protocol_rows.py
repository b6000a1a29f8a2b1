"""The rows of protocols: ten seconds of a fingertip, a held force beside its depths, a row on the whole hand."""

import numpy as np
import thenar
from bench.rows import Row, at_most
from bench.timing import cpu_ms, once_ms
from proof import meshes

FINGERTIP, RATE_HZ, DURATION_S = 234, 100, 10.0
ROWS = 40
RELAXATION = thenar.Effect("relaxation", 0.35)
FRICTION = thenar.Effect("friction", 1.0)


def fingertip(effects=()):
    """A fingertip of `FINGERTIP` vertices with a bone inside, and the plate above it."""
    vertices, triangles = meshes.ellipsoid((8.0, 10.0, 7.0), FINGERTIP)
    material = thenar.Material.finger_layer()
    skin = thenar.Skin(vertices, triangles, materials=material, effects=list(effects))
    return skin, thenar.Product(*meshes.box((-15.0, -15.0, 7.0), (15.0, 15.0, 12.0)))


def presses():
    """Times and depths of three presses, holds and releases in `DURATION_S`."""
    time = np.arange(0.0, DURATION_S, 1.0 / RATE_HZ)
    depth = 1.5 * np.clip(1.5 * np.sin(2.0 * np.pi * 0.3 * time), -0.1, 1.0)
    return time, depth


def fingertip_rows():
    """A protocol of `DURATION_S` at `RATE_HZ` against the second that it is wanted in."""
    time, depth = presses()
    rows = []
    for name, effects in (("relaxation", [RELAXATION]), ("relaxation and friction", [RELAXATION, FRICTION])):
        skin, plate = fingertip(effects)
        slide = np.zeros((len(time), 3))
        slide[:, 0] = 0.2 * np.sin(2.0 * np.pi * 0.5 * time)
        protocol = {"time_s": time, "depth_mm": depth, "slide_mm": slide}
        ours, course = once_ms(lambda s=skin, p=plate, q=protocol: s.run(q, p, direction=(0, 0, -1)))
        if not course.has_converged.all() or course.force_n.max() < 0.1:
            raise AssertionError(f"the protocol with {name} did not converge")
        what = f"protocol, {DURATION_S:g} s at {RATE_HZ} Hz, {FINGERTIP} vertices, {name}"
        note = f"up to {course.force_n.max():.2f} N on {course.contact_area_mm2.max():.0f} mm2"
        ratio = ours / 1000.0
        rows.append(Row(what, "one second", ours, 1000.0, ratio, "<= 1x", ratio <= 1.0, note))
    return rows


def held_rows():
    """A held force beside the same offsets given: how many presses a row of it costs."""
    skin, plate = fingertip([RELAXATION])
    time = np.arange(0.0, 3.0, 0.03)
    force = np.minimum(1.0, 0.02 + 2.0 * time)

    def held():
        return skin.run({"time_s": time, "force_n": force}, plate, direction=(0, 0, -1))

    course = held()
    if np.abs(course.force_n - force).max() > 2e-5:
        raise AssertionError("the held force was not held")
    given = {"time_s": time, "offset_mm": course.offset_mm}
    theirs = cpu_ms(lambda: skin.run(given, plate, direction=(0, 0, -1)), 3)
    what = f"held force, {len(time)} rows, {FINGERTIP} vertices, relaxation"
    return [at_most(what, "the offsets found, given", (cpu_ms(held, 3), theirs), 3)]


def hand_rows(hand):
    """A row of a protocol on the whole hand beside a warm press of the same moves."""
    product = thenar.Product(*hand.handle)
    skin = thenar.Skin(hand.rest, hand.triangles, regions=hand.regions, materials=hand.materials)
    poses = [hand.posed, hand.posed + [0.0, 0.0, 0.05]]
    turn = iter(range(10**9))

    def press():
        return skin.press(product, posed_vertices_mm=poses[next(turn) % 2], warm_start=True)

    rows, warm = [], cpu_ms(press, 15)
    what = f"a row of a protocol, {len(hand.rest):,} vertices, moves of 0.05 mm"
    for name, effects in (
        ("no effect", []),
        ("relaxation", [RELAXATION]),
        ("relaxation, friction", [RELAXATION, FRICTION]),
    ):
        skin.set_effects(effects)

        def run(count):
            moves = np.where(np.arange(count) % 2, -0.05, 0.0)
            slide = np.outer(np.arange(count), [0.02, 0.0, 0.0])
            protocol = {"time_s": 0.02 * np.arange(count), "offset_mm": moves, "slide_mm": slide}
            return skin.run(protocol, product, posed_vertices_mm=hand.posed, direction=(0, 0, 1))

        run(2)
        first, _ = once_ms(lambda: run(1))
        whole, course = once_ms(lambda: run(1 + ROWS))
        if not course.has_converged.all():
            raise AssertionError(f"the protocol with {name} did not converge on the hand")
        each = (whole - first) / ROWS
        rows.append(at_most(f"{what}, {name}", "a warm press, no effect", (each, warm), 1.5))
    return rows


def protocol_rows(hand):
    """All of them."""
    return fingertip_rows() + held_rows() + hand_rows(hand)
