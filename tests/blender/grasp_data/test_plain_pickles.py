"""Pickles are read as data: what numpy wrote comes out equal, code is refused by name and never run."""

import builtins
import collections
import io
import os
import pickle
import struct

import numpy as np
import pytest
from thenar_blender.grasp_data import plain_pickle
from thenar_blender.scene.checks import Refusal


def same(a, b):
    """Whether two nested values hold the same; an array of objects is a list."""
    if isinstance(b, np.ndarray) and b.dtype == object:
        return same(a, list(b.ravel()) if b.shape else b.item())
    if isinstance(b, np.ndarray):
        return isinstance(a, np.ndarray) and a.dtype.kind == b.dtype.kind and a.shape == b.shape and (a == b).all()
    if isinstance(b, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in b)
    if isinstance(b, list | tuple):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    return a == b


VALUES = {
    "double": np.arange(12.0).reshape(3, 4),
    "columns": np.asfortranarray(np.arange(12.0).reshape(3, 4)),
    "single": np.float32([[1.5, -2.0]]),
    "whole": np.int64([1, 2**40]),
    "big": np.arange(4, dtype=">f8"),
    "truth": np.array([True, False]),
    "names": np.array(["left", "right hand"]),
    "none": np.zeros((0, 3)),
    "point": np.array(3.5),
    "objects": np.array([{"a": np.ones(2)}, None], dtype=object),
    "one": np.array({"params": {"pose": np.ones(3)}}, dtype=object),
    "numbers": [1, -5, 2**70, 1.25, True, None, "text", b"bytes", (1, 2), (1,), ()],
    "scalar": np.float32(2.5),
    "ordered": collections.OrderedDict(a=1, b=np.ones(2)),
}


@pytest.mark.parametrize("protocol", range(6))
def test_what_numpy_wrote_comes_out_equal(protocol):
    read = plain_pickle.loads(pickle.dumps(VALUES, protocol), "a.pkl")
    assert same(read, {**VALUES, "ordered": dict(VALUES["ordered"])})


def test_a_pickle_of_python_2():
    # What Python 2 wrote of {'pose': numpy.array([1.0, 2.0])}: protocol 2, bytes as text, the old module's name.
    out = io.BytesIO()
    out.write(
        b"\x80\x02}q\x01U\x04poseq\x02cnumpy.core.multiarray\n_reconstruct\nq\x03cnumpy\nndarray\nq\x04K\x00\x85q"
    )
    out.write(
        b"\x05U\x01bq\x06\x87q\x07Rq\x08(K\x01K\x02\x85q\x09cnumpy\ndtype\nq\nU\x02f8q\x0bK\x00K\x01\x87q\x0cRq\r("
    )
    out.write(b"K\x03U\x01<q\x0eNNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tq\x0fb\x89U\x10")
    out.write(struct.pack("<2d", 1.0, 2.0) + b"q\x10tq\x11bs.")
    assert same(plain_pickle.loads(out.getvalue(), "a.pkl"), {"pose": np.array([1.0, 2.0])})


class Evil:
    """Runs a command when it is unpickled."""

    def __init__(self, command):
        self.command = command

    def __reduce__(self):
        return os.system, (self.command,)


@pytest.mark.parametrize("protocol", range(6))
def test_code_is_refused_by_name_and_not_run(tmp_path, protocol):
    mark = tmp_path / "mark"
    data = pickle.dumps({"pose": np.ones(3), "evil": Evil(f"touch {mark}")}, protocol)
    with pytest.raises(Refusal, match=r"asks for '(posix|nt)\.system', which is code"):
        plain_pickle.loads(data, "a.pkl")
    assert not mark.exists()
    with pytest.raises(Refusal, match="asks for"):
        plain_pickle.loads(pickle.dumps(collections.Counter("a"), protocol), "a.pkl")
    pickle.loads(data)
    assert mark.exists(), "the pickle does run code where Python's own reader reads it"


@pytest.mark.parametrize(
    "data",
    [
        b"(cos\nsystem\nS'true'\no.",  # OBJ
        b"(S'true'\nios\nsystem\n.",  # INST
        b"Pid\n.",  # PERSID
        b"\x80\x02\x82\x01.",  # EXT1
        b"\x80\x04\x8c\x02os\x8c\x06system\x93\x8c\x04true\x85R.",  # STACK_GLOBAL
        b"cnumpy.core.multiarray\n_reconstruct.__globals__\n.",
        b"cnumpy\nload\n.",
        b"cbuiltins\neval\n(S'1'\ntR.",
    ],
)
def test_every_way_to_code_is_refused(data):
    with pytest.raises(Refusal):
        plain_pickle.loads(data, "a.pkl")


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b".",
        b"N",
        b"(.",
        b"]\x94h\x00a.",  # a list that holds itself
        b"h\x07.",
        b"cnumpy\nndarray\n.",
        pickle.dumps(np.ones(3))[:-2] + b"0.",  # an array whose contents never follow
        b"(" * 100000 + b".",
        b"]" + b"q\x00](h\x00h\x00eq\x00" * 90 + b".",
        pickle.dumps(np.zeros(2, [("a", "f8"), ("b", "f8")])),
        pickle.dumps(np.ones(2, complex)),
    ],
)
def test_damaged_and_odd_pickles_are_refused(data):
    with pytest.raises(Refusal, match=r"'a\.pkl'"):
        plain_pickle.loads(data, "a.pkl")


def test_a_shape_that_lies_is_refused():
    data = pickle.dumps(np.zeros((2, 3)), 2)
    for other in (b"K\x02K\x04", b"K\xffK\xff", b"K\x02K\x02"):
        with pytest.raises(Refusal):
            plain_pickle.loads(data.replace(b"K\x02K\x03", other, 1), "a.pkl")


def test_noise_is_refused_or_read_and_imports_nothing(monkeypatch):
    random = np.random.default_rng(5)
    sound = [pickle.dumps(VALUES, protocol) for protocol in range(6)]
    outcomes, imported, real = collections.Counter(), set(), builtins.__import__

    def noted(name, *others, **named):
        imported.add(name.split(".")[0])
        return real(name, *others, **named)

    for _ in range(1000):
        data = bytearray(sound[random.integers(6)])
        for place in random.integers(0, len(data), random.integers(1, 6)):
            data[place] = random.integers(256)
        end = random.integers(1, len(data) + 1) if random.random() < 0.2 else len(data)
        with monkeypatch.context() as watched:
            watched.setattr(builtins, "__import__", noted)
            try:
                plain_pickle.loads(bytes(data[:end]), "a.pkl")
                outcomes["read"] += 1
            except Refusal:
                outcomes["refused"] += 1
    assert imported <= {"numpy", "warnings", "codecs"}, imported
    assert outcomes["read"] > 50 and outcomes["refused"] > 50, outcomes
