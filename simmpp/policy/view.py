"""What a rule sees: one record, which the engine fills before it asks."""

from __future__ import annotations

from typing import TYPE_CHECKING


class View:
    """What a PE may know when its policy decides; whole numbers (int64), in this order in memory.

    Behind these come the policy's own numbers: every field of ``PolicyParameters`` that holds a
    number, by its name (``view.batch``), a share of n0 / nb as the floor of that many rays. A
    further input is a line here and its value in ``engine.pe.dispatch``.
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
