"""Figure 2 of Nebel 1998 and the claims about it: the analytical model's part of a reproduction."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from simmpp.common.files import Row, write_csv
from simmpp.common.units import format_ps
from simmpp.config.config import Config
from simmpp.model.analytical import Rays, rays_of
from simmpp.model.border import SAID, border_terms, claims
from simmpp.model.costs import Costs, costs_of
from simmpp.studies.nebel98.figure2_data import (
    ANALYTICAL,
    DEFAULT_RATIOS,
    model_grid,
    model_times,
    rows_of,
    winner_maps,
)
from simmpp.studies.nebel98.verdict import DOES_NOT, HOLDS, PAPER, Verdict
from simmpp.workload.workload import Workload


def reproduce_figure2(config: Config, workload: Workload, out: Path) -> list[Verdict]:
    """Write figure2.csv, figure2.png and figure2.svg; returns the verdicts on F2a and F2b."""
    times = model_times(config, workload, model_grid(config))
    rows = rows_of(times, workload.name, ANALYTICAL, 0.0)
    write_figure2(config, workload, rows, f"Figure 2: analytical model, {workload.name}", out)
    by = _by(costs_of(config.machine_for(config.processors), workload), rays_of(workload))
    return [
        Verdict(
            claim.claim,
            f"{PAPER}figure 2 (model): {SAID[claim.claim]}",
            claim.simulated,
            HOLDS if claim.holds else DOES_NOT,
            by,
        )
        for claim in claims(times)
    ]


def write_figure2(
    config: Config,
    workload: Workload,
    rows: Sequence[Row],
    heading: str,
    out: Path,
    ratios: Sequence[tuple[str, float]] = DEFAULT_RATIOS,
) -> list[Path]:
    """Write ``figure2.csv`` and the maps for several cost ratios; returns the paths of these."""
    # Not at the top: pages, which show the other figures, need no matplotlib.
    from simmpp.studies.nebel98.figure2_plot import draw_figure2

    write_csv(rows, list(rows[0]), out / "figure2.csv")
    return draw_figure2(winner_maps(config, workload, ratios), heading, out)


def _by(costs: Costs, rays: Rays) -> str:
    """The formula of the border (see ``model.border``) with this machine's and scene's numbers."""
    message, saved = border_terms(costs)
    return (
        f"border x = 1 - nb (nb - 1) M / (n S): M = {format_ps(round(message))} per message of "
        f"rays, S = {format_ps(round(saved))} saved per ray that is sent and not served, "
        f"n = {rays.mean_tests:.0f} rays at a step in the mean"
    )
