"""A part that revolves: its profile in the (r, z) half-plane, swept around z into hexahedra.

Seen along its axis it is made of circles divided evenly, with a core of squares where the axis is solid.

    (x, y) = r (cos t, sin t),   t = 2 pi k / n                                                     (1)

A cell that reached the axis would have an edge of length zero, so the disc inside the smallest circle is an
O-grid: a bulged square of (n/4) x (n/4) cells, whose outline has n points at the angles of (1), and rings
between that outline and the circle. With s, t in [-1, 1], u = tan(pi s/4), v = tan(pi t/4),

    p = (c/2) [ (u, v) + max(|u|, |v|) (u, v) / |(u, v)| ]                                          (2)

turned by 45 degrees: half a square, half a circle, so that at the outline's four corners, where three cells
meet, none of them has an angle near 90 (the two rings would be flat) or 180 degrees (the square would be).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, lcm, pi

import numpy as np

from flexarm.arrays import Floats, Ints
from flexarm.errors import InvalidParameter
from flexarm.material import Material
from flexarm.solids.cell_types import CELL_TYPES
from flexarm.solids.mesh import SolidMesh
from flexarm.solids.revolve.lines import SAME, Lines
from flexarm.solids.revolve.profile import Block, BoltCircle, Patch
from flexarm.solids.revolve.selection import pad_notes, point_sets


def revolved(
    blocks: Sequence[Block],
    *,
    size: float | tuple[float, float],
    around: int | None = None,
    order: int = 2,
    patches: Sequence[Patch | BoltCircle] = (),
    material: Material | None = None,
) -> SolidMesh:
    """Mesh a part made of rings, discs and tubes around z with hexahedra.

    Blocks that touch share their points; blocks must not overlap.

    Parameters
    ----------
    blocks : sequence of Block
        The rectangles of the profile; each is a group of cells.
    size : float or (float, float)
        Largest edge of a cell [m], along r and z alike or each of its own.
    around : int, optional
        Cells around the axis; default: as long as `size` on the largest radius, at least 8, and a multiple of
        the number of bolts. A multiple of 4 where the axis is solid.
    order : {1, 2}
        1: 8-node hexahedra with straight edges. 2: 20-node ones, whose middle points lie on the circles.
    patches : sequence of Patch and BoltCircle
        Further sets of points.
    material : Material, optional
        Of the blocks that name none.

    Returns
    -------
    mesh : SolidMesh
        With a group for each block; point sets `BLOCK.inner`, `BLOCK.outer`, `BLOCK.bottom`, `BLOCK.top` for
        each block and `inner`, `outer`, `bottom`, `top` for the whole part (its least and largest r and z);
        and those of `patches`.

    Examples
    --------
    >>> from flexarm.solids import Block, revolved
    >>> hub = revolved([Block("disc", 0, 0.05, 0, 0.01), Block("tube", 0.03, 0.05, 0.01, 0.06)], size=0.01)
    >>> sorted(hub.cell_groups)
    ['disc', 'tube']
    """
    _check(blocks, patches)
    if order not in (1, 2):
        raise InvalidParameter(f"must be 1 (hex8) or 2 (hex20), got {order}", where="order")
    along_r, along_z = _sizes(size)
    radii, heights = _lines(blocks, patches, along_r, along_z)
    n = _around(radii, along_r, around, patches)
    plan = plan_of(radii.values, n, along_r)
    z = np.repeat(heights.values, len(plan.points))
    points = np.column_stack([np.tile(plan.points, (len(heights), 1)), z])
    circle = np.tile(plan.circle, len(heights))
    cells, groups = _sweep(plan.quads, plan.column, len(plan.points), blocks, radii, heights)
    used, inverse = np.unique(cells, return_inverse=True)
    points, circle, cells = points[used], circle[used], inverse.reshape(cells.shape)
    if order == 2:
        points, cells = with_middle_points(points, circle, cells)
    kind = "hex8" if order == 1 else "hex20"
    mesh = SolidMesh(
        points=points,
        cells={kind: cells},
        cell_groups={name: {kind: indices} for name, indices in groups.items()},
        point_sets=point_sets(points, blocks, patches, n),
        materials=_materials(blocks, material),
        notes=tuple(pad_notes(patches, n)),
    )
    return mesh


def _check(blocks: Sequence[Block], patches: Sequence[Patch | BoltCircle]) -> None:
    if not blocks:
        raise InvalidParameter("there are none; a part needs at least one block", where="blocks")
    names = [item.name for item in (*blocks, *patches)]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InvalidParameter(f"names must differ; given twice: {', '.join(twice)}", where="blocks")
    most = max(block.outer for block in blocks)
    for i, a in enumerate(blocks):
        for b in blocks[i + 1 :]:
            wide = min(a.outer, b.outer) - max(a.inner, b.inner)
            high = min(a.top, b.top) - max(a.bottom, b.bottom)
            if wide > SAME * most and high > SAME * most:
                raise InvalidParameter(
                    f"blocks {a.name!r} and {b.name!r} overlap by {wide:g} m along r and {high:g} m along z; "
                    "blocks may touch, not overlap",
                    where="blocks",
                )


def _sizes(size: float | tuple[float, float]) -> tuple[float, float]:
    along_r, along_z = size if isinstance(size, tuple) else (size, size)
    if not (along_r > 0 and along_z > 0):
        raise InvalidParameter(f"must be positive, got {size} m", where="size")
    return along_r, along_z


def _lines(
    blocks: Sequence[Block], patches: Sequence[Patch | BoltCircle], along_r: float, along_z: float
) -> tuple[Lines, Lines]:
    r = [value for block in blocks for value in (block.inner, block.outer)]
    z = [value for block in blocks for value in (block.bottom, block.top)]
    (least_r, most_r), (least_z, most_z) = (min(r), max(r)), (min(z), max(z))
    for patch in patches:
        if isinstance(patch, BoltCircle):
            r += [patch.radius - patch.diameter / 2, patch.radius + patch.diameter / 2]
            z += [patch.height]
        else:
            r += [patch.inner, patch.outer]
            z += [patch.bottom, patch.top]
    r = [value for value in r if least_r <= value <= most_r]
    z = [value for value in z if least_z <= value <= most_z]
    radii = Lines.through(r, along_r, most_r)
    if least_r == 0:  # inside the smallest circle the core has lines of its own
        smallest = min(value for value in r if value > SAME * most_r)
        radii = Lines(np.concatenate([[0.0], radii.values[radii.index(smallest) :]]))
    return radii, Lines.through(z, along_z, most_z - least_z)


def _around(radii: Lines, size: float, wanted: int | None, patches: Iterable[object]) -> int:
    fewest_around = 8
    step = 4 if radii.values[0] == 0 else 1
    if wanted is None:
        bolts = lcm(step, *(p.count for p in patches if isinstance(p, BoltCircle)))
        least = max(fewest_around, ceil(2 * pi * radii.values[-1] / size * (1 - 1e-9)))
        return int(bolts * ceil(least / bolts))
    if wanted < fewest_around or wanted % step:
        solid = " and a multiple of 4, as the axis is solid" if step == 4 else ""
        raise InvalidParameter(f"must be at least {fewest_around}{solid}, got {wanted}", where="around")
    return wanted


def _sweep(
    quads: Ints, column: Ints, n_plan: int, blocks: Sequence[Block], radii: Lines, heights: Lines
) -> tuple[Ints, dict[str, Ints]]:
    """Return the hexahedra of all blocks, and the indices of those of each."""
    cells, groups, count = [], {}, 0
    for block in blocks:
        r, z = radii.within(block.inner, block.outer), heights.within(block.bottom, block.top)
        ring = quads[(column >= r.start) & (column < r.stop - 1)]
        for level in range(z.start, z.stop - 1):
            cells.append(np.hstack([ring + level * n_plan, ring + (level + 1) * n_plan]))
        n = len(ring) * (z.stop - 1 - z.start)
        groups[block.name] = np.arange(count, count + n)
        count += n
    return np.concatenate(cells), groups


def _materials(blocks: Sequence[Block], rest: Material | None) -> Mapping[str, Material]:
    return {block.name: material for block in blocks if (material := block.material or rest) is not None}


def with_middle_points(points: Floats, circle: Floats, cells: Ints) -> tuple[Floats, Ints]:
    """Return points and 20-node cells with a point m in the middle of every edge from a to b.

        m = (a + b)/2,    and r(m) = r   where r(a) = r(b) = r                                           (1)

    An edge between two points of one circle, of radius `circle` (nan for points on none), is a chord, whose
    middle is moved out to the arc; all other edges (along r, along z, inside the core) are straight.
    """
    edges = np.sort(cells[:, np.array(CELL_TYPES["hex20"].edges)].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middle = points[unique].mean(axis=1)
    radius = circle[unique]
    arcs = radius[:, 0] == radius[:, 1]  # nan equals nothing
    middle[arcs, :2] *= (radius[arcs, 0] / np.linalg.norm(middle[arcs, :2], axis=1))[:, None]  # eq. (1)
    numbers = len(points) + inverse.reshape(len(cells), -1)
    return np.concatenate([points, middle]), np.hstack([cells, numbers])


#: c in (2), as a part of the radius of the circle around the core.
CORE = 0.5


@dataclass(frozen=True)
class Plan:
    """Points and quadrilaterals in the plane normal to the axis."""

    points: Floats
    """x, y [m]."""
    circle: Floats
    """Radius of the circle that a point lies on [m], nan inside the core."""
    quads: Ints
    """Corners, anticlockwise."""
    column: Ints
    """Index of the line at each quad's inner radius; the core belongs to line 0."""


