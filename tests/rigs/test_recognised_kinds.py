"""Rigs of 19 kinds are recognised by shape: whole bodies, both hands, any axes, any unit, names taken away."""

import numpy as np
import pytest
from bodies import DIGITS
from makers import KINDS

pytest.importorskip("bpy")
from thenar_blender.rigs.chains import Skeleton  # noqa: E402
from thenar_blender.rigs.recognise import recognise  # noqa: E402

TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def skeleton(made):
    return Skeleton(*made.arrays())


def nameless(given):
    return Skeleton(tuple(f"Bone.{k:03}" for k in range(len(given.names))), given.parents, given.heads, given.skin)


def shuffled(given, seed=4):
    """The same bones in another order: `(skeleton, order)`."""
    order = np.random.default_rng(seed).permutation(len(given.names))
    place = np.argsort(order)
    parents = np.array([-1 if given.parents[k] < 0 else place[given.parents[k]] for k in order])
    return Skeleton(tuple(given.names[k] for k in order), parents, given.heads[order], given.skin[order]), order


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("side", ["right", "left"])
def test_every_bone_of_both_hands(kind, side):
    made = KINDS[kind]()
    found = recognise(skeleton(made), side)
    assert found.chosen is not None, found.missing()
    assert found.chosen.side == side
    assert found.chosen.roles == made.truth[side]
    assert len(found.hands) == 2
    assert found.chosen.remarks == ()


@pytest.mark.parametrize("kind", sorted(set(KINDS) - {"openxr_flat"}))
def test_names_taken_away_order_axes_and_unit_changed(kind):
    made = KINDS[kind]()
    given, order = shuffled(skeleton(made))
    bare = nameless(given)
    turned = Skeleton(bare.names, bare.parents, 0.00001 * bare.heads @ TURN.T + 3.0, bare.skin)
    found = recognise(turned)
    back = {hand.side: {r: given.names[bare.names.index(n)] for r, n in hand.roles.items()} for hand in found.hands}
    assert back == made.truth


@pytest.mark.parametrize("kind", ["makehuman", "mixamo", "daz8", "smplx"])
def test_a_mirrored_body_swaps_its_sides(kind):
    made = KINDS[kind]()
    bare = nameless(skeleton(made))
    mirrored = Skeleton(bare.names, bare.parents, bare.heads * [-1.0, 1.0, 1.0], bare.skin)
    straight = {hand.side: hand.roles for hand in recognise(bare).hands}
    swapped = {hand.side: hand.roles for hand in recognise(mirrored).hands}
    assert straight["right"] == swapped["left"] and straight["left"] == swapped["right"]


@pytest.mark.parametrize("kind", ["makehuman", "vroid"])
def test_the_hand_that_carries_the_mesh_is_chosen(kind):
    """A glove on a whole body's armature: only one hand's bones carry skin."""
    made = KINDS[kind]()
    names, parents, heads, skin = made.arrays()
    only = set(made.truth["left"].values())
    found = recognise(Skeleton(names, parents, heads, skin * [name in only for name in names]))
    assert found.chosen.roles == made.truth["left"] and len(found.hands) == 1 and found.sentence() == ""


def test_of_two_alike_the_right_one_and_it_is_said():
    found = recognise(skeleton(KINDS["mixamo"]()))
    assert found.chosen.side == "right"
    assert found.sentence() == "2 hands found, the right one is used; see Side"


def test_shape_goes_before_names_and_it_is_said():
    """Index and little finger's names exchanged: the bones are where they are."""
    made = KINDS["unity"]()
    names, parents, heads, skin = made.arrays()
    swap = {"Index": "Little", "Little": "Index"}
    wrong = tuple(next((n.replace(a, b) for a, b in swap.items() if a in n), n) for n in names)
    found = recognise(Skeleton(wrong, parents, heads, skin), "left")
    assert found.chosen.roles["index_proximal"] == "LeftLittleProximal"
    assert "'LeftLittleProximal' is named little, but lies where the index is" in found.sentence()


@pytest.mark.parametrize("digits", [("thumb", "index", "middle", "ring"), ("thumb", "index", "middle", "little")])
def test_a_hand_of_four_digits(digits):
    """Names say which finger is lacking; without names it is the last."""
    made = KINDS["mixamo"]()
    names, parents, heads, skin = made.arrays()
    gone = {name for side in made.truth.values() for role, name in side.items() if role.partition("_")[0] not in digits}
    gone -= {made.truth[side]["wrist"] for side in made.truth}
    given = Skeleton(names, parents, heads, skin * [name not in gone for name in names])
    found = recognise(given, "right").chosen
    want = {role: name for role, name in made.truth["right"].items() if name not in gone}
    assert found.roles == want
    assert found.remarks == (f"4 digits: {', '.join(digits)}",)
    bare = recognise(nameless(given)).hands
    assert all({role.partition("_")[0] for role in hand.roles} == {"wrist", *DIGITS[:4]} for hand in bare)


@pytest.mark.parametrize("part", ["toe", "Hair", "Skirt"])
@pytest.mark.parametrize("has_names", [True, False])
def test_feet_hair_and_skirts_are_no_hands(part, has_names):
    made = KINDS["makehuman" if part == "toe" else "vroid"]()
    names, parents, heads, skin = made.arrays()
    given = Skeleton(names, parents, heads, skin * [part.lower() in name.lower() for name in names])
    found = recognise(given if has_names else nameless(given))
    assert found.chosen is None and found.hands == ()
    assert "not taken for a hand" in found.missing()
    if has_names:
        assert "names say" in found.missing()


def test_two_chains_are_no_hand():
    made = KINDS["unity"]()
    names, parents, heads, skin = made.arrays()
    given = Skeleton(names, parents, heads, skin * [name.startswith(("RightIndex", "RightThumb")) for name in names])
    assert recognise(given).missing() == "no bone that carries this mesh has three or more chains of bones below it"


def test_a_flat_unbent_hand_has_no_side_without_names():
    """A plane hand whose thumb lies in its plane is its own mirror image turned over: no side is made up."""
    made = KINDS["smplx"]()
    names, parents, heads, skin = made.arrays()
    keep = [name in set(made.truth["right"].values()) for name in names]
    flat = heads * [1.0, 1.0, 0.0]
    found = recognise(nameless(Skeleton(names, parents, flat, skin * keep)))
    assert [hand.side for hand in found.hands] == [None] or found.chosen is None
