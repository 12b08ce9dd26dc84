"""Signatures of effects at payloads, links, the base and points: who moves the tip where, and when.

The paper's arm, q from the vertical: tangential is (cos q, 0, -sin q), radial (sin q, 0, cos q), the
payload's weight puts m g L sin q on the hinge. Closed forms are those of small deflections without axial
load: horizontally they hold within 0.5 % (`FLAT`); leaning, the weight along the arm softens it by up to
1.3 % (its f1 by 0.65 %), which counts twice in what an effect changes, and more on a sprung hub (`LEANING`).
"""

import numpy as np
import pytest
from arms import (
    EI,
    LENGTH,
    PAYLOAD,
    RHO_A,
    G,
    arm,
    drive,
    fixed,
    hinge,
    paper_arm,
    point,
    rigid,
    smooth_step,
)

from flexarm import modes, simulate, static
from flexarm.arm import Measurement
from flexarm.effects import (
    BaseCompliance,
    BaseTilt,
    ExternalVibration,
    JointCompliance,
    LinkBow,
    LinkDamping,
    LinkLength,
    LinkMass,
    LinkStiffness,
    PayloadInertia,
    PayloadMass,
    PayloadOffset,
    ReflectorOffset,
)
from flexarm.measurement.deformation import deflection, strain
from flexarm.measurement.sampling import CannotMeasure

ANGLES = np.array([-1.2, -0.6, -0.2, 0.3, 0.8, 1.2])
FLAT, LEANING = 5e-3, 0.05
HORIZONTAL = np.pi / 2
WEIGHTLESS = {"gravity": (0.0, 0.0, 0.0)}


def moved(arm, q, base=None):
    """Tip of an arm from that of another (default: the plain arm), tangential and radial [m]."""
    base = paper_arm() if base is None else base
    gap = static(arm, {"hinge": q}).position[0] - static(base, {"hinge": q}).position[0]
    return gap @ np.array([[np.cos(q), np.sin(q)], [0, 0], [-np.sin(q), np.cos(q)]])


def all_moved(effect, base=None):
    base = paper_arm() if base is None else base
    return np.array([moved(base.with_effect(effect), q, base) for q in ANGLES])


def check_tangential(effect, expected, base=None):
    """What an effect moves tangentially is `expected(q)`, and hardly anything radially."""
    base = paper_arm() if base is None else base
    found = all_moved(effect, base)
    assert found[:, 0] == pytest.approx(expected(ANGLES), rel=LEANING)
    assert np.abs(found[:, 1]).max() < 0.05 * np.abs(found[:, 0]).max()
    if abs(expected(HORIZONTAL)) > 1e-9:
        flat = moved(base.with_effect(effect), HORIZONTAL, base)[0]
        assert flat == pytest.approx(expected(HORIZONTAL), rel=FLAT)


# ----------------------------------------------------------------------- payload


def test_a_heavier_payload_bends_the_arm_further():
    """Tangentially, by m g sin q L^3/(3 EI) of what it is heavier."""
    extra = 0.03 * PAYLOAD
    check_tangential(
        PayloadMass(at="load", mass=PAYLOAD + extra),
        lambda q: extra * G * np.sin(q) * LENGTH**3 / (3 * EI),
    )


def test_payload_mass_and_compliances_coincide_for_one_payload():
    """All go with sin q in a quasi-static run of one payload: collinear within the tracker's 5e-5 m.

    The sag of the hub, of the link and of a heavier payload are m g L sin q times a number; what differs is
    of second order in the sag (0.034 m on 3 m).
    """
    patterns = [
        all_moved(effect)[:, 0]
        for effect in (
            PayloadMass(at="load", mass=1.1 * PAYLOAD),
            JointCompliance(at="hinge", stiffness=1e6),
            LinkStiffness(at="rod", scale=0.9),
            BaseCompliance(at="base", stiffness=1e6),
        )
    ]
    for one in patterns:
        for other in patterns:
            scale = one @ other / (other @ other)
            assert np.abs(one - scale * other).max() < 5e-5


