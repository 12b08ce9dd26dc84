"""From a dictionary to a table, or to one error that lists every problem with its place."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from flexarm.errors import InvalidFile, InvalidParameter, Problem
from flexarm.tables.field import Inconsistent, Nested, Path
from flexarm.tables.messages import sentence
from flexarm.tables.place import dotted, field_at, line_in, without_tags

AnyTable = TypeVar("AnyTable", bound=BaseModel)


def check_table(
    table: type[AnyTable], data: dict[str, Any], file: str | FilePath | None = None, text: str = ""
) -> AnyTable:
    """Return `data`, what a TOML file holds, as a `table`; file and its text are for messages.

    Raise InvalidFile or InvalidParameter with all problems found; InvalidParameter without a file.
    """
    try:
        return table.model_validate(data)
    except ValidationError as error:
        if file is None:
            raise parameter_error(table, error, data) from None
        found = problems_of(table, error, data)
    refuse(found, data, file, text)
    raise AssertionError("a refused table has at least one problem")


def refuse(found: list[tuple[Path, str]], data: dict[str, Any], file: str | FilePath, text: str) -> None:
    """Raise InvalidFile with the pairs of place and sentence, if there are any."""
    most_listed = 1000  # problems that one error lists; a last line counts the others
    problems = [Problem(dotted(path, data), what, line_in(text, path)) for path, what in found[:most_listed]]
    if len(found) > most_listed:
        problems.append(Problem("file", f"has {len(found) - most_listed} more problems"))
    if problems:
        first = problems[0]
        raise InvalidFile(file, first.where, first.what, line=first.line, problems=tuple(problems))


def parameter_error(table: type[BaseModel], error: ValidationError, data: Any) -> InvalidParameter:
    """Return the error of a table that was made in Python."""
    problems = tuple(Problem(dotted(path, data), what) for path, what in problems_of(table, error, data))
    label = getattr(table, "name", None)  # effects carry their name on the class
    first = problems[0]
    where = ".".join(word for word in (label if isinstance(label, str) else "", first.where) if word)
    return InvalidParameter(first.what, where=where or table.__name__, problems=problems)


def problems_of(
    table: type[BaseModel], error: ValidationError, data: Any, prefix: Path = ()
) -> list[tuple[Path, str]]:
    """Return pairs of place and sentence."""
    found: list[tuple[Path, str]] = []
    for entry in error.errors(include_url=False):
        path = prefix + without_tags(entry["loc"], data, entry["type"] == "missing")
        context = entry.get("ctx", {})
        cause = context.get("error")
        if isinstance(cause, Inconsistent):
            found += [(path + below, what) for below, what in cause.problems]
        elif isinstance(cause, Nested):
            found += problems_of(cause.table, cause.error, cause.data, path)
        else:
            if entry["type"].startswith("union_tag"):
                path = (*path, context["discriminator"].strip("'"))
            field, allowed = field_at(table, entry["loc"])
            found.append((path, sentence(dict(entry), field, allowed)))
    return found
