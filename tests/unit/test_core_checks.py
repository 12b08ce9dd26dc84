"""Claims about the private core: what does not fit raises an error of flexarm and reads nothing else."""

import numpy as np
import pytest
import scipy.sparse
from tests.helpers.arms import TUBE, beam, hinge, point

import flexarm
from flexarm import _core
from flexarm.assembly import assemble
from flexarm.errors import InvalidParameter

FAR = [-1, 1, 1000, 2**31 - 1]
"""No numbers of the only joint, point and link there is."""
GRAVITY = np.array([0.0, 0.0, -9.81])


def arm(elements: int = 4) -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 1.0], TUBE) | {"elements": elements}],
            "points": [point("tip", "rod", [0, 0, 1.0])],
        }
    )


class Things:
    """A system, its equilibrium and a state of another system."""

    def __init__(self) -> None:
        kind = _core.DriveKind.motor_angle
        self.system = assemble(arm(), {"hinge": kind})
        self.loads = _core.Loads(gravity=GRAVITY)
        self.rest = _core.static_equilibrium(self.system, [0.1], self.loads)
        self.other = assemble(arm(elements=9), {"hinge": kind})
        self.other_rest = _core.static_equilibrium(self.other, [0.1], self.loads)
        self.options = _core.TransientOptions()
        self.options.end, self.options.step = 0.01, 1e-3
        self.drives = [_core.PiecewisePolynomial.constant(0.1)]


@pytest.fixture(scope="module")
def these() -> Things:
    return Things()


@pytest.mark.parametrize("k", FAR)
def test_an_index_outside_is_refused(these, k):
    system, state = these.system, these.rest.state
    stepping = _core.Stepping(system, 1e-3, -0.05)
    run = _core.SampledRun(system, these.rest, these.drives, these.options)
    derivative = _core.static_derivative(system, these.rest, [])
    for call in (
        lambda: system.point_frame(state, k),
        lambda: system.part_shape(state, k),
        lambda: _core.section_forces(system, state, these.loads, k),
        lambda: _core.joint_torque(system, state, k),
        lambda: _core.Readings(system).joint(state, k),
        lambda: _core.Readings(system).point(state, k),
        lambda: _core.moved(system, state, derivative, k, 1.0),
        lambda: run.point_position(k),
        lambda: run.point_velocity(k),
        lambda: _core.static_equilibrium(
            system, [0.1], _core.Loads(gravity=GRAVITY, points=[_core.PointLoad(point=k)])
        ),
        lambda: stepping.advance(stepping.start(these.rest), np.zeros((1, 3)), [_core.PointLoad(point=k)]),
    ):
        with pytest.raises(InvalidParameter):
            call()


