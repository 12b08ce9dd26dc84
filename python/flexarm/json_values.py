"""Values as JSON can hold them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf, isfinite, nan
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer

_NULL = PlainSerializer(lambda value: value if isfinite(value) else None, when_used="json")
KnownOrNan = Annotated[float, BeforeValidator(lambda value: nan if value is None else value), _NULL]
"""A number that is null in files where it is not finite, which JSON has not, and NaN when read again."""
LogEvidence = Annotated[float, BeforeValidator(lambda value: -inf if value is None else value), _NULL]
"""The same of a logarithm of evidence, of which none is -inf."""


def plain(value: Any) -> Any:
    """Return dictionaries, lists, plain numbers and texts; null for numbers that are not finite."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):  # arrays and scalars of NumPy
        return plain(value.tolist())
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value
