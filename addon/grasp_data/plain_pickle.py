"""Pickles of numpy arrays and plain containers read without Python's unpickler: nothing is imported, nothing is called.

A machine of its own walks the opcodes. Names of classes and functions that it does not know are refused, with their
name; the few it knows (numpy's own for arrays) stand for data here and are never looked up.
"""

import pickletools
from dataclasses import dataclass
from math import prod

import numpy as np

from ..scene.checks import Refusal

MOST_STEPS = 5_000_000
"""Opcodes of one pickle; arrays take a few each, lists of single numbers one a number."""
DEEPEST = 60
"""Containers within containers."""

_MARK = object()
_MULTIARRAY = ("numpy.core.multiarray", "numpy._core.multiarray")
_NUMERIC = ("numpy.core.numeric", "numpy._core.numeric")
_KNOWN = {
    **{(module, "_reconstruct"): "array" for module in _MULTIARRAY},
    **{(module, "scalar"): "scalar" for module in _MULTIARRAY},
    **{(module, "_frombuffer"): "buffer" for module in _NUMERIC},
    ("numpy", "ndarray"): "ndarray",
    ("numpy", "dtype"): "dtype",
    ("_codecs", "encode"): "encode",
    ("builtins", "bytes"): "bytes",
    ("__builtin__", "bytes"): "bytes",
    ("collections", "OrderedDict"): "dict",
}
"""(module, name) in the file -> what it stands for here."""
_KINDS = "biufSUO"
"""Kinds of numpy's types that are data: truth, whole numbers, floats, text, and objects, whose contents are read."""


@dataclass
class _Name:
    means: str


@dataclass
class _Type:
    text: str
    order: str = "="

    def dtype(self):
        """numpy's type; `ValueError` where it is none of plain data."""
        text = self.text.lstrip("<>=|")
        found = np.dtype(text if text[0] in "SUO" else self.order.replace("|", "=") + text)
        if found.kind not in _KINDS or found.names or found.subdtype:
            raise ValueError(f"type {self.text!r}")
        return found.newbyteorder(self.order) if found.kind == "U" and self.order in "<>" else found


@dataclass
class _Array:
    """An array whose contents follow later in the file."""

    state: tuple | None = None


class _Forbidden(Exception):
    """A name of code in the file."""


def loads(data, name):
    """What a pickle holds: arrays, dicts, lists, tuples, texts, numbers. `name` of the file is for messages.

    Raises `Refusal` for a name of code, and for a file that is damaged or no pickle.
    """
    try:
        return _resolve(_Machine().run(data), [], {})
    except _Forbidden as error:
        raise Refusal(
            f"'{name}' asks for '{error}', which is code; only numpy arrays and plain containers are read: save the "
            "arrays that are wanted as .npz"
        ) from None
    except (ValueError, TypeError, LookupError, AttributeError, OverflowError, RecursionError, EOFError) as error:
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise Refusal(f"'{name}' is no pickle of arrays ({reason}); save the arrays as .npz") from None


class _Machine:
    """The stack, the memo, and what each opcode does to them."""

    def __init__(self):
        self.stack, self.memo = [], {}

    def run(self, data):
        """The one value that the pickle leaves."""
        for step, (code, argument, _place) in enumerate(pickletools.genops(data)):
            if step > MOST_STEPS:
                raise ValueError(f"more than {MOST_STEPS:,} single values")
            if code.name == "STOP":
                if len(self.stack) != 1 or self.stack[0] is _MARK:
                    raise ValueError("more or less than one value")
                return self.stack[0]
            self._do(code.name, argument)
        raise ValueError("no end")

    def _do(self, name, argument):
        if name in _PUSHED:
            self.stack.append(argument)
        elif name in _CONSTANTS:
            self.stack.append(_CONSTANTS[name]())
        elif name in ("PUT", "BINPUT", "LONG_BINPUT"):
            self.memo[argument] = self.stack[-1]
        elif name in ("GET", "BINGET", "LONG_BINGET"):
            self.stack.append(self.memo[argument])
        elif name not in ("PROTO", "FRAME"):
            action = getattr(self, f"_{name.lower()}", None)
            if action is None:
                raise _Forbidden(str(argument) if isinstance(argument, str) else name)
            action(argument)

    def _memoize(self, _):
        self.memo[len(self.memo)] = self.stack[-1]

    def _mark(self, _):
        self.stack.append(_MARK)

    def _pop(self, _):
        self.stack.pop()

    def _pop_mark(self, _):
        self._since_mark()

    def _dup(self, _):
        self.stack.append(self.stack[-1])

    def _list(self, _):
        self.stack.append(self._since_mark())

    def _tuple(self, _):
        self.stack.append(tuple(self._since_mark()))

    def _tuple1(self, _):
        self._join(1)

    def _tuple2(self, _):
        self._join(2)

    def _tuple3(self, _):
        self._join(3)

    def _dict(self, _):
        items = self._since_mark()
        self.stack.append(dict(zip(items[::2], items[1::2], strict=True)))

    def _append(self, _):
        last = self.stack.pop()
        self._top(list).append(last)

    def _appends(self, _):
        items = self._since_mark()
        self._top(list).extend(items)

    def _setitem(self, _):
        value, key = self.stack.pop(), self.stack.pop()
        self._top(dict)[key] = value

    def _setitems(self, _):
        items = self._since_mark()
        self._top(dict).update(zip(items[::2], items[1::2], strict=True))

    def _global(self, argument):
        module, _, name = argument.partition(" ")
        self._push_name(module, name)

    def _stack_global(self, _):
        name, module = self.stack.pop(), self.stack.pop()
        self._push_name(module, name)

    def _push_name(self, module, name):
        if (module, name) not in _KNOWN:
            raise _Forbidden(f"{module}.{name}")
        self.stack.append(_Name(_KNOWN[module, name]))

    def _reduce(self, _):
        arguments, called = self.stack.pop(), self.stack.pop()
        if not isinstance(called, _Name) or not isinstance(arguments, tuple):
            raise ValueError("a call of what is no name")
        self.stack.append(_stands_for(called.means, arguments))

    def _build(self, _):
        state = self.stack.pop()
        found = self.stack[-1]
        if isinstance(found, _Type):
            if state[2:5] != (None, None, None):
                raise ValueError(f"type {found.text!r} of several fields")
            found.order = {"<": "<", ">": ">"}.get(state[1], "=")
        elif isinstance(found, _Array):
            found.state = state[1:]
        else:
            raise ValueError("a state of what is no array")

    def _since_mark(self):
        place = len(self.stack) - 1 - self.stack[::-1].index(_MARK)
        items = self.stack[place + 1 :]
        del self.stack[place:]
        return items

    def _join(self, count):
        items = tuple(self.stack[-count:])
        if len(items) < count or any(item is _MARK for item in items):
            raise ValueError("a tuple of nothing")
        self.stack[-count:] = [items]

    def _top(self, kind):
        if not isinstance(self.stack[-1], kind):
            raise ValueError("an item for what is no container")
        return self.stack[-1]


