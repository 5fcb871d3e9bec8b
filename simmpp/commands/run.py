"""``simmpp run``: the policies of a configuration at one point, as a table, JSON and a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import click
from rich.progress import TaskID

from simmpp.commands.parts import options, short_cuts
from simmpp.commands.parts.own_policies import tell_files
from simmpp.commands.parts.pictures import until_of, write_picture, write_unfinished
from simmpp.commands.parts.recording import (
    Looks,
    Recorder,
    check_timeline,
    recorders_of,
    sink_of,
    warn_of_window,
)
from simmpp.commands.parts.results import check_results, write_results
from simmpp.commands.parts.tables import numbers
from simmpp.commands.parts.terminal import (
    go_on,
    notice,
    progress_bars,
    say,
    warn,
    wrote,
)
from simmpp.commands.parts.tracing import workload
from simmpp.commands.parts.verifying import verify_runs
from simmpp.commands.reading import print_reading
from simmpp.common.folders import RUN
from simmpp.common.modules import PICTURES
from simmpp.config.config import Config, load_config
from simmpp.engine.record.recording import Recording
from simmpp.run.fitting import require_fitting
from simmpp.run.point import Point, PolicyRun, make_point, refuse_models, run_point
from simmpp.run.record import record_of_run, write_record
from simmpp.run.rows import RECORD, RESULTS, row, write_rows
from simmpp.run.summary import heading, measures, notes
from simmpp.sweeps.executors import start_server
from simmpp.sweeps.winners.answer import answer_of
from simmpp.sweeps.worker import warm_up
from simmpp.workload.sources import require_drawn


@click.command(
    "run",
    epilog=options.examples(
        "simmpp run configs/quick.yaml --picture quick.png",
        "simmpp run configs/quick.yaml --policy ray,concurrent --fraction 5% --figures figures",
        "simmpp run configs/quick.yaml --timeline cut.json --timeline-window '0 ms:5 ms'",
    ),
)
@options.config_argument
@options.engine("The event loop.  [default: the key engine, or else compiled]")
@short_cuts.settings(
    "Set any other dotted key, such as machine.preset=t3d; repeatable.",
    short_cuts.POLICY,
    short_cuts.PROCESSORS,
    short_cuts.FRACTION,
    short_cuts.SEED,
)
@options.path("--out", "Folder for run.json and results.csv.")
@options.path("--picture", "Write the picture as PNG.")
@click.option(
    "--until",
    metavar="TIME",
    help="With --picture: also what of it each policy has finished by then, such as '5 ms'.",
)
@options.path(
    "--results",
    "Write what comes of the rays, object by object: .csv or .parquet.",
    metavar="FILE",
)
@options.path(
    "--timeline",
    "Write what every PE does, and when: .json or .json.gz for Perfetto and Chrome, .parquet.",
    metavar="FILE",
)
@click.option(
    "--timeline-window",
    "window",
    metavar="START:END",
    help="The part of the run that --timeline writes, such as '0 ms:5 ms'; all of it by default.",
)
@options.path(
    "--figures",
    "Folder for pictures of every run: what PEs do, traffic, torus, pixels, memory.",
    metavar="DIR",
)
@options.no_code
@click.option(
    "--verify",
    is_flag=True,
    help="Make picture and results again from the tests that the simulated PEs did, and compare.",
)
def run_command(
    config_path: Path,
    engine: tuple[str, ...],
    overrides: tuple[str, ...],
    out: Path | None,
    picture: Path | None,
    until: str | None,
    results: Path | None,
    timeline: Path | None,
    window: str | None,
    figures: Path | None,
    verify: bool,
    may_run: bool,
) -> None:
    """Compare dataflow policies at one point.

    CONFIG is a YAML file: one scene, one machine, the policies. `simmpp keys` lists its keys.
    Object dataflow is run as the reference of the profits and the replicated scene as the ceiling,
    if they are not named.
    """
    config = load_config(config_path, (*overrides, *engine), may_run=may_run)
    tell_files(config)
    options.writable(picture, "--picture", ".png")
    until_ps = until_of(until, picture)
    check_results(results)
    options.claim(out, "--out", RUN)
    window_ps = None if window is None else options.window_of(window, "--timeline-window")
    check_timeline(timeline, window_ps)
    if figures != out:
        options.claim(figures, "--figures")
    warn(config, is_swept=False)
    settings = config.settings
    if settings.sweep or settings.tolerance is not None or len(settings.seeds) > 1:
        notice(
            f"run simulates one point with one seed, {settings.seeds[0]}; the values under "
            "'sweep', more seeds, tolerance and refine are for simmpp sweep"
        )
    if figures and options.available_cores() > 1:
        start_server(PICTURES)  # loads matplotlib while the rays are traced
    looks = Looks(picture, until_ps, results, timeline, window_ps, figures)
    run(config, out=out, looks=looks, verify=verify)


def run(config: Config, *, out: Path | None, looks: Looks, verify: bool) -> None:
    """Trace, place, simulate, print; what is finished is written even when interrupted."""
    refuse_models(config)
    if looks.picture or verify:
        require_drawn(config.ray_source, "--picture" if looks.picture else "--verify")
    point = make_point(config, workload(config, simulating=True))
    require_fitting(point)
    if looks.picture:
        write_picture(point, looks.picture)
    if looks.results:
        write_results(point, looks.results)
    runs: list[PolicyRun] = []
    try:
        with recorders_of(point, looks) as recorders:
            record = Recording(tests=verify, ends=looks.until_ps is not None)
            _simulate(point, runs, recorders, record)
    finally:
        if out and runs:
            write_record(record_of_run(point, runs), out / RECORD)
            write_rows(runs, point, out / RESULTS)
    _print(point, runs)
    warn_of_window(runs, looks)
    print_reading(config)
    unfinished: list[Path] = []
    if looks.picture and looks.until_ps is not None:
        unfinished = write_unfinished(point, runs, looks.picture, looks.until_ps)
    _print_files(out, looks, unfinished)
    if verify:
        has_results = looks.results is not None or bool(point.workload.object_results.any())
        verify_runs(point, runs, tallies=has_results)


def _simulate(
    point: Point, runs: list[PolicyRun], recorders: list[Recorder], record: Recording
) -> None:
    """Append each policy's run to ``runs`` as it is finished, with a bar for each."""
    counts = any(recorder.needs_counters for recorder in recorders)
    n_rays = point.workload.n_rays
    with progress_bars() as bars:
        loading = bars.add_task("loading the engine", total=None)
        warm_up(point.config.settings.engine)
        bars.remove_task(loading)
        tasks: dict[str, TaskID] = {}

        def progress(title: str, rays_left: int) -> None:
            if title not in tasks:
                tasks[title] = bars.add_task(f"simulating {title}", total=n_rays)
            bars.update(tasks[title], completed=n_rays - rays_left)

        finished = run_point(
            point,
            record=replace(record, counters=counts, hops=counts),
            log_of=partial(sink_of, recorders),
            progress=progress,
        )
        for run in finished:
            runs.append(run)
            for recorder in recorders:
                recorder.end(run)


def _print(point: Point, runs: Sequence[PolicyRun]) -> None:
    """What was simulated, who wins, every measure of every policy, and what one has to know."""
    titles = [run.parameters.title for run in runs]
    labels = {run.parameters.title: run.parameters.name for run in runs}
    say(f"{heading(point)}\n")
    rows = [row(point, run) for run in runs]
    for sentence in answer_of([each for each in rows if each["makespan_ps"] != ""], labels=labels):
        say(sentence.text)
    say()
    say(numbers(titles, measures(runs)))
    say()
    for note in notes(point, runs):
        say(note)


def _print_files(out: Path | None, looks: Looks, unfinished: Sequence[Path]) -> None:
    """Which there are now, and the command that goes on with them."""
    rows = [out / RECORD, out / RESULTS] if out else []
    looked = (looks.picture, *unfinished, looks.results, looks.timeline, looks.figures)
    files = [*rows, *filter(None, looked)]
    if files:
        say()
    wrote(*files)
    if out:
        go_on("report", out)
