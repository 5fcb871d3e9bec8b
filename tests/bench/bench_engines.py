"""How many messages a second each engine simulates: `python tests/bench/bench_engines.py`.

Two loads. *Exchanges*: PEs fetch objects of pseudo-random owners one after the other, 64-byte
requests and 1 KiB replies, startups and packing charged: nothing but messages. *Mountain5*: object
dataflow on the paper's picture, 64 PEs, a tenth of the scene each. The ratio of the engines is
measured in one process, so it holds on any machine; the rates do not.
"""

from __future__ import annotations

import math
import resource
import time
from dataclasses import replace
from fractions import Fraction
from typing import get_args

import numpy as np

import simmpp
from simmpp.engine.result import Result
from simmpp.machine.machine import Machine
from simmpp.machine.torus import CONTENTIONS, LINKS
from simmpp.placement.placement import Placement
from simmpp.policy.policy import Packing
from simmpp.workload.cache.store import workload_for
from simmpp.workload.workload import SPHERE, Workload

EXCHANGES = 128_000
REPEATS = 3
PACKINGS: tuple[Packing, ...] = get_args(Packing)


def exchanges(processors: int) -> tuple[Workload, Machine, Placement]:
    """One ray per PE that needs a long row of remote objects, one object per PE."""
    each = EXCHANGES // processors
    me = np.arange(processors)[:, None]
    offset = np.random.default_rng(1).integers(1, processors, (processors, each))
    workload = Workload(
        name="exchanges",
        digest="exchanges",
        picture=(1, processors),
        kinds=np.zeros(processors, np.uint8),
        parents=np.full(processors, -1, np.int32),
        child_offsets=np.full(processors + 1, processors, np.int32),
        pixels=np.arange(processors, dtype=np.int32),
        hits=np.full(processors, -1, np.int32),
        hit_distances=np.full(processors, np.inf),
        itinerary_offsets=np.arange(processors + 1, dtype=np.int64) * each,
        itinerary_objects=((me + offset) % processors).astype(np.int32).reshape(-1),
        object_kinds=np.full(processors, SPHERE, np.uint8),
        object_triangles=np.zeros(processors, np.int32),
        object_bytes=np.full(processors, 1024 - 64, np.int64),
        object_centroids=np.zeros((processors, 3)),
    )
    machine = replace(simmpp.make_machine(processors=processors), request_bytes=0)
    placement = Placement(
        processors=processors,
        owners=np.arange(processors, dtype=np.int32),
        replica_offsets=np.zeros(processors + 1, np.int64),
        replica_objects=np.zeros(0, np.int32),
        transient=0,
        pixel_pes=np.arange(processors, dtype=np.int32),
    )
    return workload, machine, placement


def mountain5(processors: int, resolution: int = 512) -> tuple[Workload, Machine, Placement]:
    """The paper's picture."""
    picture = simmpp.Picture(resolution=resolution)
    workload = workload_for(simmpp.load_scene("mountain:5"), picture)
    memory = simmpp.Memory(fraction=Fraction(1, 10))
    placement = simmpp.place(workload, processors, memory, simmpp.PlacementRules(), 0)
    return workload, simmpp.make_machine(processors=processors), placement


def best_s(engine: str, case: tuple[Workload, Machine, Placement]) -> tuple[float, Result]:
    """The shortest of some runs of object dataflow, in CPU seconds."""
    runs = [run_s(engine, case, "object") for _ in range(REPEATS)]
    return min(seconds for seconds, _ in runs), runs[0][1]


def run_s(
    engine: str,
    case: tuple[Workload, Machine, Placement],
    policy: str,
    packing: Packing = "none",
) -> tuple[float, Result]:
    """One run and its CPU seconds."""
    parameters = simmpp.PolicyParameters(policy, packing=packing)
    began_s = time.process_time()
    result = simmpp.simulate(*case, parameters, engine=engine)
    return time.process_time() - began_s, result


def main() -> None:
    """Print a line per load and number of PEs."""
    for engine in ("simpy", "compiled"):  # compile first
        simmpp.simulate(*exchanges(2), simmpp.PolicyParameters("object"), engine=engine)
    print("load       PEs    messages  compiled/s     simpy/s   ratio   peak MB")
    for load, sizes in ((exchanges, (64, 512, 4096)), (mountain5, (64,))):
        for processors in sizes:
            case = load(processors)
            fast_s, result = best_s("compiled", case)
            slow_s, same = best_s("simpy", case)
            if (result.makespan_ps, result.events) != (same.makespan_ps, same.events):
                raise SystemExit("the engines differ")
            peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
            print(
                f"{load.__name__:9} {processors:5} {result.messages:10} "
                f"{result.messages / fast_s:12,.0f} {result.messages / slow_s:11,.0f} "
                f"{slow_s / fast_s:7.1f} {peak_mb:9}"
            )


