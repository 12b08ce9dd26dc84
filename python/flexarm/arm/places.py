"""Places on a link that joints, payloads and points name: the link's frame, or an interface's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.inertia import Matrix
from flexarm.arm.link import SuperElementLink
from flexarm.arm.rotation import IDENTITY, Vector

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm


def place_in_link(arm: Arm, place: str) -> tuple[Matrix, Vector]:
    """Return rotation and position [m] of a place in the frame of its link, undeformed.

    Raise InvalidFile or InvalidParameter if the link is a super-element whose file cannot be read or has no
    such interface.
    """
    name, _, interface = place.partition(":")
    link = arm.link(name) if interface else None
    if not isinstance(link, SuperElementLink):
        return IDENTITY, (0.0, 0.0, 0.0)
    rotation, position = link.part.interface(interface)
    rows = [tuple(map(float, row)) for row in rotation]
    x, y, z = map(float, position)
    return (rows[0], rows[1], rows[2]), (x, y, z)  # type: ignore[return-value]
