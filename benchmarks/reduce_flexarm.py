"""The ring reduced by flexarm's core: assembly of K and M, then `reduce_part`."""

import ring

from flexarm import _core


def assemble(part, threads):
    """K and M of a mesh, lower triangles."""
    return _core.assemble_solids(part.core(), threads=threads)


def reduce(part, K, M, modes=ring.MODES):
    """Craig-Bampton with its quality numbers and recovery."""
    faces = [
        _core.Interface(
            name,
            position=position,
            rotation=[[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            points=part.point_set(name),
            kind=_core.InterfaceKind.rigid,
        )
        for name, position in ring.FACES.items()
    ]
    return _core.reduce_part(K, M, part.points, faces, modes=modes)


def statistics(reduced):
    """Where the seconds of `reduce_part` went, by which libraries."""
    phases = ("check", "factor", "interfaces", "modes", "matrices", "quality")
    report, factor = reduced.statistics, reduced.statistics.factor
    return {
        "seconds": {phase: getattr(report, f"seconds_{phase}") for phase in phases}
        | {"ordering": factor.seconds_ordering, "numeric": factor.seconds_factor, "all": report.seconds},
        "factor": {name: getattr(factor, name) for name in ("backend", "ordering", "blas")},
        "entries": {name: getattr(factor, name) for name in ("entries", "entries_amd", "entries_metis")},
        "operations": factor.operations,
        "lanczos": {"steps": report.lanczos_steps, "block": report.lanczos_block},
        "freedoms": {"all": report.n_freedoms, "inner": report.n_inner},
    }


def version():
    """Of flexarm and its core."""
    core = _core.build_info()
    return {"flexarm": core.version, "git": core.git, "solver": core.solver, "compiler": core.compiler}
