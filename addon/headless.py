"""The command line: solve, batch, demo, samples. One `main` for Blender's `--command` and for `python -m`."""

import argparse
import importlib
import json
import os
import sys
from pathlib import Path

import bpy

from . import export, maps, native, workflow
from . import result as results
from .scene.checks import Refusal


def main(arguments):
    """Run one command. Returns the exit code: 0 done, 2 bad input (one sentence on stderr); anything else is raised."""
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as leave:
        return leave.code or 0
    try:
        options.run(options)
    except (Refusal, *native.error_types()) as error:
        text = " ".join(str(error).split())
        print(f"thenar: {text}", file=sys.stderr, flush=True)
        return 2
    return 0


def open_file(path):
    """Open a .blend file. Raises `Refusal` where it is missing or unreadable."""
    if not Path(path).is_file():
        raise Refusal(f"there is no file '{path}'")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(Path(path).resolve()), load_ui=False)
    except RuntimeError as error:
        raise Refusal(f"'{path}' cannot be opened: {' '.join(str(error).split())}") from None
    if bpy.context.scene.thenar.live:
        bpy.context.scene.thenar.live = False


def save_file(path):
    """Save the open file as a copy at `path`, whole or not at all."""
    target = Path(path).resolve()
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_name(f".{target.stem}.partial.blend")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(partial), copy=True, compress=True)
        os.replace(partial, target)
    finally:
        partial.unlink(missing_ok=True)


def save_json(path, values):
    """Write `values` as JSON at `path`, whole or not at all."""
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(values, indent=1)
    export.replace_file(target, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))


def press(options):
    """Set hand, product, force and frame as asked for, and solve. Returns the result as plain values."""
    choose(options)
    workflow.solve(bpy.context)
    return results.as_dict(bpy.context.scene.thenar.result)


def choose(options):
    """Set hand, product, model, force and frame of the open file as asked for. Raises `Refusal`."""
    scene = bpy.context.scene
    settings = scene.thenar
    if options.frame is not None:
        scene.frame_set(options.frame)
    if options.hand:
        settings.hand = _find(options.hand, "hand")
    if options.product:
        _set_product(settings, options.product)
    if options.model:
        settings.model = options.model.upper()
    if options.force is not None:
        if options.force <= 0.0:
            raise Refusal(f"a force of {options.force:g} N cannot be reached; give one above zero")
        settings.use_force, settings.force_n = True, options.force


def _solve(options):
    if options.blend:
        open_file(options.blend)
    elif not bpy.data.filepath:
        raise Refusal("no file is open; name the .blend file to solve")
    summary = press(options)
    if options.render:
        from . import pictures

        pictures.render_scene(bpy.context, Path(options.render), options.map and options.map.upper())
    if options.out:
        save_file(options.out)
    if options.json:
        save_json(options.json, summary)
    print(
        f"{summary['force_n']:.2f} N on {summary['contact_area_mm2'] / 100:.2f} cm2, "
        f"peak {summary['peak_pressure_kpa']:.1f} kPa, mean {summary['mean_pressure_kpa']:.1f} kPa",
        flush=True,
    )


def _batch(options):
    from . import batch

    by = batch.By(options.workers, options.scheduler, options.part)
    batch.run(Path(options.jobs), Path(options.out), by)


def _worker(_options):
    from .batch import worker

    worker.serve()


def _demo(options):
    from . import demo

    demo.run(options.sample or options.samples, Path(options.out))


def _samples(options):
    try:
        maker = importlib.import_module(".hand.samples", __package__)
    except ModuleNotFoundError:
        raise Refusal("this build cannot make samples") from None
    maker.make_samples(Path(options.out))


def _find(name, role):
    found = bpy.data.objects.get(name)
    if found is None:
        listed = ", ".join(sorted(obj.name for obj in bpy.data.objects if obj.type == "MESH")[:8]) or "none"
        raise Refusal(f"there is no object '{name}' for the {role}; meshes in the file: {listed}")
    return found


def _set_product(settings, name):
    if name not in bpy.data.objects and name in bpy.data.collections:
        settings.product, settings.product_collection = None, bpy.data.collections[name]
    else:
        settings.product, settings.product_collection = _find(name, "product"), None


def _parser():
    parser = argparse.ArgumentParser(prog="thenar", description="Skin contact of a hand with a product")
    commands = parser.add_subparsers(required=True, metavar="command")
    solve = commands.add_parser("solve", help="press the hand of a file against a product")
    solve.add_argument("blend", nargs="?", help="the .blend file; left out under 'blender -b FILE --command'")
    add_press_options(solve)
    solve.add_argument("--out", metavar="OUT.blend", help="save the solved file there")
    solve.add_argument("--render", metavar="OUT.png", help="render the scene with pressure and legend")
    solve.add_argument("--map", choices=[kind.lower() for kind in maps.MAPS], help="what the rendered colours show")
    solve.add_argument("--json", metavar="OUT.json", help="write the result there")
    solve.set_defaults(run=_solve)
    batch = commands.add_parser("batch", help="solve many cases, each in a process of its own")
    batch.add_argument("jobs", metavar="JOBS.toml")
    batch.add_argument("--out", required=True, metavar="DIR")
    batch.add_argument("--workers", type=int, default=0, help="processes at a time; 0: as processors and memory allow")
    batch.add_argument("--scheduler", metavar="ADDRESS", help="solve on the workers of this Dask scheduler")
    batch.add_argument("--part", metavar="I/N", help="solve every N-th case from the I-th on, and write no tables")
    batch.set_defaults(run=_batch)
    worker = commands.add_parser("worker", help="solve cases that come as lines of JSON; started by batch")
    worker.set_defaults(run=_worker)
    demo = commands.add_parser("demo", help="solve and render the sample grasp")
    demo.add_argument("--sample", metavar="FILE.blend")
    demo.add_argument("--samples", metavar="DIR", default="blend-samples")
    demo.add_argument("--out", default="target/demo", metavar="DIR")
    demo.set_defaults(run=_demo)
    samples = commands.add_parser("samples", help="make the sample files anew")
    samples.add_argument("--out", required=True, metavar="DIR")
    samples.set_defaults(run=_samples)
    return parser


def add_press_options(parser):
    """Options that say what to press and how; the scene's own settings stand for those left out."""
    parser.add_argument("--hand", metavar="NAME", help="object that is the hand")
    parser.add_argument("--product", metavar="NAME", help="object or collection that is the product")
    parser.add_argument("--force", type=float, metavar="N", help="normal force to reach")
    parser.add_argument("--model", choices=("layer", "paper"))
    parser.add_argument("--frame", type=int)
