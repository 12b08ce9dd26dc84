"""A summary of a mesh in a few lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexarm.solids.mesh import SolidMesh


def describe(mesh: SolidMesh) -> str:
    """Return the size, cells, groups with their materials, sets: one thing a line."""
    counts = ", ".join(f"{len(nodes)} {kind}" for kind, nodes in mesh.cells.items())
    size = " x ".join(f"{length:.4g}" for length in mesh.box[1] - mesh.box[0]) if mesh.n_points else "empty"
    lines = [
        f"{mesh.file or 'mesh'}: {mesh.n_points} points, {mesh.n_dof} degrees of freedom, "
        f"{counts or 'no cells'}",
        f"  size  {size} m",
    ]
    for name, group in mesh.cell_groups.items():
        cells = sum(len(indices) for indices in group.values())
        lines.append(f"  group {name}: {cells} cells{_material(mesh, name)}")
    lines += [f"  set   {name}: {len(points)} points" for name, points in mesh.point_sets.items()]
    return "\n".join(lines)


def _material(mesh: SolidMesh, group: str) -> str:
    material = mesh.materials.get(group)
    if material is None:
        return ""
    return (
        f", E = {material.youngs_modulus:.4g} Pa, nu = {material.poisson_ratio:g}, "
        f"rho = {material.density:g} kg/m3"
    )
