"""addon/docs/effects.md lists the effects as the library does: run this file to write that half of it again."""

from pathlib import Path

import thenar

DOCUMENT = Path(__file__).parents[2] / "addon/docs/effects.md"
KINDS = {"tissue": "## Effects of tissue and contact", "instrument": "## Effects of an instrument"}
HEAD = "| number | unit | default | usual range | meaning |\n| --- | --- | --- | --- | --- |"


def catalogue():
    """The document's second half, from `thenar.effects()`."""
    parts = []
    for kind, title in KINDS.items():
        parts.append(title)
        for effect in thenar.effects():
            if effect["kind"] == kind:
                parts += entry(effect)
    return "\n\n".join(parts) + "\n"


def entry(effect):
    """The paragraphs of one effect."""
    meaning = effect["meaning"][:1].upper() + effect["meaning"][1:]
    about = f"{meaning}. Amplitude, 0 to {effect['most']:g}: {effect['amplitude']}. Source: {effect['source']}."
    parts = [f"### `{effect['name']}`", about]
    if effect["shape"]:
        rows = [
            f"| `{row['name']}` | {row['unit']} | {row['default']:g} | {row['physiological'][0]:g} to "
            f"{row['physiological'][1]:g} | {row['meaning']} |"
            for row in effect["shape"]
        ]
        parts.append("\n".join([HEAD, *rows]))
    parts += [f"`{row['name']}` ({', '.join(row['options'])}): {row['meaning']}." for row in effect["choices"]]
    if effect["painted"]:
        parts.append(f"Painted by vertex: {effect['painted']}.")
    parts.append("Signs in data:\n\n" + "\n".join(f"- {sign['sentence']}" for sign in effect["consequences"]))
    return parts


def written(text):
    """The document with its second half made again."""
    return text.split(KINDS["tissue"])[0] + catalogue()


def test_the_document_lists_every_effect_with_its_numbers():
    text = DOCUMENT.read_text()
    assert text == written(text), "run `python tests/python/test_effect_document.py` with the new library"


if __name__ == "__main__":
    DOCUMENT.write_text(written(DOCUMENT.read_text()))
