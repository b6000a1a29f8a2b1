"""A worker process: takes a case a line as JSON from its input, solves it in Blender, answers a line."""

import json
import os
import sys
import time
import traceback
from argparse import Namespace
from pathlib import Path

import bpy

from .. import names, native, workflow
from ..grasp import fitting
from ..grasp_fit import fitter
from ..hand import build, pads
from ..hand_bones import posing
from ..results import result as results
from ..scene.checks import Refusal
from ..soft_grip import settings as grip_settings
from ..terminal import headless
from . import depends
from .case_files import file_of
from .jobs import check
from .processors import Own

_FORM = 'give each on a line of its own, as {"case": {"blend": "FILE.blend"}, "stem": "FOLDER/NAME"}'


def serve():
    """Answer tasks until the input ends, one line each. What Blender prints goes to the standard error output."""
    own = Own()
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    answers.write(json.dumps({"thenar": names.VERSION, "ready": True}) + "\n")
    answers.flush()
    known = {}
    for number, line in enumerate(sys.stdin.buffer, 1):
        began, used = time.monotonic(), time.process_time()
        answers.write(json.dumps(_answer(line, number, known)) + "\n")
        answers.flush()
        own.took(time.monotonic() - began, time.process_time() - used)


def _answer(line, number, known):
    try:
        task = _task(line, number)
        headless.open_file(task["case"]["blend"])
        files = depends.of_open_file(known)
        return {"summary": {**solve(task["case"], Path(task["stem"])), "files": files}}
    except (Refusal, *native.error_types()) as error:
        return {"error": " ".join(str(error).split())}
    except Exception as error:  # one bad case must not take the worker with it
        place = traceback.extract_tb(error.__traceback__)[-1]
        return {"error": f"{type(error).__name__}: {error} ({Path(place.filename).name}, line {place.lineno})"}


def _task(line, number):
    """The task of a line of the input. Raises `Refusal` where it is none."""
    try:
        task = json.loads(line)
    except ValueError as error:  # what is not UTF-8 too
        raise Refusal(f"line {number} is not JSON ({error}); {_FORM}") from None
    if not isinstance(task, dict) or not isinstance(task.get("case"), dict) or not isinstance(task.get("stem"), str):
        raise Refusal(f"line {number} is no task; {_FORM}")
    check(task["case"], task["case"].get("name", f"of line {number}"))
    return task


def solve(case, stem):
    """Solve one case, whose file is open; pictures and files go to `stem` with their suffixes.

    Returns the result's values. Raises `Refusal` or the native module's errors.
    """
    context = bpy.context
    options = Namespace(
        frame=case.get("frame"),
        hand=case.get("hand"),
        product=case.get("product"),
        model=case.get("model"),
        force=case.get("force_n"),
    )
    headless.choose(options)
    if "hand_percentile" in case or "hand_sex" in case:
        _change_hand(context, case)
    if "pose" in case:
        _pose(context, case["pose"])
    if "fit" in case:
        _fit(context, case["fit"])
    if "stiffness" in case:
        _stiffen(context.scene.thenar.hand, float(case["stiffness"]))
    _cover(context, case)
    workflow.solve(context)
    if case.get("save", True):
        headless.save_file(file_of(stem, ".blend"))
    if case.get("render", False):
        _render(context, file_of(stem, ".png"))
    return results.as_dict(context.scene.thenar.result)


def _cover(context, case):
    """Cover every part of the product with the grip that the case asks for; groups of the file stay."""
    for part in workflow.product_parts(context.scene.thenar):
        grip = part.thenar.grip
        if "grip" in case:
            grip.material = case["grip"].upper()
        if "grip_shore_a" in case:
            grip.material, grip.hardness = grip_settings.SHORE_A, case["grip_shore_a"]
        if "grip_youngs_mpa" in case:
            grip.material, grip.youngs_mpa = grip_settings.CUSTOM, case["grip_youngs_mpa"]
        if "grip_thickness_mm" in case:
            if grip.material == grip_settings.RIGID:
                raise Refusal(
                    f"grip_thickness_mm is given, but '{part.name}' is rigid; add grip, grip_shore_a or grip_youngs_mpa"
                )
            grip.thickness_mm = case["grip_thickness_mm"]


def _change_hand(context, case):
    """A made hand of another size in the place of the file's own, which is taken out of the scene."""
    settings = context.scene.thenar
    old = settings.hand
    shape = {"percentile": float(case.get("hand_percentile", 50.0)), "sex": case.get("hand_sex", "male")}
    hand, rig = build.add_hand(context, build.make(**shape))
    settings.hand = hand
    if old is not None:
        top = old.parent if old.parent is not None and old.parent.type == "ARMATURE" else None
        if top is not None:
            rig.matrix_world = top.matrix_world
        for obj in {old, top} - {None}:
            bpy.data.objects.remove(obj)
    context.view_layer.update()


def _pose(context, name):
    from ..hand.poses import POSES

    if name not in POSES:
        raise Refusal(f"there is no pose '{name}'; known: {', '.join(POSES)}")
    posing.apply_pose(context, context.scene.thenar.hand, name)


def _fit(context, strength):
    settings = context.scene.thenar
    wish = fitter.Wish({"light": pads.LIGHT_MM, "firm": pads.FIRM_MM}[strength])
    fit = fitting.prepare(context, settings.hand, workflow.product_parts(settings), wish)
    if fitting.can_search(fit):
        found = fitting.search_all(fit, fitting.asked_of(strength.upper()))[0].grasp
    else:
        found = fitting.compute(fit)
    fitting.finish(context, fit, found, "AUTO")


def _stiffen(hand, factor):
    for material in tuple(hand.thenar.materials) or (hand.thenar.default_material,):
        for name in ("g0_kpa", "g_lim_kpa"):
            wanted = getattr(material, name) * factor
            setattr(material, name, wanted)
            if abs(getattr(material, name) - wanted) > 1e-4 * wanted:
                raise Refusal(
                    f"stiffness {factor:g} gives a modulus of {wanted:.3g} kPa, which no skin has; "
                    f"the nearest is {getattr(material, name):.3g} kPa"
                )


def _render(context, path):
    from .. import pictures

    partial = path.with_name(f".{path.name.removesuffix('.png')}.{os.getpid()}.partial.png")
    try:
        pictures.render_scene(context, partial)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
