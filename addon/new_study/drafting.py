"""The study that is being made: filled from files, kept in step with the user's answers, and what is still open."""

from contextlib import suppress
from functools import partial
from pathlib import Path

from ..languages import iface
from ..scene.checks import Refusal
from . import looking, repeats, settings, writing


def steps(context, folder, names):
    """Look at the files, and open the proposal, as the steps of a computation. Returns its recordings' count.

    Raises `Refusal`, the scene as it was. A proposal that stays open keeps what was read of its files.
    """
    paths = _chosen(folder, names)
    try:
        found = yield partial(_look_at, paths)
        return _open(context, folder, found)
    finally:
        files = context.scene.thenar_new_study.files
        looking.keep({(item.path, item.run) for item in files})


def _chosen(folder, names):
    if not names:
        raise Refusal("no file is chosen; choose the files of the recordings, with Ctrl or Shift for several")
    recorded = [name for name in names if name not in writing.OWN]
    if not recorded:
        raise Refusal(f"'{names[0]}' is a file of a study and no recording; choose the files of the recordings")
    return [Path(folder) / name for name in sorted(recorded, key=_natural)]


def _look_at(paths, cancel=None, progress=None):
    """The recordings of all files; those that state everything are read whole, so that `refresh` finds them read."""
    found = []
    for number, path in enumerate(paths):
        if cancel is not None and cancel.is_set():
            break  # what was found is dropped
        if progress is not None:
            progress("read", number / len(paths))
        seen = looking.look(path)
        for each in seen:
            if not each.headers:
                with suppress(Refusal):  # said at its file, by `refresh`
                    looking.track(each.path, each.run, ())
        found += seen
    return found


def _open(context, folder, found):
    if len(found) > settings.MOST_FILES:
        raise Refusal(
            f"these are {len(found)} recordings, and one study takes {settings.MOST_FILES} here; "
            "choose fewer, or write study.toml by hand"
        )
    state, hand = context.scene.thenar_new_study, context.scene.thenar.hand
    with settings.filling():
        _clear(state)
        state.is_open, state.folder, state.title = True, str(folder), Path(folder).name or "Study"
        state.skin = settings.FLAT if hand is None else settings.HAND
        several = {each.path for each in found if each.run}
        for each in found:
            item = state.files.add()
            item.path, item.run = each.path, each.run
            item.name = Path(each.path).name + (f", {each.run}" if each.path in several else "")
            item.head = _columns(state, each).name if each.headers else ""
    refresh(context)
    return len(state.files)


def discard(state):
    """Close the proposal; files on disk stay."""
    looking.keep(())
    _clear(state)


def _clear(state):
    for name in ("files", "columns", "protocols"):
        getattr(state, name).clear()
    for name in ("is_open", "is_own_grouping", "replaces", "site_vertex", "site_hand", "site_count", "site_region"):
        state.property_unset(name)


def leave_out(context, number):
    """Take the recording of this number, from 0, out of the proposal. Returns its name. Raises `Refusal`."""
    state = context.scene.thenar_new_study
    if number >= len(state.files):
        raise Refusal(f"there is no recording {number}; the list has {len(state.files)}, numbered from 0")
    name = state.files[number].name
    state.files.remove(number)
    asked = {item.head for item in state.files}
    for place in reversed(range(len(state.columns))):
        if state.columns[place].name not in asked:
            state.columns.remove(place)
    refresh(context)
    return name


def refresh(context):
    """Read every file under the answers so far, and group repeats until the user groups by hand."""
    state = context.scene.thenar_new_study
    with settings.filling():
        tracks = [_read(state, item) for item in state.files]
        if not state.is_own_grouping:
            for item, number in zip(state.files, repeats.groups(tracks), strict=True):
                item.protocol = number + 1
        _fit_protocols(state, tracks)


def read_again(context):
    """Read every file as it is now on disk; groups and tools stay as the user saw them."""
    state = context.scene.thenar_new_study
    with settings.filling():
        for item in state.files:
            _read(state, item)


def _read(state, item):
    try:
        track = looking.track(item.path, item.run, columns_of(state, item))
    except Refusal as refusal:
        item.problem, item.about, item.reach_mm = str(refusal), "", 0.0
        return None
    item.problem, item.reach_mm = "", repeats.reach_mm(track)
    item.about = repeats.describe(track)
    if not item.about and repeats.is_still(track):
        item.problem = (
            f"'{item.name}' shows a tool that does not move while it presses; "
            "choose a recording that holds the way down too, or leave this one out"
        )
    elif not item.about:
        item.problem = f"'{item.name}' shows no press: no force above zero; check columns and signs"
    return track


