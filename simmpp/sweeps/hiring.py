"""The crew that a user asks for: this process, others beside it, or a cluster."""

from __future__ import annotations

from simmpp.sweeps.cluster import Cluster
from simmpp.sweeps.crew import Crew, Here
from simmpp.sweeps.processes import Processes


def crew_for(workers: int, cluster: str | None) -> Crew:
    """A cluster's workers, or that many processes; one works right here.

    Raises ConfigError if there is no such cluster.
    """
    if cluster is not None:
        return Cluster(cluster)
    return Crew(Here(), 1) if workers == 1 else Processes(workers)
