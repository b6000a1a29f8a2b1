"""Operators of presets: save, choose, remove, import, export. What they hold stands in `kinds`."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import languages
from ..operators import polling, running
from ..results.export import replace_file
from ..scene.checks import Refusal
from . import files, kinds

_NAMES = {}
"""Items of menus by kind: Blender needs the texts of a dynamic list kept."""


@dataclass(frozen=True)
class Wish:
    """Of which part of the product, and whether of all regions of the hand."""

    part: str = ""
    all_regions: bool = False


def _named(self, _context):
    items = [(name, name, "", index) for index, name in enumerate(files.listed(self.kind))]
    _NAMES[self.kind] = items or [("", "No presets saved yet", "", 0)]
    return _NAMES[self.kind]


def _kind():
    return EnumProperty(name="Kind", description="What the preset is for", items=kinds.ITEMS)


def _part():
    return StringProperty(name="Part", description="Part of the product; empty: all parts", options={"SKIP_SAVE"})


def _all_regions(description):
    return BoolProperty(name="All Regions", description=description, options={"SKIP_SAVE"})


class THENAR_OT_preset_save(bpy.types.Operator):
    """Save the settings as a preset: a file in the user's configuration, for other scenes and other people"""

    bl_idname = "thenar.preset_save"
    bl_label = "Save Preset"
    bl_options = {"REGISTER"}

    kind: _kind()
    name: StringProperty(name="Name", description="Name of the preset", default="My Preset", maxlen=files.LONGEST)
    part: _part()
    all_regions: _all_regions("Save the materials of all regions by name, in place of the selected region's alone")
    replace: BoolProperty(name="Replace", description="Replace a preset of that name", options={"SKIP_SAVE"})

    def invoke(self, context, event):
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "name")
        if self.kind == kinds.SKIN:
            layout.prop(self, "all_regions")
        layout.prop(self, "replace")

    def execute(self, context):
        path = running.attempt(self, self._save, context)
        if path is None:
            return {"CANCELLED"}
        self.report({"INFO"}, languages.report("Saved '{name}' in {folder}", name=path.stem, folder=path.parent))
        return {"FINISHED"}

    def _save(self, context):
        content = kinds.content_of(context, self.kind, Wish(self.part, self.all_regions))
        return files.save(self.kind, self.name, content, self.replace)


class THENAR_OT_preset_apply(bpy.types.Operator):
    """Set what a saved preset holds"""

    bl_idname = "thenar.preset_apply"
    bl_label = "Apply Preset"
    bl_options = {"REGISTER", "UNDO"}

    kind: _kind()
    name: EnumProperty(name="Preset", description="Which preset", items=_named)
    part: _part()
    all_regions: _all_regions("Give a material of one region to all of them; their thickness and bones stay")

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.busy(), polling.live(context))

    def execute(self, context):
        remark = running.attempt(self, self._apply, context)
        if remark is None:
            return {"CANCELLED"}
        text = languages.report("'{name}' applied", name=self.name) + (f"; {remark}" if remark else "")
        self.report({"WARNING" if remark else "INFO"}, text)
        return {"FINISHED"}

    def _apply(self, context):
        if not self.name:
            raise Refusal("no preset of this kind is saved yet; press + to save one, or import a file")
        path = files.path_of(self.kind, self.name)
        kind, values = kinds.check(context, files.read(path), path.name)
        _same_kind(kind, self.kind, path)
        return kinds.put(context, kind, values, Wish(self.part, self.all_regions))


class THENAR_OT_preset_remove(bpy.types.Operator):
    """Delete a preset's file; what it was applied to stays"""

    bl_idname = "thenar.preset_remove"
    bl_label = "Remove Preset"
    bl_options = {"REGISTER"}

    kind: _kind()
    name: EnumProperty(name="Preset", description="Which preset", items=_named)

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context):
        done = running.attempt(self, self._remove)
        if done is None:
            return {"CANCELLED"}
        self.report({"INFO"}, languages.report("Removed '{name}'", name=self.name))
        return {"FINISHED"}

    def _remove(self):
        if not self.name:
            raise Refusal("no preset of this kind is saved yet; press + to save one, or import a file")
        files.remove(self.kind, self.name)
        return True


class THENAR_OT_preset_import(bpy.types.Operator, ImportHelper):
    """Add a preset's file from someone else to the presets; it is checked first"""

    bl_idname = "thenar.preset_import"
    bl_label = "Import Preset"
    bl_options = {"REGISTER"}

    filename_ext = files.SUFFIX
    filter_glob: StringProperty(default=f"*{files.SUFFIX}", options={"HIDDEN"})
    filepath: StringProperty(name="File", description="The preset's file (.json)", subtype="FILE_PATH")
    replace: BoolProperty(name="Replace", description="Replace a preset of that name", options={"SKIP_SAVE"})

    def execute(self, context):
        path = running.attempt(self, self._import, context)
        if path is None:
            return {"CANCELLED"}
        title = next(item[1] for item in kinds.ITEMS if item[0].lower() == path.parent.name)
        self.report(
            {"INFO"},
            languages.report("Imported '{name}' as a preset: {title}", name=path.stem, title=languages.iface(title)),
        )
        return {"FINISHED"}

    def _import(self, context):
        source = Path(bpy.path.abspath(self.filepath))
        content = files.read(source)
        kind, _values = kinds.check(context, content, source.name)
        own = {key: value for key, value in content.items() if key not in ("format", "version", "kind")}
        return files.save(kind, source.stem, own, self.replace)


class THENAR_OT_preset_export(bpy.types.Operator, ExportHelper):
    """Copy a preset's file to a place of your choice, to send it to someone"""

    bl_idname = "thenar.preset_export"
    bl_label = "Export Preset"
    bl_options = {"REGISTER"}

    filename_ext = files.SUFFIX
    filter_glob: StringProperty(default=f"*{files.SUFFIX}", options={"HIDDEN"})
    kind: _kind()
    name: EnumProperty(name="Preset", description="Which preset", items=_named)

    def invoke(self, context, event):
        self.filepath = f"{self.name}{files.SUFFIX}"
        return super().invoke(context, event)

    def execute(self, context):
        path = running.attempt(self, self._export)
        if path is None:
            return {"CANCELLED"}
        self.report({"INFO"}, languages.report("Wrote {files}", files=path.name))
        return {"FINISHED"}

    def _export(self):
        if not self.name:
            raise Refusal("no preset of this kind is saved yet; press + to save one, or import a file")
        source, path = files.path_of(self.kind, self.name), Path(bpy.path.abspath(self.filepath))
        if not path.parent.is_dir():
            raise Refusal(f"there is no folder '{path.parent}'; make it or choose another place")
        files.read(source)
        try:
            replace_file(path, lambda partial: shutil.copyfile(source, partial))
        except OSError as error:
            raise Refusal(f"'{path}' cannot be written: {error.strerror}; choose another place") from None
        return path


def _same_kind(kind, wanted, path):
    if kind != wanted:
        raise Refusal(f"'{path.name}' is a preset of another kind ({kind.lower()}); import it, which sorts it in")


CLASSES = (
    THENAR_OT_preset_save,
    THENAR_OT_preset_apply,
    THENAR_OT_preset_remove,
    THENAR_OT_preset_import,
    THENAR_OT_preset_export,
)