def _fit_protocols(state, tracks):
    """A protocol for each number up to the largest that a file has, with the tool that its files bring."""
    most = max((item.protocol for item in state.files), default=0)
    while len(state.protocols) < most:
        state.protocols.add()
    while len(state.protocols) > most:
        state.protocols.remove(len(state.protocols) - 1)
    taken = set()
    words = [repeats.describe(track) for track in tracks]
    for number, protocol in enumerate(state.protocols, 1):
        _bring_tool(protocol, [item.tool for item in state.files if item.protocol == number], state.is_own_grouping)
        of_it = [text for item, text in zip(state.files, words, strict=True) if item.protocol == number and text]
        name = of_it[0] if of_it else f"protocol {number}"
        protocol.name = name if name not in taken else f"{name} ({number})"
        taken.add(protocol.name)


def _bring_tool(protocol, tools, is_own_grouping):
    """Give a protocol the tool of its files.

    Where they differ, the user who put them together sees and keeps the protocol's; else the size is asked for again.
    """
    differ = set(tools)
    if not is_own_grouping and len(differ) > 1:
        differ.discard(settings.NO_TOOL)
    if len(differ) == 1:
        settings.set_tool(protocol, differ.pop())
    elif not is_own_grouping or not differ:
        settings.set_tool(protocol, settings.NO_TOOL)


def columns_of(state, item):
    """(key, header) pairs for `[recordings.columns]`; empty where the file itself says all."""
    head = state.columns.get(item.head) if item.head else None
    if head is None:
        return []
    pairs = []
    for role in head.asks.split():
        header = getattr(head, role)
        if not header:
            continue
        is_reversed = getattr(head, f"{role}_reversed", False)
        unit = getattr(head, f"{role}_unit")
        key = "travel" if role == "depth" and head.depth_zero == "ANY" else role
        unit = "" if unit == settings.STATED else f"_{unit.lower()}"
        pairs.append((key + unit, f"-{header}" if is_reversed else header))
    return pairs


def _columns(state, found):
    """The row of questions of a head; files of the same head and questions share it."""
    key = "\t".join((*found.headers, " ".join(found.asks)))
    head = state.columns.get(key)
    if head is not None:
        return head
    head = state.columns.add()
    head.name, head.asks = key, " ".join(found.asks)
    for header in found.headers:
        head.headers.add().name = header
    for role, header in looking.propose(found.headers, found.asks).items():
        setattr(head, role, header)
    head.depth_reversed, head.force_reversed = found.is_depth_reversed, found.is_force_reversed
    head.depth_zero = "TOUCH" if looking.TOUCHED.search(head.depth) else "ANY"
    return head


def problem(context):
    """What must be answered before the study can be written, as one sentence; empty if nothing."""
    state = context.scene.thenar_new_study
    if not state.is_open:
        return "no study is being made; press New Study from Files first"
    if not len(state.files):
        return "every recording is left out; press New Study from Files to choose others"
    for item in state.files:
        if item.problem:
            return item.problem
    count = len({item.protocol for item in state.files})
    if count > settings.MOST_PROTOCOLS:
        words = (
            "these are {count} protocols, and one study takes {most} here; make several studies, each from a folder of "
            "its own, or write study.toml by hand"
        )
        return iface(words, count=count, most=settings.MOST_PROTOCOLS)
    for number, protocol in enumerate(state.protocols, 1):
        is_used = any(item.protocol == number for item in state.files)
        if is_used and protocol.shape != "PLANE" and protocol.diameter_mm <= 0.0:
            words = "the tool's diameter of protocol {number} is not given; measure it and enter it in mm"
            return iface(words, number=number)
        if is_used and state.skin == settings.FLAT and protocol.shape in {"PLANE", "CYLINDER"}:
            return (
                "a flat plate or a cylinder touches flat skin up to its edges, which the study does not know; "
                "choose a sphere or a flat rod, or a hand under Pressed"
            )
    return _skin_problem(context, state)


def _skin_problem(context, state):
    if state.skin == settings.FLAT:
        return ""
    hand = context.scene.thenar.hand
    if hand is None or hand.type != "MESH":
        return "there is no hand yet; press Make Hand, or choose Flat Skin under Pressed"
    if state.site_vertex >= 0 and state.site_hand != hand:
        words = "the place was clicked on another hand than '{name}'; press Pick Site and click it again"
        return iface(words, name=hand.name)
    count = len(hand.data.vertices)
    if state.site_vertex >= 0 and (state.site_count != count or state.site_vertex >= count):
        words = "'{name}' was changed since the place was clicked; press Pick Site and click it again"
        return iface(words, name=hand.name)
    if state.site_vertex < 0 and state.site_region not in hand.thenar.materials:
        return "where on the hand did the tool press? Press Pick Site and click the skin, or choose a region"
    return ""


def _natural(name):
    """Sorts `press 2` before `press 10`."""
    digits = "".join(letter if letter.isdigit() else " " for letter in name).split()
    words = "".join(" " if letter.isdigit() else letter for letter in name.lower())
    return (" ".join(words.split()), [int(number) for number in digits], name)
