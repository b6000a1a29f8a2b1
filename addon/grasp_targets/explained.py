"""What is said of a posture that explains a recording. Searches nothing."""

import math

from ..languages import report
from . import recording

HALF = 0.5
"""A posture that leaves more than this share of the difference is not said to explain the recording."""


def sentence(found):
    """Report level and sentence for a `recording.Explained`."""
    is_explained = found.before.is_noise(found.recorded_n) or _explains(found)
    return "INFO" if is_explained else "WARNING", " ".join(lines(found))


def lines(found):
    """What is said, a line for each thing: what posture removed, forces, motions, what a gain does, what it is not."""
    before, after = found.before, found.after
    if before.is_noise(found.recorded_n):
        words = "The hand explains the recording as it is, within the noise assumed: {left:.1f} kPa rms by cell."
        return [report(words, left=before.cells_kpa)]
    if found.removed < recording.LITTLE:
        words = "No posture near this one explains the recording: {left:.1f} kPa rms by cell are left over."
        first = report(words, left=after.cells_kpa)
    else:
        words = "Explained by posture: {share:.0%} of the difference, {before:.1f} to {after:.1f} kPa rms by cell."
        other = "A posture removes {share:.0%} of the difference, {before:.1f} to {after:.1f} kPa rms by cell."
        words = words if _explains(found) else other
        first = report(words, share=found.removed, before=before.cells_kpa, after=after.cells_kpa)
    words = "Force {before:.0f} N before, {after:.0f} N now, {recorded:.0f} N recorded."
    out = [first, report(words, before=before.force_n, after=after.force_n, recorded=found.recorded_n)]
    motion = found.motion
    words = "Joints turned by up to {turned:.0f} degrees; the hand moved {moved:.1f} mm and turned {swung:.0f} degrees."
    if found.grasp is not None:
        out.append(report(words, turned=motion.turned_deg, moved=motion.moved_mm, swung=motion.swung_deg))
    if motion.is_stopped:
        words = "The search stopped at its bounds of {turn:.0f} degrees and {move:.0f} mm: check how the mat lies."
        out.append(report(words, turn=math.degrees(recording.MOST_RAD), move=recording.MOST_MM))
    if found.is_gain_as_good:
        words = "A gain of {gain:.2f} of the mat explains as much with the hand as it was: check the calibration first."
        out.append(report(words, gain=before.gain))
    return [*out, report("Tissue stayed as it is: one frame does not tell posture from tissue.")]


def _explains(found):
    is_bound = found.motion.is_stopped or found.is_gain_as_good
    return found.removed >= HALF and not is_bound
