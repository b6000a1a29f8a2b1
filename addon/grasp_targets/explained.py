"""What is said of a posture that explains a recording. Knows nothing of the search."""

from ..languages import report

LITTLE = 0.1
"""A posture that removes a smaller share of what was left over explains nothing."""


def sentence(found):
    """Report level and sentence for a `recording.Explained`."""
    is_explained = found.before.is_noise(found.recorded_n) or (removed(found) >= LITTLE and not found.is_gain_as_good)
    level = "INFO" if is_explained else "WARNING"
    return level, " ".join(lines(found))


def lines(found):
    """What is said, a line for each thing: what posture removed, forces, motions, what a gain does, what it is not."""
    before, after = found.before, found.after
    if before.is_noise(found.recorded_n):
        words = "The hand explains the recording as it is, within the noise assumed: {left:.1f} kPa rms by cell."
        return [report(words, left=before.cells_kpa)]
    if removed(found) < LITTLE:
        words = "No posture near this one explains the recording: {left:.1f} kPa rms by cell are left over."
        first = report(words, left=after.cells_kpa)
    else:
        words = "Explained by posture: {share:.0%} of the difference, {before:.1f} to {after:.1f} kPa rms by cell."
        other = "A posture removes {share:.0%} of the difference, {before:.1f} to {after:.1f} kPa rms by cell."
        words = other if found.is_gain_as_good else words
        first = report(words, share=removed(found), before=before.cells_kpa, after=after.cells_kpa)
    words = "Force {before:.0f} N before, {after:.0f} N now, {recorded:.0f} N recorded."
    out = [first, report(words, before=before.force_n, after=after.force_n, recorded=found.recorded_n)]
    words = "Joints turned by up to {turned:.0f} degrees, the hand moved {moved:.1f} mm."
    out.append(report(words, turned=found.turned_deg, moved=found.moved_mm))
    if found.is_gain_as_good:
        words = "A gain of {gain:.2f} of the mat explains as much with the hand as it was: check the calibration first."
        out.append(report(words, gain=before.gain))
    return [*out, report("Tissue stayed as it is: one frame does not tell posture from tissue.")]


def removed(found):
    """Share of the difference by cell that the posture removed."""
    return 1.0 - found.after.cells_kpa / max(found.before.cells_kpa, 1e-9)
