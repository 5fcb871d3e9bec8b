"""The state of a machine that stands still, in words."""

from __future__ import annotations

from simmpp.engine.state import State


def starved(state: State) -> str:
    """What to say when rays are left and nothing is scheduled: a bug, or a policy that starves."""
    load = state.pes["load"]
    holders = [f"PE {k}: {load[k]} rays, all waiting" for k in load.nonzero()[0][:5]]
    return (
        f"{state['rays_left']} rays are left and nothing is scheduled "
        f"after {state['tests']} tests: {'; '.join(holders)}"
    )
