"""One draw of a placement: owners, residents, pixels."""

from __future__ import annotations

from simmpp.arguments import MOST_COUNT, MOST_SEED, require_whole
from simmpp.placement.owners import owners
from simmpp.placement.pixels import pixel_pes
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.placement.residents import replicas
from simmpp.workload.workload import Workload


def place(
    workload: Workload, processors: int, memory: Memory, rules: PlacementRules, seed: int
) -> Placement:
    """Place a workload on ``processors`` PEs; the same arguments give the same placement.

    Raises ConfigError for a number of PEs or a seed that can't be.
    """
    require_whole("processors", processors, 1, MOST_COUNT)
    require_whole("seed", seed, 0, MOST_SEED)
    owner_of = owners(rules.owners, workload.object_centroids, processors, seed)
    offsets, objects = replicas(workload, owner_of, processors, memory, seed)
    return Placement(
        processors=processors,
        owners=owner_of,
        replica_offsets=offsets,
        replica_objects=objects,
        transient=memory.transient,
        pixel_pes=pixel_pes(rules.pixels, workload.picture, processors, seed),
    )


def draws(memory: Memory, rules: PlacementRules) -> bool:
    """Whether the seed has a part in a placement; otherwise it is the same for every seed."""
    residents = memory.residents == "random" and (memory.bytes is not None or memory.fraction < 1)
    return residents or "random" in (rules.owners, rules.pixels)
