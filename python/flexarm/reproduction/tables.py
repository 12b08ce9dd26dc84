"""The data behind each figure: named columns with units, as CSV.

Models have a value in every row. Measured columns are empty but at the tracker's own stamps: nothing is
interpolated between its samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.drive import Drive
from flexarm.output import write_file
from flexarm.reproduction.oscillation import grid
from flexarm.reproduction.study import Study
from flexarm.reproduction.variants import tube_of
from flexarm.simulation import simulate


@dataclass(frozen=True)
class Column:
    """Values of one column, their description and unit."""

    values: Floats
    text: str


Table = dict[str, Column]


def tables(study: Study) -> dict[str, Table]:
    """Return the columns of every figure, by the paper's number."""
    return {
        "04": input_shaft(study),
        "06": deformed_shape(study),
        "07": position(study),
        "08": position(study, zoom_window(study)),
        "09": errors(study),
        "10": tangential_error(study),
    }


def input_shaft(study: Study) -> Table:
    """Return Figure 4: the angle imposed on the reducer's input."""
    time = grid(study)
    time = time[time <= study.experiment.duration + 1e-9]
    run = study.runs["sine"]
    shaft = run.joint_angle[:, run.joints.index("motor_shaft")]
    return {
        "time_s": Column(time, "time [s]"),
        "input_shaft_rad": Column(
            np.interp(time, run.time, shaft) - shaft[0],
            "angle of the reducer's input shaft from the vertical [rad]",
        ),
    }


def deformed_shape(study: Study) -> Table:
    """Return Figure 6: the tube's axis at the greatest measured offset, and the three tips."""
    shape_points = 13  # places along the tube at which its deformed shape is computed
    time = deformed_instant(study)
    start = study.models.hinge.design.hub.flange_radius
    places = np.linspace(start, study.plane.length, shape_points)
    point = study.model.point("tip")
    along = tuple(
        point.replace(name=f"p{i}", position=(0.0, 0.0, float(place - start)))
        for i, place in enumerate(places)
    )
    finer = tube_of(study.model).replace(elements=shape_points - 1)
    links = tuple(finer if link.name == "tube" else link for link in study.model.links)
    arm = study.model.replace(points=along, links=links)
    run = simulate(arm, Drive({"hinge": study.encoder}, end=time + 0.01))
    shape = np.array([run.at([time], entry.name)[0, [0, 2]] for entry in along])
    tip = study.rigid(np.array([time]))[0]
    measured = np.full((shape_points, 2), np.nan)
    measured[-1] = study.measured[int(np.searchsorted(study.stamps, time))]
    rigid = places[:, None] / study.plane.length * tip
    return {
        "along_m": Column(places, "distance from the hinge axis along the tube [m]"),
        "rigid_x_m": Column(rigid[:, 0], "rigid arm at the encoder's angle, x [m]"),
        "rigid_z_m": Column(rigid[:, 1], "rigid arm at the encoder's angle, z [m]"),
        "model_x_m": Column(shape[:, 0], "finite-element model, x [m]"),
        "model_z_m": Column(shape[:, 1], "finite-element model, z [m]"),
        "measured_x_m": Column(measured[:, 0], "virtual measurement of the tip, x [m]"),
        "measured_z_m": Column(measured[:, 1], "virtual measurement of the tip, z [m]"),
    }


def deformed_instant(study: Study) -> float:
    """Return the stamp of the greatest measured tangential offset [s]."""
    return float(study.stamps[np.argmax(np.abs(study.measured_tangential))])


def position(study: Study, window: tuple[float, float] | None = None) -> Table:
    """Return Figures 7 and 8: tip positions."""
    time, measured = _placement(study, window)
    parts = {"rigid": study.rigid(time), "model": study.tip("fe", time), "measured": measured(study.measured)}
    names = {
        "rigid": "rigid arm at the encoder's angle",
        "model": "finite-element model",
        "measured": "virtual measurement",
    }
    table = {"time_s": Column(time, "time [s]")}
    for axis, k in (("z", 1), ("x", 0)) if window is None else (("z", 1),):
        for name, values in parts.items():
            table[f"{name}_{axis}_m"] = Column(values[:, k], f"{names[name]}, tip {axis} [m]")
    return table


def errors(study: Study) -> Table:
    """Return Figure 9: errors of the rigid position, vertical and horizontal."""
    time, measured = _placement(study, None)
    model = study.tip("fe", time) - study.rigid(time)
    seen = measured(study.measured - study.rigid(study.stamps))
    table = {"time_s": Column(time, "time [s]")}
    for axis, k, text in (("z", 1, "vertical"), ("x", 0, "horizontal")):
        table[f"measured_{axis}_m"] = Column(seen[:, k], f"virtual measurement minus rigid arm, {text} [m]")
        table[f"model_{axis}_m"] = Column(model[:, k], f"finite-element model minus rigid arm, {text} [m]")
    return table


def tangential_error(study: Study) -> Table:
    """Return Figure 10: tangential errors."""
    time, measured = _placement(study, None)
    seen = measured(study.measured_tangential[:, None])[:, 0]
    return {
        "time_s": Column(time, "time [s]"),
        "measured_m": Column(seen, "virtual measurement, tangential error [m]"),
        "encoder_m": Column(study.tangential("fe", time), "model driven by the encoder signal [m]"),
        "sine_m": Column(study.tangential("sine", time), "model driven by the pure sine [m]"),
    }


def zoom_window(study: Study) -> tuple[float, float]:
    """Return the window of Figure 8 about the first reversal, where the tip vibrates [s]."""
    turn, seconds = study.experiment.period / 4, 4.5
    return turn - 0.7 * seconds, turn + 0.3 * seconds


def _placement(study: Study, window: tuple[float, float] | None) -> tuple[Floats, Callable[[Floats], Floats]]:
    """Return the instants of a table, and a function that puts the tracker's samples among them."""
    stamps, equal = study.stamps, grid(study)
    first, last = window or (-np.inf, np.inf)
    kept = (stamps >= first) & (stamps <= last)
    equal = equal[(equal >= first) & (equal <= last)]
    time = np.unique(np.concatenate([equal, stamps[kept]]))

    def at_stamps(values: Floats) -> Floats:
        found = np.full((len(time), values.shape[1]), np.nan)
        found[np.searchsorted(time, stamps[kept])] = values[kept]
        return found

    return time, at_stamps


def write_csv(table: Table, path: Path) -> None:
    """Write one row for each instant or place; cells without a measurement stay empty."""
    columns = [["" if np.isnan(x) else f"{x:.9g}" for x in column.values] for column in table.values()]
    rows = [",".join(cells) for cells in zip(*columns, strict=True)]
    write_file(path, "\n".join([",".join(table), *rows]) + "\n")
