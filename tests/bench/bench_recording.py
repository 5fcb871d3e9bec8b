"""What it costs to watch a run: its event log, counters for pictures, timelines in files.

    python tests/bench/bench_recording.py [PIXELS [PEs]]

Mountain5, 512 x 512, a tenth of the scene on each of 64 PEs. Ratios are of CPU seconds in one
process, the least of 25 runs each, taken in turns; "nothing again" is what noise does to them.
Sizes are of the files that were written.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from pathlib import Path

import simmpp
from simmpp.engine.record.log import Sink
from simmpp.engine.record.recording import Recording
from simmpp.report.timeline.recorder import SUFFIXES, TimelineRecorder
from simmpp.run.point import PolicyRun

REPEATS = 25


def main(pixels: int = 512, processors: int = 64) -> None:
    """Print the costs, then the files."""
    workload = simmpp.trace(simmpp.load_scene("mountain:5"), simmpp.Picture(resolution=pixels))
    machine = simmpp.make_machine("t3e", processors=processors)
    placement = simmpp.place(workload, processors, simmpp.Memory(), simmpp.PlacementRules(), seed=0)

    def run(policy: simmpp.PolicyParameters, noted: Recording) -> tuple[float, simmpp.Result]:
        began_s = time.process_time()
        result = simmpp.simulate(workload, machine, placement, policy, record=noted)
        return time.process_time() - began_s, result

    records = {
        "nothing": Recording(),
        "event log": Recording(log=ignore),
        "counters": Recording(counters=True),
        "counters, hops of rays": Recording(counters=True, hops=True),
        "nothing again": Recording(),
    }
    for name in ("object", "ray", "concurrent"):
        policy = simmpp.PolicyParameters(name)
        cpu_s: dict[str, list[float]] = {record: [] for record in records}
        for _ in range(REPEATS):
            for record, noted in records.items():
                cpu_s[record].append(run(policy, noted)[0])
        base_s = min(cpu_s["nothing"])
        costs = [f"{r} {min(s) / base_s - 1:+.1%}" for r, s in cpu_s.items()][1:]
        print(f"{name:10} {base_s:.3f} s; {', '.join(costs)}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            for suffix in SUFFIXES:
                path = Path(folder, f"timeline{suffix}")
                recorder = TimelineRecorder(path, machine)
                sink: Sink = recorder.begin(policy)
                spent_s, result = run(policy, Recording(log=sink))
                recorder.end(PolicyRun(policy, result, named=True, wall_s=0.0))
                recorder.close()
                print(f"  {suffix:8} {path.stat().st_size / 1e6:7.1f} MB, {spent_s:.2f} CPU s")
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(f"peak {peak_mb:.0f} MB")


def ignore(rows: object) -> None:
    """A sink for which nothing has to be done."""


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
