"""Every string of the interface that Blender or the add-on translates: from registered classes, and from the sources.

As a script: prints for each language what is missing and what no longer occurs, as entries of its PO file; with
`--write` it takes the latter out, puts all entries in order, and keeps the file.
"""

import ast
import functools
import inspect
import re
import sys
from pathlib import Path

import error_templates
import finding_templates
import sentence_templates
import source_strings

ROOT = Path(__file__).resolve().parents[3]
LETTER = "addon/diagnosis/letter.py", "addon/diagnosis/wording.py"
"""Files whose sentences stay English: the letter is the library's report."""


def of_classes():
    """(context, string) -> where it stands, of all registered classes of the add-on."""
    import bpy

    out = {}

    def put(text, where, context="*"):
        if text and source_strings.is_words(text):
            out.setdefault((context or "*", text), where)

    for cls in _below(bpy.types.Operator):
        module, _, name = cls.bl_idname.partition(".")
        rna = getattr(getattr(bpy.ops, module), name).get_rna_type()
        put(rna.name, cls.__name__, rna.translation_context)
        put(rna.description, cls.__name__)
        _put_properties(put, cls, rna)
    for base in (bpy.types.Panel, bpy.types.Menu, bpy.types.FileHandler):
        for cls in _below(base):
            put(cls.bl_label, cls.__name__, getattr(cls, "bl_translation_context", "*"))
    for base in (bpy.types.PropertyGroup, bpy.types.AddonPreferences):
        for cls in _below(base):
            _put_properties(put, cls, cls.bl_rna)
    return out


def _put_properties(put, cls, rna):
    own = {name for base in cls.__mro__ if _is_ours(base) for name in inspect.get_annotations(base)}
    for prop in rna.properties:
        name, where, context = prop.identifier, f"{cls.__name__}.{prop.identifier}", prop.translation_context
        if name not in own or prop.is_hidden or prop.name == name:
            continue
        put(prop.name, where, context)
        put(prop.description, where)
        for item in prop.enum_items_static if prop.type == "ENUM" else ():
            put(item.name, f"{where}.{item.identifier}", context)
            put(item.description, f"{where}.{item.identifier}")


def _is_ours(cls):
    return cls.__module__.startswith("thenar_blender")


def _below(base):
    for cls in base.__subclasses__():
        yield from _below(cls)
        if _is_ours(cls) and cls.is_registered:
            yield cls


def of_data():
    """Names that code makes of identifiers: effects and their numbers, regions, digits, grades, map units, stages."""
    from thenar_blender import languages, maps
    from thenar_blender.grasp import samples
    from thenar_blender.hand_bones import roles
    from thenar_blender.panels import lists
    from thenar_blender.properties import effect_settings
    from thenar_blender.results import grades, sentences
    from thenar_blender.rigs import skin_regions

    out, laws = {}, {}
    for row in effect_settings.offered().values():
        names = [row["name"], *(each["name"] for each in (*row["shape"], *row["choices"]))]
        out |= dict.fromkeys(map(effect_settings.title, names), f"effect {row['name']}")
        options = [effect_settings.title(option) for choice in row["choices"] for option in choice["options"]]
        laws |= dict.fromkeys(((languages.LAW, option) for option in options), f"effect {row['name']}")
    for name in skin_regions.NAMES:
        out |= dict.fromkeys((sentences.region_title(name), lists.brief(name)), f"region {name}")
    for digit in ("thumb", *roles.FINGERS, "wrist", "palm"):
        out |= dict.fromkeys((digit.capitalize(), digit), "digits")
    for grade in grades.ORDER:
        out |= dict.fromkeys((grade, grades.title(grade)), "grades")
    for view in maps.MAPS.values():
        out |= {view.title: view.kind, view.meaning: view.kind, view.missing: view.kind}
        if " " in view.unit:
            out[view.unit] = view.kind
    out |= dict.fromkeys(grades._HEADINGS.values(), "reasons of grades")
    out |= dict.fromkeys((sample.label for sample in samples.SAMPLES.values()), "samples")
    out |= dict.fromkeys(("Power", "Pinch"), "kinds of grasps")
    out |= dict.fromkeys((*stages(), *_timed(), "Layer"), "stage or model")
    of_bones = {(languages.BONE, role.rpartition("_")[2].capitalize()): "bones" for role in roles.ROLES}
    return {**of_bones, **laws, **{(languages.OWN, text): where for text, where in out.items()}}


