"""One process of the comparison: solves the cases given as JSON and prints what came out, as JSON.

python worker.py '{"code": "flexarm", "solves": 3, "cases": [{"elements": 2, "steps": 3000, "end": 20}]}'
"""

import importlib
import json
import sys


def main():
    """Solve each case `solves` times with a model built anew; the last line printed is the result."""
    order = json.loads(sys.argv[1])
    code = order["code"]
    solver = importlib.import_module("solve_flexarm" if code == "flexarm" else "solve_exudyn")
    results = []
    for case in order["cases"]:
        try:
            runs = [solver.solve({"code": code, **case}) for _ in range(order.get("solves", 1))]
        except Exception as failure:  # EXUDYN's errors have no common type; a setting that fails is a result
            results.append({"failed": str(failure)})
            continue
        results.append({**runs[0], "cpu": [run["cpu"] for run in runs]})
    print(json.dumps({"version": solver.version(), "results": results}))


if __name__ == "__main__":
    main()
