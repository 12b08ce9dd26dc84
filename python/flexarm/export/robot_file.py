"""XML files of robots: read, changed in place and written again.

What does not change stays as it stands: tags with their blanks, comments, namespaces, what lies before and
after the root. So a difference of both files shows what was written.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.errors import InvalidFile
from flexarm.output import write_file
from flexarm.reading import reading, regular_file, xml_text

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


@dataclass(frozen=True, eq=False)
class RobotFile:
    """An XML file, and how it is written."""

    root: Element
    before: str
    """What stands before the root."""
    after: str
    encoding: str
    tags: dict[Element, tuple[str, dict[str, str]]]
    """Start tag of each element as it stands, and the attributes that it says."""

    def text(self) -> str:
        """Return the file with all that has changed since it was read."""
        return self.before + self._element(self.root) + self.after

    def _element(self, element: Element) -> str:
        from xml.etree.ElementTree import Comment
        from xml.sax.saxutils import escape, quoteattr

        remark: Any = Comment  # what the tag of a comment is
        if element.tag is remark:
            return f"<!--{element.text}-->"
        inner = escape(element.text or "")
        inner += "".join(self._element(child) + escape(child.tail or "") for child in element)
        start, stated = self.tags.get(element, ("", {}))
        if not start or stated != element.attrib:
            attributes = "".join(f" {key}={quoteattr(value)}" for key, value in element.items())
            start = f"<{element.tag}{attributes}" + (">" if inner else "/>")
        if start.endswith("/>"):
            if not inner:
                return start
            start = start.removesuffix("/>").rstrip() + ">"
        return f"{start}{inner}</{element.tag}>"


def read_robot(path: Path, root: str) -> RobotFile:
    """Return an XML file, comments included.

    Raise InvalidFile if it is no XML file, or its root has another name.
    """
    from xml.parsers.expat import ExpatError

    with reading(regular_file(path), "XML"):
        text, encoding = xml_text(path, path.read_bytes())
        try:
            found = _parsed(text, encoding)
        except ExpatError as error:
            raise InvalidFile(path, f"line {error.lineno}", f"is no XML: {error}") from None
    if found.root.tag != root:
        raise InvalidFile(path, "file", f"must hold a <{root}>, got <{found.root.tag}>")
    return found


def _parsed(text: str, encoding: str) -> RobotFile:
    """Return the tree, with prefixes of namespaces as they stand and the tags of its elements.

    The parser counts in bytes, so it gets UTF-8, in which each part of a tag has one.
    """
    from xml.etree.ElementTree import TreeBuilder
    from xml.parsers.expat import ParserCreate

    raw, parser, builder = text.encode(), ParserCreate("utf-8"), TreeBuilder(insert_comments=True)
    ends, depth = [0, 0], [0]
    tags: dict[Any, tuple[str, dict[str, str]]] = {}

    def start(tag: str, attributes: dict[str, str]) -> None:
        at = parser.CurrentByteIndex
        if depth[0] == 0:
            ends[0] = at
        depth[0] += 1
        stated = raw[at : _tag_end(raw, at)].decode()
        tags[builder.start(tag, attributes)] = (stated, dict(attributes))

    def end(tag: str) -> None:
        depth[0] -= 1
        builder.end(tag)
        if depth[0] == 0:
            ends[1] = _tag_end(raw, parser.CurrentByteIndex)

    def comment(text: str) -> None:
        if depth[0]:
            builder.comment(text)

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler, parser.CommentHandler = builder.data, comment
    parser.Parse(raw, True)
    return RobotFile(builder.close(), raw[: ends[0]].decode(), raw[ends[1] :].decode(), encoding, tags)


def _tag_end(raw: bytes, at: int) -> int:
    """Return the place behind the `>` of a tag that begins at a place; one in quotes does not count."""
    quote = 0
    for k in range(at, len(raw)):
        if quote:
            quote = 0 if raw[k] == quote else quote
        elif raw[k] in b"\"'":
            quote = raw[k]
        elif raw[k] == ord(">"):
            return k + 1
    return len(raw)


def add(parent: Element, child: Element) -> None:
    """Add an element as the last one, indented as its neighbours are."""
    if len(parent):
        last = parent[-1]
        child.tail = last.tail
        last.tail = parent.text if (parent.text or "").isspace() else last.tail
    parent.append(child)


def remove(parent: Element, child: Element) -> None:
    """Remove an element with its indentation."""
    place = list(parent).index(child)
    if place:
        parent[place - 1].tail = child.tail
    parent.remove(child)


def write_robot(file: RobotFile, path: Path, inputs: list[Path], force: bool) -> None:
    """Write an XML file, which appears when it is whole and replaces no input.

    Raise InvalidFile if it cannot be written.
    """
    text = file.text()
    if "\r\n" in file.before + "".join(tag for tag, _ in file.tags.values()) + file.after:
        text = text.replace("\r\n", "\n").replace("\n", "\r\n")
    write_file(path, text.encode(file.encoding, "xmlcharrefreplace"), inputs, force)


def refuse_no_joint(path: Path, wanted: list[str], there: list[str], written: int) -> None:
    """Refuse a file that has none of the model's joints.

    Raise InvalidFile with the names of both.
    """
    if written == 0:
        names = ", ".join(there) or "none"
        what = f"must have a joint of the model ({', '.join(wanted)}), got {names}"
        raise InvalidFile(path, "joints", what)


def number(value: float) -> str:
    """Return a number with all its digits."""
    return repr(float(value)).removesuffix(".0")
