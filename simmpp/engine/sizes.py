"""How much room a run needs, before it begins."""

from __future__ import annotations

import numpy as np

from simmpp.engine.arrays.layout import Sizes
from simmpp.engine.record.log import LOG_ROWS
from simmpp.engine.record.recording import Recording
from simmpp.engine.tables.tallies import sends_deposits
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload


def sizes_of(
    workload: Workload, placement: Placement, parameters: PolicyParameters, recording: Recording
) -> Sizes:
    """Upper bounds of a run, as far as its arrays can't grow."""
    nb, n_objects, n_rays = placement.processors, workload.n_objects, workload.n_rays
    # One step sends at most a request per object (per ray, unmerged), a batch and a load per PE.
    sent = (n_objects if parameters.merge_requests else n_rays) + 2 * nb + 2  # and an escape
    leaves = sends_deposits(workload, placement)
    sent += nb if leaves else 0  # a batch of deposits as well
    each = placement.island if parameters.rules.to_holders else 1  # PEs that a ray may go to
    known = nb * placement.island
    talks = parameters.rules.talks or parameters.steals or leaves
    pairs = known if talks else min(known, 2 * workload.n_tests * each)
    return Sizes(
        nb=nb,
        island=placement.island,
        objects=n_objects,
        rays=n_rays,
        misses=1 + min(nb * n_objects, n_rays + nb * (_most_kept(workload, placement) + 1)),
        peers=1 + pairs,
        sent=sent,
        messages=2 * min(sent, n_objects + 2 * nb + 2),  # so that one more step finds room
        deposits=leaves,
        talks=parameters.rules.talks,
        steals=parameters.steals,
        tested=workload.n_tests if recording.tests else 0,
        ended=n_rays if recording.ends else 0,
        logged=2 * LOG_ROWS + sent if recording.sink is not None else 0,
        counted=nb if recording.counters else 0,
        bounded=placement.capacity is not None and placement.capacity.has_credits,
        measured=placement.capacity is not None,
    )


def _most_kept(workload: Workload, placement: Placement) -> int:
    """Fetched objects that a PE keeps at most."""
    if not placement.transient_bytes:
        return placement.transient
    smallest_first = np.cumsum(np.sort(workload.object_bytes))
    return int(np.searchsorted(smallest_first, placement.transient_bytes, side="right"))
