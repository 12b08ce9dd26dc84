r"""A boom as far as it was drawn out in a run: the same beam, longer or shorter.

.. math:: error \leftarrow error + L - L_0, \qquad u \leftarrow u \, (L/L_0)^2                       (1)

L is the length that the record states, L_0 the model's, and error the parameter of the effect `link_length`,
which carries the change: section and material stay, payloads and points keep their fraction of the length,
joints with `at = "end"` follow. The tip offset u of a bow belongs to the model's length; its curvature
2 u/L^2 is the boom's own and stays. Derivatives by u are those by the offset of the boom as it was drawn out;
those by all other parameters mean the model's.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexarm.arm.consistency import missing
from flexarm.arm.effect import read_effect
from flexarm.arm.link import Beam
from flexarm.arm.rotation import scaled
from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.table import DrawnLink


def with_link_lengths(arm: Arm, links: Mapping[str, DrawnLink]) -> Arm:
    """Return the arm with links of the lengths that a record states, eq. (1).

    Raises
    ------
    InvalidParameter
        If there is no such link, or it is no beam.
    """
    known = {link.name: link for link in arm.links}
    for name, drawn in links.items():
        if name not in known:
            raise InvalidParameter(missing("link", name, known), where=f"links.{name}")
        link = known[name]
        if not isinstance(link, Beam):
            what = f"must be a beam to have a length, {name!r} is a {link.type} link"
            raise InvalidParameter(what, where=f"links.{name}.length")
        own, bow = arm.effect("link_length", name), arm.effect("link_bow", name)
        error = float(getattr(own, "error", 0.0)) + drawn.length - link.length
        arm = arm.with_effect(read_effect({"name": "link_length", "at": name, "error": error}))
        if bow is not None:
            tip_offset = scaled((drawn.length / link.length) ** 2, bow.tip_offset)  # type: ignore[attr-defined]
            arm = arm.with_effect(bow.replace(tip_offset=tip_offset))  # eq. (1)
    return arm
