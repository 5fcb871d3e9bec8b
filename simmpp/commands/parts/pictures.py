"""Pictures that ``simmpp run`` writes: the whole one, and what of it is there at a moment."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from simmpp.commands.parts.options import LAST_PS
from simmpp.commands.parts.terminal import at_work, say
from simmpp.common.errors import ConfigError
from simmpp.common.units import format_ps, picoseconds
from simmpp.run.point import Point, PolicyRun
from simmpp.run.unfinished import finished_roots
from simmpp.workload.describe import roots
from simmpp.workload.trace.shading import save_png


def until_of(text: str | None, picture: Path | None) -> int | None:
    """The moment of ``--until`` in picoseconds, if there is one; ConfigError for what is none."""
    if text is None:
        return None
    if picture is None:
        raise ConfigError("--until: expected --picture FILE beside it")
    try:
        return picoseconds(text, LAST_PS)
    except ConfigError as error:
        raise ConfigError(f"--until: {error}") from None


def write_picture(point: Point, path: Path) -> None:
    """The picture that one processor alone would make."""
    with at_work("drawing the picture"):
        config = point.config
        save_png(config.ray_source.draw(config.picture, point.workload), path)


def write_unfinished(
    point: Point, runs: Sequence[PolicyRun], path: Path, until_ps: int
) -> list[Path]:
    """The picture of each policy at that moment, beside the whole one; says how far each is."""
    files, workload = [], point.workload
    config = point.config
    say()
    for run in runs:
        done = finished_roots(workload, run.result, until_ps)
        title = re.sub(r"[^\w.+-]+", "-", run.parameters.title)
        file = path.with_name(f"{path.stem}-{title}{path.suffix}")
        with at_work(f"drawing the picture of {run.parameters.title}"):
            save_png(config.ray_source.draw(config.picture, workload, done), file)
        share = f"{done.mean():.1%} of {len(done)} {roots(workload)} are finished"
        say(f"{run.parameters.title} at {format_ps(until_ps)}: {share}")
        files.append(file)
    return files
