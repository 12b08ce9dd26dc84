r"""A boom as far as it was drawn out in a run: the same beam, longer or shorter.

.. math:: end \leftarrow end \, L/L_0, \qquad u \leftarrow u \, (L/L_0)^2                             (1)

L is the length that the record states, L_0 the model's. Section and material stay, so stiffness and mass per
length do; payloads and points keep their fraction of the length, those beyond the end their distance from it,
and joints with `at = "end"` follow. The tip offset u of a bow belongs to the model's length; its curvature
2 u/L^2 is the boom's own and stays too.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from flexarm.arm.consistency import missing
from flexarm.arm.link import Beam
from flexarm.arm.rotation import added, dot, scaled
from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.table import DrawnLink


def drawn_out(arm: Arm, links: Mapping[str, DrawnLink]) -> Arm:
    """The arm with links of the lengths that a record states, eq. (1).

    Raises
    ------
    InvalidParameter
        If there is no such link, or it is no beam.
    """
    for name, drawn in links.items():
        arm = _drawn(arm, _beam(arm, name), drawn.length)
    return arm


def _beam(arm: Arm, name: str) -> Beam:
    found = {link.name: link for link in arm.links}
    if name not in found:
        raise InvalidParameter(missing("link", name, found), where=f"links.{name}")
    link = found[name]
    if not isinstance(link, Beam):
        raise InvalidParameter(
            f"must be a beam to have a length, {name!r} is a {link.type} link", where=f"links.{name}.length"
        )
    return link


def _drawn(arm: Arm, beam: Beam, length: float) -> Arm:
    ratio = length / beam.length

    def followed(entry: Any) -> Any:
        """A payload or point at the same fraction of the beam."""
        if entry.link != beam.name:
            return entry
        fraction = min(max(dot(entry.position, beam.end) / beam.length**2, 0.0), 1.0)
        return entry.replace(position=added(entry.position, scaled(fraction * (ratio - 1), beam.end)))

    def bowed(effect: Any) -> Any:
        """The same curvature."""
        if (effect.name, effect.at) != ("link_bow", beam.name):
            return effect
        return effect.replace(tip_offset=scaled(ratio**2, effect.tip_offset))

    other = beam.replace(end=scaled(ratio, beam.end))  # eq. (1)
    return arm.replace(
        links=tuple(other if link is beam else link for link in arm.links),
        payloads=tuple(followed(load) for load in arm.payloads),
        points=tuple(followed(point) for point in arm.points),
        effects=tuple(bowed(effect) for effect in arm.effects),
    )