def test_another_payload_tells_mass_from_stiffness():
    """What a soft link does scales with the weight, 5 kg or 14.1; 1 kg too much in the model does not."""
    own = RHO_A * LENGTH * 3 / 8  # the rod's weight bends it as 3/8 of it at the tip would
    arms = {mass: paper_arm(payload=mass) for mass in (5.0, PAYLOAD)}

    def ratio(effect):
        light, heavy = (
            moved(arm.with_effect(effect(mass)), HORIZONTAL, arm)[0] for mass, arm in arms.items()
        )
        return light / heavy

    soft = ratio(lambda mass: LinkStiffness(at="rod", scale=0.9))
    assert soft == pytest.approx((5.0 + own) / (PAYLOAD + own), rel=FLAT)
    assert ratio(lambda mass: PayloadMass(at="load", mass=mass + 1.0)) == pytest.approx(1.0, rel=FLAT)


def test_a_payload_offset_turns_the_hub_by_its_moment():
    """On a sprung hub by m g x cos q/k, where no compliance has a part; the link bends by M L^2/(2 EI)."""
    k, x = 1e5, 0.04
    check_tangential(
        PayloadOffset(at="load", offset=(x, 0, 0)),
        lambda q: PAYLOAD * G * x * np.cos(q) * (LENGTH / k + LENGTH**2 / (2 * EI)),
        paper_arm(spring=k),
    )


def test_a_payload_offset_outwards_is_a_longer_lever():
    """Offset z along the link: the tip moment m g z sin q, so M L (1/k + L/(2 EI)) with sin q."""
    k, z = 1e5, 0.05
    check_tangential(
        PayloadOffset(at="load", offset=(0, 0, z)),
        lambda q: PAYLOAD * G * z * np.sin(q) * (LENGTH / k + LENGTH**2 / (2 * EI)),
        paper_arm(spring=k),
    )


def test_a_payload_offset_turns_with_the_link():
    """The centre of mass of a rigid arm's payload is R (p + offset): the moment on the hinge tells."""
    stiff = (
        paper_arm(1)
        .with_effect(LinkStiffness(at="rod", scale=1e6))
        .with_effect(PayloadOffset(at="load", offset=(0.1, 0.0, -0.2)))
    )
    for q in ANGLES:
        x = (LENGTH - 0.2) * np.sin(q) + 0.1 * np.cos(q)
        expected = -G * (PAYLOAD * x + RHO_A * LENGTH**2 / 2 * np.sin(q))
        assert static(stiff, {"hinge": q}).joint_torque[0] == pytest.approx(expected, rel=5e-6)


def test_payload_inertia_lowers_the_first_frequency_by_rayleighs_quotient():
    """w^2/w0^2 = 1/(1 + J alpha^2/m*): shape 3 (x/L)^2/2 - (x/L)^3/2 of a tip load, alpha = 3/(2 L).

    m* = M + 33/140 rho A L. The rod's own inertia bends the mode a little more than a tip load does: 4 % of
    what J changes.
    """
    inertia = 0.5
    base = paper_arm(8)
    f0 = modes(base, count=1, gravity=False).frequency_hz[0]
    f1 = modes(base.with_effect(PayloadInertia(at="load", inertia=inertia)), count=1, gravity=False)
    modal_mass = PAYLOAD + 33 / 140 * RHO_A * LENGTH
    expected = inertia * (1.5 / LENGTH) ** 2 / modal_mass
    assert (f0 / f1.frequency_hz[0]) ** 2 - 1 == pytest.approx(expected, rel=0.04)


def test_payload_inertia_does_not_move_an_arm_at_rest():
    found = all_moved(PayloadInertia(at="load", inertia=(0.4, 0.5, 0.3)))
    assert np.abs(found).max() < 1e-12


# -------------------------------------------------------------------------- link


def test_link_stiffness_divides_the_sag():
    """Of tip load and own weight: (m g L^3/3 + rho A g L^4/8) sin q/EI (1/scale - 1)."""
    sag = (PAYLOAD * G * LENGTH**3 / 3 + RHO_A * G * LENGTH**4 / 8) / EI
    check_tangential(LinkStiffness(at="rod", scale=0.95), lambda q: sag * np.sin(q) * (1 / 0.95 - 1))


