"""Many runs at once give what each gives alone, but for rounding."""

import pytest
from tests.helpers.arms import TUBE, beam, hinge, point

import flexarm


def arm_with(mass: float) -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 1.0], TUBE)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 1.0], "mass": mass}],
            "points": [point("tip", "rod", [0, 0, 1.0])],
        }
    )


DRIVE = flexarm.Drive.from_samples([0.0, 0.1, 0.2, 0.3], {"hinge": [0.0, 0.1, 0.2, 0.2]})
MASSES = [1.0, 2.0, 4.0, 8.0]


def test_runs_side_by_side_are_the_runs_alone_in_their_order() -> None:
    together = flexarm.simulate_all([(arm_with(m), DRIVE) for m in MASSES], n_jobs=2, step=1e-3)
    for mass, run in zip(MASSES, together, strict=True):
        alone = flexarm.simulate(arm_with(mass), DRIVE, step=1e-3)
        assert run.position == pytest.approx(alone.position, abs=1e-12)


def test_options_reach_every_run() -> None:
    runs = flexarm.simulate_all([(arm_with(2.0), DRIVE)], step=5e-3, sensitivities=["payloads.load.mass"])
    assert runs[0].solver["step"] == 5e-3
    assert runs[0].sensitivities is not None


def test_a_run_that_fails_is_raised() -> None:
    stray = flexarm.Drive.from_samples([0.0, 1.0], {"elbow": [0.0, 0.1]})
    with pytest.raises(flexarm.InvalidParameter, match="elbow"):
        flexarm.simulate_all([(arm_with(1.0), DRIVE), (arm_with(1.0), stray)], n_jobs=2)


def test_progress_tells_the_share_and_can_stop() -> None:
    seen: list[float] = []

    def report(done: float) -> bool:
        seen.append(done)
        return len(seen) < 2

    runs = flexarm.simulate_all([(arm_with(m), DRIVE) for m in MASSES], n_jobs=1, progress=report)
    assert seen == [0.25, 0.5]
    assert len(runs) == 2


def test_no_threads_are_refused() -> None:
    with pytest.raises(flexarm.InvalidParameter, match="at least 1"):
        flexarm.simulate_all([], n_jobs=0)


def test_a_run_that_is_no_pair_is_named() -> None:
    with pytest.raises(flexarm.InvalidParameter, match=r"runs\[1\]: must be a pair .*, got Arm"):
        flexarm.simulate_all([(arm_with(1.0), DRIVE), arm_with(2.0)])  # type: ignore[list-item]
    with pytest.raises(flexarm.InvalidParameter, match=r"runs\[0\]: .*, got \(Drive, Arm\)"):
        flexarm.simulate_all([(DRIVE, arm_with(1.0))])  # type: ignore[list-item]


def test_progress_tells_the_share_of_a_run_that_is_under_way() -> None:
    seen: list[float] = []
    long = flexarm.Drive.from_samples([0.0, 400.0], {"hinge": [0.0, 0.0]})
    flexarm.simulate_all(
        [(arm_with(1.0), long)], n_jobs=1, step=2e-5, progress=lambda done: seen.append(done) or done < 0.001
    )
    assert 0 < seen[0] < 1
    assert len(seen) < 5
