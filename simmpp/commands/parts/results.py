"""The table that ``simmpp run --results`` writes: what comes of the rays, object by object."""

from __future__ import annotations

from pathlib import Path

from simmpp.commands.parts import options
from simmpp.commands.parts.terminal import at_work
from simmpp.common.errors import ConfigError
from simmpp.common.files import write_csv, write_parquet
from simmpp.config.config import Config
from simmpp.run.point import Point

WRITERS = {".csv": write_csv, ".parquet": write_parquet}


def check_results(config: Config, path: Path | None) -> None:
    """Raise ConfigError unless there are such results, and they can be written at ``path``."""
    if path is None:
        return
    options.writable(path, "--results")
    if path.suffix.lower() not in WRITERS:
        expected = f"expected a file {' or '.join(WRITERS)}"
        raise ConfigError(f"--results: value {str(path)!r}: {expected}")
    if not config.ray_source.has_results:
        raise ConfigError("--results: expected radiosity or particles; a picture has --picture")


def write_results(point: Point, path: Path) -> None:
    """Write what one processor alone would find: a row for each object."""
    with at_work(f"writing {path}"):
        columns = point.config.ray_source.results(point.workload) or {}
        cells = zip(*(column.tolist() for column in columns.values()), strict=True)
        rows = [dict(zip(columns, row, strict=True)) for row in cells]
        WRITERS[path.suffix.lower()](rows, list(columns), path)
