"""The policies of the package, by name.

A further one is a file like ``concurrent``, and a line here.
"""

from __future__ import annotations

from simmpp.policy.concurrent import CONCURRENT_DATAFLOW
from simmpp.policy.cost import COST
from simmpp.policy.holders import HOLDERS
from simmpp.policy.object_dataflow import OBJECT_DATAFLOW
from simmpp.policy.policy import Policy
from simmpp.policy.ray_dataflow import RAY_DATAFLOW
from simmpp.policy.replicated import REPLICATED

POLICIES: dict[str, Policy] = {
    "object": OBJECT_DATAFLOW,
    "ray": RAY_DATAFLOW,
    "concurrent": CONCURRENT_DATAFLOW,
    "replicated": REPLICATED,
    "holders": HOLDERS,
    "cost": COST,
}
REFERENCE, CEILING = "object", "replicated"
"""Run with every point: what profits are measured against, and no dataflow at all."""
CLASSICAL = ("object", "ray")
"""The dataflows that the paper joins; the faster of them is what a further one has to beat."""
DEFAULT_POLICY = "concurrent"
"""What a configuration that names none compares with object dataflow."""
