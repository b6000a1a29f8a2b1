"""One skin pressed by several threads at once: presses overlap, and each gets the bits that it gets alone."""

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pressing_shapes as shapes
import pytest
import thenar

SHEET = shapes.sheet(25, 0.8, 0.2)
BALLS = [thenar.Product(*shapes.ball(9.0, (x, 0.0, 9.0 - depth), 24)) for x, depth in ((-1.0, 0.9), (1.5, 0.6))]
# So long that it ends when it is stopped.
ENDLESS = {"time_s": np.arange(200_000.0), "depth_mm": 0.5 + 0.1 * np.sin(np.arange(200_000.0))}


class Running:
    """A protocol that runs on `skin` in a thread of its own from when the block begins until it ends."""

    def __init__(self, skin):
        self.skin, self.begun, self.stop, self.ended = skin, threading.Event(), threading.Event(), None

    def __enter__(self):
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()
        assert self.begun.wait(60.0)
        return self

    def __exit__(self, *raised):
        self.stop.set()
        self.thread.join()

    def run(self):
        try:
            self.skin.run(ENDLESS, BALLS[0], cancel=self.stop, progress=self.tell)
            self.ended = "by itself"
        except thenar.Cancelled:
            self.ended = "stopped"

    def tell(self, stage, fraction):
        if stage == "protocol":
            self.begun.set()


def numbers(contact):
    return [contact.pressure_mpa, contact.displacement_mm, contact.total_force_n, contact.gap_mm]


def same(ours, wanted):
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(numbers(ours), numbers(wanted), strict=True))


def presses(skin, product):
    """From nothing, warm, and as Live does, each in a posture of its own."""
    lifted = np.linspace(0.0, 0.1, 3)[:, None, None] * (0, 0, 1) + SHEET[0]
    hows = [{}, {"warm_start": True}, {"live": True}]
    return [skin.press(product, posed_vertices_mm=posed, **how) for posed, how in zip(lifted, hows, strict=True)]


def test_presses_of_one_skin_overlap():
    skin = thenar.Skin(*SHEET)
    alone = skin.press(BALLS[1])
    with Running(skin) as running:
        assert same(skin.press(BALLS[1]), alone)
        walk = skin.start(BALLS[1])
        assert walk.advance(0.0, depth_mm=0.4).total_force_n[2] != 0
        assert running.ended is None
    assert running.ended == "stopped"


def test_threads_get_the_bits_that_each_gets_alone():
    fresh = {"warm_start": False}
    alone = [thenar.Skin(*SHEET).press(product, **fresh) for product in BALLS]
    skin, barrier = thenar.Skin(*SHEET), threading.Barrier(len(BALLS))

    def press(product):
        barrier.wait()
        return [skin.press(product, **fresh) for _ in range(5)]

    with ThreadPoolExecutor(len(BALLS)) as pool:
        for contacts, wanted in zip(pool.map(press, BALLS), alone, strict=True):
            assert all(same(contact, wanted) for contact in contacts)


def test_in_one_thread_presses_go_on_from_each_other_as_on_a_skin_of_its_own():
    skin, other = thenar.Skin(*SHEET), thenar.Skin(*SHEET)
    ours = presses(skin, BALLS[0])
    with Running(other):
        meanwhile = presses(other, BALLS[0])
    assert all(same(a, b) for a, b in zip(ours, meanwhile, strict=True))


def test_a_warm_start_begins_at_the_last_result_in_whatever_workspace():
    skin = thenar.Skin(*SHEET)
    skin.press(BALLS[0])
    pivots = skin.press(BALLS[1]).convergence.pivots
    with Running(skin):  # it runs in the workspace of the press before
        assert skin.press(BALLS[1], warm_start=True).convergence.pivots < pivots


def test_a_change_of_effects_leaves_what_runs_as_it_began():
    skin = thenar.Skin(*SHEET)
    walk = skin.start(BALLS[0])
    with Running(skin) as running:
        skin.set_effects([thenar.Effect("bone", 0.5)])
        assert [effect.name for effect in skin.effects] == ["bone"]
        changed = skin.press(BALLS[0])
        assert running.ended is None
    assert same(changed, thenar.Skin(*SHEET, effects=[thenar.Effect("bone", 0.5)]).press(BALLS[0]))
    with pytest.raises(thenar.SolveError, match="effects have changed"):
        walk.advance(0.0, depth_mm=0.4)


@pytest.mark.parametrize("name", ["friction", "bone"])
def test_a_skin_with_other_effects_is_one_prepared_with_them(name):
    skin, effects = thenar.Skin(*SHEET), [thenar.Effect(name, 0.5)]
    bare = skin.press(BALLS[0], slide_mm=(0.1, 0, 0))
    derived = skin.with_effects(effects)
    assert not skin.effects and derived.effects[0].name == name
    ours, wanted = (
        each.press(BALLS[0], slide_mm=(0.1, 0, 0)) for each in (derived, thenar.Skin(*SHEET, effects=effects))
    )
    assert same(ours, wanted)
    assert same(skin.press(BALLS[0], slide_mm=(0.1, 0, 0)), bare)
    derived.set_effects([])
    assert same(derived.press(BALLS[0], slide_mm=(0.1, 0, 0)), bare)
    skin.set_effects(effects)
    assert not derived.effects


def test_a_run_with_other_effects_leaves_those_of_the_skin():
    skin = thenar.Skin(*SHEET, effects=[thenar.Effect("friction")])
    protocol = {"time_s": [0.0, 1.0], "depth_mm": [0.2, 0.5]}
    ours = skin.run(protocol, BALLS[0], effects=[thenar.Effect("bone", 0.5)])
    wanted = thenar.Skin(*SHEET, effects=[thenar.Effect("bone", 0.5)]).run(protocol, BALLS[0])
    assert np.array_equal(ours.force_n, wanted.force_n)
    assert [effect.name for effect in skin.effects] == ["friction"]
