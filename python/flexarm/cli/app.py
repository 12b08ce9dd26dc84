"""The command line: its commands and what `flexarm --help` says."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from inspect import cleandoc
from typing import Annotated, Any

import typer
from typer.core import TyperArgument, TyperCommand

COMMANDS = (
    "example",
    "import",
    "check",
    "static",
    "modes",
    "linearise",
    "simulate",
    "compare",
    "diagnose",
    "calibrate",
    "plan",
    "campaign",
    "reduce",
    "export",
    "view",
    "reproduce",
)
"""In the order of the help. Each is a function in a module of its name."""
MODULES = {"import": "import_logs"}
"""Commands whose names Python keeps for itself, and the names of their functions."""

HELP = """
Simulate flexible robot arms by finite elements, and compare them with measurements.

A MODEL is a TOML file, a RECORD a directory with record.toml and CSV files. All values are in SI units and
radians, joints on the output side (motor angle over ratio).

    flexarm example tryout                          files to try all this on
    flexarm check arm.toml                          what is it, what does it weigh
    flexarm import run7.map.toml --out measured     a record from anyone's logs
    flexarm check arm.toml measured                 could its sensors be right
    flexarm static arm.toml --joint hinge=0.5       how far does it sag
    flexarm modes arm.toml                          how does it vibrate
    flexarm linearise arm.toml --out arm.mat        matrices for control design
    flexarm simulate arm.toml --drive swing.csv --out run
    flexarm compare arm.toml measured               how far is the model off
    flexarm diagnose arm.toml measured --out why    what does the model lack
    flexarm calibrate arm.toml measured --out fit   estimate what is uncertain
    flexarm plan arm.toml --drive swing.csv         what could an experiment tell
    flexarm campaign tolerances.toml --out study    what do its tolerances cost
    flexarm reduce hub.inp --interface ...          a solid part as a link
    flexarm export found.toml --urdf robot.urdf --out found.urdf
    flexarm view run                                see it move, in the browser

Exit code: 0 done, 2 the input is at fault, 3 the numbers are at fault (no convergence), 130 interrupted
(Ctrl-C), 143 terminated (SIGTERM): then only complete output is left, and named.
"""


class _Command(TyperCommand):
    """A command whose help shows arguments by their names alone, as it does options: no `<list[Path]>`."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        for argument in (each for each in self.params if isinstance(each, TyperArgument)):
            vars(argument)["display_type_rich"] = lambda ctx: None


def app_for(arguments: list[str]) -> typer.Typer:
    """Return the application with the command that is asked for; with all of them where that is none.

    Parsing the options of the other commands costs 20 ms.
    """
    return _app(arguments[:1] if arguments and arguments[0] in COMMANDS else COMMANDS)


def _app(commands: Iterable[str]) -> typer.Typer:
    app = typer.Typer(
        name="flexarm",
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        add_completion=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback(help=_help(HELP))(_common)
    for name in commands:
        module = MODULES.get(name, name)
        command = getattr(import_module(f"flexarm.cli.{module}"), module)
        app.command(name, cls=_Command, help=_help(command.__doc__ or ""))(command)
    return app


def _print_version(wanted: bool) -> None:
    if wanted:
        import flexarm

        print(f"flexarm {flexarm.__version__}")
        raise typer.Exit


def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass


def _help(text: str) -> str:
    """Help with its indented lines kept: a backspace tells the formatter not to wrap a paragraph."""
    paragraphs = cleandoc(text).split("\n\n")
    return "\n\n".join(f"\b\n{part}" if part.startswith(" ") else part for part in paragraphs)
