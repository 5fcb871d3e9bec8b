"""Ray dataflow: a ray travels to the owner of the object it needs, objects stay."""

from __future__ import annotations

from simmpp.policy.rules import DataflowPolicy
from simmpp.policy.view import View


def in_batches(view: View) -> bool:
    """Send every full batch, and all that waits when there is nothing else to do."""
    return view.waiting >= view.batch or view.nothing_else != 0


RAY_DATAFLOW = DataflowPolicy(
    name="ray",
    source="Nebel 1998, sections 2.2 and 3.1 (rays are buffered, one message per processor)",
    may_send=in_batches,
    send_from="batch",
)
