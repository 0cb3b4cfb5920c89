"""What a computed result is on disk: an npz file with the arrays, a JSON text of all else, and a
digest of both.

No code of a file is run, unlike with pickle: what is read is numbers, texts, arrays, tuples, lists,
dicts, and instances of classes of this project that are loaded already, whose attributes are set
without a call of anything of theirs. A file that is cut, or of which a byte was changed, is
refused, which for a cache is a miss.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from dataclasses import fields, is_dataclass
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import IO, Any
from zipfile import BadZipFile

import numpy as np

from fabrics.base.assumed_number import Assumed
from fabrics.base.files import MOST

PACKAGES = ("fabrics", "meshing", "unitcell3d", "shellfabric", "weavecell", "validation")
FORMAT = "weavecell result 1"
SUFFIX = "npz"
# kind of `files.MOST`
OF_ARRAYS = "HDF5 file"
# what the many ways in which a damaged zip file, array or text can be wrong raise
DAMAGED = (
    ValueError,
    KeyError,
    IndexError,
    TypeError,
    AttributeError,
    EOFError,
    OSError,
    BadZipFile,
    NotImplementedError,
    RecursionError,
    MemoryError,
    OverflowError,
)


class UnreadableResult(Exception):
    """A file that holds no whole result."""


def write(content: object, file: IO[bytes]) -> None:
    """Write a result to an open file.

    Raises
    ------
    TypeError : it holds something that is none of what this module keeps
    """
    arrays: list[np.ndarray] = []
    text = json.dumps({"format": FORMAT, "content": _plain(content, arrays)}).encode()
    named = {f"array_{number}": array for number, array in enumerate(arrays)}
    named["content"] = np.frombuffer(text, np.uint8)
    named["sha256"] = np.frombuffer(_digest(named), np.uint8)
    np.savez(file, **named)


def read(file: IO[bytes]) -> Any:
    """Return the result in an open file.

    Raises
    ------
    UnreadableResult : it is cut, changed, or of another kind
    """
    try:
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        if size > MOST[OF_ARRAYS]:
            raise UnreadableResult("it is too large")
        with np.load(BytesIO(file.read()), allow_pickle=False) as members:
            # `write` packs nothing: no member is larger than it is in the file
            if sum(member.file_size for member in members.zip.infolist()) > size:
                raise UnreadableResult("it is too large")
            named = {name: members[name] for name in members.files}
        if bytes(named.pop("sha256")) != _digest(named):
            raise UnreadableResult("its digest is another one")
        stated = json.loads(bytes(named["content"]))
        if stated["format"] != FORMAT:
            raise UnreadableResult(f"its format is not {FORMAT!r}")
        return _content(stated["content"], named)
    except DAMAGED as problem:
        raise UnreadableResult(str(problem)) from problem


def _digest(named):
    """SHA-256 of arrays with their names, types and shapes."""
    total = hashlib.sha256()
    for name in sorted(named):
        array = named[name]
        total.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        total.update(np.ascontiguousarray(array).tobytes())
    return total.digest()


def _plain(value, arrays):
    """A value as JSON has it; arrays are added to a list, and named by their number in it."""
    kind = type(value)
    if value is None or kind in (bool, int, float, str):
        return value
    if kind is Assumed:
        return {"assumed": list(value.parts)}
    if kind is list:
        return [_plain(part, arrays) for part in value]
    if kind is tuple:
        return {"tuple": [_plain(part, arrays) for part in value]}
    if kind in (set, frozenset):
        # the order in which a set is walked changes from process to process
        return {kind.__name__: [_plain(part, arrays) for part in sorted(value, key=repr)]}
    if kind is dict:
        return {"dict": [[_plain(key, arrays), _plain(value[key], arrays)] for key in value]}
    if isinstance(value, (np.ndarray, np.generic)) and value.dtype != object:
        arrays.append(np.asarray(value))
        form = "array"
        if isinstance(value, np.generic):
            form = "number"
        return {form: len(arrays) - 1}
    if isinstance(value, Path):
        return {"path": str(value)}
    if kind is SimpleNamespace:
        return {"namespace": _plain(vars(value), arrays)}
    if kind.__module__.partition(".")[0] in PACKAGES:
        return {"object": _name(kind), "state": _plain(_state(value), arrays)}
    raise TypeError(f"a {kind.__name__} cannot be kept")


def _state(value):
    """What makes an instance of a class of ours: arguments of an exception, entries of a tuple or a
    dict, and attributes."""
    state: dict[str, Any] = {}
    if isinstance(value, BaseException):
        state["args"] = value.args
    elif isinstance(value, tuple):
        state["args"] = tuple(value)
    elif isinstance(value, dict):
        state["args"] = dict(value)
    if is_dataclass(value):
        state["attributes"] = {entry.name: getattr(value, entry.name) for entry in fields(value)}
    else:
        state["attributes"] = dict(getattr(value, "__dict__", {}))
    return state


def _content(plain, arrays):
    """The value that `_plain` made something of."""
    if isinstance(plain, list):
        return [_content(part, arrays) for part in plain]
    if not isinstance(plain, dict):
        return plain
    kind, content = next(iter(plain.items()))
    if kind == "array":
        return arrays[f"array_{content}"]
    if kind == "number":
        return arrays[f"array_{content}"][()]
    if kind == "assumed":
        return Assumed(*content)
    if kind == "path":
        return Path(content)
    if kind == "namespace":
        return SimpleNamespace(**_content(content, arrays))
    if kind == "object":
        return _object(_class(content), _content(plain["state"], arrays))
    if kind == "dict":
        return {_content(key, arrays): _content(value, arrays) for key, value in content}
    of_parts = {"tuple": tuple, "set": set, "frozenset": frozenset}
    return of_parts[kind](_content(part, arrays) for part in content)


def _object(kind, state):
    """An instance of a class of ours, made without its constructor."""
    if issubclass(kind, BaseException):
        made = kind.__new__(kind)
        made.args = state["args"]
    elif issubclass(kind, tuple):
        made = tuple.__new__(kind, state["args"])
    else:
        made = kind.__new__(kind)
    if isinstance(made, dict):
        dict.update(made, state["args"])
    for name, value in state["attributes"].items():
        # a frozen dataclass sets its own attributes in this way
        object.__setattr__(made, name, value)
    return made


def _name(kind):
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(name):
    """The class of ours with a name, of a module that is loaded."""
    module, _, path = name.partition(":")
    found: Any = sys.modules[module]
    for part in path.split("."):
        found = getattr(found, part)
    # a name that some module of ours imported leads elsewhere
    if not isinstance(found, type) or _name(found) != name:
        raise ValueError(f"{name} is no class")
    if module.partition(".")[0] not in PACKAGES:
        raise ValueError(f"{name} is no class of this project")
    return found
