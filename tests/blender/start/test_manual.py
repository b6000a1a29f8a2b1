"""Every button and property leads to a heading of the manual that is there, and messages to their entries."""

import fnmatch
import re

import bpy
import pytest
from thenar_blender.panels import manual
from thenar_blender.panels.main import Tab

DOCS = manual.FOLDER.parent / "docs"


def slugs(name):
    """Anchors as forges make them of the headings of a page (GitHub's rule), by its own code."""
    out = set()
    for line in (DOCS / name.replace(".html", ".md")).read_text("utf-8").splitlines():
        if line.startswith("#"):
            kept = "".join(c for c in line.lstrip("# ").lower() if c.isalnum() or c in "-_ ")
            out.add(kept.replace(" ", "-"))
    return out


def first(entries, wanted):
    """As Blender looks it up: the first pattern that fits, in lower case."""
    return next((page for pattern, page in entries if fnmatch.fnmatchcase(wanted.lower(), pattern)), None)


def names():
    """`bpy.ops` and `bpy.types` names of all that Thenar registers."""
    for name in dir(bpy.ops.thenar):
        yield f"bpy.ops.thenar.{name}"
    for cls in bpy.types.PropertyGroup.__subclasses__() + bpy.types.AddonPreferences.__subclasses__():
        if "thenar_blender" in cls.__module__:
            yield from (
                f"bpy.types.{cls.__name__}.{key}"
                for key in (rna.identifier for rna in cls.bl_rna.properties)
                if key != "rna_type"
            )


def test_every_operator_and_property_has_a_page_and_its_heading_is_there(scene):
    prefix, entries = manual.manual_map()
    assert prefix.startswith("file:") and prefix.endswith("/")
    wanted = list(names())
    assert len(wanted) > 300
    unknown = {"guide.html", "guide.html#thenar"}
    for name in wanted:
        page = first(entries, name)
        assert page, name
        file, _, heading = page.partition("#")
        assert not heading or heading in slugs(file), (name, page)
        if name.startswith("bpy.ops"):
            assert page not in unknown - {"guide.html#thenar"}, f"{name} has no heading of its own"


def test_blender_looks_up_the_manual_of_thenar(scene):
    assert any(call() == manual.manual_map() for call in bpy.utils._manual_map)


def test_every_operator_has_a_tooltip(scene):
    for name in dir(bpy.ops.thenar):
        rna = getattr(bpy.ops.thenar, name).get_rna_type()
        assert rna.description.strip(), name
        for key, prop in rna.properties.items():
            if key != "rna_type" and not prop.is_hidden:
                assert prop.name, (name, key)


def test_main_panels_have_a_heading_of_their_label():
    missing = [cls.bl_label for cls in Tab.__subclasses__() if hasattr(cls, "bl_label") and not hasattr(cls, "said")]
    missing = [label for label in missing if manual.heading_of(label) not in slugs("guide.html")]
    # Parts of Result, Recordings and Diagnosis that their parents' headings explain.
    assert set(missing) <= {"Comparison", "Notes", "Bake", "Regions", "Comfort", "Quality and Time"}, missing


@pytest.fixture
def built(tmp_path, monkeypatch):
    """A manual with two messages."""
    (tmp_path / "troubleshooting.html").write_text(
        '<h3 id="a">no skin comes within \u2026 mm of the product</h3><h3 id="b">the hand &#39;\u2026&#39; is \u2026; '
        'pick a mesh object</h3><h3 id="c">\u2026, line \u2026: \u2026</h3>'
    )
    monkeypatch.setattr(manual, "FOLDER", tmp_path)
    for cached in (manual._messages, manual._headings):
        cached.cache_clear()
    yield tmp_path
    for cached in (manual._messages, manual._headings):
        cached.cache_clear()


def test_messages_lead_to_their_entry(built):
    assert manual.page_of_message("No skin comes within 12.5 mm of the product, so") == "troubleshooting.html#a"
    assert manual.page_of_message("the hand 'Arm' is a curve; pick a mesh object") == "troubleshooting.html#b"
    assert manual.page_of_message("something else: no, line 3") is None
    assert re.fullmatch(r"file:///.*troubleshooting\.html#b", manual.address("troubleshooting.html#b"))
    assert manual.address("troubleshooting.html#nowhere") is None and manual.address("other.html") is None
