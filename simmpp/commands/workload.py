"""``simmpp workload``: what the rays of a picture ask for, and their export to other tools."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np

from simmpp.commands.parts import options
from simmpp.commands.parts.inputs import config_of
from simmpp.commands.parts.tables import table
from simmpp.commands.parts.terminal import OBJECTS_SHOWN, at_work, go_on, say, wrote
from simmpp.commands.parts.tracing import workload
from simmpp.common.errors import ConfigError
from simmpp.common.units import format_bytes
from simmpp.workload.describe import object_uses, primaries, rays_by_depth, rays_by_kind
from simmpp.workload.exchange.columns import WORKLOAD_SUFFIXES, is_workload
from simmpp.workload.exchange.exchange import export_workload
from simmpp.workload.workload import Workload

DEPTHS_SHOWN = 12


@click.command(
    "workload",
    epilog=options.examples(
        "simmpp workload mountain:4 --export mountain4.parquet",
        "simmpp workload configs/quick.yaml --set picture.resolution=32",
    ),
)
@click.argument("spec")
@options.path("--export", "Write it as .parquet or .npz.")
@options.setting(
    "Set a dotted key of the configuration, such as picture.resolution=128; repeatable."
)
@click.option("--objects", "all_objects", is_flag=True, help="List every object, however many.")
@options.no_code
def workload_command(
    spec: str,
    export: Path | None,
    overrides: tuple[str, ...],
    all_objects: bool,
    may_run: bool,
) -> None:
    """List the rays of a picture, and which objects they need.

    SPEC is a scene as `simmpp scene` takes it, a workload file (.parquet or .npz), or a
    configuration (.yaml). --export writes rays and objects as tables that other tools can read
    and `scene: {workload: FILE}` reads back.
    """
    options.writable(export, "--export")
    if export and not is_workload(export.name):
        expected = f"expected a file {' or '.join(WORKLOAD_SUFFIXES)}"
        raise ConfigError(f"--export: value {str(export)!r}: {expected}")
    rays = workload(config_of(spec, overrides, may_run=may_run))
    if export:
        with at_work(f"writing {export}"):
            export_workload(rays, export)
    _list(rays, None if all_objects else OBJECTS_SHOWN)
    if export:
        wrote(export)
        go_on("run", "CONFIG", "--set", f"scene={export}")


def _list(workload: Workload, most_objects: int | None) -> None:
    """Print counts, rays by depth and kind, and objects; the first ones of a long list."""
    tested = len(np.unique(workload.itinerary_objects))
    size = format_bytes(int(workload.object_bytes.sum()))
    depths = rays_by_depth(workload)
    deepest = f", ... to depth {len(depths)}" if len(depths) > DEPTHS_SHOWN else ""
    say(
        f"{workload.name}: {primaries(workload)}, {workload.n_rays} rays in all, "
        f"{workload.n_tests} tests\n"
        f"{workload.n_objects} objects, {size}; {tested} of them tested\n"
        f"rays by depth: {', '.join(map(str, depths[:DEPTHS_SHOWN]))}{deepest}",
    )
    say()
    say(table(rays_by_kind(workload)))
    say()
    say(table(object_uses(workload, most_objects)))
    if most_objects is not None and workload.n_objects > most_objects:
        rest = workload.n_objects - most_objects
        say(f"... and {rest} more objects; --objects lists all")
