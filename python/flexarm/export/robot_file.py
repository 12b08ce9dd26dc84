"""XML files of robots: read, changed in place and written again, comments and layout kept."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.errors import InvalidFile
from flexarm.output import write_file
from flexarm.reading import reading, regular_file

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


def read_robot(path: Path, root: str) -> Element:
    """Return the root of an XML file, comments included.

    Raise InvalidFile if it is no XML file, or its root has another name.
    """
    from xml.etree import ElementTree

    with reading(regular_file(path), "XML"):
        parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
        try:
            found = ElementTree.fromstring(path.read_bytes(), parser)
        except ElementTree.ParseError as error:
            raise InvalidFile(path, f"line {error.position[0]}", f"is no XML: {error}") from None
    if found.tag != root:
        raise InvalidFile(path, "file", f"must hold a <{root}>, got <{found.tag}>")
    return found


def write_robot(root: Element, path: Path, inputs: list[Path]) -> None:
    """Write an XML file, which appears when it is whole and replaces no input.

    Raise InvalidFile if it cannot be written.
    """
    from xml.etree import ElementTree

    write_file(path, ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n", inputs)


def refuse_no_joint(path: Path, wanted: list[str], there: list[str], written: int) -> None:
    """Refuse a file that has none of the model's joints.

    Raise InvalidFile with the names of both.
    """
    if written == 0:
        names = ", ".join(there) or "none"
        raise InvalidFile(
            path, "joints", f"must have a joint of the model ({', '.join(wanted)}), got {names}"
        )


def number(value: float) -> str:
    """Return a number with all its digits."""
    return repr(float(value)).removesuffix(".0")
