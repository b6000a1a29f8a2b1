"""Libraries that peers need, from Debian packages unpacked beside the build: nothing is installed."""

import ctypes
import shutil
import subprocess


class Unavailable(Exception):
    """A peer cannot be had here; the message says why."""


def unpacked(root, packages):
    """The folder `root` with these packages unpacked in it, fetched once. Raises Unavailable."""
    if root.is_dir():
        return root
    if not (shutil.which("apt-get") and shutil.which("dpkg-deb")):
        raise Unavailable(f"{packages[0]} comes from Debian, and this machine has no apt-get and dpkg-deb")
    part = root.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    got = subprocess.run(["apt-get", "download", *packages], cwd=part, capture_output=True, text=True)
    if got.returncode != 0:
        lines = got.stderr.strip().splitlines() or ["apt-get download failed"]
        raise Unavailable(f"Debian's {packages[0]} cannot be downloaded: {lines[-1]}")
    for package in sorted(part.glob("*.deb")):
        subprocess.run(["dpkg-deb", "-x", package, part], check=True)
    part.rename(root)
    return root


def load(root, packages, name):
    """Loads the library `name` of these packages for every module that asks for it later. Raises Unavailable."""
    for library in sorted(unpacked(root, packages).rglob(name)):
        try:
            return ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
        except OSError as error:
            raise Unavailable(str(error)) from error
    raise Unavailable(f"{packages[0]} holds no {name}")
