"""Rigs that are not ours: other names, rolls, rest axes and hierarchy, as exchange files and game rigs bring them."""

import bpy
import numpy as np
import pytest
from hand_scenes import evaluated_mm, with_cylinder
from mathutils import Vector
from thenar_blender.grasp import fitting
from thenar_blender.grasp_fit import walls
from thenar_blender.hand import build, pads
from thenar_blender.hand_bones import bonemap, reading, roles

MM = 1e-3


def rename_and_roll(rig):
    """Our own rig under a common naming scheme, every bone rolled, no limits, quaternions."""
    renamed = {"carpus": "hand.R", "thumb_metacarpal": "thumb.01.R", "thumb_proximal": "thumb.02.R"}
    renamed["thumb_distal"] = "thumb.03.R"
    for finger in roles.FINGERS:
        renamed[f"{finger}_metacarpal"] = f"palm.{finger}.R"
        for k, segment in enumerate(("proximal", "middle", "distal")):
            renamed[f"{finger}_{segment}"] = f"f_{'pinky' if finger == 'little' else finger}.0{k + 1}.R"
    for old, new in renamed.items():
        rig.data.bones[old].name = new
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in rig.data.edit_bones:
        bone.roll += 0.7
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in rig.pose.bones:
        bone.rotation_mode = "QUATERNION"
        for constraint in list(bone.constraints):
            bone.constraints.remove(constraint)
    bonemap.set_map(rig, {}, "AUTO")


def exchanged(made):
    """The made hand's skin on a rig as an exchange file brings it: `(hand, rig)`.

    All bones stand up along world Z whatever their segment does, each with a roll of its own; no metacarpals but the
    thumb's, whose weights the hand bone carries; a forearm with a twist bone above, a spacer between hand and every
    finger, and end bones behind the tips; the armature scaled by 0.01 and turned.
    """
    hand, old = build.add_hand(bpy.context, made)
    heads = {bone["name"]: np.array(bone["head_mm"]) for bone in made["bones"]}
    tails = {bone["name"]: np.array(bone["tail_mm"]) for bone in made["bones"]}
    data = bpy.data.armatures.new("Exchange")
    rig = bpy.data.objects.new("Exchange", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rolls = iter(np.random.default_rng(5).uniform(-3.0, 3.0, 60))

    def add(name, place_mm, parent, deforms=True):
        bone = data.edit_bones.new(name)
        bone.head = Vector(place_mm * 100.0 * MM)
        bone.tail = bone.head + Vector((0.0, 0.0, 1.2))
        bone.roll, bone.use_deform = next(rolls), deforms
        bone.parent = data.edit_bones.get(parent)

    names = {}
    below = np.array([0.0, -220.0, 0.0])
    add("RightForeArm", below, "")
    add("RightForeArmTwist", 0.5 * below, "RightForeArm", deforms=False)
    add("RightHand", heads["carpus"], "RightForeArm")
    names["carpus"] = "RightHand"
    for digit in ("thumb", *roles.FINGERS):
        segments = ("metacarpal", "proximal", "distal") if digit == "thumb" else ("proximal", "middle", "distal")
        add(f"{digit}Spacer", 0.5 * (heads["carpus"] + heads[f"{digit}_{segments[0]}"]), "RightHand", deforms=False)
        parent = f"{digit}Spacer"
        for k, segment in enumerate(segments, 1):
            name = f"RightHand{'Pinky' if digit == 'little' else digit.capitalize()}{k}"
            add(name, heads[f"{digit}_{segment}"], parent)
            names[f"{digit}_{segment}"] = parent = name
        add(f"{parent}_end", tails[f"{digit}_distal"], parent, deforms=False)
        names.setdefault(f"{digit}_metacarpal", "RightHand")
    bpy.ops.object.mode_set(mode="OBJECT")
    merge_groups(hand, names)
    rig.scale = (0.01, 0.01, 0.01)
    hand.parent = None
    hand.modifiers[0].object = rig
    bpy.data.objects.remove(old)
    for obj in (hand, rig):
        obj.rotation_euler = (0.4, -0.3, 1.0)
    bpy.context.view_layer.update()
    return hand, rig


def merge_groups(hand, names):
    """Rename bone groups; several that come together under one name add their weights."""
    for old, new in names.items():
        group = hand.vertex_groups[old]
        target = hand.vertex_groups.get(new) or hand.vertex_groups.new(name=new)
        for vertex in hand.data.vertices:
            for share in vertex.groups:
                if share.group == group.index and share.weight > 0.0:
                    target.add([vertex.index], share.weight, "ADD")
        hand.vertex_groups.remove(group)


def check_grasp(context, hand):
    """Fit a light grasp; the pads reach their depths, and the scene shows what was fitted."""
    before = evaluated_mm(hand)
    product, job = with_cylinder(context, hand)
    found = fitting.compute(job)
    fitting.finish(context, job, found, "HAND")
    misses = [abs(found.depths_mm[name] - want) for name, want in found.targets_mm.items()]
    assert np.median(misses) < 0.6
    gap = walls.Gauge(job.product, is_thin=False).gaps(evaluated_mm(hand))
    for pad in job.hand.pads:
        assert pads.pad_depth(gap[pad.rows]) == pytest.approx(found.depths_mm[pad.name], abs=0.02)
    return before, found


def test_other_names_and_rolls(blender, hand):
    mesh, rig = hand
    rename_and_roll(rig)
    assert blender.ops.thenar.guess_bones() == {"FINISHED"}
    assert bonemap.get_map(rig)["little_middle"] == "f_pinky.02.R"
    assert len(bonemap.get_map(rig)) == len(roles.ROLES)
    check_grasp(blender.context, mesh)


def test_other_axes_and_hierarchy(blender, made):
    context = blender.context
    mesh, rig = exchanged(made)
    context.scene.thenar.hand = mesh
    assert blender.ops.thenar.guess_bones() == {"FINISHED"}
    found = bonemap.get_map(rig)
    assert found["little_middle"] == "RightHandPinky2" and found["thumb_metacarpal"] == "RightHandThumb1"
    assert found["wrist"] == "RightHand" and not any(role == "index_metacarpal" for role in found)
    _, grasp = check_grasp(context, mesh)
    assert len(grasp.targets_mm) == 19


def test_bones_drawn_elsewhere_flex_about_the_same_axes(blender, made):
    """On both rigs a joint turns about the same line in the hand: it is the joints that say it, not the drawing."""
    own, own_rig = build.add_hand(bpy.context, made)
    bonemap.set_map(own_rig, bonemap.get_map(own_rig), "AUTO")
    ours, _ = reading.read_rig(bpy.context, own)
    known = roles.resolve(ours, bonemap.get_map(own_rig))
    bpy.data.objects.remove(own)
    mesh, _ = exchanged(made)
    theirs, names = reading.read_rig(bpy.context, mesh)
    joints = roles.resolve(theirs, names)
    for role in ("index_proximal", "ring_middle", "little_distal", "thumb_proximal"):
        one = roles.flexion_axis(ours, known.bones[role])
        other = roles.flexion_axis(theirs, joints.bones[role])
        assert abs(one @ other) > np.cos(np.radians(12.0)), role
        assert one @ other > 0.0, role
    assert joints.side == known.side == 1.0
