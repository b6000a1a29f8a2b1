"""Blender that quits, loads a file or loses the extension while something computes: all ends well."""

import subprocess
import sys
import threading
from pathlib import Path

import bpy
import pytest
import test_computing
import thenar_blender
from thenar_blender.operators import running

HERE = Path(__file__).parents[1]
PRESSING = """
import sys
sys.path.insert(0, sys.argv[1])
import bpy, stage, thenar_blender
from thenar_blender import status, workflow
from thenar_blender.operators import running
bpy.ops.wm.read_factory_settings(use_empty=True)
thenar_blender.register()
hand, product = stage.pad(fineness=7), stage.plate()
bpy.context.scene.thenar.hand, bpy.context.scene.thenar.product = hand, product
stage.raise_under(hand, product, depth=4.0)
worker = running.Worker(next(workflow.steps(bpy.context)))
while not status.run.stage:
    pass
assert not worker.is_done()
"""
# Blender 4.5 never ends while an extension is registered, whichever it is.
ENDINGS = [("thenar_blender.unregister()", 0)]
if bpy.app.version >= (5, 0):
    ENDINGS += [("", 0), ("sys.exit(3)", 3), ("raise RuntimeError('on purpose')", 1)]


@pytest.mark.parametrize(("end", "code"), ENDINGS)
def test_blender_quits_while_it_presses(end, code):
    for _ in range(3):
        command = [sys.executable, "-c", PRESSING + end, str(HERE)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120)
        assert done.returncode == code, done.stderr
        assert "Thread" not in done.stderr and "AssertionError" not in done.stderr


def patient(cancel, progress):
    """Work that listens and would go on for a minute."""
    cancel.wait(60.0)


@pytest.fixture
def under_way(monkeypatch):
    """A computation as a button starts it; windows are not there, so their part is left out."""
    monkeypatch.setattr(running, "begin", lambda context, operator: "timer")
    monkeypatch.setattr(running, "end", lambda context, timer: ended.append(timer))
    ended, threads = [], set(threading.enumerate())
    operator = test_computing.Operator([patient])
    operator._steps = operator.steps(None)
    operator._start(None, next(operator._steps))
    (worker,) = set(threading.enumerate()) - threads
    yield operator
    assert ended == ["timer"] and operator.undone == 1 and not worker.is_alive()
    assert operator.modal(None, None) == {"CANCELLED"}, "Blender may call it once more"


def test_loading_a_file_ends_what_computes(under_way):
    bpy.ops.wm.read_homefile(use_empty=True)


def test_switching_the_extension_off_ends_what_computes(under_way):
    thenar_blender.unregister()
    thenar_blender.register()