_PUSHED = {
    *("INT", "BININT", "BININT1", "BININT2", "LONG", "LONG1", "LONG4", "FLOAT", "BINFLOAT"),
    *("STRING", "BINSTRING", "SHORT_BINSTRING", "UNICODE", "BINUNICODE", "SHORT_BINUNICODE", "BINUNICODE8"),
    *("BINBYTES", "SHORT_BINBYTES", "BINBYTES8", "BYTEARRAY8"),
}
_CONSTANTS = {
    "NONE": lambda: None,
    "NEWTRUE": lambda: True,
    "NEWFALSE": lambda: False,
    "EMPTY_LIST": list,
    "EMPTY_TUPLE": tuple,
    "EMPTY_DICT": dict,
}


def _stands_for(means, arguments):
    """The data that a known name with its arguments stands for."""
    if means == "array":
        return _Array()
    if means == "dtype":
        return _Type(_text(arguments[0]))
    if means == "scalar":
        return _filled((), arguments[0], arguments[1], "C").item()
    if means == "buffer":
        data, kind, shape, order = arguments
        return _Array((shape, kind, order == "F", data))
    if means == "encode":
        return arguments[0].encode("latin-1")
    if means == "bytes" and not arguments:
        return b""
    if means == "dict":
        return dict(arguments[0]) if arguments else {}
    raise ValueError(f"a call of {means}")


def _text(value):
    return value.decode("ascii") if isinstance(value, bytes) else str(value)


def _filled(shape, kind, data, order):
    """An array (shape) of the bytes `data`."""
    dtype = kind.dtype()
    content = data.encode("latin-1") if isinstance(data, str) else data
    sizes = [int(size) for size in shape]
    if min(sizes, default=0) < 0 or prod(sizes) * dtype.itemsize != len(content) or dtype.hasobject:
        raise ValueError("an array of another length than its shape says")
    return np.frombuffer(content, dtype).reshape(sizes, order=order).copy()


def _resolve(value, within, done):
    """`value` with its arrays filled in; what is there several times is filled once."""
    if not isinstance(value, (list, tuple, dict, _Array, _Name, _Type)):
        return value
    if id(value) in done:
        return done[id(value)][1]
    if id(value) in within or len(within) > DEEPEST:
        raise ValueError("containers that hold themselves, or too deep")
    within.append(id(value))
    if isinstance(value, dict):
        out = {key: _resolve(item, within, done) for key, item in value.items()}
    elif isinstance(value, (list, tuple)):
        out = type(value)(_resolve(item, within, done) for item in value)
    elif isinstance(value, _Array) and value.state is not None:
        out = _array(value, within, done)
    else:
        raise ValueError("a name without its array")
    within.pop()
    done[id(value)] = value, out
    return out


def _array(value, within, done):
    """A filled array; one of objects as a list, or as its one object."""
    shape, kind, is_fortran, data = value.state
    if not kind.dtype().hasobject:
        return _filled(shape, kind, data, "F" if is_fortran else "C")
    if not isinstance(data, list) or len(data) != prod(shape):
        raise ValueError("an array of objects of another length than its shape says")
    items = [_resolve(item, within, done) for item in data]
    return items if shape else items[0]
