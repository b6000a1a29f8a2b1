"""Makes the trial's cases with maps: local_cases.npz, local_cases.json (public) and local_labels.json (sealed).

`python -m trial.drawing.make_local_cases` in `tests`, from inclusions_by_finite_elements.npz by way of studies.py. On
trial: the pad `finger` with each of the twelve spots three times, and without any; for calibration: the other pads,
without. What a case's folder holds besides the skin is kept as the text that it is.
"""

import hashlib
import json
import tempfile
import zlib
from pathlib import Path

import numpy as np
from trial import pads, studies

HERE = Path(__file__).parents[1]
WAYS = ((0.01, "fine"), (0.03, "fine"), (0.01, "coarse"))  # noise and mat of a spot's three cases
NULLS = 18


def plans():
    """(split, case of studies.py, noise, mat), in order."""
    for spot in pads.SPOTS:
        yield from (("trial", spot, *way) for way in WAYS)
    for split, of in (("trial", ["finger"]), ("calibration", [pad for pad in pads.PADS if pad != "finger"])):
        yield from ((split, of[k % len(of)], *WAYS[k % len(WAYS)]) for k in range(NULLS))


def made(split, case, noise, mat, seed):
    """(public entry, label, packed files) of one case."""
    with tempfile.TemporaryDirectory() as folder:
        truth = studies.make(case, seed, noise, folder, mat)
        files = {path.name: path.read_text() for path in sorted(Path(folder).iterdir()) if path.suffix != ".ply"}
    label = {"stratum": "local" if case in pads.SPOTS else "null", "names": [], "noise": noise}
    label |= {"scatter": "maps", "pitch_mm": studies.MATS[mat][0]}
    if case in pads.SPOTS:
        label |= {"names": ["inclusion"], "center_mm": truth.center_mm, "depth_mm": truth.depth_mm}
        label |= {"radius_mm": truth.radius_mm, "contrast": truth.contrast}
    pad = case if case in pads.PADS else "finger"
    return {"split": split, "pad": pad, "mat": mat}, label, zlib.compress(json.dumps(files).encode(), 9)


def main():
    """Makes every case, shuffles them, and writes the three files."""
    found = [made(*plan, 7000 + k) for k, plan in enumerate(plans())]
    salt = hashlib.sha256(np.random.default_rng(6).bytes(16)).hexdigest()[:16]
    public, labels, packed, first = {}, {}, [], 0
    for number, where in enumerate(np.random.default_rng(98).permutation(len(found))):
        entry, label, files = found[where]
        sealed = hashlib.sha256((salt + json.dumps(label, sort_keys=True)).encode()).hexdigest()
        public[f"local_{number:03d}"] = entry | {"label": sealed, "bytes": [first, first + len(files)]}
        labels[f"local_{number:03d}"] = label
        packed.append(np.frombuffer(files, dtype=np.uint8))
        first += len(files)
    np.savez(HERE / "local_cases.npz", files=np.concatenate(packed))
    for name, value in (("cases", {"cases": public}), ("labels", {"salt": salt, "labels": labels})):
        (HERE / f"local_{name}.json").write_text(json.dumps(value).replace('"local_', '\n"local_') + "\n")


if __name__ == "__main__":
    main()
