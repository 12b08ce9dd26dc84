"""Draw the pictures of docs/viewing.md: pages of `flexarm view` in headless Chromium, and plain ones.

Needs Chromium (Debian: apt-get install chromium) and `pip install 'flexarm[view]'`.
"""

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import flexarm
from flexarm.example.files import write as write_example
from flexarm.viewer import View

HERE = Path(__file__).resolve().parents[1]
FIGURES = HERE / "docs" / "figures"
SIZE = "1000,640"
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--use-angle=swiftshader",
]


def shoot(shown: View, name: str, folder: Path, fragment: str = "t=0") -> None:
    """Save the picture of a page at an instant."""
    page = folder / f"{name}.html"
    shown.save(page, force=True)
    command = ["chromium", *FLAGS, "--hide-scrollbars", f"--window-size={SIZE}", "--virtual-time-budget=4000"]
    picture = FIGURES / f"view-{name}.png"
    subprocess.run(
        [*command, f"--screenshot={picture}", f"{page.as_uri()}#{fragment}"], check=True, capture_output=True
    )


def three_joints(folder: Path) -> None:
    """A spatial arm: model, equilibrium, a mode, a run."""
    arm = flexarm.Arm.from_toml(HERE / "examples" / "three_joints.toml")
    pose = {"shoulder": 0.8, "elbow": 1.2}
    sag, shapes = flexarm.static(arm, pose), flexarm.modes(arm, pose)
    shoot(sag.view(), "equilibrium", folder)
    shoot(shapes.view(), "mode", folder, "clip=3&t=0.5")
    sag.plot().figure.savefig(FIGURES / "view-plot-equilibrium.png", dpi=90)
    shapes.plot().figure.savefig(FIGURES / "view-plot-modes.png", dpi=70)


def example(folder: Path) -> None:
    """The example arm: a record beside the model that lacks an effect, and a solid part."""
    (folder / "tryout").mkdir()
    write_example(folder / "tryout")
    arm = flexarm.Arm.from_toml(folder / "tryout" / "arm.toml")
    record = flexarm.Record.load(folder / "tryout" / "fast")
    run = flexarm.simulate(record.applied_to(arm), record)
    shoot(run.view(record), "record", folder, "t=9")
    part = flexarm.reduce_mesh(
        folder / "tryout" / "bracket.inp", {"foot": "BORE", "hand": "FLANGE:average"}, modes=5, unit="mm"
    )
    shoot(part.view(folder / "tryout" / "bracket.inp"), "part", folder)


if __name__ == "__main__":
    import matplotlib

    matplotlib.use("Agg")
    with TemporaryDirectory() as temporary:
        three_joints(Path(temporary))
        example(Path(temporary))
