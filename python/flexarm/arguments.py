"""Arguments of public functions: each is of a kind, and one that is not becomes our error before any work."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from inspect import signature
from reprlib import repr as shortened
from typing import Any, ParamSpec, TypeVar
from warnings import warn

from flexarm.errors import InvalidParameter

P = ParamSpec("P")
R = TypeVar("R")
Made = TypeVar("Made")


@dataclass(frozen=True)
class Kind:
    """The kind of an argument."""

    words: str
    """As the message says it after "must be"."""
    accepts: Callable[[Any], bool]
    """Returns True for a value of this kind."""


FORMER = {"jobs": "n_jobs"}
"""Former names of arguments, which functions with the new one take for one release, with a warning."""


def takes(**kinds: Kind) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Check arguments by name before a function runs; a default is always allowed.

    Names in `USUAL` are of the kind there, unless another one is given.

    Raise InvalidParameter from the function: the argument, what it must be and what it is.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        expected, own = signature(function), {**USUAL, **kinds}

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            for old in FORMER.keys() & kwargs.keys() - expected.parameters.keys():
                if FORMER[old] in expected.parameters and FORMER[old] not in kwargs:
                    said = f"{function.__name__}: {old} is now {FORMER[old]}"
                    warn(said, DeprecationWarning, stacklevel=2)
                    kwargs[FORMER[old]] = kwargs.pop(old)
            for name, value in expected.bind(*args, **kwargs).arguments.items():
                if name in own and value is not expected.parameters[name].default:
                    require(own[name], name, value)
            return function(*args, **kwargs)

        return checked

    return decorate


def holds(**kinds: Kind) -> Callable[[type[Made]], type[Made]]:
    """Check the fields of a class by name before an object is made, as `takes` does for a function."""

    def decorate(made: type[Made]) -> type[Made]:
        made.__init__ = takes(**kinds)(made.__init__)  # type: ignore[method-assign]
        return made

    return decorate


def require(kind: Kind, name: str, value: object) -> None:
    """Check one argument.

    Raise InvalidParameter with its name, what it must be and what it is.
    """
    if not kind.accepts(value):
        raise InvalidParameter(f"must be {kind.words}, got {_told(value)}", where=name)


def _numpy() -> Any:
    """Return NumPy, which commands that compute nothing start without."""
    import numpy

    return numpy


def _told(value: object) -> str:
    """Return the text of a value, shortened if it holds others, or the type of a large one."""
    if isinstance(value, dict | list | tuple):
        return shortened(value)
    simple = value is None or isinstance(value, str | bytes | float | bool)
    return repr(value)[:80] if simple else type(value).__name__


def _is_number(value: object) -> bool:
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return False
    return not isinstance(value, str | bytes) and _numpy().ndim(value) == 0


def _as_array(value: object, dtype: type | None = None) -> Any:
    """Return an array, or None where NumPy makes none."""
    try:
        return _numpy().asarray(value, dtype=dtype)
    except (TypeError, ValueError, OverflowError):
        return None


def _is_row(value: object) -> bool:
    array = _as_array(value)
    return array is not None and array.dtype.kind in "fiu" and array.ndim <= 1


def _is_array(value: object) -> bool:
    return not isinstance(value, str | bytes) and _as_array(value, float) is not None


def _is_rotation(value: object) -> bool:
    np = _numpy()
    if not _is_array(value) or np.shape(value) != (3, 3):
        return False
    turn = np.asarray(value, dtype=float)
    return np.allclose(turn @ turn.T, np.eye(3), atol=1e-9) and bool(np.linalg.det(turn) > 0)


def _is_indices(value: object) -> bool:
    array = _as_array(value)
    if array is None:
        return False
    return array.dtype.kind in "iu" or (array.dtype.kind == "f" and not array.size)


def _is_count(value: Any) -> bool:
    whole = isinstance(value, int | _numpy().integer) and not isinstance(value, bool)
    return whole and bool(abs(value) < 2**31)


def _is_names(value: Any) -> bool:
    if isinstance(value, Iterator):  # looked at once only, by whoever uses it
        return True
    named = isinstance(value, Collection) and not isinstance(value, str | bytes)
    return named and all(isinstance(name, str) for name in value)


def _is_pairs(value: object) -> bool:
    if not isinstance(value, Mapping | Collection) or isinstance(value, str | bytes | _numpy().ndarray):
        return False
    pairs = value.items() if isinstance(value, Mapping) else value
    return all(
        isinstance(p, tuple | list) and len(p) == 2 and all(isinstance(t, str) for t in p) for p in pairs
    )


def _any(value: object) -> bool:
    return True


def _each(accepts: Callable[[Any], bool]) -> Callable[[Any], bool]:
    """Return a test of all items of a collection; iterators pass, as they can be read once only."""
    return lambda value: (
        isinstance(value, Iterator)
        or (
            isinstance(value, Collection)
            and not isinstance(value, str | bytes | _numpy().ndarray)
            and all(map(accepts, value.values() if isinstance(value, Mapping) else value))
        )
    )


def _either(*accepts: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: any(each(value) for each in accepts)


def _by_name(accepts: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: (
        isinstance(value, Mapping) and all(isinstance(k, str) and accepts(v) for k, v in value.items())
    )


def _one_of(module: str, *names: str) -> Callable[[Any], bool]:
    """Return a test for instances of classes that are imported when it runs."""
    return lambda value: isinstance(value, tuple(getattr(import_module(module), name) for name in names))


_is_material = _one_of("flexarm.arm.link", "Material")
_is_base = _one_of("flexarm.record", "BaseStand")

ARM = Kind("an Arm", _one_of("flexarm.arm", "Arm"))
DRIVE = Kind("a Drive, such as Drive.from_samples gives, or a Record", _one_of("flexarm", "Drive", "Record"))
DRIVES = Kind("a list or dictionary of Drives and Records", _each(DRIVE.accepts))
RECORD = Kind("a Record, such as Record.load gives", _one_of("flexarm.record", "Record"))
RECORDS = Kind("a Record, or a list or dictionary of them", _either(RECORD.accepts, _each(_any)))
POLICY = Kind("a SelectionPolicy", _one_of("flexarm", "SelectionPolicy"))
MOTION = Kind("a Simulation", lambda value: hasattr(value, "arm") and hasattr(value, "time"))
SENSORS = Kind("a list of Sensors", _each(_one_of("flexarm.arm.sensor", "Sensor")))
SIGNALS = Kind("a list or dictionary of Signals", _each(_one_of("flexarm.record", "Signal")))
CLOCKS = Kind("a dictionary of Clocks by name", _by_name(_one_of("flexarm.record", "Clock")))
BASE = Kind("a BaseStand or None", lambda value: value is None or _is_base(value))
FRAMES = Kind("a dictionary of Frames by name", _by_name(_one_of("flexarm.record", "Frame")))
MATERIALS = Kind("a dictionary of Materials by name", _by_name(_is_material))
MATERIAL = Kind("a Material, or a dictionary of them by name", _either(_is_material, MATERIALS.accepts))
NUMBER = Kind("a number", _is_number)
NUMBERS = Kind("a number or a row of numbers", _is_row)
ROW = Kind("a row of numbers", lambda value: _is_row(value) and _numpy().ndim(value) == 1)
POSITIVE = Kind(
    "a positive, finite number", lambda value: _is_number(value) and 0 < float(value) < _numpy().inf
)
SECONDS = Kind(
    "a positive, finite number of seconds, or None", lambda value: value is None or POSITIVE.accepts(value)
)
SHARE = Kind("a number from 0 to 1", lambda value: _is_number(value) and 0 <= float(value) <= 1)
ARRAY = Kind("an array of numbers", _is_array)
ARRAYS = Kind("a dictionary of arrays of numbers by name", _by_name(_is_array))
INDICES = Kind("a dictionary of whole numbers by name", _by_name(_is_indices))
GROUPS = Kind("a dictionary of dictionaries of whole numbers", _by_name(INDICES.accepts))
COUNT = Kind("a whole number", _is_count)
JOBS = Kind("a whole number of at least 1", lambda value: _is_count(value) and value >= 1)
VECTOR = Kind("three numbers", lambda value: _is_row(value) and _numpy().size(value) == 3)
ROTATION = Kind("a 3 x 3 rotation matrix that does not mirror", _is_rotation)
AXES = Kind("Axes of matplotlib", lambda value: callable(getattr(value, "add_collection", None)))
FLAG = Kind("True or False", lambda value: isinstance(value, bool | _numpy().bool_))
TEXT = Kind("a text", lambda value: isinstance(value, str))
NAMES = Kind("a list of names", _is_names)
NAME_TUPLE = Kind("a tuple of names", lambda value: isinstance(value, tuple | list) and _is_names(value))
NAME_OR_NAMES = Kind("a name or a list of names", _either(TEXT.accepts, _is_names))
VALUES = Kind("a dictionary of numbers by name", _by_name(_is_number))
PAIRS = Kind("a dictionary or pairs of texts", _is_pairs)
ITEMS = Kind("a list", lambda value: isinstance(value, Iterable) and not isinstance(value, _numpy().ndarray))
TEXTS = Kind("a dictionary of texts by name", _by_name(TEXT.accepts))
VECTORS = Kind("a dictionary of three numbers by name", _by_name(_is_row))
NAMED = Kind("a dictionary by name", _by_name(_any))
TABLES = Kind("a dictionary, as a TOML file gives it", lambda value: isinstance(value, Mapping))
PATH = Kind("a path of a file", lambda value: isinstance(value, str | os.PathLike) and value != "")
SOLID = Kind("a SolidMesh", _one_of("flexarm.solids", "SolidMesh"))
LISTED = Kind("a text or a path of a file", lambda value: isinstance(value, str | os.PathLike))
MESH = Kind("a SolidMesh or a path", _either(PATH.accepts, SOLID.accepts))

_NAMES_OF: dict[str, Kind] = {
    "damping_matrix directory grids mass_matrix mjcf model out path urdf": PATH,
    "at clock description dimension file frame initial input joint key kind link name payload": TEXT,
    "point quantity side signal time_column unit": TEXT,
    "alpha damping_ratio end jitter_std max_frequency noise_std scale step zero_std": NUMBER,
    "align allow_outside check_step consistent_forces energies force lumped": FLAG,
    "averages count mode seed threads": COUNT,
    "hold_out record": RECORD,
    "arm": ARM,
    "ax": AXES,
    "clocks": CLOCKS,
    "frames": FRAMES,
    "joints": VALUES,
    "max_seconds": SECONDS,
    "mesh": MESH,
    "n_jobs": JOBS,
    "records": RECORDS,
    "rotation": ROTATION,
    "sensitivities": NAMES,
    "simulation": MOTION,
    "translation": VECTOR,
}
USUAL = {name: kind for names, kind in _NAMES_OF.items() for name in names.split()}
"""Kinds of arguments by name, where the name means the same in all functions."""
