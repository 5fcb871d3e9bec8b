"""How many segments of particles a second are followed: `python tests/bench/bench_particles.py`.

On one thread, with the table, tallies and digest; seconds of this process's CPU, the best of
three, for each preset; without the table in brackets.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from simmpp.workload.particles.cells import Cells, long_cells
from simmpp.workload.particles.presets import PRESETS
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.tracer import tallies, trace

CASES = [
    *((name, Particles(count=200_000)) for name in PRESETS),
    ("slab", Particles(count=100_000, capture="implicit")),
    ("shield", Particles(count=50_000, capture="implicit", splitting=True)),
]
REPEATS = 3


def seconds(what: Callable[[], Any]) -> float:
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        what()
        times.append(time.process_time() - start)
    return min(times)


def main() -> None:
    for name, particles in CASES:
        cells = Cells.model_validate(long_cells(name))
        n = trace(cells, particles, threads=1).n_tests
        both = seconds(lambda c=cells, p=particles: trace(c, p, threads=1))
        alone = seconds(lambda c=cells, p=particles: tallies(c, p, threads=1))
        how = particles.capture + (", splitting" if particles.splitting else "")
        print(f"{name}, {how}: {n} segments, {n / both / 1e6:.1f} M/s ({n / alone / 1e6:.1f} M/s)")


if __name__ == "__main__":
    main()
