"""The manual inside the extension: which page and heading tells about what, for F1, panel headers and errors."""

import functools
import html
import re
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "manual"
"""Where the extension holds its pages as HTML; the source tree has none."""

_OPERATORS = (
    ("add_sample add_product accept_size scale_product pick pick_hand add_hand make_hand", "guide.html#start"),
    ("solve clear apply grasp_lighter show_place select_place", "guide.html#thenar"),
    ("refine_skin", "guide.html#finer-skin"),
    ("reach_target", "guide.html#targets"),
    ("fit_grasp settle_grasp use_grasp more_grasps apply_pose", "guide.html#grasp"),
    ("add_pose_library blend_pose", "guide.html#pose-library"),
    ("guess_bones join_bones assign_digit pick_digits regions_from_bones show_regions", "guide.html#bones"),
    ("back_to_controls", "guide.html#start"),
    ("look look_back report show_pressure show_map select_region", "guide.html#result"),
    ("certify paint_thickness", "guide.html#reference"),
    ("reset_range render_preset", "guide.html#display"),
    ("region_add region_remove region_preset assign_regions", "guide.html#materials"),
    ("effect_add effect_remove", "guide.html#effects"),
    ("preset_save preset_apply preset_remove preset_import preset_export", "guide.html#presets"),
    ("picture open_picture", "guide.html#pictures"),
    ("load_hand_pose read_hand_pose", "grasp_data.html#poses-of-mano-and-smpl-x"),
    ("export_contact_map", "grasp_data.html#contact-maps"),
    ("show_frame", "guide.html#curves-over-time"),
    ("bake play_take export export_bake", "guide.html#bake--export"),
    (
        "load_recording read_recording remove_recording compare outline_mat show_recording show_residual",
        "guide.html#recordings",
    ),
    (
        "new_study read_study_files write_study discard_study leave_out_file pick_site sample_study",
        "guide.html#new-study",
    ),
    ("diagnose apply_finding show_finding", "guide.html#diagnosis"),
    ("copy_debug_info", "guide.html#menus-and-preferences"),
    ("*", "guide.html"),
)
"""Operators by name behind `bpy.ops.thenar.`, and where they are explained; the first that fits."""

_TYPES = (
    ("thenartargets thenartargetrow", "guide.html#targets"),
    ("thenargrasp thenargrasps", "guide.html#grasp"),
    ("thenarbonemap", "guide.html#bones"),
    ("thenarhandshape", "guide.html#hand-shape"),
    ("thenarmaps", "guide.html#display"),
    ("thenarmaterial", "guide.html#materials"),
    ("thenargrip", "guide.html#soft-grip"),
    ("thenareffect thenareffectnumber thenareffectchoice", "guide.html#effects"),
    ("thenarpictures", "guide.html#pictures"),
    ("thenarbake thenarbakedpart", "guide.html#bake--export"),
    ("thenarplacing thenarprint thenarrecording thenarrecordings", "guide.html#recordings"),
    ("thenarcomparison thenarmeasure thenarworst", "guide.html#recordings"),
    ("thenarnewstudy thenarstudyfile thenarstudyprotocol thenarstudycolumns", "guide.html#new-study"),
    ("thenardiagnosis thenarmodeleffect", "guide.html#diagnosis"),
    ("thenarreference", "guide.html#reference"),
    ("thenarresult thenarregionresult thenarcomfort thenartext thenarstage", "guide.html#result"),
    ("thenartabs", "guide.html#tabs-by-task"),
    ("thenarpreferences", "guide.html#menus-and-preferences"),
    ("thenar*", "guide.html#thenar"),
)
"""Groups of properties by type in lower case, and where they are explained; the first that fits."""


def address(page):
    """The address of a page, with its `#heading`; None where the add-on holds no such page or heading."""
    name, _, heading = page.partition("#")
    if heading and heading not in _headings(name):
        return None
    return f"{(FOLDER / name).as_uri()}#{heading}" if (FOLDER / name).is_file() else None


def manual_map():
    """What `bpy.utils.register_manual_map` wants: the address before, and (pattern, page) pairs."""
    operators = [(f"bpy.ops.thenar.{name}*", page) for names, page in _OPERATORS for name in names.split()]
    types = [(f"bpy.types.{name}.*", page) for names, page in _TYPES for name in names.split()]
    return f"{FOLDER.as_uri()}/", (*operators, *types)


def heading_of(title):
    """The anchor of a heading: letters in lower case, blanks as hyphens, no punctuation."""
    return re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")


def draw(layout, page):
    """A button that opens a page of the manual; nothing where there is none."""
    url = address(page)
    if url:
        layout.operator("wm.url_open", text="", icon="HELP", emboss=False).url = url


def page_of_message(message):
    """The page of Troubleshooting on an error or note; None where it lists none like it."""
    fitting = [(len(pattern.pattern), anchor) for pattern, anchor in _messages() if pattern.search(message)]
    return f"troubleshooting.html#{max(fitting)[1]}" if fitting else None


@functools.cache
def _headings(name):
    """Anchors of a page."""
    file = FOLDER / name
    return set(re.findall(r'<h\d id="([^"]+)">', file.read_text("utf-8"))) if file.is_file() else set()


@functools.cache
def _messages():
    """(pattern, anchor) of each message that Troubleshooting lists; dots of omission stand for anything."""
    file = FOLDER / "troubleshooting.html"
    text = file.read_text("utf-8") if file.is_file() else ""
    out = []
    for anchor, heading in re.findall(r'<h3 id="([^"]+)">(.*?)</h3>', text):
        words = html.unescape(re.sub(r"<[^>]+>", "", heading)).split("\u2026")
        if max(map(len, words)) > 8:
            pattern = ".*".join(re.escape(part) for part in words)
            out.append((re.compile(pattern, re.IGNORECASE | re.DOTALL), anchor))
    return out
