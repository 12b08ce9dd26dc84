"""Reading and writing TOML text, with errors that name the file and the line."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from flexarm.errors import InvalidFile
from flexarm.foreign_files import foreign_kind, markup, prose, table_of_text
from flexarm.reading import decoded, regular_file


def read_text(file: Path) -> str:
    """Return the text of a file (UTF-8).

    Raise InvalidFile if it is missing, a directory, not readable or not a text in UTF-8.
    """
    if kind := foreign_kind(file):
        raise InvalidFile(file, "file", kind)
    with suppress(OSError):  # of names that are too long: refused below
        if (file / "record.toml").is_file():
            raise InvalidFile(file, "file", "is a record, a file is needed; a command takes the model first")
    regular_file(file)
    try:
        return decoded(file, file.read_bytes(), "utf-8").removeprefix("\ufeff")
    except OSError as error:
        raise InvalidFile(file, "file", f"cannot be read: {error.strerror}") from None


def read_toml(file: Path, expected_format: str) -> tuple[dict[str, Any], str]:
    """Return the tables of a TOML file and its text; its key `format` must say what is expected."""
    try:
        text = read_text(file)
    except InvalidFile as refused:
        bad = refused.__cause__
        if isinstance(bad, UnicodeDecodeError):
            narrow, wide = (bad.object.decode(each, "replace") for each in ("cp1252", "utf-16"))
            if kind := table_of_text(narrow) or markup(narrow) or markup(wide):
                raise InvalidFile(file, "file", kind) from None
        raise
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        if kind := markup(text) or table_of_text(text):
            raise InvalidFile(file, "file", kind) from None
        if kind := prose(text):
            raise InvalidFile(file, "file", f"{kind}; allowed is {expected_format!r}") from None
        what, place = _split_place(str(error))
        if twice := re.match(r"Cannot mutate immutable namespace \('(\w+)',", what):
            what = (
                f"{twice[1]} = ... is given above; write all of it there, or each as a table [[{twice[1]}]]"
            )
        raise InvalidFile(file, place, f"not valid TOML: {what}{_line_at(text, place)}") from None
    except ValueError:  # Python reads no integer of more digits
        raise InvalidFile(file, _longest_line(text), "a whole number has thousands of digits") from None
    found = data.get("format")
    if found != expected_format:
        got = "is missing" if found is None else f"is {found!r}"
        got += ", which `flexarm import` reads" if found == "flexarm-map/1" else ""
        raise InvalidFile(file, "format", f"{got}; allowed is {expected_format!r}")
    return data, text


def _longest_line(text: str) -> str:
    lines = text.splitlines()
    return f"line {max(range(len(lines)), key=lambda i: len(lines[i])) + 1}"


def _split_place(message: str) -> tuple[str, str]:
    """Tomllib's "Invalid value (at line 3, column 5)" as sentence and place."""
    match = re.fullmatch(r"(.*?) \(at (line \d+, column \d+|end of document)\)", message, re.DOTALL)
    return (match[1], match[2]) if match else (message, "TOML")


def _line_at(text: str, place: str) -> str:
    """Return the line of a place, with the form of numbers and texts where it is another one."""
    match = re.match(r"line (\d+)", place)
    line = text.splitlines()[int(match[1]) - 1].strip() if match else ""
    if not line:
        return ""
    value = line.partition("=")[2].strip()
    hint = ""
    if re.match(r"[-+]?\d+,\d", value):
        hint = "; decimals take a point"
    elif re.match(r"[^\W\d]", value):
        hint = "; texts stand in quotes"
    elif re.match(r"[-+\d.]+\s*[^\W\d]", value):
        hint = "; a number stands without its unit"
    return f", got {line[:60]!r}{hint}"


def toml_text(data: Mapping[str, Any]) -> str:
    """TOML text: lists of tables as `[[name]]`, tables at the top as `[name]`, deeper ones inline."""
    import tomlkit

    document = tomlkit.document()
    for key, value in sorted(data.items(), key=lambda item: _has_header(item[1])):
        document.add(tomlkit.key(key), at_top(value))
    return tomlkit.dumps(document)


def at_top(value: Any) -> Any:
    """Return the TOML item of a value at the top of a document: tables have headers of their own."""
    import tomlkit

    if not _has_header(value):
        return inline(value)
    if isinstance(value, Mapping):
        return table_of(value)
    tables = tomlkit.aot()
    for item in value:
        tables.append(table_of(item))
    return tables


def _has_header(value: Any) -> bool:
    """Return True if a value at the top stands below a header of its own, hence after all that do not."""
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)
    )


def table_of(content: Mapping[str, Any]) -> Any:
    """Return a TOML table below a header; what lies in it is inline."""
    import tomlkit

    table = tomlkit.table()
    for key, value in content.items():
        table.add(tomlkit.key(key), inline(value))
    return table


def inline(value: Any) -> Any:
    """Return a TOML item that needs no header."""
    import tomlkit

    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        for name, content in value.items():
            table.add(tomlkit.key(name), inline(content))
        return table
    if isinstance(value, list | tuple):  # of tables, too, which tomlkit by itself would give headers
        array = tomlkit.array()
        for item in value:
            array.append(inline(item))
        return array
    value = value.item() if hasattr(value, "item") else value  # NumPy's numbers
    if isinstance(value, float) and 1e6 <= abs(value) < 1e16:  # as 2.1e11, in place of 210000000000.0
        short = re.sub(r"\.?0*e\+0*", "e", f"{value:.16e}")
        return tomlkit.value(min(repr(value), short, key=len) if float(short) == value else repr(value))
    return tomlkit.item(value)