def test_a_state_of_another_system_is_refused(these):
    system, rest, state = these.system, these.other_rest, these.other_rest.state
    derivative = _core.static_derivative(these.other, rest, [])
    same = _core.static_derivative(system, these.rest, [])
    varied = _core.Varied(these.other, these.other, 1.0, -1.0)
    n = 6 * these.system.n_nodes
    for call in (
        lambda: system.point_frame(state, 0),
        lambda: _core.section_forces(system, state, these.loads, 0),
        lambda: _core.joint_torque(system, state, 0),
        lambda: _core.Readings(system).joint(state, 0),
        lambda: _core.Readings(system).point(state, 0),
        lambda: _core.joint_angles(system, state),
        lambda: _core.motor_torques(system, state, True),
        lambda: _core.base_wrench(system, state),
        lambda: _core.modes(system, rest, 2),
        lambda: _core.frequency_derivatives(system, rest, 2, []),
        lambda: _core.static_derivative(system, rest, []),
        lambda: _core.static_derivative(system, these.rest, [varied]),
        lambda: _core.simulate(system, rest, these.drives, these.options),
        lambda: _core.simulate_differentiated(system, rest, these.drives, these.options, [], same),
        lambda: _core.simulate_differentiated(
            system, these.rest, these.drives, these.options, [], derivative
        ),
        lambda: _core.SampledRun(system, rest, these.drives, these.options),
        lambda: _core.DifferentiatedSampledRun(system, rest, these.drives, these.options, [], same),
        lambda: _core.Stepping(system, 1e-3, -0.05).start(rest),
        lambda: _core.snapshots(system, [state], these.loads),
        lambda: _core.displaced(system, state, np.zeros(n), np.zeros(n), np.zeros(n)),
        lambda: _core.displaced(system, these.rest.state, np.zeros(n - 1), np.zeros(n), np.zeros(n)),
        lambda: _core.tangents(system, rest),
        lambda: _core.moved(system, state, same, 0, 1.0),
        lambda: _core.released(system, rest, system),
        lambda: _core.released(system, these.rest, these.other),
        lambda: _core.released_derivative(system, derivative, system),
    ):
        with pytest.raises(InvalidParameter):
            call()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_refused(these, bad):
    system, stepping = these.system, _core.Stepping(these.system, 1e-3, -0.05)
    driven = assemble(arm(), {"hinge": _core.DriveKind.torque})
    let_go = _core.released(system, these.rest, driven)
    begin = stepping.start(these.rest)
    row = np.array([[bad, 0.0, 0.0]])
    push = _core.PointLoad(point=0, force=np.array([0.0, bad, 0.0]))
    cube = scipy.sparse.csc_matrix(np.full((9, 9), bad))
    run = _core.SampledRun(driven, let_go, these.drives, these.options)
    for call in (
        lambda: _core.static_equilibrium(system, [bad], these.loads),
        lambda: _core.static_equilibrium(system, [0.1], _core.Loads(gravity=np.array([0, 0, bad]))),
        lambda: _core.static_equilibrium(system, [0.1], _core.Loads(gravity=GRAVITY, points=[push])),
        lambda: stepping.advance(begin, row),
        lambda: stepping.advance(begin, np.zeros((1, 3)), [push]),
        lambda: run.advance(np.array([bad]), 1),
        lambda: _core.PiecewisePolynomial.constant(bad),
        lambda: _core.cubic_spline(np.array([0.0, 1.0, 2.0]), np.array([0.0, bad, 0.0])),
        lambda: _core.cubic_spline(np.array([0.0, bad]), np.zeros(2)),
        lambda: _core.check_step(bad),
        lambda: _core.reduce_part(scipy.sparse.tril(cube), scipy.sparse.tril(cube), np.zeros((3, 3)), []),
    ):
        with pytest.raises(InvalidParameter):
            call()


def test_a_matrix_that_is_none_is_refused_where_it_enters():
    whole = scipy.sparse.eye(9, format="csc")
    broken = scipy.sparse.eye(9, format="csc")
    broken.indices[3] = 10**6
    for matrix in (np.eye(9), None, broken):
        with pytest.raises(InvalidParameter, match="stiffness matrix: "):
            _core.reduce_part(matrix, whole, np.zeros((3, 3)), [])


@pytest.mark.parametrize("step", [0.0, -1e-3, 1e-10, 1e-76, 5e-324, np.nan, np.inf])
def test_a_step_has_a_floor(step):
    drive = flexarm.Drive.from_samples([0, 1e-3], {"hinge": [0, 0.1]})
    with pytest.raises(InvalidParameter, match="step must be positive, at least 1e-09 s and finite"):
        flexarm.simulate(arm(), drive, step=step)
    with pytest.raises(InvalidParameter, match="step must be positive, at least 1e-09 s and finite"):
        flexarm.Stepper(arm(), {"hinge": "motor"}, step=step)


def test_a_run_at_the_shortest_step_is_finite():
    drive = flexarm.Drive.from_samples([0, 1e-8], {"hinge": [0, 1e-12]})
    run = flexarm.simulate(arm(), drive, step=1e-9)
    assert len(run.time) == 11
    assert np.isfinite(run.position).all()