def growth() -> None:
    """How time grows with the machine at equal work, and with the work on an equal machine."""
    print("\nobject dataflow, Mountain5, compiled\nPEs    pixels     messages  seconds  peak MB")
    machines = [(processors, 512) for processors in (64, 256, 1024, 4096, 16384)]
    pictures = [(64, resolution) for resolution in (64, 128, 256, 512, 1024)]
    for processors, resolution in machines + pictures:
        seconds, result = best_s("compiled", mountain5(processors, resolution))
        peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        print(
            f"{processors:5} {resolution:5}^2 {result.messages:12} {seconds:8.3f} {peak_mb:8}",
        )


def contention() -> None:
    """What links and ports cost: the shortest of runs without and with them, in turns."""
    print(
        "\nlinks, ports, compiled\nload      policy        PEs   messages     none    links  ratio"
    )
    loads = [(exchanges, "object", processors) for processors in (64, 512, 4096)]
    loads += [(mountain5, policy, 64) for policy in ("object", "ray", "concurrent")]
    for load, policy, processors in loads:
        workload, machine, placement = load(processors)
        machines = [replace(machine, contention=each) for each in CONTENTIONS]
        times: list[list[float]] = [[], []]
        for _ in range(2 * REPEATS):  # alternately, as others use the processor too
            for each, found in zip(machines, times, strict=True):
                seconds, result = run_s("compiled", (workload, each, placement), policy)
                found.append(seconds)
        none_s, links_s = map(min, times)
        print(
            f"{load.__name__:9} {policy:11} {processors:5} {result.messages:10} "
            f"{none_s:8.3f} {links_s:8.3f} {links_s / none_s:6.2f}"
        )


def features() -> None:
    """What features cost that change little or nothing, each run in turns with one without any.

    ``capacity`` is one that never binds: credits are kept, and none is ever refused.
    """
    print("\nfeatures, Mountain5, compiled: CPU time / that of a run without them")
    workload, machine, placement = mountain5(64, 256)
    ample = simmpp.Memory(fraction=Fraction(1, 10), capacity="100 GB")
    bounded = simmpp.place(workload, 64, ample, simmpp.PlacementRules(), 0)
    cases = {
        "none": (workload, machine, placement),
        "capacity": (workload, machine, bounded),
        "links": (workload, replace(machine, contention=LINKS), placement),
        "thread": (workload, replace(machine, service="thread"), placement),
        "nic": (workload, replace(machine, service="nic"), placement),
        "noise": (workload, replace(machine, noise="1%"), placement),
    }
    print(f"{'policy':11}", *(f"{name:>9}" for name in cases))
    for policy in ("object", "ray", "concurrent", "holders"):
        times = dict.fromkeys(cases, math.inf)
        for _ in range(2 * REPEATS):
            for name, case in cases.items():
                times[name] = min(times[name], run_s("compiled", case, policy)[0])
        ratios = (f"{seconds / times['none']:9.3f}" for seconds in times.values())
        print(f"{policy:11}", *ratios)


def packing() -> None:
    """What messages of several parts cost, alternately with those of one; the shortest of runs."""
    print(
        "\npacking, Mountain5, compiled\npolicy      packing    messages     parts  seconds   ratio"
    )
    case = mountain5(64)
    for policy, packings in (("object", PACKINGS[:2]), ("concurrent", PACKINGS)):
        times: dict[Packing, float] = dict.fromkeys(packings, math.inf)
        results: dict[Packing, Result] = {}
        for _ in range(2 * REPEATS):
            for how in packings:
                seconds, results[how] = run_s("compiled", case, policy, how)
                times[how] = min(times[how], seconds)
        for how, result in results.items():
            print(
                f"{policy:11} {how:9} {result.messages:9} {result.parts:9} "
                f"{times[how]:8.3f} {times[how] / times['none']:7.2f}"
            )


if __name__ == "__main__":
    main()
    features()
    packing()
    contention()
    growth()