def test_link_stiffness_scales_both_planes_and_not_the_twist():
    """First bending frequencies go with sqrt(scale) in both planes; the mode of torsion stays.

    Torsion of rod and payload inertia J about the rod's axis: w = sqrt(G J_t/(L J)) for a heavy payload.
    """
    base = paper_arm(4).with_effect(PayloadInertia(at="load", inertia=30.0))
    soft = base.with_effect(LinkStiffness(at="rod", scale=0.5))
    f, g = (modes(arm, count=5, gravity=False) for arm in (base, soft))

    def of(found, axis):
        """Frequencies whose tip turns most about one of the base's axes."""
        turns = np.abs(found.shape[:, 0, 3:]).argmax(axis=1)
        return found.frequency_hz[turns == axis]

    for bending in (0, 1):
        assert of(g, bending)[0] / of(f, bending)[0] == pytest.approx(np.sqrt(0.5), rel=1e-6)
    assert of(g, 2)[0] == pytest.approx(of(f, 2)[0], rel=1e-9)


def test_link_mass_adds_weight_and_inertia():
    """Sag of the own weight rho A g L^4/(8 EI) sin q (scale - 1), and M + 33/140 rho A L in the frequency."""
    scale = 1.2
    sag = RHO_A * G * LENGTH**4 / (8 * EI)
    check_tangential(LinkMass(at="rod", scale=scale), lambda q: (scale - 1) * sag * np.sin(q))
    f = [
        modes(arm, count=1, gravity=False).frequency_hz[0]
        for arm in (paper_arm(), paper_arm().with_effect(LinkMass(at="rod", scale=scale)))
    ]
    own = 33 / 140 * RHO_A * LENGTH
    assert (f[0] / f[1]) ** 2 == pytest.approx((PAYLOAD + scale * own) / (PAYLOAD + own), rel=1e-3)


def test_a_longer_link_shows_radially():
    """The tip moves outwards by the error; tangentially only by the sag's 3 error/L of 0.034 m."""
    error = 2e-3
    found = all_moved(LinkLength(at="rod", error=error))
    sag = PAYLOAD * G * LENGTH**3 / (3 * EI)
    assert found[:, 1] == pytest.approx(np.full(len(ANGLES), error), abs=2e-6)
    assert np.abs(found[:, 0]).max() < 5 * error / LENGTH * sag
    assert np.abs(found[:, 0]).min() > 0


def test_a_longer_link_counts_as_displacement_from_the_nominal_arm():
    longer = paper_arm().replace(**WEIGHTLESS).with_effect(LinkLength(at="rod", error=2e-3))
    found = static(longer, {"hinge": 0.5}).displacement[0]
    assert found == pytest.approx(2e-3 * np.array([np.sin(0.5), 0, np.cos(0.5)]), abs=1e-12)


def test_link_damping_is_the_decrement_of_the_clamped_link():
    """A first mode released from its static shape loses exp(-2 pi zeta) a period.

    Without payload and gravity, the mode of which the ratio speaks; higher modes of the start shape, and the
    phase at which maxima are taken, leave 3 % of the decrement at a step of 1/400 of a period.
    """
    zeta = 0.02
    alone = paper_arm(4, payload=0.0).replace(**WEIGHTLESS)
    damped = alone.with_effect(LinkDamping(at="rod", damping_ratio=zeta))
    assert modes(damped, count=1).damping_ratio[0] == pytest.approx(zeta, rel=1e-6)
    period = 1 / modes(alone, count=1).frequency_hz[0]
    kick = drive({"hinge": lambda t: 0.01 * smooth_step(t / (2 * period))}, end=12 * period)
    run = simulate(damped, kick, step=period / 400, alpha=0.0)
    swing = run.position[:, 0, 0] - LENGTH * np.sin(0.01)
    swing = swing[run.time > 3 * period]
    tops = swing[1:-1][(swing[1:-1] > swing[:-2]) & (swing[1:-1] > swing[2:])]
    decrement = np.log(tops[0] / tops[4]) / 4
    assert decrement == pytest.approx(2 * np.pi * zeta, rel=0.03)


