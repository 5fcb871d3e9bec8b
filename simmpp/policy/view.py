"""What a rule sees: one record, which is filled before each question."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from simmpp.common.compiled import kernel
from simmpp.machine.topology import Network, hops


class View:
    """What a PE may know when its policy decides; whole numbers (int64), in this order in memory.

    Behind these come the policy's own numbers: every field of ``PolicyParameters`` that holds a
    number, by its name (``view.batch``), a share of n0 / nb as the floor of that many rays. A
    further input is a line here and its value in ``show``.
    """

    load: int
    """Rays that this PE holds, ready or waiting."""
    waiting: int
    """Send: rays that wait for objects of the owner and may be sent. Ask: rays that wait for the
    object and that no request covers."""
    nothing_else: int
    """1 if no ray is ready and the inbox is empty, else 0."""
    known_load: int
    """Send: load last heard of the owner; -1: not known (load_info none). Ask: -1."""
    age_ps: int
    """Send: time since that was heard (since the start if never, 0 if exact). Ask: 0."""
    hops: int
    """Links between this PE and the owner, for policies that say ``knows_hops``; else 0."""

    if TYPE_CHECKING:

        def __getattr__(self, number: str) -> int:
            """One of the policy's own numbers."""


@kernel
def show(view: View, s: Any, pe: Any, network: Network, me: int, owner: int, waiting: int) -> None:
    """Fill in what either rule is shown; what it may know of loads is up to the engine.

    ``s`` and ``pe`` are the engine's records of the run and of the PE ``me`` that decides.
    """
    view.load, view.waiting = pe.load, waiting
    if s.knows_hops:
        view.hops = hops(network, me, owner)
