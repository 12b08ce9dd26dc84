"""Pages from the templates of this folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any


def filled(template: str, filters: Mapping[str, Callable[..., Any]] | None = None, **values: Any) -> str:
    """Return a template with its values, which are escaped; a value that is missing is an error.

    Parameters
    ----------
    template : str
        Name of its file.
    filters : dict of str to callable, optional
        What the template may apply to values.
    **values
        By name.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("flexarm.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= filters or {}
    return environment.get_template(template).render(**values)
