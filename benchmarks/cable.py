"""Cost of the pin-jointed cable model: S-720, one ply, 250 us, one core (thesis Table 4-3), beside the shell.

    python benchmarks/cable.py [repetitions]

Prints medians of marching time; compilation and the filling of the cell's table are not in them.
"""

import sys
from dataclasses import replace
from statistics import median

from shell import machine

from fabrics import catalogue
from shellfabric.impact import simulation
from validation.models.cable.model import CableNet, CableNumerics
from validation.models.cable.solver import run

THESIS = {"cable": 1243.0, "shell": 1932.0}  # [s], Table 4-3, on one processor of its day


def row(name, cells, steps, times, source):
    wall = median(times)
    per = 1e9 * wall / (cells * steps)
    print(f"{name:34s} {cells:7d} {steps:6d} {wall:9.3f} {per:8.2f} {min(times):9.3f} {THESIS[source]:8.0f}")
    return wall


def main(repetitions=7):
    print("; ".join(f"{name} {value}" for name, value in machine().items()))
    setup = simulation.ImpactSetup(catalogue.load("S-720").with_effective_density(), 100.0, end_time=250e-6)
    print(f"{'S-720 at 100 m/s, 250 us, quarter':34s} {'parts':>7s} {'steps':>6s} {'median s':>9s} {'ns/part':>8s} "
          f"{'best s':>9s} {'thesis s':>8s}")  # fmt: skip
    for cfl in (0.4, 0.9):
        net = CableNet.of(setup, numerics=CableNumerics(cfl=cfl))
        results = [run(net, 100.0, 250e-6) for _ in range(repetitions)]
        wall = row(
            f"net, bars, step {cfl} of the bound",
            net.bars,
            results[0].steps,
            [r.wall_time for r in results],
            "cable",
        )
        print(f"    energy balance off by {100 * results[0].energy_error_max:.2f} % of the strike energy")
    for model in ("decoupled", "compressible"):
        results = [simulation.run(replace(setup, cell_model=model)) for _ in range(repetitions)]
        cells = results[0].panel.elements
        shell = row(f"shell, elements, {model}", cells, results[0].steps, [r.wall_time for r in results], "shell")
        print(f"    shell over net {shell / wall:.2f} at 0.9 of the bound each (thesis {1932 / 1243:.2f})")


if __name__ == "__main__":
    main(*(int(text) for text in sys.argv[1:]))
