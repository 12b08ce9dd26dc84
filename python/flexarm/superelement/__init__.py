"""Super-elements: parts reduced to interfaces and internal modes, as plain data with files of their own."""

from flexarm.superelement.element import SuperElement

__all__ = ["SuperElement"]
