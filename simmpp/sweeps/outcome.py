"""What a simulation leaves behind: the integers of its row, or why it failed."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Outcome:
    """One finished task."""

    key: str
    """The task's."""
    numbers: dict[str, int] = field(default_factory=dict)
    """The integers of its row by column; empty if it failed."""
    effective_fraction: float = 0.0
    wall_s: float = 0.0
    """Placement + event loop."""
    cpu_s: float = 0.0
    """The same on the processor, whatever else runs beside it."""
    error: str = ""
    """One line; empty if all went well."""
