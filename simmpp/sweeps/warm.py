"""The first run of a process loads or makes the compiled code; here it is one that isn't timed."""

from __future__ import annotations

from functools import cache

import numpy as np

from simmpp.engine.simulate import simulate
from simmpp.machine.presets import machine
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import SPHERE, Workload

PROCESSORS = N_OBJECTS = 2


@cache
def warm_up(engine: str) -> None:
    """Simulate the smallest machine that sends messages, once per process."""
    placement = place(_WORKLOAD, PROCESSORS, Memory(), PlacementRules(), seed=0)
    policy = PolicyParameters("concurrent")
    simulate(_WORKLOAD, machine(processors=PROCESSORS), placement, policy, engine=engine)


_WORKLOAD = Workload(
    name="two rays",
    digest="",
    picture=(1, 2),
    kinds=np.zeros(2, np.uint8),
    parents=np.full(2, -1, np.int32),
    child_offsets=np.full(3, 2, np.int32),
    pixels=np.arange(2, dtype=np.int32),
    hits=np.array([1, 0], np.int32),
    hit_distances=np.ones(2),
    itinerary_offsets=np.arange(3),
    itinerary_objects=np.array([1, 0], np.int32),
    object_kinds=np.full(N_OBJECTS, SPHERE, np.uint8),
    object_triangles=np.zeros(N_OBJECTS, np.int32),
    object_bytes=np.full(N_OBJECTS, 100),
    object_centroids=np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
)
"""Each ray starts at one PE and needs the object of the other."""
