"""Names of places: "base", a link, or an interface of a super-element, `link:interface`."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator

from flexarm.tables.table import check_name


def _check_place(place: str) -> str:
    words = place.split(":")
    if len(words) > 2:
        raise ValueError(f"{place!r} has more than one ':'; allowed are LINK and LINK:INTERFACE")
    for word in words:
        check_name(word)
    return place


Place = Annotated[str, AfterValidator(_check_place)]


def link_of(place: str) -> str:
    """The link of a place: "hub" of "hub:output"."""
    return place.partition(":")[0]
