"""Rules that the tree breaks today: each count may fall, never rise. `python tests/architecture/ratchets.py`.

`--update` writes fallen counts to `ratchets.toml` and refuses risen ones; `--raise RULE.PLACE` lets one rise, and the
commit says why. The name of a place (`contact`, `addon`) or of a rule lists what is counted. Code under `cfg(test)`
counts for words only.
"""

import re
import sys
import tomllib
from pathlib import Path

import circles
import rust_tokens
import signatures
import sources

ROOT = Path(__file__).resolve().parents[2]
TABLE = Path("tests/architecture/ratchets.toml")
MOST_FILES = 15
MOST_README = 150
# Words for which the field has a term, and stems that no newcomer can guess.
AVOIDED = "told foretold beside anew borne_out made_of takes_up stands left_over"
STEMS = (
    "acting shown made promise possible planned looks atoms alike together standing carried held spread turned kept "
    "half along rounded weld remarks poke walk"
)
# Names that belong to other projects, or to the language.
PASSED = {"mod", "lib", "main", "__init__", "conftest"}


def files_in_circles(root):
    """Files that use each other in a circle, by crate and in the add-on."""
    return {place: [name for circle in found for name in circle] for place, found in _circles(root).items()}


def largest_circle(root):
    return {place: found[0] for place, found in _circles(root).items() if found}


def values_per_function(root):
    """Functions that take more than five values, counted through tuples."""
    found = {}
    for crate in sources.crates(root):
        texts = {path: path.read_text() for path in sources.library_sources(root, crate)}
        aliases = signatures.tuples_by_name(texts.values())
        for path, text in texts.items():
            found.setdefault(crate, []).extend(_crowded(root, path, signatures.of_rust(text, aliases)))
    for path in sorted((root / "addon").rglob("*.py")):
        found.setdefault("addon", []).extend(_crowded(root, path, signatures.of_python(path.read_text())))
    return found


def files_per_folder(root):
    """Files of code beyond fifteen, by folder."""
    folders = {}
    for path in sources.with_suffix(root, ".rs", ".py"):
        folders.setdefault(path.parent.as_posix(), []).append(path.name)
    return {folder: names[MOST_FILES:] for folder, names in folders.items() if len(names) > MOST_FILES}


def readme_lines(root):
    path = root / "README.md"
    return {"README.md": path.read_text().splitlines()[MOST_README:]} if path.exists() else {}


def avoided_words(root):
    """Words to avoid in the names of files, and of test functions, by crate, in the add-on and in the tests."""
    found = {}
    for path in sources.with_suffix(root, ".rs", ".py"):
        place = path.parts[1] if path.parts[0] == "rust" else path.parts[0]
        names = [] if path.stem in PASSED else [(path.stem, word) for word in _words(path.stem, f"{AVOIDED} {STEMS}")]
        for name in _test_functions(root / path):
            names += [(name, word) for word in _words(name, AVOIDED)]
        found.setdefault(place, []).extend(f"{path}: '{word}' in {name}" for name, word in names)
    return found


ALL = [files_in_circles, largest_circle, values_per_function, files_per_folder, readme_lines, avoided_words]


def counts(root, rule):
    """What `rule` counts by place, where there is anything."""
    return {place: len(found) for place, found in sorted(rule(root).items()) if found}


def complaints(root, rule, table):
    """What is otherwise than in the table: a count that rose, or one that fell and must be lowered there."""
    allowed, wrong = table.get(rule.__name__, {}), []
    now = counts(root, rule)
    for place in sorted({*allowed, *now}):
        before, count = allowed.get(place, 0), now.get(place, 0)
        if count > before:
            wrong.append(f"{rule.__name__}, {place}: {count}, {before} allowed ({_command(rule.__name__)} lists them)")
        elif count < before:
            wrong.append(f"{rule.__name__}, {place}: lower the ratchet to {count} ({_command('--update')})")
    return wrong


def read_table(root):
    path = root / TABLE
    return tomllib.loads(path.read_text()) if path.exists() else {}


def updated(root, table, raised=()):
    """The table with fallen counts, and what rose without being named in `raised` (RULE.PLACE)."""
    new, refused = {}, []
    for rule in ALL:
        allowed = table.get(rule.__name__, {})
        for place, count in counts(root, rule).items():
            may_rise = f"{rule.__name__}.{place}" in raised or not table
            before = allowed.get(place, 0)
            if count > before and not may_rise:
                refused.append(f"{rule.__name__}.{place}: {count}, {before} allowed")
            kept = count if may_rise else min(count, before)
            if kept:
                new.setdefault(rule.__name__, {})[place] = kept
    return new, refused


def written(table):
    """The text of a table, a line for every place, so that two branches seldom touch the same one."""
    lines = [f"# What breaks a rule today; every number may only fall. Written by {_command('--update')}"]
    for rule in ALL:
        if rule.__name__ in table:
            lines += ["", f"# {_goal(rule)}", f"[{rule.__name__}]"]
            lines += [f'"{place}" = {count}' for place, count in sorted(table[rule.__name__].items())]
    return "\n".join(lines) + "\n"


def _goal(rule):
    return {
        "files_in_circles": "Files that stand in circles.",
        "largest_circle": "Files of the largest circle.",
        "values_per_function": f"Functions of more than {signatures.MOST} values, counted through tuples.",
        "files_per_folder": f"Files of code beyond {MOST_FILES}.",
        "readme_lines": f"Lines beyond {MOST_README}.",
        "avoided_words": "Words to avoid in names of files and test functions.",
    }[rule.__name__]


def _command(argument):
    return f"python tests/architecture/ratchets.py {argument}"


def _circles(root):
    found = {crate: circles.of_crate(root, crate) for crate in sources.crates(root)}
    return found | {"addon": circles.of_addon(root)}


def _crowded(root, path, found):
    name = path.relative_to(root)
    return [f"{name}: {function} takes {count}" for function, count in found if count > signatures.MOST]


def _words(name, words):
    return [word for word in words.split() if re.search(rf"(^|_){word}(_|$)", name)]


def _test_functions(path):
    if path.suffix == ".py":
        return re.findall(r"^\s*def (test_\w+)", path.read_text(), re.MULTILINE)
    code, names = rust_tokens.tokens(path.read_text()), []
    for at in range(len(code) - 4):
        if code[at : at + 4] == ["#", "[", "test", "]"] and "fn" in code[at:]:
            names.append(code[code.index("fn", at) + 1])
    return names


def main(arguments):
    table = read_table(ROOT)
    if "--update" in arguments or "--raise" in arguments:
        raised = arguments[arguments.index("--raise") + 1 :] if "--raise" in arguments else []
        new, refused = updated(ROOT, table, raised)
        (ROOT / TABLE).write_text(written(new))
        print("\n".join(f"refused to rise: {line}" for line in refused) or "written")
        return 1 if refused else 0
    for rule in ALL:
        found = rule(ROOT)
        for place in sorted(found):
            if found[place]:
                print(f"{rule.__name__}, {place}: {len(found[place])}")
            if {rule.__name__, place} & set(arguments):
                print("\n".join(f"    {line}" for line in found[place]))
    for place in arguments:
        uses = circles.addon_uses(ROOT) if place == "addon" else {}
        uses = circles.crate_uses(ROOT, place) if place in sources.crates(ROOT) else uses
        print("\n".join(circles.shown(uses)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
