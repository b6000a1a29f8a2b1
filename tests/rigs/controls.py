"""What a control rig does to its bones: where they stand, and which of their constraints act."""

import numpy as np


def matrices(rig):
    return {bone.name: np.array(bone.matrix) for bone in rig.pose.bones}


def holding(rig):
    """`(bone, constraint)` names of all that act."""
    return {(bone.name, each.name) for bone in rig.pose.bones for each in bone.constraints if not each.mute}


def assert_same(first, second, far=1e-5):
    assert first.keys() == second.keys()
    for name, matrix in first.items():
        assert np.abs(matrix - second[name]).max() < far, name
