"""The policies that a configuration can name: one line each."""

from __future__ import annotations

from simmpp.policy.concurrent import CONCURRENT_DATAFLOW
from simmpp.policy.object_dataflow import OBJECT_DATAFLOW
from simmpp.policy.ray_dataflow import RAY_DATAFLOW
from simmpp.policy.replicated import REPLICATED
from simmpp.policy.rules import DataflowPolicy

POLICIES: dict[str, DataflowPolicy] = {
    "object": OBJECT_DATAFLOW,
    "ray": RAY_DATAFLOW,
    "concurrent": CONCURRENT_DATAFLOW,
    "replicated": REPLICATED,
}
REFERENCE, CEILING = "object", "replicated"
"""Run with every point: what profits are measured against, and no dataflow at all."""
DEFAULT_POLICY = "concurrent"
"""What a configuration that names none compares with object dataflow."""
