"""Do the parts of a run fit together? Compiled code does not look where it reads."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import is_dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError, WorkloadError
from simmpp.common.validate import MOST_COUNT, require_whole, require_word
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.machine import SERVICES, Machine
from simmpp.machine.topology import topology_of
from simmpp.machine.torus import CONTENTIONS
from simmpp.machine.uneven import check_unlike
from simmpp.placement.placement import Placement
from simmpp.workload.check import first_gap, is_cut
from simmpp.workload.workload import MOST_TEST_SCALE, Workload


def check_fit(workload: Workload, machine: Machine, placement: Placement) -> None:
    """Raise WorkloadError or ConfigError for what a run would trip over.

    Only what the engines rely on, in milliseconds; files are checked whole when they are read.
    """
    _check_workload(workload)
    _check_machine(machine)
    _check_placement(workload, machine, placement)


def _check_workload(workload: Workload) -> None:
    n, n_objects = workload.n_rays, workload.n_objects
    fits = {
        "child_offsets": is_cut(workload.child_offsets, n, workload.n_primaries, n),
        "itinerary_offsets": is_cut(workload.itinerary_offsets, n, 0, workload.n_tests),
        "root_rounds": len(workload.root_rounds) in (0, workload.n_primaries)
        and first_gap(workload.root_rounds) < 0,
        "itinerary_objects": _lie_below(workload.itinerary_objects, n_objects),
        "object_bytes": len(workload.object_bytes) == n_objects,
        "object_triangles": len(workload.object_triangles) == n_objects,
        "object_test_ps": len(workload.object_test_ps) in (0, n_objects),
        "ray_test_scales": len(workload.ray_test_scales) in (0, n)
        and int(workload.ray_test_scales.max(initial=0)) <= MOST_TEST_SCALE,
    }
    for name, does in fits.items():
        if not does:
            raise WorkloadError(f"{name} does not fit the rays and objects", where=workload.name)


def _check_machine(machine: Machine) -> None:
    for value in _numbers(machine):
        require_whole(f"machine {machine.name}", value, 0, CLOCK_LIMIT_PS)
    require_word(f"machine {machine.name}: contention", machine.contention, CONTENTIONS)
    require_word(f"machine {machine.name}: service", machine.service, SERVICES)
    if not 1 <= machine.quantum <= MOST_COUNT or min(machine.shape) < 1:
        raise ConfigError(f"machine {machine.name}: expected a quantum and a shape of at least 1")
    require_whole(f"machine {machine.name}: least_tests", machine.least_tests, 0)
    check_unlike(machine.speed, machine.noise, machine.straggler, machine.processors)
    topology_of(machine)  # looks itself


def _numbers(value: object) -> Iterator[object]:
    """What a machine is made of, but for words."""
    if is_dataclass(value):
        for part in vars(value).values():
            yield from _numbers(part)
    elif isinstance(value, tuple):
        for part in value:
            yield from _numbers(part)
    elif not isinstance(value, str | dict):
        yield value


def _check_placement(workload: Workload, machine: Machine, placement: Placement) -> None:
    nb, n_objects = machine.processors, workload.n_objects
    if placement.processors != nb:
        raise ConfigError(f"the placement is for {placement.processors} PEs, the machine has {nb}")
    n_replicas = len(placement.replica_objects)
    fits = {
        "islands": placement.islands >= 1 and nb % placement.islands == 0,
        "owners": len(placement.owners) == n_objects
        and _lie_below(placement.owners, nb // max(placement.islands, 1)),
        "replica_offsets": is_cut(placement.replica_offsets, nb, 0, n_replicas),
        "replica_objects": _lie_below(placement.replica_objects, n_objects),
        "pixel_pes": len(placement.pixel_pes) == workload.n_primaries
        and _lie_below(placement.pixel_pes, nb),
        "window": placement.window >= 1,
        "transient": min(placement.transient, placement.transient_bytes) >= 0,
    }
    for name, does in fits.items():
        if not does:
            raise ConfigError(
                f"the placement's {name} does not fit {nb} PEs, {n_objects} objects "
                f"and {workload.n_primaries} primary rays"
            )


def _lie_below(ids: NDArray[np.signedinteger], end: int) -> bool:
    return len(ids) == 0 or bool(ids.min() >= 0 and ids.max() < end)
