"""Rules of the Rust crates: who depends on whom, what stands in one file only, and no input or output in libraries."""

import re

import sources

# Crate folder -> crates of ours that it may depend on; the table of the house, left to right.
ALLOWED = {
    "surface": set(),
    "contact": {"surface"},
    "hand": {"surface"},
    "reference": {"surface"},
    "recordings": {"surface"},
    "inference": {"surface", "contact", "recordings"},
    "comparison": {"surface", "contact", "recordings", "inference"},
    "diagnosis": {"surface", "contact", "recordings", "inference", "comparison"},
    "report": {"surface", "contact", "recordings", "inference", "comparison", "diagnosis"},
    "python": {
        "surface",
        "contact",
        "hand",
        "reference",
        "recordings",
        "inference",
        "comparison",
        "diagnosis",
        "report",
    },
    "cli": {"surface", "contact", "hand", "recordings", "inference", "comparison", "diagnosis", "report"},
    "xtask": set(),
}
LIBRARIES = ["surface", "contact", "hand", "reference", "recordings", "inference", "comparison", "diagnosis", "report"]
# Pattern -> the one file that may hold it.
ONE_FILE = {
    r"\b(obvhs|glam)::|\buse (obvhs|glam)\b": "rust/surface/src/tree/bvh.rs",
    r"\bnumpy::|\buse numpy\b": "rust/python/src/conversion/arrays.rs",
    r"\b1\.4826": "rust/inference/src/observe/robust_scale.rs",
    r"\bfn huber\b": "rust/inference/src/least_squares/huber.rs",
    r"\bdamping\b": "rust/inference/src/least_squares/levenberg_marquardt.rs",
}
PRINTING = r"\b(println|eprintln|print|eprint|dbg)!"
# A prepared skin is only read: nobody writes to one or locks one, and what it holds cannot change behind `&`.
WRITTEN_SKIN = r"&('\w+ )?mut (thenar_contact::)?Skin\b|\b(Mutex|RwLock|RefCell)<(thenar_contact::)?Skin\b"
INNER_CHANGE = r"\b(Mutex|RwLock|RefCell|Cell|UnsafeCell|Atomic\w+)\b"
INPUT_OUTPUT = r"\bstd::(fs|net|process|env)\b|\bstd::io::(stdin|stdout|stderr)\b"


def crate_dependencies(root):
    wrong = []
    for crate, manifest in sources.crates(root).items():
        if crate not in ALLOWED:
            wrong.append(f"rust/{crate} has no place in the table of rooms")
            continue
        tables = [manifest.get(name, {}) for name in ("dependencies", "dev-dependencies", "build-dependencies")]
        ours = {name.removeprefix("thenar-") for table in tables for name in table if name.startswith("thenar-")}
        wrong += [f"rust/{crate} must not depend on {other}" for other in sorted(ours - ALLOWED[crate])]
    return wrong


def python_stays_outside(root):
    wrong = []
    for crate, manifest in sources.crates(root).items():
        if crate != "python":
            bound = {"pyo3", "numpy"} & set(manifest.get("dependencies", {}))
            wrong += [f"rust/{crate} must not know {name}" for name in sorted(bound)]
    return wrong


def one_file_only(root):
    wrong = []
    for path in sorted(root.glob("rust/*/src/**/*.rs")):
        name = path.relative_to(root).as_posix()
        code = sources.rust_code(path)
        for pattern, home in ONE_FILE.items():
            if name != home and re.search(pattern, code):
                wrong.append(f"{name} uses what only {home} may use")
    return wrong


def libraries_are_silent(root):
    return _found_in_libraries(root, LIBRARIES, PRINTING, "prints")


def libraries_read_no_files(root):
    readers = [crate for crate in LIBRARIES if crate != "recordings"]
    return _found_in_libraries(root, readers, INPUT_OUTPUT, "does input or output")


def skins_are_only_read(root):
    """No `&mut Skin`, no lock around one, no method of it with `&mut self`, and no interior mutability in its room."""
    users = [crate for crate in sources.crates(root) if crate == "contact" or "contact" in ALLOWED.get(crate, ())]
    wrong = _found_in_libraries(root, users, WRITTEN_SKIN, "writes to a skin")
    for path in sorted(root.glob("rust/contact/src/**/*.rs")):
        name, code = path.relative_to(root).as_posix(), sources.rust_code(path)
        methods = "".join(re.findall(r"^impl Skin \{.*?^\}", code, re.DOTALL | re.MULTILINE))
        if "&mut self" in methods:
            wrong.append(f"{name}: a method of Skin takes &mut self")
        if name.startswith("rust/contact/src/skin/") and (match := re.search(INNER_CHANGE, code)):
            wrong.append(f"{name} writes to a skin: {match.group()}")
    return wrong


def lints_are_on(root):
    """`clippy -D warnings` forbids unwrap only where the workspace's lints are taken over and not allowed away."""
    wrong = [
        f"rust/{crate}/Cargo.toml does not take the workspace's lints"
        for crate, manifest in sources.crates(root).items()
        if not manifest.get("lints", {}).get("workspace")
    ]
    for path in sorted(root.glob("rust/*/src/**/*.rs")):
        if re.search(r"allow\([^)]*unwrap_used", sources.rust_code(path)):
            wrong.append(f"{path.relative_to(root)} allows unwrap")
    return wrong


def version_stands_once(root):
    return [
        f"rust/{crate}/Cargo.toml states a version of its own"
        for crate, manifest in sources.crates(root).items()
        if manifest["package"].get("version") != {"workspace": True}
    ]


def _found_in_libraries(root, crates, pattern, what):
    wrong = []
    for crate in crates:
        for path in sources.library_sources(root, crate):
            match = re.search(pattern, sources.rust_code(path))
            if match:
                wrong.append(f"{path.relative_to(root)} {what}: {match.group()}")
    return wrong


ALL = [
    crate_dependencies,
    python_stays_outside,
    one_file_only,
    libraries_are_silent,
    libraries_read_no_files,
    skins_are_only_read,
    lints_are_on,
    version_stands_once,
]
