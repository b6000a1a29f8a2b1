"""The bone under the skin of a rigged hand: mirrored with the hand, and named where the rig does not tell it."""

from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np
import pytest
import stage
from mathutils import Matrix
from thenar_blender.reference import certify, notes

SAMPLE = Path(__file__).parents[3] / "blend-samples" / "fingertip_on_plate.blend"


def opened(mirror=(1.0, 1.0, 1.0), flips=False):
    """The sample solved, its rig and product scaled; the tissue that the reference solve is given."""
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    settings = bpy.context.scene.thenar
    for obj in (settings.hand.parent, settings.product):
        obj.matrix_world = Matrix.Diagonal((*mirror, 1.0)) @ obj.matrix_world
    if flips:
        settings.hand.data.flip_normals()
    bpy.context.view_layer.update()
    return solved()


def solved():
    stage.solve()
    with ExitStack() as taken:
        return certify.read(bpy.context, taken)


@pytest.mark.parametrize(("mirror", "flips"), [((-1.0, 1.0, 1.0), False), ((-1.0, -1.0, -1.0), True)])
def test_a_mirrored_hand_has_mirrored_tissue(mirror, flips):
    """The same tissue and product but mirrored: the reference solve of it has the same force."""
    plain, mirrored = opened(), opened(mirror, flips)
    assert plain.bones_note == mirrored.bones_note == ""
    origin = plain.job.reading.hand.origin_mm * mirror - mirrored.job.reading.hand.origin_mm
    for name in ("posed_mm", "bone_mm", "product_mm"):
        assert getattr(mirrored, name) == pytest.approx(getattr(plain, name) * mirror + origin, abs=1e-3), name
    assert volume(mirrored) == pytest.approx(volume(plain), rel=1e-4), "the triangles face outward"
    assert np.array_equal(mirrored.held, plain.held)


def volume(tissue):
    a, b, c = (tissue.posed_mm[tissue.triangles[:, corner]] for corner in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def test_a_constraint_on_a_bone_leaves_the_bones_known():
    expected = opened().bone_mm
    rig = bpy.context.scene.thenar.hand.parent
    for bone in rig.pose.bones:
        bone.constraints.new("COPY_ROTATION").influence = 0.5  # no target: it does nothing
    tissue = solved()
    assert tissue.bones_note == "" and tissue.bone_mm == pytest.approx(expected, abs=1e-3)


def test_bones_that_are_not_known_are_named():
    hand, _ = stage.scene()
    stage.bend(hand)
    tissue = solved()
    assert "bone" in tissue.bones_note
    found = type("Record", (), {"folded": [], "cut_mm": 0.0, "sideways_share": 0.0, "pressure_mpa": np.zeros(642)})
    (note,) = notes.of(tissue, found)
    assert note.startswith("the bones of the rig are not known: ") and tissue.bones_note in note