def test_a_bow_turns_with_the_link():
    """Weightless, the tip stands at R(q) (end + tip_offset), but for 2 u^2/(3 L) that an arc is drawn in."""
    u = np.array([0.006, 0.004, 0.0])
    arm = paper_arm(4).replace(**WEIGHTLESS).with_effect(LinkBow(at="rod", tip_offset=tuple(u)))
    drawn_in = 2 * (u @ u) / (3 * LENGTH)
    for q in (0.0, 0.7, -1.1):
        R = np.array([[np.cos(q), 0, np.sin(q)], [0, 1, 0], [-np.sin(q), 0, np.cos(q)]])
        found = R.T @ static(arm, {"hinge": q}).displacement[0]
        assert found == pytest.approx(u - [0, 0, drawn_in], abs=2e-8)  # u (2 u/L)^2/12 of third order


def test_a_bow_is_an_arc():
    """w(x) = u (x/L)^2 at every point of the link, whatever its elements."""
    arm = paper_arm(3).replace(**WEIGHTLESS)
    places = [
        {"name": f"p{i}", "link": "rod", "position": [0, 0, x]} for i, x in enumerate((0.4, 1.0, 2.2, 3.0))
    ]
    arm = (
        type(arm)
        .from_dict({**arm.to_dict(), "points": places})
        .with_effect(LinkBow(at="rod", tip_offset=(0.006, 0, 0)))
    )
    found = static(arm).displacement[:, 0]
    assert found == pytest.approx(0.006 * (np.array([0.4, 1.0, 2.2, 3.0]) / LENGTH) ** 2, abs=1e-7)


def test_a_bow_grows_from_the_start_of_the_run():
    """tip_offset (1 - exp(-t/tau)) after the start, which need not be t = 0; an arm held still.

    A constant bow is there at once; a growing one not yet in statics. The start is a step of the tip's speed,
    u/tau, which leaves a ringing of u/(tau w) = 8e-6 m.
    """
    u, tau = 5e-3, 40.0
    base = paper_arm(2).replace(**WEIGHTLESS)
    growing = base.with_effect(LinkBow(at="rod", tip_offset=(u, 0, 0), time_constant=tau))
    assert static(growing).displacement[0] == pytest.approx([0, 0, 0], abs=1e-12)
    still = drive({"hinge": lambda t: 0.0 * t}, end=60.0, samples=11)
    late = type(still).from_samples(np.linspace(100, 160, 11), {"hinge": np.zeros(11)})
    for motion, start in ((still, 0.0), (late, 100.0)):
        run = simulate(growing, motion, step=5e-2)
        expected = u * (1 - np.exp(-(run.time - start) / tau))
        assert np.abs(run.position[:, 0, 0] - expected).max() < 2 * u / (tau * 2 * np.pi * 2.8)


def test_the_growth_of_a_bow_is_work():
    """kinetic + elastic + gravity + damped - work stays; what is left falls with the square of the step."""
    bent = paper_arm(2).with_effect(LinkBow(at="rod", tip_offset=(0.01, 0.004, 0.0), time_constant=0.5))
    bent = bent.with_effect(LinkDamping(at="rod", damping_ratio=0.01))
    motion = drive({"hinge": lambda t: 0.8 + 0.0 * t}, end=1.0, samples=11)
    left = []
    for step in (2e-3, 1e-3):
        run = simulate(bent, motion, step=step, alpha=0.0)
        left.append(np.ptp(run.kinetic + run.elastic + run.gravity + run.damped - run.work))
        assert np.ptp(run.work) > 0.1
    assert left[0] < 1e-4
    assert left[0] / left[1] == pytest.approx(4.0, rel=0.1)


# -------------------------------------------------------------------------- base


