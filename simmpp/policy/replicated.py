"""No dataflow: every PE holds the whole scene. The ceiling, but not a bound."""

from __future__ import annotations

from simmpp.policy.rules import DataflowPolicy

REPLICATED = DataflowPolicy(
    name="replicated",
    source="Nebel 1998, section 2 (duplication of the whole scene on every processor)",
    all_resident=True,
)
