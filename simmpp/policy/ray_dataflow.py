"""Ray dataflow: a ray travels to the owner of the object it needs, objects stay."""

from __future__ import annotations

from simmpp.policy.rules import DataflowPolicy, send_rule


@send_rule
def always(
    load: int, known_load: int, age_ps: int, waiting: int, nothing_else: int, min_load: int
) -> bool:
    """Send every full batch, and all that waits when there is nothing else to do."""
    return True


RAY_DATAFLOW = DataflowPolicy(
    name="ray",
    source="Nebel 1998, sections 2.2 and 3.1 (rays are buffered, one message per processor)",
    may_send=always,
)
