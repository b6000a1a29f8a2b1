"""Siconos' lexicographic Lemke, from Debian packages."""

import ctypes
from pathlib import Path

import numpy as np
from bench.peers import debian
from bench.peers.debian import Unavailable

LEMKE = 200  # SICONOS_LCP_LEMKE
DENSE = 0  # NM_DENSE
PACKAGES = [
    "libsiconos-numerics7",
    "libopenblas0-pthread",
    "liblapacke",
    "libtmglib3",
    "liblapack3",
    "libblas3",
    "libcxsparse3",
    "libldl2",
    "libsuitesparseconfig5",
    "libscotch-7.0",
    "libmumps-seq-5.5",
    "libgfortran5",
]


class _Problem(ctypes.Structure):
    _fields_ = (("size", ctypes.c_int), ("matrix", ctypes.c_void_p), ("q", ctypes.c_void_p))


def load(folder):
    """Fetches (once) and loads the library below `folder`. Raises Unavailable."""
    root = debian.unpacked(Path(folder) / "siconos", PACKAGES)
    waiting = sorted(path for path in root.rglob("*.so*") if path.is_file() and "siconos_numerics" not in path.name)
    while waiting:
        refused = [path for path in waiting if not _opens(path)]
        if len(refused) == len(waiting):
            break  # What is left needs something that is not here; the library itself says whether that matters.
        waiting = refused
    for library in root.rglob("libsiconos_numerics.so.7"):
        try:
            return _declare(ctypes.CDLL(str(library)))
        except OSError as error:
            raise Unavailable(str(error)) from error
    raise Unavailable("libsiconos-numerics7 holds no libsiconos_numerics.so.7")


def _opens(path):
    try:
        ctypes.CDLL(str(path))
    except OSError:
        return False
    return True


def _declare(library):
    library.NM_create_from_data.restype = ctypes.c_void_p
    library.NM_create_from_data.argtypes = [ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_void_p]
    library.solver_options_create.restype = ctypes.c_void_p
    library.solver_options_create.argtypes = [ctypes.c_int]
    library.lcp_lexicolemke.restype = None
    pointer = ctypes.c_void_p
    library.lcp_lexicolemke.argtypes = [pointer, pointer, pointer, pointer, pointer]
    return library


def prepare(library, matrix, gap):
    """A call without arguments that solves w = M z + q anew and returns z.

    It raises ArithmeticError if Siconos reports failure.
    """
    columns = np.asfortranarray(matrix, dtype=float)
    offset = np.ascontiguousarray(gap, dtype=float)
    dense = library.NM_create_from_data(DENSE, len(gap), len(gap), columns.ctypes.data)
    problem = _Problem(len(gap), dense, offset.ctypes.data)
    options = library.solver_options_create(LEMKE)

    def solve(_keep=(columns, offset)):
        z, w, info = np.zeros(len(gap)), np.zeros(len(gap)), ctypes.c_int(-1)
        library.lcp_lexicolemke(ctypes.byref(problem), z.ctypes.data, w.ctypes.data, ctypes.byref(info), options)
        if info.value != 0:
            raise ArithmeticError(f"siconos lexicolemke ended with {info.value}")
        return z

    return solve
