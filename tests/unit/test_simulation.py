"""Claims about a run as an object: its arrays, files, plots, progress and how it stops."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from arms import arm, beam, crane, drive, general, hinge, paper_arm, smooth_step

import flexarm
from flexarm import InvalidFile, InvalidParameter, Simulation
from flexarm.arm.sensor import Sensor
from flexarm.measurement.predict import read


@pytest.fixture(scope="module")
def run() -> Simulation:
    """A short swing with everything recorded."""
    motion = drive({"hinge": lambda t: 0.4 * smooth_step(t)}, 1.2, 601)
    return flexarm.simulate(paper_arm(2, 1e5), motion, step=0.01, forces=True, rotations=True)


def test_shapes_and_names(run):
    n = 121
    assert (run.points, run.joints) == (("tip",), ("hinge",))
    shapes = {name: getattr(run, name).shape for name in ("time", "position", "orientation", "angular_rate")}
    assert shapes == {
        "time": (n,),
        "position": (n, 1, 3),
        "orientation": (n, 1, 4),
        "angular_rate": (n, 1, 3),
    }
    assert run.joint_torque.shape == (n, 1)
    assert run.section_forces.shape == (n, 1, 2, 6)
    assert run.base_wrench.shape == (n, 6)
    assert run.kinetic.shape == run.work.shape == (n,)


def test_arrays_are_read_only(run):
    for array in (run.time, run.position, run.joint_angle, run.work, run.orientation, run.base_wrench):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_arrays_outlive_their_run(run):
    """They stay where the core wrote them, and no later run may write there."""
    motion = drive({"hinge": lambda t: 0.4 * smooth_step(t)}, 1.2, 601)
    alone = flexarm.simulate(run.arm, motion, step=0.01).position
    for _ in range(3):
        flexarm.simulate(run.arm, motion, step=0.01)
    assert np.array_equal(alone, run.position)


def test_what_was_not_asked_for_is_none():
    plain = flexarm.simulate(paper_arm(1), drive({"hinge": lambda t: 0 * t}, 0.05, 11), step=0.01)
    assert plain.orientation is plain.section_forces is plain.base_wrench is plain.acceleration is None


def test_starts_in_equilibrium(run):
    """First row: static equilibrium under the first drive value, at rest, nothing worked yet."""
    rest = flexarm.static(run.arm)
    assert run.position[0] == pytest.approx(rest.position, abs=1e-12)
    assert run.joint_torque[0] == pytest.approx(rest.joint_torque, abs=1e-9)
    assert run.section_forces[0] == pytest.approx(rest.section_forces, abs=1e-7)
    assert run.base_wrench[0] == pytest.approx(rest.base_wrench, abs=1e-9)
    assert np.abs(run.velocity[0]).max() == run.work[0] == run.damped[0] == 0


def test_stays_where_nothing_moves():
    """Held drives keep a loaded arm in its equilibrium."""
    still = flexarm.simulate(paper_arm(2, 1e5), drive({"hinge": lambda t: 1.0 + 0 * t}, 1.0, 11), step=0.01)
    assert still.position == pytest.approx(np.broadcast_to(still.position[0], still.position.shape), abs=1e-9)


def test_undriven_joints_stand_where_the_drive_says():
    """`rest` places joints that nothing drives; the others start at 0."""
    two = arm(
        joints=[hinge("first", "one"), hinge("second", "two", "one", at="end")],
        links=[beam(name, [0, 0, 1], general(1e-3, 1e-7), elements=1) for name in ("one", "two")],
    )
    motion = flexarm.Drive.from_samples([0, 0.1], {"first": [0.2, 0.2]})
    placed = flexarm.Drive(motion.joints, {"second": -0.7}, 0.0, 0.1)
    assert flexarm.simulate(two, placed, step=0.01).joint_angle[-1] == pytest.approx([0.2, -0.7], abs=1e-9)
    assert flexarm.simulate(two, motion, step=0.01).joint_angle[-1] == pytest.approx([0.2, 0.0], abs=1e-9)


def test_at_interpolates_between_steps(run):
    """On the steps the stored places; between them Hermite's cubic, whose error is h^4 x''''/384."""
    assert run.at(run.time[[3, 70]], "tip") == pytest.approx(run.position[[3, 70], 0], abs=1e-12)
    motion = drive({"hinge": lambda t: 0.4 * smooth_step(t)}, 1.2, 601)
    times = run.time[20:100] + 0.005
    fine = flexarm.simulate(
        paper_arm(1, material={"youngs_modulus": 2e17, "poisson_ratio": 0.3, "density": 7850}),
        motion,
        step=0.005,
    )
    coarse = flexarm.simulate(fine.arm, motion, step=0.01)
    assert coarse.at(times, "tip") == pytest.approx(fine.at(times, "tip"), abs=2e-6)


def test_at_names_an_unknown_point(run):
    with pytest.raises(InvalidParameter, match="no point 'elbow'; there are tip"):
        run.at([0.1], "elbow")


def test_after_its_end_a_run_knows_nothing_and_before_its_start_it_rests(run):
    found = run.at([run.time[0] - 1, run.time[-1] + 1e-3], "tip")
    assert np.array_equal(found[0], run.position[0, 0])
    assert np.isnan(found[1]).all()


def test_specific_force_at_rest_is_g_upward(run):
    """As an IMU has it, in the axes of the section: at the start the arm stands upright."""
    assert run.acceleration[0, 0] == pytest.approx([0, 0, 9.81], abs=2e-2)


def test_orientation_and_rate_agree(run):
    """q' = q (0, w)/2: the recorded rates are those of the recorded quaternions, to order h^2."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_quat(run.orientation[:, 0])
    found = (turn[:-2].inv() * turn[2:]).as_rotvec() / 0.02
    assert found[5:] == pytest.approx(
        run.angular_rate[1:-1, 0][5:], abs=0.02 * np.abs(run.angular_rate).max()
    )


def test_save_and_load_round_trip(run, tmp_path):
    run.save(tmp_path / "run.nc")
    again = Simulation.load(tmp_path / "run.nc")
    for name in ("time", "position", "velocity", "joint_torque", "kinetic", "orientation", "base_wrench"):
        assert np.array_equal(getattr(again, name), getattr(run, name)), name
    assert again.arm == run.arm
    assert again.solver == run.solver
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_stored_run_tells_units_and_provenance(run, tmp_path):
    import xarray as xr

    run.save(tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as data:
        units = {
            name: data[name].attrs["units"] for name in ("position", "joint_angle", "joint_torque", "work")
        }
        assert units == {"position": "m", "joint_angle": "rad", "joint_torque": "N m", "work": "J"}
        assert data["position"].dims == ("time", "point", "axis")
        assert data["joint_torque"].dims == ("time", "joint")
        assert {"flexarm_version", "git", "backend", "model", "model_sha256"} <= set(data.attrs)


def test_load_refuses_another_result(run, tmp_path):
    flexarm.modes(run.arm, count=1).save(tmp_path / "modes.nc")
    with pytest.raises(InvalidFile, match="must be 'simulation', got 'modes'"):
        Simulation.load(tmp_path / "modes.nc")
    with pytest.raises(InvalidFile, match=r"absent\.nc"):
        Simulation.load(tmp_path / "absent.nc")


def test_plot_labels_its_axes_with_units(run):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots()
    assert run.plot(ax=axes) is axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "position [m]")
    assert len(axes.lines) == 3
    plt.close(figure)


def test_the_point_that_moves_most_is_drawn(run):
    """It is the tip, wherever the model names it."""
    tip = run.arm.points[0]
    half = tip.replace(name="mid", position=tuple(x / 2 for x in tip.position))
    motion = drive({"hinge": lambda t: 0.4 * smooth_step(t)}, 1.2, 601)
    both = flexarm.simulate(run.arm.replace(points=(tip, half)), motion, step=0.05)
    assert [line.get_label() for line in both.plot().lines] == ["tip x", "tip y", "tip z"]


def test_repr_tells_what_it_is(run):
    assert repr(run) == "<Simulation of 'paper': 0 to 1.2 s, 121 instants, points tip>"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"step": 0.0}, "step must be positive"),
        ({"step": -1e-3}, "step must be positive"),
        ({"alpha": 0.1}, "alpha|α"),
        ({"alpha": -0.5}, "alpha|α"),
        ({"end": -1.0}, "end of a run must lie after its start"),
    ],
)
def test_bad_options_are_named(options, message):
    with pytest.raises(InvalidParameter, match=message):
        flexarm.simulate(paper_arm(1), drive({"hinge": lambda t: t}, 0.1, 11), **options)


LONG = {"hinge": lambda t: 0.3 * np.sin(t) * smooth_step(t)}


def test_progress_is_told_and_rises():
    told = []
    flexarm.simulate(paper_arm(20, 1e5), drive(LONG, 400.0), step=2e-3, progress=told.append)
    assert len(told) >= 3
    assert told == sorted(told)
    assert 0 < told[0] < 1
    assert told[-1] <= 1


def test_a_callback_that_returns_false_stops_the_run():
    """What was reached until then is returned, rows and times alike."""
    run = flexarm.simulate(
        paper_arm(20, 1e5), drive(LONG, 500.0), step=2e-3, progress=lambda done: done < 0.01
    )
    assert 10 < len(run.time) < 125000
    assert len(run.position) == len(run.kinetic) == len(run.joint_torque) == len(run.time)
    assert np.isfinite(run.position).all()


def test_an_error_in_the_callback_comes_through():
    def fail(done):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        flexarm.simulate(paper_arm(20, 1e5), drive(LONG, 500.0), step=2e-3, progress=fail)


SCRIPT = """
import signal, sys, time
import numpy as np
import flexarm

arm = flexarm.Arm.from_toml(sys.argv[1])
t = np.linspace(0, 5000, 2001)
drive = flexarm.Drive.from_samples(t, {"hinge": 0.3 * np.sin(0.1 * t)})
told = []

def progress(done):
    if not told:
        told.append(done)
        print("running", flush=True)

try:
    flexarm.simulate(arm, drive, step=1e-3, progress=progress).save(sys.argv[2])
except KeyboardInterrupt:
    print(time.clock_gettime(time.CLOCK_MONOTONIC), flush=True)
"""


def test_ctrl_c_stops_within_a_tenth_of_a_second_and_leaves_no_file(tmp_path):
    """In a process of its own; 0.1 s of its own doing, and as much again for a busy machine."""
    paper_arm(40, 1e5).to_toml(tmp_path / "arm.toml")
    command = [sys.executable, "-c", SCRIPT, str(tmp_path / "arm.toml"), str(tmp_path / "run.nc")]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=dict(os.environ))
    try:
        assert process.stdout.readline() == "running\n"
        sent = time.clock_gettime(time.CLOCK_MONOTONIC)
        process.send_signal(signal.SIGINT)
        stopped, _ = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == 0
    assert float(stopped) - sent < 0.2
    assert [p.name for p in tmp_path.iterdir()] == ["arm.toml"]


def test_a_motor_driven_by_torque_stands_still_until_the_start():
    """A joint about the vertical has no equilibrium of its own; the motor holds it at rest, then lets go.

    A constant torque T turns the rigid inertia J by T t^2/(2 J); J = 2 kg m2 here.
    """
    arm = flexarm.Arm.from_dict(
        {
            "joints": [
                {"name": "waist", "type": "revolute", "parent": "base", "child": "disk", "axis": [0, 0, 1]}
            ],
            "links": [{"name": "disk", "type": "rigid", "mass": 1.0, "inertia": [1.0, 1.0, 2.0]}],
        }
    )
    torque = flexarm.Drive.from_samples([0.0, 1.0], {"waist": [3.0, 3.0]}, side="torque")
    run = flexarm.simulate(arm, flexarm.Drive(torque.joints, rest={"waist": 0.4}, end=1.0))
    assert run.joint_angle[0, 0] == 0.4
    # HHT starts from zero acceleration: a step late in velocity, of first order in the step of 2 ms.
    assert run.joint_angle[-1, 0] - 0.4 == pytest.approx(0.75, rel=5e-3)


def test_a_drive_that_still_moves_goes_on_through_a_step_that_passes_its_end():
    """A hinge at constant acceleration: a stop within the last step would show in the last torque."""
    model = crane()
    t = np.linspace(0, 1, 101)
    moving = flexarm.Drive.from_samples(t, {"hinge": 0.3 * t**2})
    last = []
    for step in (2e-3, 3e-3):
        run = flexarm.simulate(model, moving, step=step)
        sensor = Sensor(name="torque", quantity="motor_torque", joint="hinge", side="output", rate_hz=100)
        last.append(read(run, sensor, np.array([1.0]))[0, 0])
    assert last[1] == pytest.approx(last[0], rel=5e-3)
