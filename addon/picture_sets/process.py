"""Draws in a process of its own, from a copy of the scene: the user's file is only read, and Esc ends the process."""

import json
import os
import subprocess
import sys
import tempfile
import threading
from functools import partial
from pathlib import Path

import bpy

from .. import workflow
from ..batch import here
from ..results import export
from ..scene.checks import Refusal
from . import order as orders

MARK = "thenar-picture:"
"""Begins the lines by which the process says how far it is."""
_WAIT_S = 0.1


def steps(context, order):
    """The picture of the scene as the steps of a computation. Returns the paths written; the scene stays untouched.

    Raises `Refusal`.
    """
    orders.check(order)
    order.scene, order.is_stale = context.scene.name, workflow.is_out_of_date(context)
    wanted = orders.targets(order)
    with tempfile.TemporaryDirectory(prefix="thenar-", ignore_cleanup_errors=True) as folder:
        scene, inside = Path(folder) / "scene.blend", Path(folder) / wanted[0].name
        bpy.data.libraries.write(str(scene), {context.scene}, path_remap="ABSOLUTE")
        given = orders.Order(**{**json.loads(orders.to_text(order)), "target": str(inside)})
        made = yield partial(_run, (scene, given))
        return _put(made, wanted)


def _put(made, wanted):
    """Move what was made to where it is wanted; frames of a film that go next to it replace nobody's file."""
    written, folder = [], wanted[0].parent
    for path in map(Path, made):
        target = folder / path.name
        if target not in wanted and target.exists():
            raise Refusal(f"'{target}' exists already; choose another name, or tick Overwrite")
        try:
            folder.mkdir(parents=True, exist_ok=True)
            export.replace_file(target, lambda aside, path=path: aside.write_bytes(path.read_bytes()))
        except OSError as error:
            raise Refusal(f"'{target}' cannot be written ({error.strerror}); choose another folder") from None
        written.append(target)
    return written


def _run(job, cancel=None, progress=None):
    """Draw the order of `job` = (file, order) in a process; what it wrote."""
    scene, order = job
    command = [*here.command()[:-1], "picture", str(scene), "--order", orders.to_text(order)]
    environment = {**os.environ, "PYTHONPATH": here.environment([])["PYTHONPATH"]}
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as complaints:
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=complaints, env=environment
        )
        heard = _Heard(progress)
        listener = threading.Thread(target=heard.listen, args=(process.stdout,), daemon=True)
        listener.start()
        try:
            while process.poll() is None:
                if cancel is not None and cancel.is_set():
                    raise Refusal("the picture was cancelled")
                listener.join(_WAIT_S)
                if not listener.is_alive():
                    process.wait()
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
            process.stdin.close()
            listener.join()
        if process.returncode or heard.files is None:
            complaints.seek(0)
            raise Refusal(_why(process.returncode, complaints.read()))
    return heard.files


class _Heard:
    """What the process said: progress is passed on, the files that it wrote are kept."""

    def __init__(self, progress):
        self.files, self._progress = None, progress

    def listen(self, stream):
        """Take lines until the process closes its output."""
        with stream:
            for line in stream:
                text = line.decode("utf-8", errors="replace").strip()
                if text.startswith(MARK):
                    self._take(json.loads(text.removeprefix(MARK)))

    def _take(self, said):
        if "files" in said:
            self.files = said["files"]
        elif self._progress is not None:
            self._progress(said["stage"], said["share"])


def _why(code, complaints):
    lines = [line.strip() for line in complaints.splitlines() if line.strip()]
    refusals = [line.removeprefix("thenar: ") for line in lines if line.startswith("thenar: ")]
    if refusals:
        return refusals[-1]
    return f"the process that draws ended with code {code}" + (f": {lines[-1]}" if lines else "")


def serve(order, draw):
    """In the process: draw, and say how far it is and what was written. Ends when the one who asked is gone."""
    threading.Thread(target=_end_with_parent, args=(sys.stdin.fileno(),), daemon=True).start()

    def tell(stage, share):
        _say({"stage": stage, "share": share})

    order.tell = tell
    _say({"files": [str(path) for path in draw(order, bpy.context)]})


def _end_with_parent(pipe):
    """Nothing is ever written to the input: it ends with the process that holds its other end."""
    while os.read(pipe, 1):
        pass
    os._exit(1)


def _say(values):
    sys.stdout.write(f"\n{MARK}{json.dumps(values)}\n")
    sys.stdout.flush()
