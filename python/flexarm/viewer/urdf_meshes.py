"""Surfaces from files: what a URDF draws its links as, and the mesh that a super-element was reduced from."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arm.rotation import from_rpy
from flexarm.arm.urdf import BASE_FRAME
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.input_files import sha256
from flexarm.reading import regular_file, xml_text
from flexarm.solids import SolidMesh, read_mesh
from flexarm.solids.shape import surface
from flexarm.superelement import SuperElement
from flexarm.viewer.bodies import Meshes
from flexarm.viewer.solids import Surface, ball, box, joined, rod, triangles

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


def urdf_meshes(path: Path) -> Meshes:
    """Return the visual geometry of a URDF's links, in the links' frames, by the names of the model.

    Mesh files that are not there, or that no reader is installed for, are left out: such links are sticks.

    Raise InvalidFile if the file is no URDF.
    """
    from xml.etree import ElementTree

    try:
        robot = ElementTree.fromstring(xml_text(path, regular_file(path).read_bytes())[0])
    except (OSError, ElementTree.ParseError) as error:
        raise InvalidFile(path, "file", f"cannot be read as URDF: {error}") from None
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    found: Meshes = {}
    for link in robot.iterfind("link"):
        parts = list(_visuals(link, path))
        if parts:
            name = str(link.get("name"))
            root = name not in children
            found["base" if root else BASE_FRAME if name == "base" else name] = joined(*parts)
    return found


def _visuals(link: Element, path: Path) -> Iterator[Surface]:
    for visual in link.iterfind("visual"):
        geometry = visual.find("geometry")
        shape = next(iter(geometry), None) if geometry is not None else None
        drawn = None if shape is None else _shape(shape, path)
        if drawn is not None:
            origin = visual.find("origin")
            rpy, xyz = _numbers(origin, "rpy", "0 0 0"), _numbers(origin, "xyz", "0 0 0")
            yield drawn.moved(np.array(from_rpy(tuple(rpy))), xyz)


def _shape(shape: Element, path: Path) -> Surface | None:
    if shape.tag == "box":
        return box(_numbers(shape, "size", "0 0 0"))
    if shape.tag == "sphere":
        return ball(float(_numbers(shape, "radius", "0")[0]))
    if shape.tag == "cylinder":
        half = np.array([0, 0, 0.5 * float(_numbers(shape, "length", "0")[0])])
        return rod(-half, half, float(_numbers(shape, "radius", "0")[0]))
    if shape.tag == "mesh":
        file = _found(str(shape.get("filename")), path.parent)
        read = None if file is None else _read(file)
        scale = _numbers(shape, "scale", "1 1 1")
        return None if read is None else Surface(read.corners * scale, read.faces)
    return None


def _numbers(element: Element | None, key: str, default: str) -> Floats:
    return np.array((default if element is None else element.get(key, default)).split(), dtype=float)


def _found(name: str, folder: Path) -> Path | None:
    """Return the file of a mesh: `package://NAME/...` lies in a folder NAME above the URDF, or beside it."""
    plain = name.removeprefix("file://")
    inside = plain.removeprefix("package://")
    tried = [folder / plain]
    if inside != plain:
        above = [folder.absolute(), *folder.absolute().parents]
        tried = [place / rest for place in above for rest in (inside, inside.partition("/")[2])]
    return next((file for file in tried if file.is_file()), None)


def _read(file: Path) -> Surface | None:
    """Return a surface in its file's units; None without a reader for it."""
    try:
        import trimesh
    except ImportError:
        return None
    try:
        read: Any = trimesh.load(file, force="mesh")
        corners, faces = np.asarray(read.vertices, dtype=float), np.asarray(read.faces, dtype=int)
    except Exception as error:
        raise InvalidFile(file, "mesh", f"cannot be read: {error}") from None
    return Surface(corners, faces) if len(faces) else None


def part_surface(
    part: SuperElement, mesh: SolidMesh | str | Path | None, folder: Path | None = None
) -> Surface | None:
    """Return the surface of a part.

    Without its mesh: of the file that it was reduced from, where that still lies in `folder` unchanged.
    """
    unit = str(part.provenance.get("mesh_unit", "m"))
    if mesh is None and folder is not None and part.provenance.get("mesh_file"):
        file = folder / str(part.provenance["mesh_file"])
        same = file.is_file() and sha256(file) == part.provenance.get("mesh_sha256")
        mesh = file if same else None
    if mesh is None:
        return None
    solid = mesh if isinstance(mesh, SolidMesh) else read_mesh(mesh, unit=unit)
    # Points inside the part are left out.
    faces = triangles(surface(solid))
    used, renumbered = np.unique(faces, return_inverse=True)
    return Surface(solid.points[used], renumbered.reshape(faces.shape))
