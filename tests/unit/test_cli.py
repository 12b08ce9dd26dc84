"""The command line: exit codes, standard output and error, and no traceback for a user's mistake."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pytest import approx

from flexarm import Arm, Record, Signal
from flexarm.cli.run import run


def flexarm(*arguments: object) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own."""
    code = "from flexarm.cli import main; main()"
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@pytest.fixture
def bad_model(tmp_path: Path, model_text: str) -> Path:
    path = tmp_path / "bad.toml"
    path.write_text(model_text.replace("mass = 14.1", "mass = -1"))
    return path


SHAFT = """
[[joints]]
name = "shaft"
type = "revolute"
parent = "base"
child = "rotor"
axis = [0, 0, 1]
[[links]]
name = "rotor"
type = "rigid"
mass = 1
com = [0, 0, 0]
inertia = [0.1, 0.1, 0.1]
[[gears]]
name = "reducer"
input = "shaft"
output = "hinge"
ratio = 120
"""

# ------------------------------------------------------------------------ processes


def test_a_mistake_ends_as_exit_code_2_and_one_line(bad_model: Path) -> None:
    done = flexarm("check", bad_model)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == f"error: {bad_model}: payloads.load.mass (line 42): must be at least 0, got -1 kg\n"


@pytest.mark.parametrize("command", ["check", "static", "modes"])
def test_every_command_refuses_a_model_that_is_garbage(command: str, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_bytes(bytes(range(256)))
    done = flexarm(command, tmp_path / "arm.toml")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: {tmp_path / 'arm.toml'}: line ")
    assert "Traceback" not in done.stderr


def test_a_record_that_goes_back_in_time_is_told_with_its_line(record_dir: Path) -> None:
    (record_dir / "encoder.csv").write_text("time_s,encoder_deg\n0,1\n0.1,2\n0.1,3\n")
    done = flexarm("check", record_dir)
    assert done.returncode == 2
    assert done.stderr == (
        f"error: {record_dir / 'encoder.csv'}: line 4, column time_s: "
        "0.1 repeats 0.1 of line 3; times must rise\n"
    )


def test_check_starts_without_numpy_and_help_without_the_model(model_file: Path) -> None:
    """What makes the command line start in a third of a second."""
    code = (
        "import sys; from flexarm.cli.run import run; code = run(sys.argv[1:]); "
        "heavy = {'numpy', 'scipy', 'xarray', 'matplotlib', 'rich', 'flexarm.arm'}; "
        "print(code, *sorted(heavy & set(sys.modules)))"
    )
    for arguments, loaded in ((["check", str(model_file)], "0 flexarm.arm"), (["--help"], "0")):
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True
        )
        assert done.stdout.splitlines()[-1] == loaded


def test_a_reader_that_goes_away_is_no_error(model_file: Path) -> None:
    code = "import sys; from flexarm.cli import main; main()"
    pipe = f"'{sys.executable}' -c '{code}' check '{model_file}' | head -c 1"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {pipe}"], capture_output=True, text=True, check=False
    )
    assert "Traceback" not in done.stderr
    assert "BrokenPipe" not in done.stderr


# ------------------------------------------------------------------------- in process


def test_check_prints_a_weight_statement(model_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["check", str(model_file)]) == 0
    out = capsys.readouterr().out
    assert "weight at q = 0" in out
    assert "whole                   29.8032" in out  # 13.7032 + 2 + 14.1 kg


