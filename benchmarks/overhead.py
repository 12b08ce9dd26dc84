"""What surrounds the core's time: Python from an arm to arrays, and a process from the shell to files.

One run of the swing, 4 segments, 20 s at 2 ms, everything recorded; its drive is a CSV file of 10 001 rows.
"""

import json
import os
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import measure
import numpy as np
import problem

SEGMENTS, STEP = 4, 2e-3


def python_overhead(repetitions):
    """CPU seconds of `flexarm.simulate` and of the core's part of it, the steps and their records."""
    from solve_flexarm import drive, swinging_arm, timed

    from flexarm import _core

    stepping, spent = _core.simulate, []

    def timed_stepping(*arguments):
        began = time.process_time()
        run = stepping(*arguments)
        spent.append(time.process_time() - began)
        return run

    _core.simulate = timed_stepping
    try:
        motion = drive("hinge", problem.END)
        whole = [timed(swinging_arm(SEGMENTS), motion, STEP, problem.END)[1] for _ in range(repetitions)]
    finally:
        _core.simulate = stepping
    return {"whole": whole, "core": spent}


def shell_process(repetitions):
    """CPU seconds of `flexarm simulate`, once Python has kept its bytecode as it does for any user."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "flexarm", "simulate", *_files(Path(folder))]
        kept = {"PYTHONPYCACHEPREFIX": os.fspath(Path(folder, "bytecode"))}
        measure.command([*words, "--out", Path(folder, "first")], **kept)
        runs = [measure.command([*words, "--out", Path(folder, str(i))], **kept) for i in range(repetitions)]
    return [run.cpu for run in runs]


def _files(folder):
    """Arguments: the model's file, and the drive's."""
    from solve_flexarm import swinging_arm

    model, swing = folder / "arm.toml", folder / "swing.csv"
    swinging_arm(SEGMENTS).to_toml(model)
    t = np.linspace(0, problem.END, round(problem.END / STEP) + 1)
    np.savetxt(swing, np.c_[t, problem.angle(t)], "%.9f", ",", header="time_s,hinge", comments="")
    return model, "--drive", swing


def lines(result):
    """The result in words."""
    added = median(a - b for a, b in zip(result["whole"], result["core"], strict=True))
    core = median(result["core"])
    yield f"a call of flexarm.simulate: {1e3 * added:.2g} ms over the core's {1e3 * core:.3g} ms"
    yield f"flexarm simulate from the shell: {measure.Spread.of(result['shell']).text()} s of CPU time"


if __name__ == "__main__":
    order = json.loads(sys.argv[1])
    print(json.dumps({**python_overhead(5 * order["repetitions"]), "shell": shell_process(**order)}))
