"""Claims about drives: splines through samples, held outside, read from CSV."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from arms import arm, hinge, rigid

import flexarm
from flexarm import Drive, InvalidFile, InvalidParameter, JointDrive
from flexarm.drive.doubts import doubts

ARM = arm(
    joints=[
        hinge("hinge", "one"),
        hinge("wrist", "two", "one"),
        {"name": "weld", "type": "fixed", "parent": "two", "child": "three"},
    ],
    links=[rigid("one", 1.0), rigid("two", 1.0), rigid("three", 1.0)],
)
T = np.array([0.0, 0.3, 0.5, 1.1, 1.6, 2.0])


def cubic(t):
    return 0.2 - 0.7 * t + 1.3 * t**2 - 0.4 * t**3


def test_cubic_polynomials_are_reproduced():
    """Not-a-knot: through samples of a cubic the spline is that cubic, ends included."""
    found = Drive.from_samples(T, {"hinge": cubic(T)}).joints["hinge"]
    t = np.linspace(0, 2, 201)
    assert found(t) == pytest.approx(cubic(t), abs=1e-14)


@pytest.mark.parametrize(("n", "f"), [(2, lambda t: 1 - 2 * t), (3, lambda t: 1 - 2 * t + 3 * t**2)])
def test_few_samples_are_joined_by_a_line_or_a_parabola(n, f):
    found = Drive.from_samples(T[:n], {"hinge": f(T[:n])}).joints["hinge"]
    t = np.linspace(0, T[n - 1], 21)
    assert found(t) == pytest.approx(f(t), abs=1e-14)


def test_drive_is_held_before_and_after():
    found = Drive.from_samples(T, {"hinge": cubic(T)}).joints["hinge"]
    assert found([-5.0, 7.0]) == pytest.approx([cubic(0.0), cubic(2.0)], abs=1e-14)
    core = found.polynomial()
    assert list(core(7.0)) == pytest.approx([cubic(2.0), 0, 0], abs=1e-14)
    assert list(core(-5.0)) == pytest.approx([cubic(0.0), 0, 0], abs=1e-14)


def test_runs_share_the_polynomial_of_a_drive_and_processes_make_their_own():
    found = Drive.from_samples(T, {"hinge": cubic(T)}).joints["hinge"]
    assert found.polynomial() is found.polynomial()
    other = pickle.loads(pickle.dumps(found))
    assert list(other.polynomial()(0.8)) == list(found.polynomial()(0.8))
    assert other.side == found.side


def test_the_core_differentiates_the_same_polynomial():
    """Value, rate and acceleration of the cubic inside."""
    core = Drive.from_samples(T, {"hinge": cubic(T)}).joints["hinge"].polynomial()
    for t in (0.1, 0.5, 1.9):
        expected = [cubic(t), -0.7 + 2.6 * t - 1.2 * t**2, 2.6 - 2.4 * t]
        assert list(core(t)) == pytest.approx(expected, abs=1e-12)


def test_drive_spans_its_samples():
    found = Drive.from_samples(T + 3, {"hinge": cubic(T)})
    assert (found.start, found.end) == (3.0, 5.0)


def test_drive_is_frozen():
    found = Drive.from_samples(T, {"hinge": cubic(T)}).joints["hinge"]
    with pytest.raises(ValueError, match="read-only"):
        found.breaks[0] = 1.0


@pytest.mark.parametrize(
    ("time", "values", "message"),
    [
        ([0.0], [1.0], "at least two"),
        ([0.0, 0.0], [1.0, 2.0], "rising"),
        ([0.0, -1.0], [1.0, 2.0], "rising"),
        ([0.0, np.nan], [1.0, 2.0], "finite"),
        ([0.0, 1.0], [1.0, np.inf], "hinge: must be finite, got inf at 1 s"),
        ([0.0, 1.0], [1.0, 2.0, 3.0], "hinge: needs 2 values, one for each time"),
    ],
)
def test_bad_samples_are_named(time, values, message):
    with pytest.raises(InvalidParameter, match=message):
        Drive.from_samples(time, {"hinge": values})


def test_unknown_side_is_named():
    with pytest.raises(InvalidParameter, match="must be one of motor, output, torque"):
        JointDrive(np.array([0.0, 1.0]), np.zeros((4, 1)), "sideways")


def write(tmp_path, text):
    path = tmp_path / "drive.csv"
    path.write_text(text)
    return path


def test_csv_is_the_samples(tmp_path):
    """Comments and order of columns do not matter."""
    rows = "".join(f"{cubic(t):.17g},{t:.17g},{-t:.17g}\n" for t in T)
    found = Drive.from_csv(write(tmp_path, "hinge,time_s,wrist\n# a comment\n" + rows), ARM)
    assert set(found.joints) == {"hinge", "wrist"}
    assert found.joints["hinge"]([0.7]) == pytest.approx([cubic(0.7)], abs=1e-13)
    assert found.joints["wrist"]([0.7]) == pytest.approx([-0.7], abs=1e-13)
    assert found.end == 2.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,hinge\n0,1\n1,2\n", "header: there is no column 'time_s'; there are t, hinge"),
        ("time_s\n0\n1\n", "header: drives no joint; add a column named hinge or wrist"),
        ("time_s,elbow\n0,1\n1,2\n", "column elbow: is no moving joint of the model; there are hinge, wrist"),
        ("time_s,weld\n0,1\n1,2\n", "column weld: is no moving joint"),
        ("time_s,hinge\n0,1\n", "needs at least two rows"),
        ("time_s,hinge\n0,1\n1,\n", "line 3, column hinge: must be a finite number"),
        (
            "time_s,hinge\n0,1\n# pause\n1,2\n1,3\n",
            "line 5, column time_s: times must rise, got 1 s after 1 s",
        ),
        ("time_s,hinge\n0,1\n2,2\n1,3\n", "line 4, column time_s: times must rise, got 1 s after 2 s"),
        ("time_s,hinge\n0,1\n1,two\n", "line 3, column hinge: must be a number, got 'two'"),
        ("time_s,hinge\n0,1\n1\n", "line 3"),
        ("", "line 1: has no header"),
    ],
)
def test_bad_csv_is_named_with_its_place(tmp_path, text, message):
    path = write(tmp_path, text)
    with pytest.raises(InvalidFile) as caught:
        Drive.from_csv(path, ARM)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)


def test_missing_csv_is_named(tmp_path):
    with pytest.raises(InvalidFile, match=r"absent\.csv"):
        Drive.from_csv(tmp_path / "absent.csv", ARM)


def test_drive_of_an_unknown_joint_is_refused():
    with pytest.raises(InvalidParameter, match="'elbow', which is no moving joint; there are hinge, wrist"):
        flexarm.simulate(ARM, Drive.from_samples([0, 1], {"elbow": [0, 1]}))


@pytest.mark.parametrize(
    ("samples", "what"),
    [
        (T[:4], r"hinge: needs 6 values, one for each time, got shape \(4,\)"),
        (np.where(T == 0.5, np.nan, T), "hinge: must be finite, got nan at 0.5 s"),
    ],
)
def test_samples_that_do_not_fit_are_told_with_their_place(samples, what):
    with pytest.raises(InvalidParameter, match=what):
        Drive.from_samples(T, {"hinge": samples})


def test_a_drive_is_shown_by_its_joints_and_its_span():
    found = Drive.from_samples(T, {"hinge": cubic(T), "wrist": 0 * T})
    assert repr(found) == "<Drive of hinge (motor), wrist (motor): 0 to 2 s>"


CASCADE = {
    "type": "cascade",
    "joint": "wrist",
    "position_gain": 5,
    "velocity_gain": 50,
    "sample_time": 0.002,
}


def doubted(side="motor", ratio=1.0, **angles):
    """What is doubted of constant angles of an arm with a belt or a controller."""
    pair = [{"name": "belt", "input": "hinge", "output": "wrist", "ratio": ratio}] if ratio else []
    table = {**ARM.to_dict(), "gears": pair, "controllers": [] if ratio else [CASCADE]}
    values = {name: np.full(T.shape, angle) for name, angle in angles.items()}
    return [str(each) for each in doubts(Drive.from_samples(T, values, side), flexarm.Arm.from_dict(table))]


def test_turns_are_counted_behind_the_gears_that_a_joint_drives():
    """Ten turns are none of an arm's joints, and a motor's shaft makes them for a tenth of one."""
    assert any("10.0 turns" in each for each in doubted(ratio=-1.0, hinge=20 * np.pi))
    assert doubted(ratio=100.0, hinge=20 * np.pi) == []
    assert any("10.0 turns" in each for each in doubted(ratio=100.0, hinge=2000 * np.pi))


def test_a_drive_of_the_motor_says_that_the_controller_does_not_act():
    [said] = doubted(ratio=0, wrist=0.3)
    assert said == (
        "column wrist: moves the motor itself, so its controller does not act; "
        "a record with a joint_command as drive lets it"
    )
    assert doubted("command", ratio=0, wrist=0.3) == doubted(ratio=0, hinge=0.3) == []


def test_a_drive_is_drawn_with_its_unit():
    axes = Drive.from_samples(T, {"hinge": cubic(T)}).plot()
    assert axes.get_xlabel() == "time [s]"
    assert axes.get_ylabel() == "angle [rad, m if prismatic]"
    time, values = axes.lines[0].get_data()
    assert values == pytest.approx(cubic(np.asarray(time)), abs=1e-12)
    pulled = Drive.from_samples(T, {"hinge": cubic(T)}, side="torque").plot()
    assert pulled.get_ylabel() == "torque [N m, N if prismatic]"


@pytest.mark.parametrize(("highest", "said"), [(0.7, []), (0.9, ["column piston"])])
def test_a_cylinder_that_is_driven_beyond_its_stroke_is_doubted(highest, said):
    """The telescopic crane of the examples has a stroke of 0.8 m."""
    arm = flexarm.Arm.from_toml(Path(__file__).parents[2] / "examples" / "telescopic_crane.toml")
    samples = {"piston": np.linspace(0.3, highest, 5)}
    drive = Drive.from_samples(np.linspace(0.0, 4.0, 5), samples)
    found = [problem for problem in doubts(drive, arm) if "travels from 0 to 0.8 m" in problem.what]
    assert [problem.where for problem in found] == said
