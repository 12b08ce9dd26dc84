"""Parts that come up often, in one call each: ring, tube, disc, shaft, flange.

All stand on z = 0 with their axis along z. For anything with steps, list its blocks and call `revolved`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Required, TypedDict, Unpack

from flexarm.errors import InvalidParameter
from flexarm.material import Material
from flexarm.solids.mesh import SolidMesh
from flexarm.solids.revolve.profile import Block, BoltCircle, Patch
from flexarm.solids.revolve.revolved import revolved


class Options(TypedDict, total=False):
    """Options of `revolved`."""

    size: Required[float | tuple[float, float]]
    around: int | None
    order: int
    patches: Sequence[Patch | BoltCircle]
    material: Material | None


def ring(inner_radius: float, outer_radius: float, height: float, **options: Unpack[Options]) -> SolidMesh:
    """Return a ring: group `ring`, sets `inner`, `outer`, `bottom`, `top`. Lengths in m.

    >>> from flexarm.solids import ring
    >>> ring(0.1, 0.2, 0.1, size=0.05, around=24).n_cells
    96
    """
    block = Block("ring", inner_radius, outer_radius, 0.0, height)
    return revolved([block], **options)


def tube(outer_diameter: float, thickness: float, length: float, **options: Unpack[Options]) -> SolidMesh:
    """Return a tube along z with the parameters of a beam's tube section: group `tube`. Lengths in m."""
    if not 0 < 2 * thickness < outer_diameter:
        raise InvalidParameter(
            f"must be positive and less than half the outer diameter ({outer_diameter / 2:g} m), got "
            f"{thickness:g} m",
            where="thickness",
        )
    block = Block("tube", outer_diameter / 2 - thickness, outer_diameter / 2, 0.0, length)
    return revolved([block], **options)


def disc(diameter: float, thickness: float, **options: Unpack[Options]) -> SolidMesh:
    """Return a solid disc: group `disc`. Lengths in m."""
    block = Block("disc", 0.0, diameter / 2, 0.0, thickness)
    return revolved([block], **options)


def shaft(steps: Sequence[tuple[float, float]], **options: Unpack[Options]) -> SolidMesh:
    """Return a solid stepped shaft along z: groups `step-1`, `step-2`, .. from the bottom.

    `steps` are (diameter, length) from z = 0 upwards [m]; options are as of `revolved`.
    """
    blocks, z = [], 0.0
    for i, (diameter, length) in enumerate(steps, start=1):
        blocks.append(Block(f"step-{i}", 0.0, diameter / 2, z, z + length))
        z += length
    return revolved(blocks, **options)


def flange(
    inner_radius: float,
    outer_radius: float,
    thickness: float,
    *,
    bolts: int,
    bolt_circle: float,
    pad: float,
    **options: Unpack[Options],
) -> SolidMesh:
    """Return a flange with pads under its bolts on the top face: group `flange`, sets `bolts`, `bolts-1`, ..

    Radii, thickness, the bolt circle's radius and the pads' diameter are in m; `inner_radius = 0` is a solid
    disc. Options are as of `revolved`.
    """
    block = Block("flange", inner_radius, outer_radius, 0.0, thickness)
    circle = BoltCircle("bolts", radius=bolt_circle, count=bolts, diameter=pad, height=thickness)
    options["patches"] = [*options.get("patches", ()), circle]
    return revolved([block], **options)
