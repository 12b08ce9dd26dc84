"""The documentation site: `make docs` writes it into build/docs; warnings are errors."""

from __future__ import annotations

import inspect
import os
import re
from pathlib import Path
from typing import Any

import flexarm

HERE = Path(__file__).parent
ROOT = HERE.parent

project = "flexarm"
author = "flexarm developers"
version = release = flexarm.__version__
extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb", ".rst": "restructuredtext"}
root_doc = "index"

# ------------------------------------------------------------------------------------------------ pages
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 4
myst_fence_as_directive = ["math"]
nb_execution_mode = "off"  # write_notebooks executes them where they lie
nb_output_stderr = "remove"
html_theme = "pydata_sphinx_theme"
html_title = "flexarm"
html_theme_options = {"show_toc_level": 2, "navigation_depth": 2, "navbar_align": "left"}
html_copy_source = False
highlight_language = "none"

# -------------------------------------------------------------------------------------------- reference
autodoc_typehints = "none"  # docstrings say types, with units and shapes
autodoc_default_options = {"members": True, "undoc-members": False}
numpydoc_class_members_toctree = False
numpydoc_show_class_members = False

OF_PYDANTIC = re.compile(
    r"^model_|^(construct|copy|dict|json|parse_\w+|schema\w*|update_forward_refs|validate)$"
)


def skip(app: Any, what: str, name: str, member: Any, left_out: bool, options: Any) -> bool | None:
    """Leave out what pydantic gives its models."""
    return True if what == "class" and OF_PYDANTIC.search(name) else None


def beside_the_pages(app: Any, name: str, text: list[str]) -> None:
    """Show links to files of the repository that are no pages as names of files."""
    if name.startswith("reference/notebooks/"):
        return  # indices of code look like links
    folder = (HERE / name).parent

    def told(link: re.Match[str]) -> str:
        words, target = link["words"], link["target"]
        place = (folder / target.partition("#")[0]).resolve()
        inside = place.is_relative_to(HERE) and (place.suffix in (".md", ".png"))
        if "://" in target or target.startswith(("#", "mailto:")) or inside:
            return link[0]
        return words if words.startswith("`") else f"{words} (`{place.relative_to(ROOT)}`)"

    text[0] = re.sub(r"(?<!!)\[(?P<words>[^\]\[]+)\]\((?P<target>[^)\s]+)\)", told, text[0])


def write_reference(app: Any) -> None:
    """Write the pages of commands and of the public namespace."""
    import click
    from typer.main import get_command

    from flexarm.cli.app import COMMANDS, app_for

    lines = ["# Commands", "", "What `flexarm COMMAND --help` says.", ""]
    for name in COMMANDS:
        group: Any = get_command(app_for([name]))
        command = group.commands[name] if hasattr(group, "commands") else group
        context = click.Context(command, info_name=f"flexarm {name}")
        lines += [f"## {name}", "", "```", command.get_help(context).replace("\b", ""), "```", ""]
    _write("commands.md", lines)
    lines = [
        "# Python",
        "",
        "The public names of `import flexarm`, and the steps of a diagnosis in `flexarm.diagnosis`.",
        "",
        "```{toctree}",
        ":glob:",
        "",
        "python/*",
        "```",
    ]
    _write("python.md", lines)
    modules = dict.fromkeys(flexarm.diagnosis.__all__, flexarm.diagnosis)
    for name, module in (modules | dict.fromkeys(flexarm.__all__, flexarm)).items():
        directive = "autoclass" if inspect.isclass(getattr(module, name)) else "autofunction"
        lines = [f"# {name}", "", "```{eval-rst}", f".. {directive}:: {module.__name__}.{name}", "```", ""]
        _write(f"python/{name}.md", lines)


def write_notebooks(app: Any) -> None:
    """Write the notebooks with their outputs; those that stand there already are not executed again."""
    import nbformat
    from nbclient import NotebookClient

    for source in sorted((ROOT / "notebooks").glob("*.ipynb")):
        page = HERE / "reference" / "notebooks" / source.name
        if page.exists() and page.stat().st_mtime >= source.stat().st_mtime:
            continue
        notebook = nbformat.read(source, as_version=4)
        notebook.metadata["language_info"] = {"name": "python", "pygments_lexer": "ipython3"}
        if app.config.execute_notebooks:
            resources = {"metadata": {"path": str(source.parent)}}
            NotebookClient(notebook, timeout=600, kernel_name="python3", resources=resources).execute()
        _write(f"notebooks/{source.name}", [nbformat.writes(notebook)])
        if not app.config.execute_notebooks:
            os.utime(page, (0, 0))  # older than its source, so that a later build executes it


def _write(name: str, lines: list[str]) -> None:
    """Write a page, unless it stands there already."""
    file, text = HERE / "reference" / name, "\n".join(lines)
    if not file.exists() or file.read_text(encoding="utf-8") != text:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


def setup(app: Any) -> None:
    """Connect the above."""
    from pygments.lexers.special import TextLexer

    app.add_lexer("mermaid", TextLexer)  # drawings that need a script of another site
    app.add_config_value("execute_notebooks", True, "env")
    app.connect("builder-inited", write_reference)
    app.connect("builder-inited", write_notebooks)
    app.connect("source-read", beside_the_pages)
    app.connect("autodoc-skip-member", skip)
