"""No dataflow: every PE holds the whole scene. The ceiling, but not a bound."""

from __future__ import annotations

from simmpp.policy.policy import Policy

REPLICATED = Policy(
    "replicated",
    "Nebel 1998, section 2 (duplication of the whole scene on every processor)",
    all_resident=True,
)