def plan_of(radii: Floats, around: int, core_size: float) -> Plan:
    """Return the plan of circles at rising `radii`; a first radius of 0 adds a core of `core_size` cells."""
    if radii[0] > 0:
        points = _circles(radii, around)
        quads = _rings(0, len(radii) - 1, around)
        column = np.repeat(np.arange(len(radii) - 1), around)
        return Plan(points, np.repeat(radii, around), quads, column)
    core, square = _core(CORE * radii[1], around)
    outline = core[-around:]
    layers = max(1, round((1 - CORE) * radii[1] / core_size))
    part = np.arange(1, layers)[:, None, None] / layers
    between = (1 - part) * outline + part * _circles(radii[1:2], around)
    points = np.concatenate([core, between.reshape(-1, 2), _circles(radii[1:], around)])
    circle = np.full(len(points), np.nan)
    circle[-around * (len(radii) - 1) :] = np.repeat(radii[1:], around)
    rings = _rings(len(core) - around, layers + len(radii) - 2, around)
    outside = np.repeat(np.arange(1, len(radii) - 1), around)
    column = np.concatenate([np.zeros(len(square) + layers * around, int), outside])
    return Plan(points, circle, np.concatenate([square, rings]), column)


def _circles(radii: Floats, around: int) -> Floats:
    angle = 2 * np.pi * np.arange(around) / around
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.concatenate([r * directions for r in radii])  # eq. (1)


