"""Names of places: "base", a link, or an interface of a super-element, `link:interface`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from pydantic import AfterValidator

from flexarm.tables.table import check_name

if TYPE_CHECKING:
    from flexarm.arm.joint import Joint


def _check_place(place: str) -> str:
    words = place.split(":")
    if len(words) > 2:
        raise ValueError(f"{place!r} has more than one ':'; allowed are LINK and LINK:INTERFACE")
    for word in words:
        check_name(word)
    return place


Place = Annotated[str, AfterValidator(_check_place)]


def link_of(place: str) -> str:
    """Return the link of a place: "hub" of "hub:output"."""
    return place.partition(":")[0]


def from_base(joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints of a tree by their number of joints from the base; in the order given where equal."""
    on: dict[str, list[Joint]] = {}
    for joint in joints:
        on.setdefault(link_of(joint.parent), []).append(joint)
    rank = {id(joint): i for i, joint in enumerate(joints)}
    order: list[Joint] = []
    level = on.get("base", [])
    while level:
        order += level
        above = [joint for below in level for joint in on.get(link_of(below.child), [])]
        level = sorted(above, key=lambda joint: rank[id(joint)])
    return order
