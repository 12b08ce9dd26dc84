"""Arguments of public functions: each is of a kind, and one that is not becomes our error before any work."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from inspect import signature
from typing import Any, ParamSpec, TypeVar

import numpy as np

from flexarm.errors import InvalidParameter

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Kind:
    """What an argument may be.

    Attributes
    ----------
    words : str
        As the message says it after "must be".
    accepts : callable
        Returns True for a value of this kind.
    """

    words: str
    accepts: Callable[[Any], bool]


def takes(**kinds: Kind) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Check arguments by name before a function runs; a default is always allowed.

    Raises
    ------
    InvalidParameter
        From the function: the argument, what it must be and what it is.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        expected = signature(function)

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            for name, value in expected.bind(*args, **kwargs).arguments.items():
                kind = kinds.get(name)
                if kind and value is not expected.parameters[name].default and not kind.accepts(value):
                    raise InvalidParameter(f"must be {kind.words}, got {_told(value)}", where=name)
            return function(*args, **kwargs)

        return checked

    return decorate


def _told(value: object) -> str:
    """A value in a few characters; of a large one the type."""
    simple = value is None or isinstance(value, str | bytes | float | bool)
    return repr(value)[:80] if simple else f"{type(value).__name__}"


def _is_number(value: object) -> bool:
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return False
    return not isinstance(value, str | bytes) and np.ndim(value) == 0  # type: ignore[arg-type]


def _is_row(value: object) -> bool:
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError):
        return False
    return array.dtype.kind in "fiu" and array.ndim <= 1


def _is_count(value: Any) -> bool:
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    return whole and bool(abs(value) < 2**31)


def _is_names(value: Any) -> bool:
    if isinstance(value, Iterator):  # looked at once only, by whoever uses it
        return True
    named = isinstance(value, Collection) and not isinstance(value, str | bytes)
    return named and all(isinstance(name, str) for name in value)


def _is_pairs(value: object) -> bool:
    if not isinstance(value, Mapping | Collection) or isinstance(value, str | bytes | np.ndarray):
        return False
    pairs = value.items() if isinstance(value, Mapping) else value
    return all(
        isinstance(p, tuple | list) and len(p) == 2 and all(isinstance(t, str) for t in p) for p in pairs
    )


def _by_name(accepts: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: (
        isinstance(value, Mapping) and all(isinstance(k, str) and accepts(v) for k, v in value.items())
    )


def _one_of(module: str, *names: str) -> Callable[[Any], bool]:
    """Of one of the classes, which are imported when somebody asks."""
    return lambda value: isinstance(value, tuple(getattr(import_module(module), name) for name in names))


ARM = Kind("an Arm", _one_of("flexarm.arm", "Arm"))
DRIVE = Kind("a Drive or a Record", _one_of("flexarm", "Drive", "Record"))
NUMBER = Kind("a number", _is_number)
NUMBERS = Kind("a number or a row of numbers", _is_row)
COUNT = Kind("a whole number", _is_count)
TEXT = Kind("a text", lambda value: isinstance(value, str))
NAMES = Kind("a list of names", _is_names)
VALUES = Kind("a dictionary of numbers by name", _by_name(_is_number))
PAIRS = Kind("a dictionary or pairs of texts", _is_pairs)
ITEMS = Kind("a list", lambda value: isinstance(value, Iterable) and not isinstance(value, np.ndarray))
TEXTS = Kind("a dictionary of texts by name", _by_name(lambda value: isinstance(value, str)))
VECTORS = Kind("a dictionary of three numbers by name", _by_name(_is_row))
TABLES = Kind("a dictionary, as a TOML file gives it", lambda value: isinstance(value, Mapping))
PATH = Kind("a path of a file", lambda value: isinstance(value, str | os.PathLike))
