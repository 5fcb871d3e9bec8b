"""Ray dataflow: a ray travels to the owner of the object it needs, objects stay."""

from __future__ import annotations

from simmpp.policy.policy import Policy, hook
from simmpp.policy.view import View


@hook
def in_batches(v: View) -> int:
    """Send all that waits: this is asked for full batches, or when nothing else is to do."""
    return v.waiting


RAY_DATAFLOW = Policy(
    "ray",
    "Nebel 1998, sections 2.2 and 3.1 (rays are buffered, one message per processor)",
    send=in_batches,
    batch="batch",
)
