"""What PEs held, as lines of the table of ``run``."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from simmpp.common.units import format_bytes
from simmpp.run.point import PolicyRun

Cell = Callable[[PolicyRun], str]


def memory_lines(runs: Sequence[PolicyRun]) -> list[tuple[str, Cell]]:
    """The most that a PE holds; with a capacity what it was, and what the capacity kept from."""
    if any(run.result.memory is None for run in runs):
        return [
            ("most bytes on a PE", lambda run: format_bytes(run.result.peak_bytes)),
            ("  of objects", lambda run: format_bytes(run.result.peak_object_bytes)),
        ]
    parts = {
        "objects for good": "peak_resident",
        "fetched objects": "peak_fetched",
        "rays, and what may come of them": "peak_ray_queue",
        "rays received": "peak_receive",
    }

    def of(*names: str) -> Callable[[PolicyRun], int]:
        return lambda run: sum(getattr(run.result.memory, name) for name in names)

    def cell(name: str) -> Cell:
        return lambda run: format_bytes(of(name)(run))

    return [
        ("the fullest PE", lambda run: format_bytes(of(*parts.values())(run))),
        *((f"  {part}", cell(name)) for part, name in parts.items()),
        ("escapes", lambda run: f"{of('escapes')(run)}"),
        ("messages of credit", lambda run: f"{of('credit_messages')(run)}"),
        ("without credit", lambda run: f"{_of_all_pes(run, of('stalled_send_ps')(run)):.1%}"),
        ("without room to ask", lambda run: f"{_of_all_pes(run, of('stalled_ask_ps')(run)):.1%}"),
    ]


def _of_all_pes(run: PolicyRun, time_ps: int) -> float:
    """A sum of times over all PEs as a share of the makespan."""
    return time_ps / max(run.result.makespan_ps * len(run.result.compute_ps), 1)