def _rings(first: int, layers: int, around: int) -> Ints:
    """Return quads between consecutive circles of `around` points, from point `first` outwards."""
    k = np.arange(around)
    inner = first + np.arange(layers)[:, None] * around + k
    following = first + np.arange(layers)[:, None] * around + (k + 1) % around
    quads = np.stack([inner, inner + around, following + around, following], axis=-1)
    return quads.reshape(-1, 4)


def _core(size: float, around: int) -> tuple[Floats, Ints]:
    """Return points and quads of the square; its outline comes last, anticlockwise from the corner on x."""
    n = around // 4
    s, t = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    uv = np.tan(np.pi / 4 * np.stack([s, t], axis=-1))
    length = np.linalg.norm(uv, axis=-1, keepdims=True)
    largest = np.abs(uv).max(axis=-1, keepdims=True)
    bulged = size / 2 * (uv + largest * uv / np.where(length > 0, length, 1))  # eq. (2)
    turn = np.array([[1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(2)  # by +45 degrees, for row vectors
    points = bulged.reshape(-1, 2) @ turn
    index = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    outline = np.concatenate([index[n, :n], index[n:0:-1, n], index[0, n:0:-1], index[:n, 0]])
    order = np.concatenate([np.setdiff1d(index.ravel(), outline), outline])
    new = np.empty(len(order), dtype=np.int64)
    new[order] = np.arange(len(order))
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return points[order], new[quads.reshape(-1, 4)]
