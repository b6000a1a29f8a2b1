"""What a scene keeps of the target of its grasp: its kind, newtons by finger, and what was reached."""

import bpy
from bpy.props import CollectionProperty, EnumProperty, FloatProperty, PointerProperty, StringProperty

TOTAL, FINGERS, RECORDING = "TOTAL", "FINGERS", "RECORDING"
KINDS = (
    (TOTAL, "Total Force", "The sum of forces over the skin, in balance with a weight"),
    (FINGERS, "Force by Finger", "A force for each finger and the palm"),
    (RECORDING, "Recording", "What the chosen recording of a mat read: the posture that explains it best"),
)
MOST_N = 500.0


def _newtons(part):
    return FloatProperty(
        name=f"{part} (N)",
        description="Sum of forces that the skin of this part shall carry, N; 0: any",
        min=0.0,
        max=MOST_N,
        soft_max=100.0,
    )


class ThenarTargetRow(bpy.types.PropertyGroup):
    """What one part of the hand carried at the end; `name` is the part, `reason` as in `reasons`."""

    wanted_n: FloatProperty()
    reached_n: FloatProperty()
    reason: StringProperty()


class ThenarTargets(bpy.types.PropertyGroup):
    """`scene.thenar_targets`: what the hand shall reach, and what it reached."""

    kind: EnumProperty(name="Target", description="What the hand shall reach from where it is", items=KINDS)
    thumb_n: _newtons("Thumb")
    index_n: _newtons("Index")
    middle_n: _newtons("Middle")
    ring_n: _newtons("Ring")
    little_n: _newtons("Little")
    palm_n: _newtons("Palm")
    rows: CollectionProperty(type=ThenarTargetRow)
    explained: StringProperty()
    """What was found of a recording, as lines."""
    held: StringProperty()
    """What is said of the balance of forces by finger."""
    stamp: StringProperty()
    """What the result holds for, see `stamp`."""


def keep(scene, rows, held):
    """Write what was reached by part, `reasons.Row`s, and what is said of its balance."""
    stored = scene.thenar_targets
    forget(stored)
    stored.held = held
    for row in rows:
        kept = stored.rows.add()
        kept.name, kept.wanted_n, kept.reached_n, kept.reason = row.part, row.wanted_n, row.reached_n, row.reason


def keep_explained(scene, lines):
    """Write what was found of a recording."""
    forget(scene.thenar_targets)
    scene.thenar_targets.explained = "\n".join(lines)


def forget(stored):
    """Leave nothing of what was reached before."""
    stored.rows.clear()
    stored.explained, stored.held, stored.stamp = "", "", ""


CLASSES = (ThenarTargetRow, ThenarTargets)


def register_properties():
    """Hang the targets on scenes."""
    bpy.types.Scene.thenar_targets = PointerProperty(type=ThenarTargets)


def unregister_properties():
    """Take them off again."""
    del bpy.types.Scene.thenar_targets
