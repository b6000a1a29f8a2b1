"""The order of a diagnosis: load the study, diagnose it in any thread, keep what was found in the scene."""

import json
from functools import partial

from .. import native
from ..recordings import settings as recordings
from ..results import reports
from ..scene.checks import Refusal
from . import curves, freshness, reading, settings


def steps(context):
    """The diagnosis of the selected study as the steps of a computation. Returns the parsed findings."""
    problem = native.problem()
    if problem:
        raise Refusal(problem)
    item = recordings.chosen(context)
    if item is None or item.kind != recordings.STUDY:
        raise Refusal("no study is selected; load its folder under Recordings, and select it")
    title, path, state = item.name, item.path, context.scene.thenar_diagnosis
    result, told, study_hash = yield partial(_diagnose, path)
    found = reading.parse(told)
    settings.fill(state, told, (title, path, study_hash))
    named = found.get("findings", ())
    clearest = [name for finding in named for name in (finding.get("when") or {}).get("recordings", ())]
    state.curves = curves.kept(result.curves, clearest) if named else ""
    state.stamp = reports.keep(result)
    freshness.forget()
    return found


def _diagnose(path, cancel=None, progress=None):
    """The library's diagnosis, its findings as compact text, and the digest of the study's files before it."""
    thenar, study_hash = native.module, freshness.digest(path)
    result = thenar.diagnose(thenar.Study.load(path), progress=progress, cancel=cancel)
    return result, json.dumps(json.loads(result.to_json()), ensure_ascii=False, separators=(",", ":")), study_hash
