"""The operator that writes the result to a file; the suffix chooses the form."""

import bpy
from bpy_extras.io_utils import ExportHelper

from .. import languages
from ..results import export
from . import polling, running


class THENAR_OT_export(bpy.types.Operator, ExportHelper):
    """Write the result: tables (.csv), arrays (.npz), or hand and product with their pressure (.glb, .gltf, .usd)"""

    bl_idname = "thenar.export"
    bl_label = "Export Contact"
    bl_options = {"REGISTER"}

    filename_ext = ".csv"
    check_extension = False
    filter_glob: bpy.props.StringProperty(default="*.csv;*.npz;*.glb;*.gltf;*.usd;*.usda;*.usdc", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_result(context))

    def execute(self, context):
        if bpy.ops.thenar.look_back.poll():
            bpy.ops.thenar.look_back()  # exporters leave out what a look hides
        written = running.attempt(self, export.write, context, bpy.path.abspath(self.filepath))
        if written is None:
            return {"CANCELLED"}
        files = ", ".join(path.name for path in written)
        self.report({"INFO"}, languages.report("Wrote {files}", files=files))
        return {"FINISHED"}


class THENAR_OT_export_bake(bpy.types.Operator, ExportHelper):
    """Write force, area, peak, shear, work and loss of every frame of the bake as a table (.csv)"""

    bl_idname = "thenar.export_bake"
    bl_label = "Export Frames"
    bl_options = {"REGISTER"}

    filename_ext = ".csv"
    filter_glob: bpy.props.StringProperty(default="*.csv", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_bake(context))

    def execute(self, context):
        written = running.attempt(self, export.write_bake, context, bpy.path.abspath(self.filepath))
        if written is None:
            return {"CANCELLED"}
        self.report({"INFO"}, languages.report("Wrote {files}", files=written.name))
        return {"FINISHED"}


CLASSES = (THENAR_OT_export, THENAR_OT_export_bake)
