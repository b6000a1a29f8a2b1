"""The operators that pose the hand by MANO's and SMPL-X's parameters and write a contact as grasp data sets do."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import languages, steps
from ..hand.operators import can_pose
from ..operators import computing, polling, running, selecting
from . import contact_map, containers, posing


class _OfPose:
    """What both operators are asked, and how they end."""

    filepath: StringProperty(name="File", description="File of pose parameters", subtype="FILE_PATH")
    side: EnumProperty(
        name="Side",
        description="Hand of the file that is taken; one of the other side is mirrored",
        items=(
            ("AUTO", "As the Hand", "The file's hand of the same side as the scene's", 0),
            ("LEFT", "Left", "The file's left hand", 1),
            ("RIGHT", "Right", "The file's right hand", 2),
        ),
    )
    numbers: EnumProperty(
        name="Numbers",
        description="What the numbers of a pose are",
        items=(
            ("AUTO", "Automatic", "Axis-angles where there are 45 or 48 a frame, else PCA coefficients", 0),
            ("AXIS_ANGLE", "Axis-Angles", "Three a joint, in radians", 1),
            ("PCA", "PCA Coefficients", "Read by the hands_components that the file brings", 2),
        ),
    )
    add_mean: BoolProperty(
        name="Add Mean Pose",
        description="Add the file's hands_mean, as models with flat_hand_mean off do; without one nothing is added",
        default=True,
    )
    keep_limits: BoolProperty(
        name="Keep Joint Limits",
        description="Turn joints only as far and about the axes that the hand's limits allow; off: exactly as the file "
        "says, with the limits switched off",
    )
    step: IntProperty(name="Every", description="Take every n-th frame of a sequence", min=1, max=1000, default=1)

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def steps(self, context):
        """The computation, see `posing.steps`."""
        wish = posing.Wish(
            {"AUTO": None, "LEFT": "left", "RIGHT": "right"}[self.side],
            {"AUTO": None, "AXIS_ANGLE": False, "PCA": True}[self.numbers],
            self.add_mean,
            self.keep_limits,
            self.step,
        )
        steps_of_file = posing.steps(context, Path(bpy.path.abspath(self.filepath)), wish)
        return selecting.in_object_mode(context, steps_of_file)

    def _report(self, _context, done):
        text = languages.report("Posed by '{key}'", key=done.key)
        if done.keyed:
            text = languages.report("{count} frames of '{key}' keyed", count=done.keyed, key=done.key)
        self.report({"WARNING" if done.remark else "INFO"}, text + (f"; {done.remark}" if done.remark else ""))
        return {"FINISHED"}


class THENAR_OT_load_hand_pose(_OfPose, computing.OpensFiles, bpy.types.Operator):
    """Pose the hand by parameters of MANO or SMPL-X (.npz, .npy, .json, .pkl); several frames become keyframes"""

    bl_idname = "thenar.load_hand_pose"
    bl_label = "Pose from MANO or SMPL-X"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default=";".join(f"*{suffix}" for suffix in containers.SUFFIXES), options={"HIDDEN"})

    def execute(self, context):
        if self.reads_beside(context):
            asked = {name: getattr(self, name) for name in ("filepath", "side", "numbers", *_SWITCHES)}
            return self.hand_over(bpy.ops.thenar.read_hand_pose, **asked)
        done = running.attempt(self, steps.at_once, self.steps(context))
        return {"CANCELLED"} if done is None else self._report(context, done)


_SWITCHES = ("add_mean", "keep_limits", "step")


class THENAR_OT_read_hand_pose(_OfPose, computing.Computing, bpy.types.Operator):
    """Read poses of MANO or SMPL-X next to the window, and key them"""

    bl_idname = "thenar.read_hand_pose"
    bl_label = "Read Hand Poses"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}
    noun = "Reading"


class THENAR_OT_export_contact_map(bpy.types.Operator, ExportHelper):
    """Write the contact as grasp data sets do (.npz, .csv): region, object point, normal, pressure by pressed vertex"""

    bl_idname = "thenar.export_contact_map"
    bl_label = "Export Contact Map"
    bl_options = {"REGISTER"}

    filename_ext = ".npz"
    check_extension = False
    filter_glob: StringProperty(default="*.npz;*.csv", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_result(context), polling.busy())

    def execute(self, context):
        if bpy.ops.thenar.look_back.poll():
            bpy.ops.thenar.look_back()  # what a look moves is not where the contact is
        written = running.attempt(self, contact_map.write, context, bpy.path.abspath(self.filepath))
        if written is None:
            return {"CANCELLED"}
        path, count = written
        self.report({"INFO"}, languages.report("Wrote {count:,} contact points to {file}", count=count, file=path.name))
        return {"FINISHED"}


CLASSES = (THENAR_OT_load_hand_pose, THENAR_OT_read_hand_pose, THENAR_OT_export_contact_map)