def test_base_tilt_turns_the_arm_and_what_gravity_does():
    """About y: the arm stands as at q + angle, from which the base is turned back: constant, gravity apart.

    About x the tip moves along -y by angle z, and sideways sag m g L^3/(3 EI) angle cos q adds to it.
    """
    angle = 2e-3
    about_y = paper_arm().with_effect(BaseTilt(at="base", angle=(0.0, angle)))
    for q in ANGLES:
        tilted = static(about_y, {"hinge": q}).position[0]
        assert tilted == pytest.approx(static(paper_arm(), {"hinge": q + angle}).position[0], abs=1e-9)
        tangential, _ = moved(about_y, q)
        change = (PAYLOAD * LENGTH**3 / 3 + RHO_A * LENGTH**4 / 8) * G / EI * np.cos(q)
        assert tangential == pytest.approx(angle * (LENGTH + change), rel=2e-3)
    about_x = paper_arm().with_effect(BaseTilt(at="base", angle=(angle, 0.0)))
    for q in (0.0, 0.8):
        tip = static(about_x, {"hinge": q}).position[0]
        sag = (PAYLOAD * LENGTH**3 / 3 + RHO_A * LENGTH**4 / 8) * G / EI * np.sin(angle)
        assert tip[1] == pytest.approx(-angle * LENGTH * np.cos(q) - sag * np.cos(q), rel=0.02)


def test_base_compliance_is_a_joint_compliance_for_the_tip_of_one_joint_but_the_hub_moves():
    """Hinge at the base's origin: the same rotation by the same moment. A point beside the hinge shows it.

    Statics of the two are the same equation; the base's angle is M/k with M = g sin q (m L + rho A L^2/2),
    within 2 % for the sag of the arm, whose lever is shorter.
    """
    k = 2e5
    hub = {"name": "hub", "link": "rod", "position": [0.2, 0, 0]}
    plain = type(paper_arm()).from_dict(
        {**paper_arm().to_dict(), "points": [*paper_arm().to_dict()["points"], hub]}
    )
    raised = plain.to_dict()
    raised["joints"][0]["origin"] = {"xyz": [0, 0, 0.5]}
    for q in ANGLES:
        soft = static(plain.with_effect(JointCompliance(at="hinge", stiffness=k)), {"hinge": q})
        base = static(plain.with_effect(BaseCompliance(at="base", stiffness=k)), {"hinge": q})
        assert base.position == pytest.approx(soft.position, abs=1e-9)
        assert soft.link_angle[0] - q > 1e-4 or q < 0
        assert base.link_angle[0] == pytest.approx(q, abs=1e-12)  # what an encoder at the output sees
    column = type(plain).from_dict(raised)
    q = 1.2
    soft = static(column.with_effect(JointCompliance(at="hinge", stiffness=k)), {"hinge": q})
    base = static(column.with_effect(BaseCompliance(at="base", stiffness=k)), {"hinge": q})
    psi = G * np.sin(q) * (PAYLOAD * LENGTH + RHO_A * LENGTH**2 / 2) / k
    assert base.displacement[1, 0] - soft.displacement[1, 0] == pytest.approx(psi * 0.5, rel=0.03)


def test_the_base_turns_about_the_first_axis_that_turns_whatever_stands_before_it():
    """psi = n (r x F)/k moves the tip by psi n x r; n is y of a hinge behind a slide and a turned mount.

    The mount's yaw of 0.5 and roll of 0.3 put n at Rz(0.5) Rx(0.3) y. Linear within psi = 1e-5.
    """
    k, r, force = 1e6, np.array([0.3, 0.2, 1.5]), np.array([4.0, -7.0, 2.0])
    model = arm(
        gravity=[0, 0, 0],
        joints=[
            hinge("hinge", "hand", "mount"),
            {"name": "slide", "type": "prismatic", "parent": "base", "child": "car", "axis": [1, 0, 0]},
            fixed("weld", "mount", "car", origin={"rpy": [0.3, 0, 0.5]}),
        ],
        links=[rigid("hand", 1.0), rigid("car", 1.0), rigid("mount", 1.0)],
        points=[point("tip", "hand", (0.0, 0.0, 0.0))],
        effects=[{"name": "base_compliance", "at": "base", "stiffness": k}],
    )
    n = np.array([-np.sin(0.5) * np.cos(0.3), np.cos(0.5) * np.cos(0.3), np.sin(0.3)])
    turned = np.array(  # Rz(0.5) Rx(0.3): r seen from the hand
        [
            [np.cos(0.5), -np.sin(0.5) * np.cos(0.3), np.sin(0.5) * np.sin(0.3)],
            [np.sin(0.5), np.cos(0.5) * np.cos(0.3), -np.cos(0.5) * np.sin(0.3)],
            [0, np.sin(0.3), np.cos(0.3)],
        ]
    )
    model = model.replace(points=(model.points[0].replace(position=tuple(turned.T @ r)),))
    psi = n @ np.cross(r, force) / k
    found = static(model, forces={"tip": force}).displacement[0]
    assert found == pytest.approx(psi * np.cross(n, r), abs=10 * psi**2)


