"""A page in a notebook, in a browser, in a file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from html import escape
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from flexarm.arguments import takes
from flexarm.arm import Arm
from flexarm.comparison.aligned_record import simulate_record
from flexarm.diagnosis.result import Diagnosis
from flexarm.errors import InvalidParameter
from flexarm.modal import Modes
from flexarm.output import PAGES, refuse_existing, refuse_suffix, write_file
from flexarm.record import Record
from flexarm.simulation import Simulation
from flexarm.solids import SolidMesh
from flexarm.statics import Statics
from flexarm.superelement import SuperElement
from flexarm.viewer.bodies import Meshes
from flexarm.viewer.measured import measured_points
from flexarm.viewer.page import page
from flexarm.viewer.scene import Scene
from flexarm.viewer.stages import gap_scale, of_arm, of_modes, of_simulation, of_statics, of_superelement
from flexarm.viewer.urdf_meshes import part_surface, urdf_meshes

HEIGHT = 620
"""Of the frame in a notebook [px]."""


class View:
    """A scene as one page in three dimensions, which shows itself in a notebook."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    @cached_property
    def html(self) -> str:
        """The page: one file that needs no network, with Meshcat's viewer in it."""
        return page(self.scene)

    @takes()
    def save(self, path: str | Path, force: bool = False, inputs: Iterable[Path] = ()) -> None:
        """Write the page as one HTML file.

        Parameters
        ----------
        path : str or Path
            The file.
        force : bool
            Replace a file of that name.
        inputs : iterable of Path
            Files that are never replaced.

        Raises
        ------
        InvalidFile
            If its name is not that of a page, it exists and `force` is not set, or it cannot be written.
        """
        refuse_suffix(Path(path), PAGES)
        refuse_existing(Path(path), force, inputs)
        write_file(path, self.html)

    def open(self) -> Path:
        """Open the page in the browser, from a temporary file, and return that file."""
        import webbrowser

        file = Path(mkdtemp(prefix="flexarm-")) / "view.html"
        file.write_text(self.html, encoding="utf-8")
        webbrowser.open(file.as_uri())
        return file

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {HEIGHT}px; border: 1px solid #d5d9de"
        return f'<iframe srcdoc="{escape(self.html)}" style="{style}"></iframe>'

    def __repr__(self) -> str:
        return f"<View of {self.scene.title!r}: open() shows it in the browser, save(path) writes it>"


def view(of: Any, **options: Any) -> View:
    """Return the page of a model, a part, a result or a diagnosis, with the options of its method `view`.

    Raise InvalidParameter if it is nothing of these.
    """
    for kind, made in _MADE.items():
        if isinstance(of, kind):
            return View(made(of, **options))
    known = ", ".join(kind.__name__ for kind in _MADE)
    raise InvalidParameter(f"must be one of {known}, got {type(of).__name__}", where="view")


@takes()
def _arm(arm: Arm, joints: Mapping[str, float] | None = None, urdf: str | Path | None = None) -> Scene:
    return of_arm(arm, joints, _meshes(arm, urdf))


@takes()
def _statics(found: Statics, scale: float | None = None, urdf: str | Path | None = None) -> Scene:
    return of_statics(found, scale, _meshes(found.arm, urdf))


@takes()
def _modes(found: Modes, urdf: str | Path | None = None) -> Scene:
    return of_modes(found, _meshes(found.arm, urdf))


@takes()
def _simulation(
    run: Simulation, record: Record | None = None, scale: float = 1.0, urdf: str | Path | None = None
) -> Scene:
    measured = (
        [] if record is None else measured_points(simulate_record(run.arm, _motion(record), simulation=run))
    )
    return of_simulation(run, scale, _meshes(run.arm, urdf), measured)


@takes()
def _superelement(part: SuperElement, mesh: SolidMesh | str | Path | None = None) -> Scene:
    return of_superelement(part, part_surface(part, mesh))


@takes()
def _diagnosis(
    found: Diagnosis, record: Record | None = None, scale: float = 1.0, urdf: str | Path | None = None
) -> Scene:
    named = [f"{effect.name} at {effect.at}" for effect in found.effects]
    note = f"updated model: {', '.join(named)}" if named else f"updated model; verdict: {found.verdict}"
    scene = _arm(found.updated, urdf=urdf) if record is None else _repaired(found, record, scale, urdf)
    return replace(scene, title=f"{found.arm.name}: diagnosis", notes=(note, *scene.notes))


def _repaired(found: Diagnosis, record: Record, scale: float, urdf: str | Path | None) -> Scene:
    """Return the runs of the updated and of the nominal model along a record, gaps at one scale."""
    pairs = [simulate_record(arm, _motion(record)) for arm in (found.updated, found.arm)]
    points = [measured_points(pair) for pair in pairs]
    runs: list[Simulation] = [pair.simulated.simulation for pair in pairs]
    times = gap_scale(runs[1], points[1])
    after, before = (
        of_simulation(run, scale, _meshes(run.arm, urdf), seen, times)
        for run, seen in zip(runs, points, strict=True)
    )
    clips = (replace(after.clips[0], name="updated model"), replace(before.clips[0], name="nominal model"))
    return replace(after, clips=clips)


def of_record(arm: Arm, record: Record, scale: float = 1.0, urdf: str | Path | None = None) -> Scene:
    """Return the run of a model along a record, measured points beside predicted ones."""
    pair = simulate_record(arm, _motion(record))
    run = pair.simulated.simulation
    return of_simulation(run, scale, _meshes(run.arm, urdf), measured_points(pair))


def _motion(record: Record) -> Record:
    if record.kind != "motion":
        held = {"static": "poses", "frequency_response": "frequency responses"}[record.kind]
        pose = "; see one by flexarm view MODEL --joint NAME=VALUE" if record.kind == "static" else ""
        raise InvalidParameter(f"holds {held}; only motions are shown{pose}", where="kind")
    return record


def _meshes(arm: Arm, urdf: str | Path | None) -> Meshes:
    found = {} if urdf is None else urdf_meshes(Path(urdf))
    for link in arm.links:
        if link.type == "superelement":
            surface = part_surface(link.part, None, Path(link.file).parent)
            found |= {} if surface is None else {link.name: surface}
    return found


_MADE: dict[type, Any] = {
    Arm: _arm,
    Statics: _statics,
    Modes: _modes,
    Simulation: _simulation,
    SuperElement: _superelement,
    Diagnosis: _diagnosis,
}
