"""A run of an arm along its drives, from equilibrium at rest."""

from __future__ import annotations

from collections.abc import Iterable

from flexarm import _core
from flexarm.arguments import DRIVE, FLAG, takes
from flexarm.arm import Arm
from flexarm.arm.parameter import parameters
from flexarm.drive import Drive
from flexarm.drive.lag import as_followed
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.sensitivity import Redrive
from flexarm.simulation.prepared import coordinates, motions, prepared_along
from flexarm.simulation.progress import Progress, reported
from flexarm.simulation.simulation import Simulation
from flexarm.simulation.solve import differentiated, solved


@takes(drive=DRIVE, forces=FLAG, rotations=FLAG)
def simulate(
    arm: Arm,
    drive: Drive | Record,
    *,
    step: float = 2e-3,
    alpha: float = -0.05,
    end: float | None = None,
    forces: bool = False,
    rotations: bool = False,
    energies: bool = False,
    consistent_forces: bool = True,
    sensitivities: Iterable[str] = (),
    dimension: str = "auto",
    progress: Progress = None,
) -> Simulation:
    """Simulate a run along the drives from equilibrium, at rest or passed in motion (`Drive.rates`).

    Parameters
    ----------
    arm : Arm
        The model, with its effects.
    drive : Drive or Record
        What moves the joints. A record's drive signals are smoothed by their noise, its payloads carried.
    step : float
        Time step [s], at least 1e-9.
    alpha : float
        Of the HHT method, -1/3 to 0; 0 damps nothing, negative values damp high frequencies.
    end : float, optional
        End of the run [s]; default: of the drive.
    forces, rotations : bool
        Record section forces and base reaction; orientations and angular rates of the points.
    energies : bool
        Record energies in the same run; otherwise a second run computes them when they are first asked for.
        Runs under a controller always record them.
    consistent_forces : bool
        False leaves torques and forces as the time stepping has them: off by a few per cent for some steps
        after a jump of a drive's acceleration or jerk. Motions are the same, and a run takes 13 to 31 %
        less CPU, one with derivatives up to 45 %. Runs under a controller always have consistent forces.
    sensitivities : iterable of str
        Keys of parameters, such as "links.rod.material.youngs_modulus" or
        "effects.backlash.hinge.gap": what the arrays are differentiated by in the same run. The result is the
        derivative of the computed motion, not a difference of runs. Under a controller it holds what the loop
        makes of the parameter, see `flexarm.control.simulate_closed_loop`.
    dimension : {"auto", "plane", "space"}
        An arm that moves in a plane is computed with three coordinates a node, several times faster and with
        the same result. "space" always takes six, as do controllers; "plane" is an error
        that tells what leaves it where there is none.
    progress : bool or callable, optional
        True shows a bar on standard error; a callable gets the share done and may return False to stop.

    Raises
    ------
    InvalidParameter
        If the drive does not fit the arm, step or alpha is out of range, or there is no derivative by a
        parameter.
    NotConverged
        With time, iteration and residual.
    KeyboardInterrupt
        On Ctrl-C, within a tenth of a second.

    Examples
    --------
    >>> drive = flexarm.Drive.from_samples([0, 1, 2, 3], {"hinge": [0, 0.2, 0.4, 0.4]})  # doctest: +SKIP
    >>> run = flexarm.simulate(arm, drive)  # doctest: +SKIP
    """
    run = prepared_along(arm, drive, step, alpha, end, forces, rotations)
    record, places = None, set()
    if isinstance(drive, Record):
        record = drive
        places = {*record.drive, *(record.signals[name].clock for name in record.drive)}
    told = run.told

    def redriven(other: Arm) -> list[_core.PiecewisePolynomial]:
        drive = told if record is None else Drive.from_record(record, other)
        return motions(other, as_followed(drive, other), run.last)

    redrive = Redrive(places, redriven, told.joints)
    wanted = parameters(run.arm, sensitivities)
    run.options.record_energies = energies
    run.options.consistent_forces = consistent_forces
    run.options.dimension = coordinates(dimension)
    if any(joint.side == "command" for joint in run.drive.joints.values()):
        if run.drive.rates is not None:
            raise InvalidParameter("a run under a controller begins at rest", where="drive.rates")
        from flexarm.control import simulate_closed_loop

        return simulate_closed_loop(
            arm,
            drive,
            step=step,
            alpha=alpha,
            end=end,
            forces=forces,
            rotations=rotations,
            sensitivities=[parameter.key for parameter in wanted],
            progress=progress,
        )
    with reported(progress, run.arm.name) as report:
        return differentiated(run, wanted, redrive, report) if wanted else solved(run, report)
