"""Flexible robot arms by finite element multibody simulation, beside what was measured on them."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from flexarm.config import config, show_config

# Public name -> module that defines it. Names are imported when first used, so that `import flexarm` stays light.
_EXPORTS = {
    "config": "flexarm.config",
    "show_config": "flexarm.config",
}

__all__ = ["config", "show_config"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("flexarm.config").version()
    if name in _EXPORTS:
        value = getattr(import_module(_EXPORTS[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'flexarm' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*globals(), *_EXPORTS, "__version__"])
