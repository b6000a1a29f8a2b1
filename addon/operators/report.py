"""The operator that writes the report of a comparison or a diagnosis."""

from pathlib import Path

import bpy
from bpy_extras.io_utils import ExportHelper

from .. import languages
from ..results import reports
from . import polling, running

_KINDS = (
    ("LATEST", "Latest", "What was found last: the comparison or the diagnosis"),
    (reports.COMPARISON, "Comparison", "What separates simulation and recordings"),
    (reports.DIAGNOSIS, "Diagnosis", "What was left out, with the evidence"),
)


class THENAR_OT_report(bpy.types.Operator, ExportHelper):
    """Write what was found: a page with plots (.html), or every number (.json)"""

    bl_idname = "thenar.report"
    bl_label = "Write Report"
    bl_options = {"REGISTER"}

    filename_ext = ".html"
    check_extension = False
    filter_glob: bpy.props.StringProperty(default="*.html;*.json", options={"HIDDEN"})
    kind: bpy.props.EnumProperty(name="Report", description="Which report to write", items=_KINDS)

    @classmethod
    def poll(cls, context):
        empty = "" if reports.states(context.scene) else "nothing was found yet; press Compare or Diagnose first"
        return polling.allows(cls, polling.no_module(), empty)

    def execute(self, context):
        path, kind = Path(bpy.path.abspath(self.filepath)), "" if self.kind == "LATEST" else self.kind
        written = running.attempt(self, reports.write, context.scene, path, kind)
        if written is None:
            return {"CANCELLED"}
        self.report({"INFO"}, languages.report("Wrote {files}", files=written.name))
        return {"FINISHED"}


CLASSES = (THENAR_OT_report,)
