"""The solid hinge on a coarse mesh, for tests."""

from flexarm.mockup import HingeDesign


def coarse_design(**changes: object) -> HingeDesign:
    """The hinge that ships with flexarm, on a mesh of some thousand freedoms a part, two modes each."""
    shipped = HingeDesign.from_toml()
    return shipped.replace(
        mesh={"size": 0.04, "around": 16}, modes={"housing": 2, "reducer": 2, "hub": 2}, **changes
    )