def test_the_base_wrench_stays_what_the_arm_puts_on_the_base():
    """Weight, and its moment about the origin at the deformed centre; not more with a base that turns."""
    k = 2e5
    for effect in (BaseCompliance(at="base", stiffness=k), JointCompliance(at="hinge", stiffness=k)):
        found = static(paper_arm().with_effect(effect), {"hinge": 1.0}).base_wrench
        reference = static(paper_arm(spring=k), {"hinge": 1.0}).base_wrench
        assert found == pytest.approx(reference, abs=1e-6)


def test_a_compliant_base_adds_no_columns():
    """Joints, links and energies of a run are the arm's own."""
    soft = paper_arm(2).with_effect(BaseCompliance(at="base", stiffness=2e5, damping=200.0))
    run = simulate(soft, drive({"hinge": lambda t: 0.3 * smooth_step(t)}, end=1.0), forces=True)
    assert run.joint_angle.shape == run.drive_angle.shape == run.motor_torque.shape == (len(run.time), 1)
    assert run.section_forces.shape == (len(run.time), 1, 2, 6)
    balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.ptp(balance) < 2e-3 * np.ptp(run.work)


@pytest.mark.parametrize("frequency", [3.0, 9.0])
def test_a_shaken_base_answers_as_a_rigid_arm_on_a_spring(frequency):
    """Amplitude A/|k - J w^2 + i c w| after the start has died away, at the frequency of the moment.

    J = m L^2 + rho A L^3/3 of an arm a million times as stiff as the paper's, upright and weightless, so its
    resonance sqrt(k/J)/(2 pi) lies at 4.3 Hz between the two. Phase against the moment by the same formula.
    """
    k, c, A = 1e5, 1500.0, 20.0
    arm = (
        paper_arm(1)
        .replace(**WEIGHTLESS)
        .with_effect(LinkStiffness(at="rod", scale=1e6))
        .with_effect(BaseCompliance(at="base", stiffness=k, damping=c))
        .with_effect(ExternalVibration(at="base", amplitude=A, frequency=frequency, phase=0.4))
    )
    run = simulate(arm, drive({"hinge": lambda t: 0.0 * t}, end=4.0, samples=11), step=5e-4)
    w = 2 * np.pi * frequency
    inertia = PAYLOAD * LENGTH**2 + RHO_A * LENGTH**3 / 3
    answer = A * np.exp(0.4j) / (k - inertia * w**2 + 1j * c * w)
    steady = run.time > 2.0
    t, x = run.time[steady], run.position[steady, 0, 0] / LENGTH
    sine, cosine = np.linalg.lstsq(np.column_stack([np.sin(w * t), np.cos(w * t)]), x, rcond=None)[0]
    assert sine + 1j * cosine == pytest.approx(answer, rel=5e-3)
    assert np.abs(x - sine * np.sin(w * t) - cosine * np.cos(w * t)).max() < 0.02 * abs(answer)


