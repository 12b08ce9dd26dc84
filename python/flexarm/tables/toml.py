"""Reading TOML text, with errors that name the file and the line."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from flexarm.errors import InvalidFile


def read_text(file: Path) -> str:
    """The text of a file (UTF-8).

    Raises
    ------
    InvalidFile
        If it is missing, a directory, not readable or not a text in UTF-8.
    """
    try:
        return file.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        byte = error.object[error.start]
        raise InvalidFile(
            file, f"line {line}", f"not a text in UTF-8: byte 0x{byte:02x} at position {error.start}"
        ) from None
    except FileNotFoundError:
        raise InvalidFile(file, "file", "there is no such file") from None
    except IsADirectoryError:
        raise InvalidFile(file, "file", "is a directory, a file is needed") from None
    except (OSError, ValueError) as error:  # ValueError: a path with a null byte
        reason = getattr(error, "strerror", None) or str(error)
        raise InvalidFile(file, "file", f"cannot be read: {reason}") from None


def read_toml(file: Path, expected_format: str) -> tuple[dict[str, Any], str]:
    """The tables of a TOML file and its text.

    Parameters
    ----------
    file : Path
        The file.
    expected_format : str
        What its key `format` must say, such as `flexarm-arm/1`.
    """
    text = read_text(file)
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        what, place = _split_place(str(error))
        raise InvalidFile(file, place, f"not valid TOML: {what}") from None
    found = data.get("format")
    if found != expected_format:
        got = "is missing" if found is None else f"is {found!r}"
        raise InvalidFile(file, "format", f"{got}; allowed is {expected_format!r}")
    return data, text


def _split_place(message: str) -> tuple[str, str]:
    """Tomllib's "Invalid value (at line 3, column 5)" as sentence and place."""
    match = re.fullmatch(r"(.*?) \(at (line \d+, column \d+|end of document)\)", message, re.DOTALL)
    return (match[1], match[2]) if match else (message, "TOML")
