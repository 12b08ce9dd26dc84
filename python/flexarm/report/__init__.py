"""The paper's figures and claims, made again: arrays in, pages out."""

from flexarm.report.reproduction import reproduce

__all__ = ["reproduce"]
