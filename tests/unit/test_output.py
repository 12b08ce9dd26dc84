"""Output is whole or not there."""

from pathlib import Path

import pytest

from flexarm.errors import InvalidFile
from flexarm.output import FIGURE, PAGE, output_directory, output_file


def test_output_appears_when_the_block_ends(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "results"
    with output_directory(target) as directory:
        (directory / "a.txt").write_text("a")
        assert not target.exists()
    assert [p.name for p in target.iterdir()] == ["a.txt"]
    assert [p.name for p in target.parent.iterdir()] == ["results"]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit])
def test_nothing_is_left_behind_when_the_block_fails(tmp_path: Path, error: type[BaseException]) -> None:
    with pytest.raises(error), output_directory(tmp_path / "deep" / "results") as directory:
        (directory / "a.txt").write_text("half")
        raise error
    assert list(tmp_path.iterdir()) == []


def test_files_that_are_there_are_kept_unless_forced(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / "b.txt").write_text("old")
    with pytest.raises(InvalidFile, match="output: holds files already"), output_directory(tmp_path):
        pass
    with output_directory(tmp_path, force=True) as directory:
        (directory / "a.txt").write_text("new")
        (directory / "sub").mkdir()
        (directory / "sub" / "c.txt").write_text("new")
    assert {p.name: p.read_text() for p in tmp_path.rglob("*.txt")} == {
        "a.txt": "new",
        "b.txt": "old",
        "c.txt": "new",
    }
    assert [p.name for p in tmp_path.parent.iterdir() if ".partial" in p.name] == []


def test_an_empty_directory_is_taken(tmp_path: Path) -> None:
    with output_directory(tmp_path) as directory:
        (directory / "a.txt").write_text("a")
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_a_file_in_the_way_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(InvalidFile, match="is a file, a directory is needed"),
        output_directory(tmp_path / "file"),
    ):
        pass
    with pytest.raises(InvalidFile, match="cannot be written"), output_directory(tmp_path / "file" / "below"):
        pass
    with pytest.raises(InvalidFile, match="cannot be written"), output_directory("/proc/flexarm"):
        pass


def test_a_file_appears_when_the_block_ends(tmp_path: Path) -> None:
    target = tmp_path / "run.nc"
    target.write_text("old")
    with output_file(target) as partial:
        partial.write_text("new")
        assert (target.read_text(), partial.suffix) == ("old", ".nc")
    assert target.read_text() == "new"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit])
def test_no_file_is_left_behind_when_the_block_fails(tmp_path: Path, error: type[BaseException]) -> None:
    with pytest.raises(error), output_file(tmp_path / "run.nc") as partial:
        partial.write_text("half")
        raise error
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "absent" / "run.nc", tmp_path / "file" / "run.nc"):
        message = r"run\.nc: output: cannot be written: there is no directory"
        with pytest.raises(InvalidFile, match=message), output_file(place) as partial:
            partial.write_text("")
    full = OSError(28, "No space left on device")
    message = "output: cannot be written: No space left"
    with pytest.raises(InvalidFile, match=message), output_file(tmp_path / "run.nc"):
        raise full


def picture(path: Path, **options: object) -> None:
    """A figure as reports draw it, or of the user's own."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(1, 1))
    figure.add_subplot().plot([0, 1])
    figure.savefig(path, **options)


def test_a_new_report_replaces_the_figures_of_the_former_one(tmp_path: Path) -> None:
    """Figures of the user and of other results stay; what is no report removes nothing."""
    for name in ("kept.png", "former.png"):
        picture(tmp_path / name, metadata={"Software": FIGURE})
    picture(tmp_path / "own.png")
    with output_directory(tmp_path, force=True) as directory:
        (directory / "run.nc").write_text("a run")
    assert (tmp_path / "former.png").exists()
    with output_directory(tmp_path, force=True) as directory:
        (directory / PAGE).write_text("a page")
        picture(directory / "kept.png", metadata={"Software": FIGURE})
    assert sorted(p.name for p in tmp_path.iterdir()) == ["kept.png", "own.png", PAGE, "run.nc"]


def test_figures_of_a_report_are_marked_as_such(tmp_path: Path) -> None:
    from matplotlib.figure import Figure

    from flexarm.report.files import drawn

    (drawing,) = drawn([("one", "where", "a caption", Figure(figsize=(1, 1)))])
    assert FIGURE.encode() in drawing.png[:256]
