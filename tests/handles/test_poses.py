"""The pose library as anatomy: thumb against fingers, no joint bent back, no skin in skin. Measured in Blender."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")
addon = pytest.importorskip("thenar_blender")

from handles import anatomy, grasping  # noqa: E402

POWER = ("power_48", "power_60", "power_100")
POSES = ("flat", "open", "relaxed", *POWER, "pinch", "precision", "fingertip_press", "palm_press")
FACING_DEG = 25.0


@pytest.fixture(scope="module")
def hands():
    """Per pose: the numbers of `anatomy.of`, angles and distances between pads, and how far the thumb pronates."""
    addon.register()
    out = {}
    for pose in POSES:
        bpy.ops.wm.read_homefile(use_empty=True)
        bpy.ops.thenar.make_hand(percentile=50)
        hand = bpy.context.scene.thenar.hand
        bpy.ops.thenar.apply_pose(name=pose)
        surface = grasping.seen(hand)
        out[pose] = anatomy.of(hand, *surface) | {
            "index": anatomy.facing(hand, surface, "thumb", ("index",)),
            "both": anatomy.facing(hand, surface, "thumb", ("index", "middle")),
            "back": anatomy.facing(hand, surface, "index", ("thumb",)),
            "pronated_deg": pronated(hand.parent.pose.bones["thumb_metacarpal"]),
        }
    yield out
    addon.unregister()


def pronated(bone):
    """Turn of a right thumb's first bone about its own length from rest, degrees, positive as the pad turns inward."""
    turn = bone.matrix_basis.to_quaternion()
    return -2.0 * float(np.degrees(np.arctan2(turn.y, turn.w)))


@pytest.mark.parametrize("pose", POSES)
def test_no_pose_bends_a_last_joint_back_or_puts_skin_in_skin(hands, pose):
    assert hands[pose]["dip_back_deg"] <= 0.5 and hands[pose]["in_skin"] == 0, hands[pose]


@pytest.mark.parametrize("pose", sorted(set(POSES) - {"flat", "palm_press", "fingertip_press"}))
def test_the_thumb_pronates_wherever_it_opposes(hands, pose):
    """In the relaxed hand too: its nail faces out, its pad toward the fingers."""
    assert hands[pose]["pronated_deg"] >= 8.0, hands[pose]


def test_a_pinch_meets_with_its_pads(hands):
    (angle, apart), back = hands["pinch"]["index"], hands["pinch"]["back"][0]
    assert angle <= FACING_DEG and back <= 45.0, hands["pinch"]
    assert apart <= 2.0, hands["pinch"]


def test_a_precision_grip_waits_for_a_small_object_between_thumb_and_two_fingers(hands):
    angle, apart = hands["precision"]["both"]
    assert angle <= FACING_DEG, hands["precision"]
    assert 4.0 <= apart <= 15.0, hands["precision"]


@pytest.mark.parametrize("pose", POWER)
def test_in_a_power_grip_the_thumb_faces_the_fingers(hands, pose):
    assert hands[pose]["index"][0] <= FACING_DEG, hands[pose]


def test_the_relaxed_thumb_is_turned_to_the_index_finger(hands):
    assert hands["relaxed"]["index"][0] < 80.0 and hands["relaxed"]["back"][0] < 40.0, hands["relaxed"]
