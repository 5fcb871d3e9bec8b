"""The table that ``simmpp run --results`` writes: what comes of the rays, object by object."""

from __future__ import annotations

from pathlib import Path

from simmpp.commands.parts import options
from simmpp.commands.parts.terminal import at_work
from simmpp.common.errors import ConfigError
from simmpp.common.files import write_csv, write_parquet
from simmpp.run.point import Point
from simmpp.workload.tallies import table_of, tally_of

WRITERS = {".csv": write_csv, ".parquet": write_parquet}


def check_results(path: Path | None) -> None:
    """Raise ConfigError unless results can be written at ``path``."""
    if path is None:
        return
    options.writable(path, "--results")
    if path.suffix.lower() not in WRITERS:
        expected = f"expected a file {' or '.join(WRITERS)}"
        raise ConfigError(f"--results: value {str(path)!r}: {expected}")


def write_results(point: Point, path: Path) -> None:
    """Write what one processor alone would find, a row for each object: of radiosity and particles
    what these are for, else what rays leave in what they hit."""
    with at_work(f"writing {path}"):
        columns = point.config.ray_source.results(point.workload)
        columns = columns or table_of(tally_of(point.workload))
        cells = zip(*(column.tolist() for column in columns.values()), strict=True)
        rows = [dict(zip(columns, row, strict=True)) for row in cells]
        WRITERS[path.suffix.lower()](rows, list(columns), path)
