"""
C++ core of flexarm (private).
"""

from __future__ import annotations

__all__: list[str] = ["BuildInfo", "build_info"]

class BuildInfo:
    """
    Versions, backends and licence of the core.
    """
    @property
    def blas(self) -> str: ...
    @property
    def build_type(self) -> str: ...
    @property
    def cholmod_found(self) -> bool: ...
    @property
    def compiler(self) -> str: ...
    @property
    def eigen(self) -> str: ...
    @property
    def git(self) -> str:
        """
        Empty where it is unknown.
        """
    @property
    def licence(self) -> str: ...
    @property
    def ordering(self) -> str: ...
    @property
    def solver(self) -> str: ...
    @property
    def suitesparse(self) -> str:
        """
        Empty where it is not used.
        """
    @property
    def version(self) -> str: ...

def build_info() -> BuildInfo:
    """
    What this build of the core is made of.
    """
