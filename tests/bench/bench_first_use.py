"""What the first use costs, and the second: python tests/bench/bench_first_use.py [TIMES]

Runs `simmpp run configs/quick.yaml` with nothing kept, then with all that this has kept, and prints
seconds by the clock and of the processors, those of processes beside included. Then compiles all
once more on one core, where no process is beside, and counts. Asserts nothing.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

QUICK = Path(__file__).parents[2] / "configs" / "quick.yaml"
TIMES = 3
COUNT = "count"


def run(cache: str, *command: str) -> tuple[float, float]:
    """Seconds by the clock and of the processors."""
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment["SIMMPP_CACHE"] = cache
    before, began_s = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, *command], env=environment, stdout=subprocess.DEVNULL)
    wall_s, after = time.perf_counter() - began_s, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def count() -> None:
    """Run in this process and on one core; say on the error output what numba has compiled."""
    from numba.core import event

    from simmpp.cli import main

    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, list(os.sched_getaffinity(0))[:1])
    sys.argv = ["simmpp", "run", str(QUICK)]
    with event.install_recorder("numba:compile") as recorder, suppress(SystemExit):
        main()
    compiled = Counter(
        entry.data["dispatcher"].py_func.__module__ + "." + entry.data["dispatcher"].__name__
        for _, entry in recorder.buffer
        if entry.is_start
    )
    ours = {name: n for name, n in compiled.items() if name.startswith("simmpp.")}
    more = {name: n for name, n in ours.items() if n > 1}
    print(
        f"{compiled.total()} compilations, {sum(ours.values())} of {len(ours)} functions "
        f"of simmpp; more than once: {more}",
        file=sys.stderr,
    )


def main() -> None:
    if sys.argv[1:] == [COUNT]:
        return count()
    command = "-m", "simmpp", "run", str(QUICK)
    for _ in range(int(sys.argv[1]) if sys.argv[1:] else TIMES):
        with tempfile.TemporaryDirectory() as cache:
            for use in ("first", "second"):
                wall_s, cpu_s = run(cache, *command)
                print(f"{use:<7}{wall_s:7.1f} s by the clock {cpu_s:7.1f} s of the processors")
    with tempfile.TemporaryDirectory() as cache:
        run(cache, __file__, COUNT)


if __name__ == "__main__":
    main()
