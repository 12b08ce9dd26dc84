"""Claims about runs in several processes and threads: they pickle, fork and end."""

import os
import pickle
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from tests.helpers.arms import TUBE, beam, hinge, point

import flexarm


def arm() -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 1.0], TUBE)],
            "points": [point("tip", "rod", [0, 0, 1.0])],
        }
    )


def test_a_run_without_energies_pickles_with_them():
    drive = flexarm.Drive.from_samples([0, 0.01, 0.02], {"hinge": [0, 0.1, 0.1]})
    run = flexarm.simulate(arm(), drive)
    again = pickle.loads(pickle.dumps(run))
    assert np.array_equal(again.position, run.position)
    assert np.array_equal(again.kinetic, run.kinetic)
    assert again.arm == run.arm


FORKS = """
import os, signal, sys
signal.alarm(60)
{body}
"""


def run_alone(body: str, place, *, env: dict[str, str] | None = None) -> str:
    """Standard output of a program in a process of its own, which is not waited for for ever."""
    program = FORKS.format(body=textwrap.dedent(body))
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=place,
        env={**os.environ, **(env or {})},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="the system cannot fork")


@needs_fork
def test_a_forked_process_reduces_parts_as_its_parent_did(tmp_path):
    """CHOLMOD's threads do not come along."""
    body = """
    import numpy as np, flexarm
    from flexarm import _core
    n = 12
    x = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    at = lambda i, j, k: (i * (n + 1) + j) * (n + 1) + k
    i, j, k = (a.ravel() for a in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
    corners = [(0,0,0), (1,0,0), (1,1,0), (0,1,0), (0,0,1), (1,0,1), (1,1,1), (0,1,1)]
    cells = np.stack([at(i + a, j + b, k + c) for a, b, c in corners], -1)
    steel = _core.SolidMaterial(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
    block = _core.CellBlock(_core.CellType.hex8, cells, np.zeros(len(cells), int))
    K, M = _core.assemble_solids(_core.SolidMesh(x, [block], [steel]))
    def end(name, z):
        points = np.flatnonzero(x[:, 2] == z).tolist()
        return _core.Interface(name, np.array([0.5, 0.5, z]), np.eye(3), points, _core.InterfaceKind.rigid)
    ends = [end("low", 0.0), end("high", 1.0)]
    first = _core.reduce_part(K, M, x, ends, 3).frequency_hz
    child = os.fork()
    if child == 0:
        signal.alarm(30)
        again = _core.reduce_part(K, M, x, ends, 3).frequency_hz
        os._exit(0 if np.allclose(first, again, rtol=1e-9) else 9)
    assert os.waitpid(child, 0)[1] == 0
    """
    run_alone(body, tmp_path, env={"OMP_NUM_THREADS": "2"})


@needs_fork
def test_a_forked_process_imports_what_a_thread_was_importing(tmp_path):
    (tmp_path / "slow_module.py").write_text("import time\ntime.sleep(1)\n")
    body = """
    import threading, time
    from flexarm.threads import thread_pool
    sys.path.insert(0, ".")
    with thread_pool(1) as pool:
        pool.submit(__import__, "slow_module")
        while "slow_module" not in sys.modules:
            time.sleep(0.01)
        child = os.fork()
        if child == 0:
            signal.alarm(20)
            import slow_module
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
    """
    run_alone(body, tmp_path)


@needs_fork
def test_a_process_forked_by_progress_is_told_that_it_has_no_threads(tmp_path):
    arm().to_toml(tmp_path / "arm.toml")
    body = """
    import flexarm
    arm = flexarm.Arm.from_toml("arm.toml")
    drive = flexarm.Drive.from_samples([0, 0.1], {"hinge": [0, 0.1]})
    children = []
    def progress(done):
        if not children:
            children.append(os.fork())
    try:
        runs = flexarm.simulate_all([(arm, drive)] * 4, n_jobs=1, progress=progress)
    except flexarm.InvalidParameter as error:
        assert children == [0] and "no threads" in str(error)
        os._exit(7)
    assert len(runs) == 4
    assert os.waitstatus_to_exitcode(os.waitpid(children[0], 0)[1]) == 7
    """
    run_alone(body, tmp_path)


def test_ctrl_c_ends_all_runs_at_once(tmp_path):
    """The runs would take hours; what waits for one of them must not wait for its end."""
    arm().to_toml(tmp_path / "arm.toml")
    body = """
    import flexarm, signal, threading
    arm = flexarm.Arm.from_toml("arm.toml")
    drive = flexarm.Drive.from_samples([0, 10000, 20000], {"hinge": [0, 0.1, 0.1]})
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    try:
        flexarm.simulate_all([(arm, drive)] * 3, n_jobs=2)
    except KeyboardInterrupt:
        print("interrupted")
    """
    assert run_alone(body, tmp_path) == "interrupted\n"
