"""Flexible robot arms by finite element multibody simulation, beside what was measured on them."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.configuration import config, show_config
    from flexarm.record import Record, Signal

# Public name and the module that defines it, imported when first used: `import flexarm` stays light.
# A public name must not also be the name of a module, which would take its place once imported.
_EXPORTS = {
    "Arm": "flexarm.arm",
    "Record": "flexarm.record",
    "Signal": "flexarm.record",
    "config": "flexarm.configuration",
    "show_config": "flexarm.configuration",
}

__all__ = ["Arm", "Record", "Signal", "config", "show_config"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("flexarm.configuration").version()
    if name in _EXPORTS:
        value = getattr(import_module(_EXPORTS[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'flexarm' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*globals(), *_EXPORTS, "__version__"])
