"""Claims about records that hold little, or something else than positions: they are located like others."""

import numpy as np
import pytest
from arms import arm, drive, hinge, point, rigid
from planted import Run, run_of, swing

import flexarm
from flexarm.comparison.aligned_record import simulate_record
from flexarm.errors import InvalidParameter
from flexarm.measurement import predict
from flexarm.record import Record, Signal
from flexarm.residual_analysis.localisation import localise
from flexarm.residual_analysis.noise_floor import noise_floor
from flexarm.residual_analysis.unexplained import unexplained_residual


def all_steps(pairs):
    """Every step that looks at a gap, and everything it prints and draws."""
    located = localise(pairs)
    assert str(located)
    assert str(noise_floor(pairs))
    assert str(unexplained_residual(located))
    assert located.plot().axes
    return located


def only(run, name, rows=slice(None), **changes):
    """The run seen by the drives and the first rows of one other signal."""
    kept = [run.record.signals[drive] for drive in run.record.drive]
    signal = run.record.signals[name]
    kept.append(signal.replace(time=signal.time[rows], values=signal.values[rows], **changes))
    return Run(run.simulation, run.record.replace(signals=kept))


@pytest.mark.parametrize("rows", [1, 2, 3, 12])
def test_a_few_samples(rows):
    located = all_steps(only(run_of("one joint"), "tip", slice(rows)).showing({}))
    assert {cell.samples for cell in located.cells if cell.state == "all"} == {rows}


def test_a_gap_of_exactly_nothing():
    located = all_steps(run_of("two joints").showing({}, None))
    assert located.where == ()
    assert not any(cell.exceeds for cell in located.cells)


def test_samples_after_the_end_of_the_run_do_not_count():
    run = run_of("one joint")
    tip = run.record.signals["tip"]
    others = [signal for signal in run.record.signals.values() if signal.name != "tip"]
    late = tip.replace(name="late", time=tip.time + 40.0)
    record = run.record.replace(signals=[*others, tip, late])
    located = all_steps(Run(run.simulation, record).showing({}))
    assert list(located.gaps) == ["hinge torque", "tip"]


def test_one_axis_alone_is_shown_along_the_sensor():
    """x alone spans neither the tangent nor the radius of a swing."""
    run = run_of("one joint")
    tip = run.record.signals["tip"]
    flat = Signal(
        name="flat",
        quantity="position",
        point="tip",
        axes=("x",),
        time=tip.time,
        values=tip.values[:, [0]],
        noise_std=4e-5,
    )
    drives = [run.record.signals[name] for name in run.record.drive]
    pair = Run(run.simulation, run.record.replace(signals=[*drives, flat]))
    gap = {"flat": lambda t: 1e-3 * np.sin(3 * t)}
    located = all_steps(pair.showing(gap))
    assert set(located.gaps["flat"].directions) == {"sensor x"}
    assert located.where[0]["direction"] == "sensor x"


@pytest.mark.parametrize(
    ("quantity", "axes", "channels"),
    [
        ("orientation", (), 4),
        ("acceleration", ("x", "z"), 2),
        ("angular_rate", ("y",), 1),
        ("inclination", ("z",), 1),
    ],
)
def test_other_quantities_of_a_point(quantity, axes, channels):
    run = run_of("one joint")
    simulation = flexarm.simulate(
        run.simulation.arm, drive({"hinge": swing(0.8, 9.0)}, 20.0), step=4e-3, rotations=True
    )
    time = np.arange(0.1, 19.0, 0.05)
    empty = Signal(
        name="body",
        quantity=quantity,
        point="tip",
        axes=axes,
        time=time,
        values=np.tile([[0.0, 0.0, 0.0, 1.0][-channels:]], (len(time), 1)),
        noise_std=1e-3,
    )
    encoder = run.record.signals["hinge encoder"]
    body = empty.replace(values=predict(simulation, empty))
    located = all_steps(
        Run(simulation, Record(signals=[encoder, body], drive=("hinge encoder",))).showing({})
    )
    assert located.rotations is None
    assert not any(cell.exceeds for cell in located.cells if cell.state == "all")


