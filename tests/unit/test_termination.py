"""Claims about Ctrl-C and SIGTERM at the command line: one line, one exit code, nothing left behind."""

import signal
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

WAYS = [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]

COMMAND = """
import sys
from flexarm.cli import app, main

def command(**options):
{body}

app.app_for = lambda arguments: command
main(["check"])
"""
"""A command of our own making, in the machinery of the real ones."""

SWALLOWS = """
    print("begun", flush=True)
    import time
    while True:
        try:
            time.sleep(600)
        except BaseException:
            pass
"""
COMPILED = """
    import hashlib
    from flexarm.output import output_directory, output_file
    with output_directory("new/out") as directory, output_file("file.nc") as partial:
        (directory / "half").write_text("half")
        partial.write_text("half")
        print("begun", flush=True)
        hashlib.pbkdf2_hmac("sha256", b"", b"", 2**31 - 1)  # minutes, in which Python calls no handler
"""
THREADS = """
    from concurrent.futures import ThreadPoolExecutor
    import time
    with ThreadPoolExecutor(2) as pool:
        pool.submit(time.sleep, 600)
        print("begun", flush=True)
        time.sleep(600)
"""


@contextmanager
def started(*words: str, place: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that does not outlive the test."""
    with subprocess.Popen(
        [sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=place
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def command(body: str) -> str:
    return COMMAND.format(body=textwrap.indent(textwrap.dedent(body), "    "))


def has_begun(process: subprocess.Popen[str]) -> bool:
    return process.stdout is not None and process.stdout.readline() == "begun\n"


@pytest.mark.parametrize(("number", "code", "how"), WAYS)
@pytest.mark.parametrize("body", [SWALLOWS, COMPILED, THREADS], ids=["swallows", "compiled", "threads"])
def test_a_command_leaves_whatever_it_is_doing(body, number, code, how, tmp_path):
    with started("-c", command(body), place=tmp_path) as process:
        assert has_begun(process)
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (code, f"{how}: nothing was written\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="tells from /proc who handles a signal")
@pytest.mark.parametrize(("number", "code", "how"), WAYS)
def test_a_command_leaves_quietly_before_it_has_imported_anything(number, code, how, tmp_path):
    """The signal comes as soon as it is handled, into the imports of the command."""
    with started("-m", "flexarm", "modes", "none.toml", place=tmp_path) as process:
        while not _handles(process.pid, signal.SIGTERM) and process.poll() is None:
            pass
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (code, f"{how}: nothing was written\n")


def _handles(pid: int, number: signal.Signals) -> bool:
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return True  # it has ended
    caught = next(line.split()[1] for line in lines if line.startswith("SigCgt:"))
    return bool(int(caught, 16) >> (number - 1) & 1)


def test_an_ignored_interrupt_stays_ignored(tmp_path):
    """As under nohup, or in the background of a shell script."""
    body = """
    print("begun", flush=True)
    import time
    time.sleep(1)
    """
    ignoring = (
        "import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_IGN); "
        "os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"
    )
    with started("-c", ignoring, "-c", command(body), place=tmp_path) as process:
        assert has_begun(process)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
