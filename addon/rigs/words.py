"""What the names of bones say about digits and sides. Names confirm what the geometry found; they do not decide it.

Knows nothing of Blender.
"""

import re

DIGITS = ("thumb", "index", "middle", "ring", "little")

_WORDS = {
    "thumb": {"thumb", "pollex", "tmb"},
    "index": {"index", "pointer", "forefinger", "fore", "idx"},
    "middle": {"middle", "mid"},
    "ring": {"ring"},
    "little": {"little", "pinky", "pinkie", "small", "pnk"},
}
_SIGNS = {"親指": "thumb", "人指": "index", "人差": "index", "中指": "middle", "薬指": "ring", "小指": "little"}
_NO_HAND = {
    "foot": {"toe", "toes", "foot", "ball", "bigtoe", "smalltoe", "metatarsal", "metatarsals", "hallux"},
    "face": {"brow", "lip", "lid", "eye", "eyelid", "tongue", "jaw", "cheek", "nose", "ear", "mouth", "face", "head"},
    "hair": {"hair", "bang", "bangs", "ponytail"},
    "cloth": {"skirt", "cape", "sleeve", "cloth", "dress", "coat"},
}
_LEFT, _RIGHT = {"l", "left", "lf"}, {"r", "right", "rt"}


def tokens(name):
    """Lower-case words of a bone's name: `mixamorig:LeftHandIndex1` is mixamorig, left, hand, index, 1."""
    apart = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", name)
    apart = re.sub(r"([A-Za-z])(\d)", r"\1 \2", apart)
    apart = re.sub(r"(\d)([A-Za-z])", r"\1 \2", apart)
    return [word.lower() for word in re.split(r"[^A-Za-z0-9]+", apart) if word]


def digits_of(chains):
    """Digit or None for each chain of bone names, e.g. `[["thumb.01.R", ...], ...]`.

    A chain's digit is what most of its names say; `middle_phalanx` is no middle finger. Numbered fingers
    (`finger1-1`, `Bip01 L Finger0`) count from the thumb if every chain has a number of its own.
    """
    out = [_spoken(chain) for chain in chains]
    if not any(out):
        numbers = [_number(chain[0]) for chain in chains]
        if None not in numbers and len(set(numbers)) == len(numbers) == len(DIGITS):
            ranks = {number: rank for rank, number in enumerate(sorted(numbers))}
            out = [DIGITS[ranks[number]] for number in numbers]
    return out


def side_of(names):
    """`left`, `right` or None, as most of the names say it: `.L`, `_r`, `Left`, `lIndex1`, `左`."""
    votes = {"left": 0, "right": 0}
    for name in names:
        words = set(tokens(name))
        small = re.match(r"^([lr])[A-Z]", name)
        if words & _LEFT or "左" in name or (small and small[1] == "l"):
            votes["left"] += 1
        if words & _RIGHT or "右" in name or (small and small[1] == "r"):
            votes["right"] += 1
    if votes["left"] == votes["right"]:
        return None
    return max(votes, key=votes.get)


def other_part(names):
    """`foot`, `face`, `hair` or `cloth` if at least half the names say so and none speaks of a finger; else None."""
    if any(_spoken([name]) or "finger" in tokens(name) for name in names):
        return None
    for part, words in _NO_HAND.items():
        if 2 * sum(bool(words & set(tokens(name))) for name in names) >= len(names):
            return part
    return None


def _spoken(chain):
    votes = {}
    for name in chain:
        cleaned = re.sub(r"middle_?(phalanx|$)|middle(?=[._-][lr]$)", "", name.lower()) if "_" in name else name
        words = tokens(name) if cleaned.lower() == name.lower() else tokens(cleaned)
        found = next((digit for sign, digit in _SIGNS.items() if sign in name), None)
        for word in words:
            found = found or next((digit for digit, known in _WORDS.items() if word in known), None)
        if found:
            votes[found] = votes.get(found, 0) + 1
    return max(votes, key=votes.get) if votes else None


def _number(name):
    found = re.search(r"(?:finger|digit)[ _.-]*(\d)", name.lower())
    return int(found[1]) if found else None