def test_a_mesh_given_to_check_is_sent_to_reduce(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "beam.inp"
    path.write_text("*NODE\n1, 0, 0, 0\n")
    assert run(["check", str(path)]) == 2
    assert "is a mesh, no model; `flexarm reduce`" in capsys.readouterr().err


def test_check_json_is_one_object(model_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["check", str(model_file), "--json"]) == 0
    captured = capsys.readouterr()
    told = json.loads(captured.out)
    assert captured.err == ""
    assert told["kind"] == "model"
    assert told["weight"]["whole"]["mass"] == approx(29.8032, abs=1e-4)
    assert told["weight"]["links"]["rod"]["centre"] == approx([0, 0, 0.4 + 1.5])
    assert told["problems"] == told["warnings"] == []


def test_check_json_lists_the_problems_of_a_bad_model(
    bad_model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["check", str(bad_model), "--json"]) == 2
    captured = capsys.readouterr()
    [problem] = json.loads(captured.out)["problems"]
    assert problem["where"] == "payloads.load.mass"
    assert captured.err.startswith("error: ")


def test_check_tells_signals_rates_and_drop_outs(
    record_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["check", str(record_dir), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["kind"] == "record"
    assert told["signals"]["hinge"]["rate_hz"] == approx(10)
    assert told["signals"]["tip"]["drop_outs"] == 2
    assert run(["check", str(record_dir / "record.toml")]) == 0
    assert "clock tracker: 0.01 +- 0.002 s" in capsys.readouterr().out


def test_check_tells_what_a_run_carried_with_units(
    record_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = record_dir / "record.toml"
    stated = "[payloads]\nhook = {}\ncase = {mass = 5, inertia = [0.1, 0.1, 0.2], position = [0, 0, 1.1]}\n"
    file.write_text(file.read_text().replace("[payloads]\n", stated))
    assert run(["check", str(record_dir)]) == 0
    told = capsys.readouterr().out
    assert "payload case: 5 kg, inertia 0.1, 0.1, 0.2 kg m2, at 0, 0, 1.1 m\n" in told
    assert "payload hook: as in the model\n" in told


def test_warnings_leave_the_exit_code_at_0(
    tmp_path: Path, model_text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(model_text.replace("-9.81]", "-1.62]"))
    assert run(["check", str(path)]) == 0
    assert (
        capsys.readouterr().err
        == f"warning: {path}: gravity: has a magnitude of 1.62 m/s2; on Earth it is 9.81 m/s2\n"
    )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["check"], "command line: Missing argument"),
        (["modes", "a", "b"], "command line: Got unexpected extra argument"),
        (["chek"], "command line: No such command 'chek'"),
        (["check", "arm.toml", "--jsn"], "command line: No such option"),
        (["check", "nowhere.toml"], "nowhere.toml: file: there is no such file"),
        (
            ["static", "MODEL", "--joint", "hinge"],
            "command line: --joint: must be NAME=VALUE with a plain number in SI units, such as hinge=0.5, "
            "got 'hinge'",
        ),
        (["static", "MODEL", "--joint", "hinge=fast"], "command line: --joint: must be NAME=VALUE"),
        (["static", "MODEL", "--joint", "hinge=inf"], "command line: --joint: must be NAME=VALUE"),
        (
            ["static", "MODEL", "--joint", "elbow=1"],
            "MODEL: --joint: there is no moving joint 'elbow'; there are hinge",
        ),
        (["modes", "MODEL", "--joint", "wrist=1"], "MODEL: --joint: there is no moving joint 'wrist'"),
        (
            ["modes", "MODEL", "--joint", "hinge=1", "--joint", "hinge=2"],
            "--joint: joint 'hinge' is given twice",
        ),
        (["modes", "MODEL", "--count", "0"], "command line: Invalid value for '--count'"),
        (["simulate", "MODEL", "--out", "run"], "command line: Missing option '--drive'"),
        (
            ["simulate", "MODEL", "--drive", "d.csv", "--out", "run", "--step", "0"],
            "--step: must be positive and at most 1e+11 s, got 0 s",
        ),
        (
            ["diagnose", "MODEL", "MODEL", "--out", "why", "--step", "1e300"],
            "--step: must be positive and at most 1e+11 s, got 1e+300 s",
        ),
        (
            ["simulate", "MODEL", "--drive", "d.csv", "--out", "run", "--alpha", "0.1"],
            "--alpha: must lie between -1/3 and 0",
        ),
        (["compare", "MODEL", "nowhere"], "nowhere: record: there is no such directory"),
    ],
)
def test_mistakes_on_the_command_line_are_told(
    arguments: list[str], said: str, model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([str(model_file) if word == "MODEL" else word for word in arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    last = captured.err.splitlines()[-1]
    assert last.startswith("error: ")
    assert said.replace("MODEL", str(model_file)) in last


def test_an_occupied_output_directory_is_refused_before_anything_runs(
    model_file: Path, record_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(record_dir.iterdir())
    assert run(["simulate", str(model_file), "--drive", "nowhere.csv", "--out", str(record_dir)]) == 2
    assert "output: holds files already" in capsys.readouterr().err
    assert sorted(record_dir.iterdir()) == before
    assert sorted(record_dir.parent.iterdir()) == sorted([model_file, record_dir])


def test_help_shows_an_example_of_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([]) == 0
    assert "flexarm compare arm.toml measured" in capsys.readouterr().out
    for command in ("check", "static", "modes", "simulate", "compare", "reproduce"):
        assert run([command, "--help"]) == 0
        assert f"\n      flexarm {command} " in capsys.readouterr().out


def test_a_step_that_never_ends_is_refused(
    model_file: Path, drive_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    arguments = ["--drive", str(drive_file), "--step", "1e-12", "--out", str(out)]
    assert run(["simulate", str(model_file), *arguments]) == 2
    assert "--step: 1e-12 s would make 1.5e+12 steps; allowed are 2e+07" in capsys.readouterr().err
    assert not out.exists()


def test_millimetres_of_a_joint_that_slides_on_the_command_line_are_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lift = {"name": "lift", "type": "prismatic", "parent": "base", "child": "mast", "axis": [0, 0, 1]}
    mast = {"name": "mast", "type": "rigid", "mass": 20.0}
    Arm.from_dict({"joints": [lift], "links": [mast]}).to_toml(tmp_path / "arm.toml")
    assert run(["static", str(tmp_path / "arm.toml"), "--joint", "lift=400", "--json"]) == 0
    assert "--joint lift: 400 m are further than any arm reaches; lengths are in m" in capsys.readouterr().err


def test_degrees_for_radians_on_the_command_line_are_a_warning(
    model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["static", str(model_file), "--joint", "hinge=90", "--json"]) == 0
    captured = capsys.readouterr()
    assert captured.err == (
        "warning: command line: --joint hinge: 90 rad are 14.3 turns; angles are in radians\n"
    )
    assert json.loads(captured.out)["joints"]["hinge"]["drive_angle"] == approx(90)


def test_a_joint_before_a_gear_is_warned_of_by_the_turns_behind_it(
    tmp_path: Path, model_text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A motor's shaft makes ten turns for a tenth of one behind it, and no thousand."""
    geared_file = tmp_path / "geared.toml"
    geared_file.write_text(model_text.replace("gear_ratio", "# gear_ratio") + SHAFT)
    assert run(["static", str(geared_file), "--joint", "shaft=62.8", "--json"]) == 0
    assert not capsys.readouterr().err
    assert run(["static", str(geared_file), "--joint", "shaft=6280", "--json"]) == 0
    assert "6280 rad are" in capsys.readouterr().err


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.startswith("flexarm 0.")


def test_failed_numbers_end_as_exit_code_3_with_time_iteration_and_residual(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from flexarm.cli import app
    from flexarm.errors import NotConverged

    def fail(**options: object) -> None:
        raise NotConverged("no equilibrium", time=0.824, iteration=12, residual=3.1e-2)

    monkeypatch.setattr(app, "app_for", lambda arguments: fail)
    assert run(["static", "arm.toml"]) == 3
    assert (
        capsys.readouterr().err
        == "error: no equilibrium (time = 0.824 s, iteration = 12, residual = 0.031)\n"
    )


def test_ctrl_c_is_one_line_and_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from flexarm.cli import app

    def interrupt(**options: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(app, "app_for", lambda arguments: interrupt)
    assert run(["check", "arm.toml"]) == 130
    assert capsys.readouterr() == ("", "interrupted: nothing was written\n")


# --------------------------------------------------------------------- a whole run


@pytest.fixture
def drive_file(tmp_path: Path) -> Path:
    path = tmp_path / "swing.csv"
    path.write_text("time_s,hinge\n0,0\n0.5,0.1\n1,0.2\n1.5,0.2\n")
    return path


def test_simulate_leaves_a_record_of_every_point_and_the_drive(
    model_text: str, tmp_path: Path, drive_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    begin, end = model_text.index("[[sensors]]"), model_text.index("[uncertainty]")
    model = tmp_path / "arm.toml"
    model.write_text(model_text[:begin] + model_text[end:])
    out = tmp_path / "out"
    assert run(["simulate", str(model), "--drive", str(drive_file), "--step", "0.01", "--out", str(out)]) == 0
    assert capsys.readouterr().err == ""
    record = Record.load(out)
    assert record.drive == ("hinge",)
    assert record.signals["hinge"].quantity == "joint_angle"
    assert record.signals["tip"].channels == ("tip_x_m", "tip_y_m", "tip_z_m")
    assert record.signals["tip"].time == approx([0.01 * i for i in range(151)])
    assert (out / "simulation.nc").stat().st_size > 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arm.toml", "out", "swing.csv"]


def test_simulate_measures_with_the_sensors_of_the_model(
    model_file: Path, tmp_path: Path, drive_file: Path
) -> None:
    arguments = ["simulate", str(model_file), "--drive", str(drive_file), "--step", "0.01"]
    for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        assert run([*arguments, "--seed", seed, "--out", str(tmp_path / name)]) == 0
    a, b, c = (Record.load(tmp_path / name).signals["tracker"] for name in "abc")
    assert a.time == approx([0.1 * i for i in range(16)])  # 10 Hz
    assert a == b
    assert a != c
    assert abs(a.values - c.values).max() < 10 * 5e-5  # both within their noise of 0.05 mm


def test_a_simulation_of_a_record_gives_its_signals_at_its_instants(model_file: Path, tmp_path: Path) -> None:
    angle = {"quantity": "joint_angle", "joint": "hinge", "time": [0, 0.4, 0.8], "values": [0, 0.1, 0.1]}
    place = {"quantity": "position", "point": "tip", "time": [0.1, 0.35], "values": [[0, 0, 1], [1, 0, 0]]}
    signals = [Signal(name="enc", **angle), Signal(name="tip", **place)]
    record, out = tmp_path / "measured", tmp_path / "out"
    Record(signals=signals, drive=("enc",)).save(record)
    assert run(["simulate", str(model_file), "--drive", str(record), "--out", str(out)]) == 0
    again = Record.load(out)
    assert again.signals["tip"].time.tolist() == [0.1, 0.35]
    assert again.signals["tip"].values[0, 2] == approx(3.4, abs=0.05)  # hinge at 0.4 m, a tube of 3 m
    assert again.signals["enc"].values[:, 0] == approx([0, 0.1, 0.1], abs=1e-9)


@pytest.mark.parametrize(
    ("number", "code", "how"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_an_interrupted_run_leaves_nothing_behind(
    number: signal.Signals, code: int, how: str, model_file: Path, drive_file: Path, tmp_path: Path
) -> None:
    drive_file.write_text("time_s,hinge\n0,0\n5000,0.1\n10000,0.2\n15000,0.2\n")  # hours at 2 ms
    out = tmp_path / "out"
    program = "from flexarm.cli import main; main()"
    words = [sys.executable, "-c", program, "simulate", model_file, "--drive", drive_file, "--out", out]
    process = subprocess.Popen([*map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 30
    while not list(tmp_path.glob(".out.partial")) and time.monotonic() < until:
        time.sleep(0.02)
    time.sleep(0.5)  # into the run
    process.send_signal(number)
    out_text, err = process.communicate(timeout=30)
    assert out_text == ""
    *announced, last = err.splitlines()
    assert any("swing.csv: column time_s: lasts 4.17 h" in each for each in announced)
    assert last == f"{how}: nothing was written"
    assert process.returncode == code
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arm.toml", "swing.csv"]
