"""One process of the reduction benchmark: one code, one size; prints its cost as JSON.

python reduce_worker.py '{"code": "flexarm", "size": "10k", "threads": 1, "file": "K.npz", "out": "out.npz"}'

Codes: write (the file for the others), flexarm, scipy, scipy-skilled, exudyn. `out` gets frequencies and
reduced matrices.
"""

import json
import sys
import time

import numpy as np


class Clock:
    """CPU and wall seconds of named stretches."""

    def __init__(self):
        self.seconds = {}

    def time(self, name, work):
        """What `work()` returns."""
        cpu, wall = time.process_time(), time.perf_counter()
        result = work()
        self.seconds[name] = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}
        return result


def run_flexarm(order, clock):
    """Mesh, assembly, reduction."""
    import reduce_flexarm as code
    import ring

    part = clock.time("mesh", lambda: ring.mesh(order["size"]))
    K, M = clock.time("assembly", lambda: code.assemble(part, order["threads"]))
    reduced = clock.time("reduction", lambda: code.reduce(part, K, M))
    result = reduced.frequency_hz, reduced.stiffness, reduced.mass
    return result, code.version(), code.statistics(reduced)


def run_scipy(order, clock):
    """Reduction of matrices read from a file."""
    import reduce_scipy as code
    from ring import Part

    part = clock.time("read", lambda: Part(order["file"]))
    skilled = order["code"] == "scipy-skilled"
    return clock.time("reduction", lambda: code.reduce(part, skilled)), code.version(), {}


def run_exudyn(order, clock):
    """The same."""
    import reduce_exudyn as code
    from ring import Part

    part = clock.time("read", lambda: Part(order["file"]))
    fem = code.prepare(part)
    clock.time("reduction", lambda: code.compute(fem, part))
    return code.result(fem, part), code.version(), {}


CODES = {"flexarm": run_flexarm, "scipy": run_scipy, "scipy-skilled": run_scipy, "exudyn": run_exudyn}


def main():
    """The last line printed is the answer."""
    order, clock = json.loads(sys.argv[1]), Clock()
    if order["code"] == "write":
        import ring

        ring.write(order["size"], order["file"])
        print(json.dumps({}))
        return
    (frequency, stiffness, mass), version, statistics = CODES[order["code"]](order, clock)
    np.savez(order["out"], frequency=frequency, stiffness=stiffness, mass=mass)
    print(json.dumps({"seconds": clock.seconds, "version": version, "statistics": statistics}))


if __name__ == "__main__":
    main()
