"""Processes and their cost: CPU seconds (user and system) and resident memory, as the kernel counted them."""

import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import venv
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

HERE = Path(__file__).resolve().parent

THREAD_LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
KEPT_BYTECODE = {"PYTHONDONTWRITEBYTECODE": ""}
"""Python keeps its bytecode, as it does for any user; else every process would compile flexarm anew."""


@dataclass(frozen=True)
class Process:
    """What a finished process printed, and what it cost."""

    output: str
    cpu: float  # s, user + system
    memory: float  # MB, largest resident set

    @property
    def answer(self):
        """The JSON in its last line."""
        return json.loads(self.output.strip().splitlines()[-1])


def command(words, threads=1, **environment):
    """Runs a command to its end, its libraries limited to that many threads.

    Raises
    ------
    RuntimeError
        If it fails, with what it wrote to standard error.
    """
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        child = subprocess.Popen(
            [str(word) for word in words],
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
            env=os.environ | dict.fromkeys(THREAD_LIMITS, str(threads)) | KEPT_BYTECODE | environment,
        )
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        if child.returncode:
            raise RuntimeError(f"{' '.join(map(str, words))} failed:\n{err.read()}")
        return Process(out.read(), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def run(python, script, order, threads=1):
    """Runs `python script order`, the order as JSON."""
    return command([python, HERE / script, json.dumps(order)], threads)


@dataclass(frozen=True)
class Spread:
    """Median of repetitions, and their range."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values):
        """Of at least one value."""
        return cls(statistics.median(values), min(values), max(values))

    def text(self, digits=3):
        """As in a table: median (low to high)."""
        return f"{self.median:.{digits}g} ({self.low:.{digits}g}-{self.high:.{digits}g})"


def alternate(orders, repetitions, solves=5):
    """CPU seconds of several competitors, taken in turns so that a busy machine is busy for all.

    Parameters
    ----------
    orders : dict of name to (python, code, case)
        One case of each competitor.
    repetitions : int
        Rounds; each starts two processes a competitor: one solves once, the other `solves` times.

    Returns
    -------
    dict of name to {"solver": list, "process": list, "memory": list, "offsets": list}
        Solver: median CPU seconds of the solves, models being built anew, one value a round. Process: CPU
        seconds of the process that solves once, imports and model included. Memory in MB.
    """
    seen = {name: {"solver": [], "process": [], "memory": []} for name in orders}
    for _ in range(repetitions):
        for name, (python, code, case) in orders.items():
            order = {"code": code, "cases": [case]}
            many = run(python, "worker.py", {**order, "solves": solves}).answer["results"][0]
            once = run(python, "worker.py", order)
            seen[name]["solver"].append(statistics.median(many["cpu"]))
            seen[name]["process"].append(once.cpu)
            seen[name]["memory"].append(once.memory)
            seen[name]["offsets"] = many["offsets"]
    return seen


def ratio(slow, fast):
    """Spread of the ratios of two lists of repetitions, round by round."""
    return Spread.of([a / b for a, b in zip(slow, fast, strict=True)])


def exudyn_python(given):
    """An interpreter that has EXUDYN: the given one, else benchmarks/.venv, made on first use."""
    if given:
        return given
    folder, wanted = HERE / ".venv", HERE / "requirements.txt"
    python, installed = folder / "bin" / "python", folder / "installed.txt"
    if not python.exists():
        venv.create(folder, with_pip=True)
    if not installed.exists() or installed.read_text() != wanted.read_text():
        print(f"installing EXUDYN into {folder}", file=sys.stderr)
        subprocess.run([str(python), "-m", "pip", "install", "--quiet", "-r", str(wanted)], check=True)
        installed.write_text(wanted.read_text())
    return str(python)


def machine():
    """Kind of processor, number of cores, load, date: what a timing means nothing without."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        lines = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = lines[0].split(":", 1)[1].strip() if lines else model
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "load": round(os.getloadavg()[0], 1),
        "date": datetime.now(UTC).date().isoformat(),
    }