def stages():
    """Names of stages that computations report, from the sources in Rust and Python."""
    found = {"read"}
    for path in (*ROOT.glob("rust/*/src/**/*.rs"), *ROOT.glob("addon/**/*.py")):
        found |= set(
            re.findall(
                r"""(?:control\s*\.step|[^_.\w]progress|control\.progress\))\(\s*"([a-z ]+)",""",
                path.read_text("utf-8"),
            )
        )
    return sorted(found)


def _timed():
    """Stages whose seconds are listed under Quality and Time: whole ones of `addon/workflow.py`, parts from Rust."""
    whole = re.findall(r'job\.seconds\["(\w+)"\]', (ROOT / "addon/workflow.py").read_text("utf-8"))
    texts = [path.read_text("utf-8") for path in ROOT.glob("rust/contact/src/**/*.rs")]
    parts = {name for text in texts for name in re.findall(r'(?:add_time\([^"()]*|seconds[^"\n]*)"([a-z ]+)"', text)}
    return [*map(str.capitalize, whole), *sorted(parts)]


@functools.cache
def of_sources(root=ROOT):
    """((context, string) -> where, [composed f-strings]) of all Python files of the add-on."""
    files = {}
    for path in sorted((root / "addon").rglob("*.py")):
        name = path.relative_to(root).as_posix()
        if name not in LETTER:
            files[name] = source_strings.Sources(ast.parse(path.read_text("utf-8")))
    polled = set().union(*(source.polled for source in files.values()))
    out, composed = {}, []
    for name, source in files.items():
        source.returned(polled)
        for line, text in source.found:
            out.setdefault(("*", text), f"{name}:{line}")
        composed += [f"{name}:{line}: {text}" for line, text in source.composed]
    return out, composed


@functools.cache
def everything():
    """(context, string) -> where it stands: classes, sources, names made of data, sentences that are kept in English.
    Thenar must be registered."""
    from thenar_blender import languages

    joints = dict.fromkeys(languages.sentences._PUT_TOGETHER, "addon/languages/sentences.py")
    templates = {
        **joints,
        **error_templates.everything(),
        **finding_templates.everything(),
        **sentence_templates.everything(),
    }
    kept = {(languages.SENTENCE, text): where for text, where in templates.items()}
    return {**kept, **of_data(), **of_sources()[0], **of_classes()}


def main():
    """Print what is missing in each language and what is left over; with `--write` bring the files into line."""
    import bpy
    import tables
    import thenar_blender
    from thenar_blender import languages
    from thenar_blender.languages import po

    bpy.ops.wm.read_factory_settings(use_empty=True)
    thenar_blender.register()
    wanted = everything()
    thenar_blender.unregister()
    for name in languages.LANGUAGES:
        path, table = languages.FOLDER / f"{name}.po", tables.entries(name)
        missing, unused = tables.compared(wanted, table)
        print(f"# {name}.po: {len(missing)} missing, {len(unused)} no longer used")
        for (context, text), where in missing.items():
            lines = [f"#: {where}", *po.lines(context, text, "")]
            print("", *lines, sep="\n")
        print(*(f"# no longer used: {text}" for _, text in unused), sep="\n")
        if "--write" in sys.argv:
            kept = {**dict.fromkeys(missing, ""), **{key: text for key, text in table.items() if key not in unused}}
            head = [line[2:] for line in path.read_text("utf-8").splitlines() if line.startswith("# ")]
            po.write(path, head, dict(sorted(kept.items(), key=tables.place)))


if __name__ == "__main__":
    main()
