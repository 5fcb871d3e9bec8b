"""``simmpp run``: the policies of a configuration at one point, as a table, JSON and a picture."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from simmpp.commands.options import NamedPath, set_option, window_of
from simmpp.commands.recording import Looks, Recorder, check_timeline, recorders_of, sink_of

if TYPE_CHECKING:
    from rich.progress import TaskID

    from simmpp.config.config import Config
    from simmpp.run.point import Point, PolicyRun

VERIFY_FAILED = 1


@click.command("run")
@click.argument("config_path", metavar="CONFIG", type=NamedPath())
@click.option("--engine", help="The event loop (see the key engine).")
@set_option("Set a dotted key of the configuration, such as memory.fraction=0.2; repeatable.")
@click.option("--out", type=NamedPath(), help="Folder for run.json and results.csv.")
@click.option("--picture", type=NamedPath(), help="Write the picture as PNG.")
@click.option(
    "--timeline",
    type=NamedPath(),
    metavar="FILE",
    help="Write what every PE does, and when: .json or .json.gz for Perfetto and Chrome, .parquet.",
)
@click.option(
    "--timeline-window",
    "window",
    metavar="START:END",
    help="The part of the run that --timeline writes, such as '0 ms:5 ms'; all of it by default.",
)
@click.option(
    "--figures",
    type=NamedPath(),
    metavar="DIR",
    help="Folder for pictures of every run: what PEs do, traffic, torus, pixels, memory.",
)
@click.option(
    "--verify",
    is_flag=True,
    help="Make the picture again from the tests that the simulated PEs did, and compare.",
)
def run_command(
    config_path: Path,
    engine: str | None,
    overrides: tuple[str, ...],
    out: Path | None,
    picture: Path | None,
    timeline: Path | None,
    window: str | None,
    figures: Path | None,
    verify: bool,
) -> None:
    """Compare dataflow policies on one scene and one machine.

    CONFIG is a YAML file; its keys are listed in the README. Object dataflow is run as the
    reference of the profits and the replicated scene as the ceiling, if they are not named.
    """
    from simmpp.commands.options import folder, writable
    from simmpp.commands.terminal import notice
    from simmpp.config.config import load_config

    if engine is not None:
        overrides = (*overrides, f"engine={engine}")
    config = load_config(config_path, overrides)
    writable(picture, "--picture", ".png")
    folder(out, "--out")
    window_ps = None if window is None else window_of(window, "--timeline-window")
    check_timeline(timeline, window_ps)
    folder(figures, "--figures")
    settings = config.settings
    if settings.sweep or settings.tolerance is not None:
        notice(
            "run simulates one point with one seed; the values under 'sweep', tolerance and refine "
            "are for simmpp sweep"
        )
    looks = Looks(picture, timeline, window_ps, figures)
    run(config, out=out, looks=looks, verify=verify)


def run(config: Config, *, out: Path | None, looks: Looks, verify: bool) -> None:
    """Trace, place, simulate, print; what is finished is written even when interrupted."""
    from simmpp.commands.terminal import output
    from simmpp.commands.tracing import workload
    from simmpp.run.point import make_point, refuse_models
    from simmpp.run.summary import summary

    refuse_models(config)
    if looks.picture or verify:
        _require_scene(config, "--picture" if looks.picture else "--verify")
    point = make_point(config, workload(config))
    if looks.picture:
        _write_picture(point, looks.picture)
    runs: list[PolicyRun] = []
    try:
        with recorders_of(point, looks) as recorders:
            _simulate(point, runs, recorders, record_tests=verify)
    finally:
        if out and runs:
            _write(point, runs, out)
    output().print(summary(point, runs))
    if verify:
        _verify(point, runs)


def _require_scene(config: Config, option: str) -> None:
    from simmpp.common.errors import ConfigError

    if config.settings.scene.workload is not None:
        problem = "expected a scene to trace; a workload file has rays, but no geometry"
        raise ConfigError(problem, where=option)


def _simulate(
    point: Point, runs: list[PolicyRun], recorders: list[Recorder], *, record_tests: bool
) -> None:
    """Append each policy's run to ``runs`` as it is finished, with a bar for each."""
    from simmpp.commands.terminal import progress_bars
    from simmpp.engine.record.recording import Recording
    from simmpp.run.point import run_point

    counts = any(recorder.needs_counters for recorder in recorders)
    n_rays = point.workload.n_rays
    with progress_bars() as bars:
        tasks: dict[str, TaskID] = {}

        def progress(title: str, rays_left: int) -> None:
            if title not in tasks:
                tasks[title] = bars.add_task(f"simulating {title}", total=n_rays)
            bars.update(tasks[title], completed=n_rays - rays_left)

        each = run_point(
            point,
            record=Recording(tests=record_tests, counters=counts, hops=counts),
            log_of=partial(sink_of, recorders),
            progress=progress,
        )
        for run in each:
            runs.append(run)
            for recorder in recorders:
                recorder.end(run)


def _write(point: Point, runs: list[PolicyRun], out: Path) -> None:
    from simmpp.run.record import record, write_record
    from simmpp.run.rows import row, write_rows

    write_record(record(point, runs), out / "run.json")
    write_rows([row(point, run) for run in runs], out / "results.csv")


def _write_picture(point: Point, path: Path) -> None:
    """The picture that one processor alone would make."""
    from simmpp.scene.load import load_scene
    from simmpp.workload.trace.shading import render, save_png

    scene = load_scene(point.config.scene_spec)
    save_png(render(scene, point.config.picture, point.workload), path)


def _verify(point: Point, runs: list[PolicyRun]) -> None:
    """Say for each policy whether its PEs made the picture; exit 1 unless all did."""
    import numpy as np

    from simmpp.scene.load import load_scene
    from simmpp.workload.trace.verify import verify

    scene, failed = load_scene(point.config.scene_spec), False
    nothing = np.zeros(0, np.int32)
    for run in runs:
        rays, objects = run.result.tested_rays, run.result.tested_objects
        problem = verify(
            scene,
            point.config.picture,
            point.workload,
            nothing if rays is None else rays,
            nothing if objects is None else objects,
        )
        verdict = f"differs: {problem}" if problem else "the picture of its tests is the same"
        click.echo(f"verify {run.parameters.title}: {verdict}")
        failed = failed or problem is not None
    if failed:
        sys.exit(VERIFY_FAILED)
