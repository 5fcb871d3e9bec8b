"""``simmpp sweep``: all points of a configuration, as tables; interrupted, it can be continued."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from simmpp.commands.parts import options, short_cuts
from simmpp.common.errors import ConfigError
from simmpp.sweeps.executors import start_server


@click.command(
    "sweep",
    epilog=options.examples(
        "simmpp sweep configs/sweep.yaml",
        "simmpp sweep configs/sweep.yaml --seeds 4 --processors 8,64 --out results/more",
    ),
)
@options.config_argument
@options.workers("Processes on this machine; 1 works in this one.  [default: one for each core]")
@click.option("--cluster", metavar="ADDRESS", help="A Dask scheduler, such as tcp://host:8786.")
@options.engine("The event loop.  [default: the key engine, or else compiled]")
@short_cuts.settings(
    "Set any other dotted key, such as tolerance=2% or sweep.ready_order='[depth-first, "
    "breadth-first]'; repeatable.",
    short_cuts.POLICY,
    short_cuts.PROCESSORS,
    short_cuts.FRACTION,
    short_cuts.SEEDS,
    is_swept=True,
)
@click.option(
    "--timeout",
    "timeout_s",
    type=options.Real("a finite number of seconds above 0", 0, min_open=True),
    metavar="SECONDS",
    help="A point that takes longer has failed.",
)
@options.no_code
@options.path("--out", "Folder of the tables.  [default: results/NAME-OF-CONFIG]")
def sweep_command(
    config_path: Path,
    workers: int | None,
    cluster: str | None,
    engine: tuple[str, ...],
    overrides: tuple[str, ...],
    timeout_s: float | None,
    may_run: bool,
    out: Path | None,
) -> None:
    """Simulate every combination of the values under the key sweep.

    Writes results.csv, results.parquet, profits.csv, timings.csv and run.json. Object dataflow is
    run as the reference of the profits, if it is not named, and has its rows. With a tolerance,
    seeds are added until the profits of each point are known that well. The same command
    continues what was interrupted, and tries failed points again. More seeds, values or policies
    add to what is in --out. Exits with 1 if a point failed.
    """
    if workers is not None and cluster is not None:
        raise ConfigError("expected --workers or --cluster, got both")
    workers = workers or options.available_cores()
    if workers > 1 and cluster is None:
        start_server()
    # Not at the top: the server of the workers and this process load numba and the rest at once.
    from simmpp.commands.parts.own_policies import tell_files
    from simmpp.commands.parts.progress import progress_of_sweep
    from simmpp.commands.parts.sweep_result import print_result
    from simmpp.commands.parts.terminal import announce_compilation, go_on, notice, say, warn
    from simmpp.commands.reading import print_readings_of_sweep
    from simmpp.config.config import load_config
    from simmpp.sweeps.sweep import run_sweep

    config = load_config(config_path, (*overrides, *engine), may_run=may_run)
    tell_files(config)
    warn(config, is_swept=True)
    out = Path("results", config_path.stem) if out is None else out
    options.folder(out, "--out")
    announce_compilation()
    call = options.call()
    with progress_of_sweep(call) as watcher:
        result = run_sweep(
            config,
            workers=workers,
            cluster=cluster,
            timeout_s=timeout_s,
            out=out,
            watcher=watcher,
            call=call,
        )
    code = print_result(result, config.settings, out)
    if code:
        notice(f"to try again: {call}")
    print_readings_of_sweep(config)
    say()
    go_on("report", out)
    sys.exit(code)
