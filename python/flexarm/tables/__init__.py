"""Tables of a TOML file: strict fields with units, and errors that name file, place and value.

`Table` is the base of everything that stands in a model or a record; `read_toml` and `check_table` turn a
file into tables or into one `InvalidFile` that lists all that is wrong.
"""

from flexarm.tables.check import check_table, parameter_error, refuse
from flexarm.tables.field import Inconsistent, component_names, unit_of, value_in
from flexarm.tables.table import (
    FrozenDict,
    Name,
    Number,
    Numbers,
    Table,
    Texts,
    Vector2,
    Vector3,
    to_python,
)
from flexarm.tables.toml import read_toml, toml_text

__all__ = [
    "FrozenDict",
    "Inconsistent",
    "Name",
    "Number",
    "Numbers",
    "Table",
    "Texts",
    "Vector2",
    "Vector3",
    "check_table",
    "component_names",
    "parameter_error",
    "read_toml",
    "refuse",
    "to_python",
    "toml_text",
    "unit_of",
    "value_in",
]
