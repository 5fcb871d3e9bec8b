"""``simmpp advise``: which policy on how many nodes, how sure that is, and what it hangs on."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click

from simmpp.commands.parts import options, short_cuts
from simmpp.common.errors import ConfigError
from simmpp.common.folders import ADVICE
from simmpp.sweeps.executors import start_server


@click.command(
    "advise",
    epilog=options.examples(
        "simmpp advise configs/advise.yaml",
        "simmpp advise configs/advise.yaml --set memory.capacity='60 kB' --out results/advice",
    ),
)
@options.config_argument
@options.workers("Processes on this machine; 1 works in this one.  [default: one for each core]")
@click.option("--cluster", metavar="ADDRESS", help="A Dask scheduler, such as tcp://host:8786.")
@short_cuts.settings(
    "Set a dotted key, such as advise.goal=node-seconds or memory.capacity='64 MB'; repeatable."
)
@click.option(
    "--seconds",
    type=options.Real("a finite number of seconds above 0", 0, min_open=True),
    metavar="SECONDS",
    help="After that long, what is best so far is advised.",
)
@click.option("--figures", is_flag=True, help="With --out: its pictures as .png and .svg, too.")
@click.option("--list", "lists", is_flag=True, help="Tell what there is to choose from, and stop.")
@options.no_code
@options.path("--out", "Folder for advise.csv and advise.html.")
def advise_command(
    config_path: Path,
    workers: int | None,
    cluster: str | None,
    overrides: tuple[str, ...],
    seconds: float | None,
    figures: bool,
    lists: bool,
    may_run: bool,
    out: Path | None,
) -> None:
    """Say which policy to use on how many nodes.

    The question is the key advise of CONFIG: a goal (time, node-seconds, or the least nodes within
    a time), numbers of nodes or a budget, and candidates; memory.capacity is the memory of a node.
    Candidates are ways to use a number of nodes, placement and memory included. What can't fit and
    what can't win is left out, the others race with the same seeds. Then the machine's constants
    are varied within their ranges, to see what the advice hangs on. Ctrl-C prints the best so far.
    Exits with 1 if nothing fits.
    """
    if workers is not None and cluster is not None:
        raise ConfigError("expected --workers or --cluster, got both")
    if figures and out is None:
        raise ConfigError("--figures: expected --out, the folder that they go to")
    workers = workers or options.available_cores()
    if workers > 1 and cluster is None and not lists:
        start_server()
    # Not at the top: the server of the workers and this process load numba and the rest at once.
    from simmpp.commands.parts.advice import advice_bar, list_candidates, print_advice, write_advice
    from simmpp.commands.parts.own_policies import tell_files
    from simmpp.commands.parts.terminal import FAILED, announce_compilation, notice, warn
    from simmpp.config.config import load_config
    from simmpp.studies.advise.advise import advise

    config = load_config(config_path, overrides, may_run=may_run)
    tell_files(config)
    if lists:
        list_candidates(config)
        return
    warn(config, is_swept=False)
    options.claim(out, "--out", ADVICE)
    announce_compilation()
    began_s = time.monotonic()
    with advice_bar() as watcher:
        advice = advise(
            config,
            workers=workers,
            cluster=cluster,
            seconds=seconds,
            maps=out is not None,
            watcher=watcher,
        )
    print_advice(advice)
    notice(f"{advice.runs + advice.further_runs} runs, {time.monotonic() - began_s:.0f} s")
    if out is not None:
        write_advice(advice, out, figures=figures)
    if advice.interrupt is not None:
        raise advice.interrupt
    if advice.chosen is None:
        sys.exit(FAILED)
