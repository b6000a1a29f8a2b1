"""A fresh file with the add-on registered for every test, and hands and products to use in it."""

import pytest

bpy = pytest.importorskip("bpy")
thenar = pytest.importorskip("thenar")
addon = pytest.importorskip("thenar_blender")


@pytest.fixture
def blender():
    """An empty file with the add-on registered; unregistered afterwards, or bpy 4.5 never exits."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    yield bpy
    addon.unregister()


@pytest.fixture(scope="session")
def made():
    """Arrays of the median hand."""
    return thenar.hand()


@pytest.fixture
def hand(blender, made):
    """The median hand in the scene: `(mesh object, armature object)`."""
    from thenar_blender.hand import build

    pair = build.add_hand(bpy.context, made)
    bpy.context.scene.thenar.hand = pair[0]
    bpy.context.view_layer.update()
    return pair


@pytest.fixture(scope="session")
def arrays(made):
    """The median hand without Blender: `fitter.Hand`."""
    from thenar_blender.grasp_fit import fitter
    from thenar_blender.hand import capsules, model, pads

    rig = model.rig_of(made)
    joints = model.joints_of(made, rig)
    return fitter.Hand(
        rig, joints, pads.pads_of(rig, joints, model.skin_of(made)), capsules.build(rig, joints, model.tails_of(made))
    )
