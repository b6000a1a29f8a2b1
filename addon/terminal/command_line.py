"""The command line: solve, batch, demo, samples. One `main` for Blender's `--command` and for `python -m`."""

import argparse
import importlib
import sys
from pathlib import Path

import bpy

from .. import maps, native
from ..scene.checks import Refusal
from . import headless


def main(arguments):
    """Run one command. Returns the exit code: 0 done, 2 bad input (one sentence on stderr); anything else is raised."""
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as leave:
        return leave.code or 0
    try:
        code = options.run(options) or 0
    except OSError as error:
        print(f"thenar: '{error.filename2 or error.filename}': {error.strerror}", file=sys.stderr, flush=True)
        return 2
    except (Refusal, *native.error_types()) as error:
        text = " ".join(str(error).split())
        print(f"thenar: {text}", file=sys.stderr, flush=True)
        return 2
    return code


def _solve(options):
    if options.blend:
        headless.open_file(options.blend)
    elif not bpy.data.filepath:
        raise Refusal("no file is open; name the .blend file to solve")
    summary = headless.press(options)
    if options.render:
        from .. import pictures

        pictures.render_scene(bpy.context, Path(options.render), options.map and options.map.upper())
    if options.out:
        headless.save_file(options.out)
    if options.json:
        headless.save_json(options.json, summary)
    print(
        f"{summary['force_n']:.2f} N on {summary['contact_area_mm2'] / 100:.2f} cm2, "
        f"peak {summary['peak_pressure_kpa']:.1f} kPa, mean {summary['mean_pressure_kpa']:.1f} kPa",
        flush=True,
    )


def _batch(options):
    from .. import batch

    by = batch.By(options.workers, options.scheduler, options.part)
    try:
        with batch.by_signals():
            batch.run(Path(options.jobs), Path(options.out), by)
    except batch.Stopped as stopped:
        print(f"thenar: {stopped}", file=sys.stderr, flush=True)
        return stopped.code
    return 0


def _worker(_options):
    from ..batch import worker

    worker.serve()


def _demo(options):
    from . import demo

    demo.run(options.sample or options.samples, Path(options.out), options.frames)


def _picture(options):
    from .. import picture_sets

    picture_sets.run(options)


def _pose_pictures(options):
    from ..pose_library import pictures

    pictures.render(options.out)


def _samples(options):
    try:
        maker = importlib.import_module("..grasp.samples", __package__)
    except ModuleNotFoundError:
        raise Refusal("this build cannot make samples") from None
    maker.make_samples(Path(options.out))


def _parser():
    parser = argparse.ArgumentParser(prog="thenar", description="Skin contact of a hand with a product")
    commands = parser.add_subparsers(required=True, metavar="command")
    solve = commands.add_parser("solve", help="press the hand of a file against a product")
    solve.add_argument("blend", nargs="?", help="the .blend file; left out under 'blender -b FILE --command'")
    add_press_options(solve)
    solve.add_argument("--out", metavar="OUT.blend", help="save the solved file there")
    solve.add_argument("--render", metavar="OUT.png", help="render the scene with pressure and legend")
    solve.add_argument("--map", choices=[kind.lower() for kind in maps.MAPS], help="what the rendered colors show")
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
    demo.add_argument("--frames", action="store_true", help="solve it at least, mean and greatest force (Xie Fig. 21)")
    demo.set_defaults(run=_demo)
    kinds = ("grip_and_print", "comfort_card", "turntable", "unrolled", "on_glass", "live_film")
    picture = commands.add_parser("picture", help="make a picture of the result that a file holds")
    picture.add_argument("blend", metavar="FILE.blend")
    picture.add_argument("--kind", choices=kinds)
    picture.add_argument("--out", metavar="FILE", help="where to: .png, for a film .mp4; a card is written as .pdf too")
    picture.add_argument("--height", type=int, default=1080, metavar="PIXELS")
    picture.add_argument("--samples", type=int, default=8, help="rays per pixel")
    picture.add_argument("--rate", type=int, default=24, help="frames a second of a turntable")
    picture.add_argument("--frames", type=int, default=48, help="most frames of a live film")
    picture.add_argument(
        "--percentiles", action="store_true", help="on a card: hands of three sizes that grasp the product"
    )
    picture.add_argument("--overwrite", action="store_true", help="replace the file if it exists")
    picture.add_argument("--order", metavar="JSON", help=argparse.SUPPRESS)
    picture.set_defaults(run=_picture)
    poses = commands.add_parser("pose_pictures", help="make the pictures of the pose library again")
    poses.add_argument("--out", required=True, metavar="DIR")
    poses.set_defaults(run=_pose_pictures)
    samples = commands.add_parser("samples", help="make the sample files again")
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
