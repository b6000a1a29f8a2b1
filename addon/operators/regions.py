"""Operators that fill the lists: hand and product from the selection, regions from vertex groups, presets."""

import bpy

from .. import languages
from ..properties import material_settings
from ..scene import regions
from . import polling, selecting


class THENAR_OT_pick(bpy.types.Operator):
    """Take hand and product from the selection: the active mesh is the hand, the other selected object the product"""

    bl_idname = "thenar.pick"
    bl_label = "Use Selection"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        active = context.object
        picked = active is not None and active.type == "MESH" and len(context.selected_objects) == 2
        text = "select the product, then Shift-click the hand's mesh, so that the hand is active"
        return polling.allows(cls, "" if picked else text)

    def execute(self, context):
        scene = context.scene.thenar
        scene.hand = context.object
        scene.product = next(obj for obj in context.selected_objects if obj != context.object)
        return {"FINISHED"}


class THENAR_OT_assign_regions(bpy.types.Operator):
    """List every vertex group of the hand as a region with a material of its own; groups named by bones are left out"""

    bl_idname = "thenar.assign_regions"
    bl_label = "Regions from Vertex Groups"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_groups(context))

    def execute(self, context):
        hand = context.scene.thenar.hand
        bones = _bone_names(hand)
        found = [group.name for group in hand.vertex_groups if group.name not in bones]
        if not found:
            words = "Every vertex group of '{name}' is a bone's; add groups for the skin's regions"
            self.report({"ERROR"}, languages.report(words, name=hand.name))
            return {"CANCELLED"}
        listed = {material.name for material in hand.thenar.materials}
        for name in found:
            if name not in listed:
                add_region(hand, name)
        return {"FINISHED"}


class THENAR_OT_region_add(bpy.types.Operator):
    """Add the active vertex group as a region"""

    bl_idname = "thenar.region_add"
    bl_label = "Add Region"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_groups(context))

    def execute(self, context):
        hand = context.scene.thenar.hand
        name = hand.vertex_groups.active.name
        if name in hand.thenar.materials:
            words = "'{name}' is listed already; make another vertex group active"
            self.report({"ERROR"}, languages.report(words, name=name))
            return {"CANCELLED"}
        add_region(hand, name)
        return {"FINISHED"}


class THENAR_OT_region_remove(bpy.types.Operator):
    """Remove the region from the list: its vertices are then no skin. The vertex group stays"""

    bl_idname = "thenar.region_remove"
    bl_label = "Remove Region"
    bl_options = {"REGISTER", "UNDO"}

    all: bpy.props.BoolProperty(name="All", description="Empty the list: the whole mesh is one region again")

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_regions(context))

    def execute(self, context):
        state = context.scene.thenar.hand.thenar
        if self.all:
            state.materials.clear()
        else:
            state.materials.remove(min(state.material_index, len(state.materials) - 1))
        state.material_index = max(0, min(state.material_index, len(state.materials) - 1))
        return {"FINISHED"}


class THENAR_OT_region_preset(bpy.types.Operator):
    """Set published values for all listed regions, by their names: palm, phalanx or fingertip"""

    bl_idname = "thenar.region_preset"
    bl_label = "Published Values"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_regions(context))

    def execute(self, context):
        for material in context.scene.thenar.hand.thenar.materials:
            material.preset = material_settings.preset_of(material.name, context.scene.thenar.model)
        return {"FINISHED"}


class THENAR_OT_select_region(bpy.types.Operator):
    """Select the region's vertices in Edit Mode"""

    bl_idname = "thenar.select_region"
    bl_label = "Select Region"
    bl_options = {"REGISTER", "UNDO"}

    index: bpy.props.IntProperty(name="Region", description="Row of the result table", min=0)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_region_result(context))

    def execute(self, context):
        hand = context.scene.thenar.hand
        selecting.to_object_mode(context)
        selecting.select(context, hand, regions.region_vertices(hand.data, self.index))
        context.scene.thenar.result.region_index = self.index
        return {"FINISHED"}


def add_region(hand, name):
    """Add a material for the vertex group of that name, with the published values of its kind."""
    material = hand.thenar.materials.add()
    material.name = name
    material.preset = material_settings.preset_of(name)
    material_settings.fill_from_preset(material, material.preset)
    hand.thenar.material_index = len(hand.thenar.materials) - 1
    return material


def _bone_names(hand):
    armatures = [modifier.object for modifier in hand.modifiers if modifier.type == "ARMATURE" and modifier.object]
    return {bone.name for armature in armatures for bone in armature.data.bones}


CLASSES = (
    THENAR_OT_pick,
    THENAR_OT_assign_regions,
    THENAR_OT_region_add,
    THENAR_OT_region_remove,
    THENAR_OT_region_preset,
    THENAR_OT_select_region,
)