def test_a_joint_that_slides_shifts_in_metres():
    model = arm(
        name="slide",
        gravity=[0, 0, -9.81],
        joints=[
            hinge("turn", "a"),
            {"name": "slide", "type": "prismatic", "parent": "a", "child": "b", "axis": [0, 0, 1]},
        ],
        links=[rigid("a", 3.0, (0, 0, 0.5), (0.1, 0.1, 0.1)), rigid("b", 2.0, (0, 0, 1.0), (0.1, 0.1, 0.1))],
        points=[point("tip", "b", [0, 0, 1.2])],
    )
    moves = {"turn": swing(0.4, 9.0), "slide": swing(0.2, 7.0)}
    simulation = flexarm.simulate(model, drive(moves, 20.0), step=4e-3)
    fast, seen = np.arange(0, 20, 0.02), np.arange(0.1, 19.5, 0.1)
    signals = [
        Signal(
            name=name,
            quantity="joint_angle",
            joint=name,
            side="motor",
            time=fast,
            values=move(fast),
            noise_std=0.0,
            unit="m" if name == "slide" else "rad",
        )
        for name, move in moves.items()
    ]
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        time=seen,
        values=np.zeros((len(seen), 2)),
        noise_std=4e-5,
    )
    tip = tip.replace(values=predict(simulation, tip))
    run = Run(simulation, Record(signals=[*signals, tip], drive=("turn", "slide")))

    def along(t):
        q = run.state("drive_angle", t)
        return (
            1e-3
            * np.sign(run.state("joint_torque", t, 1) - 18.0)[:, None]
            * np.stack([np.sin(q), np.cos(q)], axis=1)
        )

    located = all_steps(run.showing({"tip": along}))
    first = located.rotations.joints[0]
    assert (first.joint, first.unit) == ("slide", "m")
    assert first.share > 0.9
    assert first.rms == pytest.approx(1e-3, rel=0.1)
    assert {state.joint: state.units["torque"] for state in located.gaps["tip"].states} == {
        "turn": "N m",
        "slide": "N",
    }


def test_an_arm_that_stands_still_has_a_gap_without_states():
    run = run_of("one joint")
    time = np.arange(0.0, 10.0, 0.02)
    encoder = run.record.signals["hinge encoder"].replace(time=time, values=np.full(len(time), 0.3))
    tip = run.record.signals["tip"]
    tip = tip.replace(time=tip.time[:80], values=np.zeros((80, 2)))
    simulation = flexarm.simulate(
        run.simulation.arm, Record(signals=[encoder], drive=("hinge encoder",)), step=4e-3
    )
    tip = tip.replace(values=predict(simulation, tip))
    still = Run(simulation, Record(signals=[encoder, tip], drive=("hinge encoder",)))
    located = all_steps(still.showing({"tip": lambda t: 1e-3 * np.ones((len(t), 2))}))
    assert located.dependence["tip"].best == "a constant"
    assert located.where[0]["when"] == "throughout, constant"


def test_motions_and_poses_are_not_looked_at_together():
    run = run_of("one joint")
    poses = np.array(["a", "b"])
    signals = [
        Signal(
            name="hinge", quantity="joint_angle", joint="hinge", side="motor", pose=poses, values=[0.1, 0.2]
        ),
        Signal(
            name="tip", quantity="position", point="tip", pose=poses, values=np.ones((2, 3)), noise_std=1e-4
        ),
    ]
    static = simulate_record(
        run.simulation.arm, Record(signals=signals, drive=("hinge",), kind="static"), align=False
    )
    assert localise(static).gaps["tip"].time.tolist() == [0.0, 1.0]
    with pytest.raises(InvalidParameter, match=r"'b' holds poses.*'a' holds a motion"):
        localise({"a": run.showing({}), "b": static})
