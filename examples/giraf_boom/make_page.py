"""Diagnoses of the GIRAF boom, with their pages, beside its data.

    python make_page.py DATA_DIR OUT_DIR [--leave-one-out] [--jobs N] [--force]

makes the records of `make_records.py` in OUT_DIR/records and then, as `flexarm diagnose` does,

    OUT_DIR/static              seven lengths, 2013 mm held out
    OUT_DIR/static_with_hand    the same with something at the tip of which only the order is known
    OUT_DIR/ringdown            551 and 1065 mm, 1639 mm held out

each with report.html, report.json, updated.toml and figures, and `ringdown.png`: frequency and damping of the
tip against its amplitude. With --leave-one-out every length is held out once, with each of both models:
OUT_DIR/static_MMMM, OUT_DIR/static_with_hand_MMMM, and tables. Nothing of it may be committed: the data state
no licence.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from flexarm import Arm, Record
from flexarm.comparison.aligned_record import simulate_record
from flexarm.diagnosis.result import Diagnosis
from flexarm.output import output_directory
from flexarm.residual_analysis.free_decay import FreeDecay, free_decays

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import diagnosed, exit_code, page_command_line
from make_records import make_records

PAGES = {"boom.toml": "static", "boom_with_hand.toml": "static_with_hand"}
"""Models of the pulls, and where their pages are."""


def without(model: Path, folders: Sequence[Path], held: Path, jobs: int | None, page: Path) -> Diagnosis:
    """The diagnosis of all but one, which is held out."""
    return diagnosed(model, [folder for folder in folders if folder != held], held, page, jobs)


def held_out_once(
    model: Path, folders: Sequence[Path], jobs: int | None, every: bool, page: Path
) -> dict[str, Diagnosis]:
    """Diagnoses of a model with the longest boom held out and, if asked for, with every other length."""
    found = {folders[-1].name: without(model, folders, folders[-1], jobs, page)}
    for held in folders[:-1] if every else ():
        length = held.name.removeprefix("static_")
        found[held.name] = without(model, folders, held, jobs, page.with_name(f"{page.name}_{length}"))
    return found


def left_out_table(found: Mapping[str, Diagnosis]) -> str:
    """What each length missed while it was held out, and what it was predicted by."""
    lines = ["held out        before      after [mm]   verdict, effects"]
    gaps = []
    for name, each in found.items():
        gap = each.gap(each.held_out)
        gaps.append(gap.after_rms)
        effects = ", ".join(
            f"{effect.name} "
            + " ".join(
                f"{p.name} = {p.value:.3g} {p.unit}" for p in effect.parameters if abs(p.value) > p.std
            )
            for effect in each.effects
        )
        lines.append(
            f"{name:<14}{1e3 * gap.before_rms:8.2f}{1e3 * gap.after_rms:12.2f}      {each.verdict}, {effects}"
        )
    rms = 1e3 * np.array(gaps)
    square = np.sqrt(np.mean(rms**2))
    if len(rms) > 1:
        lines.append(f"mean of the lengths {rms.mean():.2f} mm, root of their mean square {square:.2f} mm")
    return "\n".join(lines)


def ring_down_figure(found: Sequence[FreeDecay], path: Path) -> None:
    """Frequency and damping ratio against amplitude, a line for each record."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for each in found:
        amplitude = [piece.amplitude for piece in each.pieces]
        frequency = np.array([piece.frequency_hz for piece in each.pieces])
        damping = [100 * piece.damping_ratio for piece in each.pieces]
        axes[0].semilogx(
            amplitude, frequency / frequency[-1], "o-", label=f"{each.record}: {frequency[-1]:.3g} Hz"
        )
        axes[1].errorbar(
            amplitude, damping, [100 * piece.damping_std for piece in each.pieces], fmt="o-", capsize=2
        )
    axes[1].set_xscale("log")
    axes[0].set(xlabel="amplitude [m/s²]", ylabel="frequency over that of the last piece [-]")
    axes[1].set(xlabel="amplitude [m/s²]", ylabel="damping ratio [%]")
    axes[0].legend()
    figure.savefig(path, dpi=120)
    plt.close(figure)


def make_page(data: Path, out: Path, jobs: int | None, every: bool, force: bool) -> None:
    """All of it."""
    with output_directory(out, force) as directory:
        folders = make_records(data, directory / "records")
        records = directory / "records"
        static = [records / folder.name for folder in folders if folder.name.startswith("static")]
        swings = [records / folder.name for folder in folders if folder.name.startswith("ringdown")]
        for model, page in PAGES.items():
            found = held_out_once(records / model, static, jobs, every, directory / page)
            print(f"{model}\n{left_out_table(found)}")
        if swings:
            without(records / "ringdown.toml", swings, swings[-1], jobs, directory / "ringdown")
            arm = Arm.from_toml(records / "ringdown.toml")
            rings = free_decays({folder.name: simulate_record(arm, Record.load(folder)) for folder in swings})
            ring_down_figure(rings, directory / "ringdown" / "ringdown.png")
            print("\n".join(map(str, rings)))
    print(f"\nwritten to {out}: open {out / 'static/report.html'}")


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    parser = page_command_line("Pages of the GIRAF boom.", "static.csv and ringdown_*.csv")
    parser.add_argument(
        "--leave-one-out", action="store_true", help="hold every length out once: eight times as long"
    )
    given = parser.parse_args()
    return exit_code(lambda: make_page(given.data, given.out, given.jobs, given.leave_one_out, given.force))


if __name__ == "__main__":
    sys.exit(main())
