"""Files of super-elements: where they lie, and whether a model names what they hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arm.names import link_of
from flexarm.output import place_of
from flexarm.tables.field import Path as TablePath

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.superelement import SuperElement


def found_from(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return tables of a model whose URDF file and parts, named from `folder`, have absolute paths."""
    return _with_files(data, lambda file: str((folder / file).resolve()))


def seen_from(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return tables of a model with the files relative to the folder in which it shall lie."""
    return _with_files(data, lambda file: Path(relpath(place_of(file), place_of(folder))).as_posix())


def _with_files(data: Mapping[str, Any], place: Any) -> dict[str, Any]:
    links, urdf = data.get("links"), data.get("urdf")
    named = {"urdf": place(urdf)} if isinstance(urdf, str) else {}
    if not isinstance(links, list | tuple):
        return {**data, **named}  # the check of the model says what is wrong with it
    return {
        **data,
        **named,
        "links": [
            {**link, "file": place(link["file"])}
            if isinstance(link, dict)
            and link.get("type") == "superelement"
            and isinstance(link.get("file"), str)
            and link["file"]
            else link
            for link in links
        ],
    }


def load_part(file: str) -> SuperElement:
    """Return the super-element in a file, read once until the file changes.

    Raise InvalidFile if it cannot be read.
    """
    path = Path(file)
    stamp = path.stat().st_mtime_ns if path.is_file() else 0
    return _loaded(str(path.resolve()), stamp)


@lru_cache(maxsize=64)
def _loaded(path: str, stamp: int) -> SuperElement:
    from flexarm.superelement import SuperElement

    return SuperElement.load(path)


def part_problems(arm: Arm) -> Iterator[tuple[TablePath, str]]:
    """Yield places and sentences for files that are missing and interfaces that their parts do not have."""
    interfaces: dict[str, tuple[str, ...]] = {}
    for i, link in enumerate(arm.links):
        if link.type != "superelement":
            continue
        if Path(link.file).is_file():
            interfaces[link.name] = link.part.interfaces
        else:
            what = f"there is no file {link.file}; `flexarm reduce` makes one from a mesh"
            yield ("links", i, "file"), what
    places = [
        *(
            (("joints", i, end), getattr(joint, end))
            for i, joint in enumerate(arm.joints)
            for end in ("parent", "child")
        ),
        *((("payloads", i, "link"), load.link) for i, load in enumerate(arm.payloads)),
        *((("points", i, "link"), point.link) for i, point in enumerate(arm.points)),
    ]
    for path, place in places:
        known = interfaces.get(link_of(place))
        if known is not None and place.partition(":")[2] not in known:
            yield (
                path,
                f"there is no interface {place.partition(':')[2]!r} on {link_of(place)!r}; "
                f"there are {', '.join(known)}",
            )
