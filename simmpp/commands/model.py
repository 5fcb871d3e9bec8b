"""``simmpp model``: the paper's analytical model over nb and x, and its figure 2."""

from __future__ import annotations

import math
from pathlib import Path

import click

from simmpp.commands.parts import options, short_cuts
from simmpp.commands.parts.own_policies import tell_files
from simmpp.commands.parts.tables import table
from simmpp.commands.parts.terminal import at_work, notice, say, wrote
from simmpp.commands.parts.tracing import workload as workload_of
from simmpp.common.errors import ConfigError
from simmpp.common.folders import MODEL
from simmpp.common.units import format_ps
from simmpp.config.config import Config, load_config
from simmpp.model.analytical import Makespans, rays_of
from simmpp.model.border import SAID, borders, claims
from simmpp.model.costs import GROUPS
from simmpp.studies.nebel98.figure2_data import (
    ANALYTICAL,
    DEFAULT_RATIOS,
    MEASURED,
    model_grid,
    model_times,
    rows_of,
)
from simmpp.workload.workload import Workload


@click.command(
    "model",
    epilog=options.examples(
        "simmpp model configs/sweep.yaml",
        "simmpp model configs/sweep.yaml --ratio packing=10 --out results/model",
    ),
)
@options.config_argument
@short_cuts.settings(
    "Set a dotted key; method=analytical-measured feeds the model with measured r.",
    short_cuts.PROCESSORS,
    short_cuts.FRACTION,
    is_swept=True,
)
@click.option(
    "--ratio",
    "ratio_texts",
    multiple=True,
    metavar="NAME=FACTOR",
    help="A further map where startup, packing, object or test takes FACTOR times as long;"
    " repeatable.  [default: packing=100, object=100, test=10]",
)
@click.option(
    "--imbalance",
    type=options.Real("a number from 0 to 1", 0, 1),
    default=0.0,
    show_default=True,
    help="Amplitude of zeta for the numbers; the figure has maps without and with.",
)
@options.path("--out", "Folder for figure2.csv and figure2.")
@options.no_code
def model_command(
    config_path: Path,
    overrides: tuple[str, ...],
    ratio_texts: tuple[str, ...],
    imbalance: float,
    out: Path | None,
    may_run: bool,
) -> None:
    """Say which dataflow the paper's analytical model expects to win.

    It knows the two classical ones, object and ray dataflow. The grid is that of the sweep's axes
    processors and memory.fraction, where there are such, and that of the paper's claims (nb = 8 ...
    1024) otherwise. Rays are those of CONFIG's scene at each step, costs those of its machine.
    --out writes figure2.csv, and figure2.png and .svg: the winner over nb and x for several cost
    ratios, and the border.
    """
    config = load_config(config_path, overrides, may_run=may_run)
    tell_files(config)
    options.claim(out, "--out", MODEL)
    ratios = _ratios(ratio_texts)
    grid = model_grid(config)
    if grid.left_out:
        notice(f"the model takes {', '.join(grid.left_out)} as set outside of the sweep")
    workload = workload_of(config)
    with at_work("evaluating the model"):
        times = model_times(config, workload, grid, imbalance=imbalance)
    method = MEASURED if config.settings.method == MEASURED else ANALYTICAL
    rows = rows_of(times, workload.name, method, 0.0 if method == MEASURED else imbalance)
    columns = ("processors", "fraction", "object_ps", "ray_ps", "ray_over_object", "winner")
    say(_heading(config, workload, method))
    say(table([{n: _cell(n, row[n]) for n in columns} for row in rows], n_keys=2))
    say(_conclusion(times))
    if out is not None:
        # Only --out draws, and matplotlib takes half a second.
        from simmpp.studies.nebel98.figure2 import write_figure2

        machine = config.preset
        heading = f"Analytical model of Nebel 1998, {workload.name}, {machine}"
        with at_work("drawing"):
            files = write_figure2(config, workload, rows, heading, out, ratios)
        wrote(*files)


def _ratios(texts: tuple[str, ...]) -> tuple[tuple[str, float], ...]:
    """``startup=0.1`` as a name and a factor."""
    ratios: list[tuple[str, float]] = []
    for text in texts:
        name, _, number = text.partition("=")
        try:
            factor = float(number)
        except ValueError:
            factor = -1.0
        if name not in GROUPS or not 0 <= factor < math.inf:
            known = ", ".join(GROUPS)
            raise ConfigError(f"--ratio: value {text!r}: expected NAME=FACTOR, a NAME of {known}")
        ratios.append((name, factor))
    return tuple(ratios) or DEFAULT_RATIOS


def _heading(config: Config, workload: Workload, method: str) -> str:
    rays = rays_of(workload)
    return (
        f"{workload.name}: n0 = {workload.n_primaries} rays at the start, {len(rays.tests)} steps, "
        f"{rays.mean_tests:.0f} rays at a step in the mean\n"
        f"machine {config.preset}, method {method}\n"
    )


def _cell(name: str, value: object) -> object:
    if name.endswith("_ps") and isinstance(value, int):
        return format_ps(value)
    return f"{value:.4g}" if isinstance(value, float) else value


def _conclusion(times: Makespans) -> str:
    at = zip(times.processors.tolist(), borders(times).tolist(), strict=True)
    lines = [f"nb = {nb}: the winner changes at x = {x:.3f}" for nb, x in at if x == x]
    for claim in claims(times):
        verdict = "holds" if claim.holds else "does not hold"
        said = f"claim {claim.claim} ({SAID[claim.claim]})"
        lines.append(f"{said} {verdict}: {claim.simulated}")
    return "\n" + "\n".join(lines or ["no change of winner at any nb"])
