"""A comparison of the library as properties that the panel shows and the file keeps."""

from math import isnan

from ..results import sentences

_SHOWN = {
    "peak_kpa": "Peak",
    "mean_kpa": "Mean",
    "force_n": "Force",
    "area_mm2": "Area",
    "overlap": "Overlap",
    "center_distance_mm": "Off centre",
    "peak_over_mean": "Peak / mean",
    "largest_force_n": "Largest force",
    "force_rms_residual_n": "Force rms",
    "scan_rms_residual_mm": "Scan rms",
}
"""The measures that the panel shows, and what it calls them: there is little room."""
_HEIGHT = "Scanned height over the skin at rest"
"""What the library calls the quantity of a scan."""


def fill(state, comparison, about):
    """Write a comparison into the scene's `comparison`.

    `about`: name of the recording, the hand on which its places lie or None, and the `Match` of a study's skin with it.
    """
    name, hand, match = about
    state.is_valid, state.recording, state.sentence = True, name, comparison.sentence
    is_hand = hand is not None and hand.type == "MESH"
    state.hand_name, state.vertices = (hand.name, len(hand.data.vertices)) if is_hand else ("", 0)
    for rows in (state.measures, state.worst, state.notes):
        rows.clear()
    several = len(comparison.recordings) > 1
    for recording in comparison.recordings:
        own = f"“{recording.name}”"  # in quotes no language takes it for a word of the interface
        prefix = f"{own}: " if several else ""
        for measure in recording.measures:
            if measure.name in _SHOWN:
                _measure(state.measures.add(), measure, prefix + measure.of)
        for place in recording.worst[:3] if several else recording.worst:
            _worst(state.worst.add(), place, recording)
            state.worst[-1].group = own if several else ""
            vertices = place.vertices if match is None else match.on_hand(place.vertices)
            state.worst[-1].vertices = ",".join(map(str, vertices))
        if recording.print is not None:
            _regions(state.measures, recording.print.regions, prefix + "inked area by region, mm²")
            state.notes.add().name = prefix + recording.sentence
        for text in recording.unknown:
            state.notes.add().name = prefix + text
    for text in comparison.notes:
        state.notes.add().name = text


def _measure(row, measure, group):
    row.name, row.group = _SHOWN[measure.name], group
    is_share = measure.name == "overlap"
    row.unit = "" if is_share else measure.unit
    row.measured = _text(measure.measured, is_share)
    row.simulated = _text(measure.simulated, is_share)


def _regions(rows, regions, group):
    """What of each region touched, where a print shows several."""
    for region in regions:
        row = rows.add()
        row.name, row.group = sentences.region_title(region.name), group
        row.measured, row.simulated = _text(region.recorded_mm2, False), _text(region.simulated_mm2, False)


def _worst(row, place, recording):
    pressure = "kPa" if recording.is_calibrated else "counts"
    unit = {"Pressure": pressure, "Contact area": "mm²", _HEIGHT: "mm"}.get(place.quantity, "N")
    if place.row is not None:
        row.name = f"row {place.row}, column {place.column}"
    elif place.sensel is not None:
        row.name = f"sensel {place.sensel}"
    else:
        brief = {"Contact area": "area", _HEIGHT: "height"}.get(place.quantity, place.quantity.lower())
        row.name = f"{brief} at {place.time_s:.3g} s"
    if recording.print is not None:
        row.residual = f"{abs(place.residual):.3g} mm², {'ink alone' if place.residual > 0 else 'no ink'}"
        return
    sigmas = "" if isnan(place.residual_sigmas) else f", {place.residual_sigmas:+.1f} σ"
    row.residual = f"{place.residual:+.3g} {unit}{sigmas}"


def _text(value, is_share):
    if isnan(value):
        return ""
    value += 0.0  # the library's sums of nothing are -0
    return f"{value:.0%}" if is_share else f"{value:.4g}"
