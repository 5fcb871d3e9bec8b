"""Where nothing fits: the least nodes that would do."""

from __future__ import annotations

from simmpp.common.errors import ConfigError
from simmpp.config.config import Config
from simmpp.studies.advise.candidates import Candidate, candidates_on
from simmpp.workload.workload import Workload

MOST_NODES = 4096
"""More are not looked at. ESTIMATE: parts of a scene are not cut smaller."""


def least_nodes(config: Config, workload: Workload, beyond: int) -> Candidate | None:
    """The candidate that fits on the fewest nodes, of doublings of what was asked for.

    None if there is none, or no such machine.
    """
    size = 2 * beyond
    while size <= MOST_NODES:
        try:
            found = [each for each in candidates_on(config, workload, size) if each.fits]
        except ConfigError:  # the machine has no more
            return None
        if found:
            return min(found, key=lambda each: (each.least_bytes, each.order))
        size *= 2
    return None
