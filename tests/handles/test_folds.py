"""Skin that folds where fingers bend: no side of a crease runs into the other. Measured by code of its own."""

import numpy as np
import pytest
import thenar
from handles import anatomy
from thenar_blender.hand import model, poses, skinning
from thenar_blender.hand_bones import roles

BENT = {
    "knuckles": (88, 0, 0),
    "middle joints": (0, 100, 0),
    "last joints": (0, 60, 75),
    "around a bar of 30 mm": (65, 80, 45),
    "around a bar of 60 mm": (45, 60, 35),
}
"""Degrees of MCP, PIP and DIP of all four fingers, up to the joints' limits; no finger reaches the palm in them."""


@pytest.fixture(scope="module", params=[("male", 50.0), ("female", 5.0), ("male", 95.0)], ids=str)
def made(request):
    """Arrays of a made hand."""
    sex, percentile = request.param
    return thenar.hand(sex=sex, percentile=percentile)


@pytest.mark.parametrize("name", BENT)
def test_no_skin_of_bent_fingers_lies_in_other_skin(made, name):
    points = bent(made, BENT[name])
    assert anatomy._in_skin(points, np.asarray(made["triangles"])) == 0


def bent(made, angles):
    """Vertices (n, 3) of the made hand with all fingers bent by `angles`, the thumb out of their way."""
    rig = model.rig_of(made)
    joints = model.joints_of(made, rig)
    pose = {**poses._fingers(*[(0, *angles)] * 4), **poses._thumb((-10, 0, 0), 0, 0)}
    return skinning.skin(rig, skinning.pose_matrices(rig, roles.pose_angles(rig, joints, pose)))
