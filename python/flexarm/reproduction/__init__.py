"""The figures and claims of the paper, made again from the virtual mock-up."""

from flexarm.reproduction.reproduction import reproduce

__all__ = ["reproduce"]