def test_a_vibration_is_no_part_of_the_equilibrium_from_which_a_run_starts():
    soft = paper_arm(2).with_effect(BaseCompliance(at="base", stiffness=1e5, damping=100.0))
    shaken = soft.with_effect(ExternalVibration(at="base", amplitude=50.0, frequency=5.0, phase=np.pi / 2))
    motion = drive({"hinge": lambda t: 0.5 + 0.0 * t}, end=0.2, samples=11)
    assert np.array_equal(static(shaken).position, static(soft).position)
    runs = [simulate(arm, motion) for arm in (soft, shaken)]
    assert np.array_equal(runs[0].position[0], runs[1].position[0])
    assert np.abs(runs[0].position[-1] - runs[1].position[-1]).max() > 1e-5


# ------------------------------------------------------------------------- points


def test_a_reflector_offset_turns_with_the_link_and_bends_nothing():
    """The tip moves by R(q + slope) offset, slope m g L^2 sin q/(2 EI) < 0.02: tangential x, radial z."""
    offset = (1.5e-3, 0.5e-3, -1e-3)
    shifted = paper_arm().with_effect(ReflectorOffset(at="tip", offset=offset))
    for q in ANGLES:
        assert moved(shifted, q) == pytest.approx([offset[0], offset[2]], abs=0.02 * 2e-3)
        side = static(shifted, {"hinge": q}).position[0] - static(paper_arm(), {"hinge": q}).position[0]
        assert side[1] == pytest.approx(offset[1], abs=1e-12)
    assert static(shifted, {"hinge": 1.0}).joint_torque == static(paper_arm(), {"hinge": 1.0}).joint_torque


# ------------------------------------------------------------------------ sensors


def held(arm, q, forces=False):
    """A run of an arm that is held still at q."""
    motion = drive({"hinge": lambda t: q + 0.0 * t}, end=0.02, samples=11)
    return simulate(arm, motion, forces=forces)


def test_a_strain_gauge_sees_the_curvature_of_a_softer_link():
    """z M/(scale EI) with M = m g (L - x) + rho A g (L - x)^2/2 of a horizontal arm; 0.5 % for its sag."""
    scale, x, z = 0.8, 1.0, 0.03
    arm = paper_arm().with_effect(LinkStiffness(at="rod", scale=scale))
    gauge = Measurement(name="gauge", quantity="strain", link="rod", position=x, fibre=(0.0, z))
    found = strain(held(arm, HORIZONTAL, forces=True), gauge, np.array([0.01]))[0, 0]
    moment = PAYLOAD * G * (LENGTH - x) + RHO_A * G * (LENGTH - x) ** 2 / 2
    assert abs(found) == pytest.approx(z * moment / (scale * EI), rel=FLAT)


def test_a_deflection_sensor_on_the_link_does_not_see_where_the_link_stands():
    """Weightless: no length, tilt or reflector makes a deflection, and a bow is one."""
    arm = (
        paper_arm(2)
        .replace(**WEIGHTLESS)
        .with_effect(LinkLength(at="rod", error=3e-3))
        .with_effect(BaseTilt(at="base", angle=(2e-3, -3e-3)))
        .with_effect(ReflectorOffset(at="tip", offset=(1e-3, 0.0, 2e-3)))
    )
    sensor = Measurement(name="sag", quantity="deflection", point="tip", axes=("x", "y", "z"))
    assert deflection(held(arm, 0.7), sensor, np.array([0.01])) == pytest.approx(0.0, abs=1e-10)
    bent = arm.with_effect(LinkBow(at="rod", tip_offset=(4e-3, 0.0, 0.0)))
    found = deflection(held(bent, 0.7), sensor, np.array([0.01]))[0]
    assert found[0] == pytest.approx(4e-3, rel=2e-3)  # the reflector, 2 mm beyond the tip, moves 0.13 % more


def test_a_deflection_has_no_frame_on_a_base_that_turns():
    soft = paper_arm(2).with_effect(BaseCompliance(at="base", stiffness=1e6))
    sensor = Measurement(name="sag", quantity="deflection", point="tip", axes=("x",))
    with pytest.raises(CannotMeasure, match=r"base_compliance.*the base must be rigid"):
        deflection(held(soft, 0.1), sensor, np.array([0.01]))
