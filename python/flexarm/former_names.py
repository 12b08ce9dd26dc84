"""Fields and arguments that have another name now, or are gone: old names are taken for one release."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import is_dataclass
from functools import wraps
from typing import Any, TypeVar
from warnings import warn

from flexarm.errors import InvalidParameter

T = TypeVar("T")


def takes_former_names(
    renamed: Mapping[str, str], removed: Mapping[str, str] | None = None
) -> Callable[[type[T]], type[T]]:
    """Return a decorator of classes that takes arguments by former names, with a warning.

    Data classes have the fields by these names, too. `renamed` has new names by old ones, `removed` what
    replaced a field. A call that gives a removed one raises InvalidParameter.
    """

    def with_former(kind: type[T]) -> type[T]:
        made: Any = kind.__init__

        @wraps(made)
        def init(self: T, *values: Any, **named: Any) -> None:
            for old in (removed or {}).keys() & named:
                raise InvalidParameter(f"is no field any more: {(removed or {})[old]}", where=old)
            for old in renamed.keys() & named:
                if renamed[old] in named:
                    raise InvalidParameter(f"is now {renamed[old]}, which is given too", where=old)
                warn(_message(kind, old, renamed[old]), DeprecationWarning, stacklevel=2)
                named[renamed[old]] = named.pop(old)
            made(self, *values, **named)

        setattr(kind, "__init__", init)  # noqa: B010
        for old, new in renamed.items():
            if is_dataclass(kind):
                setattr(kind, old, _alias(kind, old, new))
        return kind

    return with_former


def _alias(kind: type[Any], old: str, new: str) -> property:
    def read(self: Any) -> Any:
        warn(_message(kind, old, new), DeprecationWarning, stacklevel=2)
        return getattr(self, new)

    return property(read, doc=f"Former name of `{new}`.")


def _message(kind: type[Any], old: str, new: str) -> str:
    return f"{kind.__name__}.{old} is now {kind.__name__}.{new}"
