"""Operators that correct what was recognised: a digit from selected bones, all digits by clicks in the 3D view."""

import bpy
from bpy.props import EnumProperty
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from .. import languages
from ..hand.operators import can_pose
from ..hand_bones import bonemap, reading, roles
from ..operators import running
from . import assigning

REACH_PX = 60.0
"""How far from a bone a click may be, at a display scale of 1."""


class THENAR_OT_assign_digit(bpy.types.Operator):
    """Make the selected bones of the armature this digit: one bone of its chain, or all of them"""

    bl_idname = "thenar.assign_digit"
    bl_label = "Assign Digit"
    bl_options = {"REGISTER", "UNDO"}

    digit: EnumProperty(
        name="Digit",
        description="Digit of the chosen bones",
        items=[(digit, digit.capitalize(), "") for digit in assigning.DIGITS],
    )

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def execute(self, context):
        found = running.attempt(self, self._assign, context)
        if not found:
            return {"CANCELLED"}
        digit = languages.report(self.digit.capitalize())
        self.report({"INFO"}, f"{digit}: {', '.join(found.values())}")
        return {"FINISHED"}

    def _assign(self, context):
        hand = context.scene.thenar.hand
        armature = reading.armature_of(hand)
        names = [bone.name for bone in armature.pose.bones if _is_selected(bone)]
        found = assigning.assign(context, hand, self.digit, names)
        armature.thenar_bones.show_digits = True
        return found


class THENAR_OT_pick_digits(bpy.types.Operator):
    """Click each digit in the 3D view, from the thumb to the little finger. Enter ends early, Esc cancels"""

    bl_idname = "thenar.pick_digits"
    bl_label = "Pick Digits"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def invoke(self, context, event):
        if context.area is None or context.area.type != "VIEW_3D":
            self.report({"ERROR"}, "Digits are picked in a 3D view; press this in its sidebar")
            return {"CANCELLED"}
        self._hand = context.scene.thenar.hand
        armature = running.attempt(self, reading.armature_of, self._hand)
        skeleton = running.attempt(self, reading.skeleton_of, context, self._hand)
        if armature is None or skeleton is None:
            return {"CANCELLED"}
        self._armature = armature
        self._names = {n for n, skin in zip(skeleton.names, skeleton.skin, strict=True) if skin > 0.0}
        self._before = {**dict.fromkeys(roles.ROLES, ""), **bonemap.get_map(armature)}
        self._waiting = list(assigning.DIGITS)
        armature.thenar_bones.show_digits = True
        self._prompt(context)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            for role, name in self._before.items():
                setattr(self._armature.thenar_bones, role, name)
            return self._end(context, {"CANCELLED"})
        if event.type in {"RET", "NUMPAD_ENTER"} and event.value == "PRESS":
            return self._end(context, {"FINISHED"})
        region = next((r for r in context.area.regions if r.type == "WINDOW"), None)
        inside = region is not None and 0 <= event.mouse_x - region.x < region.width
        inside = inside and 0 <= event.mouse_y - region.y < region.height
        if event.type != "LEFTMOUSE" or event.value != "PRESS" or not inside:
            return {"PASS_THROUGH"}
        place = Vector((event.mouse_x - region.x, event.mouse_y - region.y))
        self.pick(context, region, place)
        return {"RUNNING_MODAL"} if self._waiting else self._end(context, {"FINISHED"})

    def pick(self, context, region, place):
        """Take the chain nearest to the 2D `place` for the digit that is waited for."""
        view = context.space_data.region_3d

        def to_screen(point):
            return location_3d_to_region_2d(region, view, point)

        reach = REACH_PX * context.preferences.system.ui_scale
        name = assigning.nearest(assigning.screen_bones(self._armature, self._names, to_screen), place, reach)
        if name is None:
            self.report({"WARNING"}, "No bone of the hand is near; click on the digit itself")
            return
        if running.attempt(self, assigning.assign, context, self._hand, self._waiting[0], [name]):
            self._waiting.pop(0)
            self._prompt(context)

    def _prompt(self, context):
        if self._waiting:
            digit = languages.iface(self._waiting[0])
            words = languages.iface("Click the {digit}    Enter: done    Esc: cancel", digit=digit)
            context.workspace.status_text_set(words)
        context.area.tag_redraw()

    def _end(self, context, result):
        context.workspace.status_text_set(None)
        context.area.tag_redraw()
        return result


def _is_selected(bone):
    return bone.select if hasattr(bone, "select") else bone.bone.select


CLASSES = (THENAR_OT_assign_digit, THENAR_OT_pick_digits)
