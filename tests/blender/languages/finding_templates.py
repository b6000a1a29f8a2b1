"""Templates of what *Compare* and *Diagnose* say in the window, from the Rust library's sources."""

import ast
import re
from functools import cache

import error_templates
import sentence_templates as kept

FILES = {
    "comparison": (
        *("comparison/sentence.rs", "comparison/measures.rs", "comparison/quantities.rs", "comparison/series.rs"),
        *("comparison/scan_heights.rs", "comparison/shown_frames.rs", "comparison/single_frame.rs", "compare.rs"),
        *("location/sentence.rs", "location/locate.rs", "location/mismatch.rs", "parameter_words.rs", "prints/"),
    ),
    "inference": ("observe/", "fit/fitting.rs", "fit/print_presses.rs", "noise/estimate.rs", "checks/"),
    "diagnosis": ("verdict_sentence.rs", "wording.rs", "findings.rs"),
}
"""Crate -> files whose strings with words are sentences of results, or parts of them."""
EXPANDED = {
    "{all} {are} explained by parameters within their bounds: what is left is no more than noise ({value1}).": (
        "The recording is explained by parameters within their bounds: what is left is no more than noise ({value1}).",
        "All {count} recordings are explained by parameters within their bounds: what is left is no more than noise "
        "({value1}).",
    ),
    "{subject} compared; without repeats of two protocols nobody can say whether a difference is more than noise.": (
        "One recording was compared; without repeats of two protocols nobody can say whether a difference is more "
        "than noise.",
        "{count} recordings were compared; without repeats of two protocols nobody can say whether a difference is "
        "more than noise.",
    ),
    "Measured {value1} lies {size} {unit}{part} {side} the simulation {value2}, {sure}{caution}.": tuple(
        f"Measured {{what}} lies {{size}} {{unit}}{{part}} {side} the simulation {{place}}, {{sure}}{caution}."
        for side in ("above", "below")
        for caution in ("", "; the simulation itself may be off by {off}")
    ),
    "The simulation lacks {value1}.{instrument}{when}{gained}{sure}": ("The simulation lacks {names}.",),
    "The instrument is at fault, not the skin: {names}.{sure}": ("The instrument is at fault, not the skin: {names}.",),
    "Something is missing, but these recordings cannot distinguish {value1}{with}.{value2}": (
        "Something is missing, but these recordings cannot distinguish {names}{with}.",
    ),
    "{value1} times what the recording's own roughness leaves; no repeats tell the noise": (
        "{value1} times what the recording's own roughness leaves",
        "no repeats tell the noise",
    ),
    "{value1} {unit} ({value2} to {value3}) {side} {what} than the simulation": tuple(
        f"{place}{{who}}, {{when}}, {shows} {{size}} {{unit}} ({{low}} to {{high}}) {side} {{what}} than the "
        "simulation (p = {p}){bound}."
        for place in ("", "Around ({x}, {y}, {z}) mm{cell}, within {radius} mm, ")
        for shows in ("shows", "show")
        for side in ("more", "less")
    ),
    "Around ({value1}, {value2}, {value3}) mm{cell}, within {value4} mm": (),
    "the place is known to {value1} mm, and {stays}": ("the place is known to {value1} mm, and {stays}",),
    "{value1} from {value2}": (),
    "settles it in {value1} % of cases": (),
    "{chance}takes about {value1} minutes": (
        "takes about {minutes} minutes",
        "settles it in {share} % of cases, takes about {minutes} minutes",
    ),
    "The recording": (),
    "All {count} recordings": (),
    "One recording was": (),
    "{count} recordings were": (),
}
"""What one field changes the rest of, or what is said in parts -> the sentences that come of it."""
_NUMBERS = ("gain", "depth at which contact begins", "force at rest", "counts per kPa")
_NUMBERS += ("mat's place", "scan's place", "scan's turn")
MORE = (
    *(
        "In “{name}”",
        "{value} (not fitted)",
        "{key} of region “{region}”{others}",
        "curves",
        "maps",
        "loading",
        "holding",
        "unloading",
        "sliding",
        "apart",
    ),
    *(f"{name} of {{owner}}" for name in _NUMBERS),
    *(
        f"{{phases}} {at}"
        for at in ("at depths of {from} to {to} mm", "at a depth of {at} mm", "from {from} to {to} s")
    ),
    *(f"{{phases}} at {at} mm from {{start}} to {{end}} s" for at in ("depths of {from} to {to}", "a depth of {at}")),
)
"""What is too short to be taken for a sentence, or made of several pieces."""


@cache
def everything():
    """template -> where it stands."""
    raw = {}
    for crate, files in FILES.items():
        for name, text in error_templates.sources(crate, files):
            for found in kept._LITERAL.finditer(text):
                template = kept._named(kept._plain(found[1]).replace("\\u{201c}", "“").replace("\\u{201d}", "”"))
                for part in error_templates.split(template.replace("\\u{b2}", "²").replace("\\u{b1}", "±")):
                    raw.setdefault(part.strip(" ,;"), name)
    gone = [each for each in EXPANDED if each not in raw]
    assert not gone, gone
    out = {text: where for text, where in raw.items() if text not in EXPANDED and not re.match(r"#|<", text)}
    for template, sentences in EXPANDED.items():
        out |= dict.fromkeys(sentences, raw[template])
    letter = "addon/diagnosis/letter.py"
    return {
        **out,
        **dict.fromkeys(headings(kept._read(letter)), letter),
        **dict.fromkeys(MORE, "rust/comparison/src/comparison/sentence.rs"),
    }


def headings(text):
    """What a letter is headed by."""
    values = {line.targets[0].id: line.value for line in ast.parse(text).body if isinstance(line, ast.Assign)}
    return [*ast.literal_eval(values["HEADINGS"]).values(), ast.literal_eval(values["UNNAMED"])]


if __name__ == "__main__":
    for template, where in everything().items():
        print(f"{where}: {template}")
