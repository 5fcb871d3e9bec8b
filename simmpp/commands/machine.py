"""``simmpp machine``: the machines there are, every constant of one, and one's own from a table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.inputs import config_of
from simmpp.commands.parts.tables import texts
from simmpp.commands.parts.terminal import go_on, say, wrote
from simmpp.common.errors import ConfigError
from simmpp.common.files import refuse_special, write_text
from simmpp.common.units import counted
from simmpp.common.yamlfile import read_yaml
from simmpp.machine.constants import Constants
from simmpp.machine.layers import Layers
from simmpp.machine.listing import lines_of
from simmpp.machine.presets import (
    SUFFIXES,
    layered,
    load_own,
    load_preset,
    preset_names,
)
from simmpp.machine.topology import topology_of
from simmpp.machine.torus import LINKS, NO_CONTENTION

FIT, FITTED_ON = "fit", "cpu-cluster"
_FREE = f"a choice, not a constant; {LINKS}: each link and port serves one message at a time"


@click.command(
    "machine",
    epilog=options.examples(
        "simmpp machine", "simmpp machine t3e", "simmpp machine fit pingpong.csv --out ours.yaml"
    ),
)
@click.argument("preset", required=False, metavar="[PRESET | FILE | fit]")
@click.argument("table", required=False)
@options.path("--out", "With fit: the file to write, to be named by the key machine.file.")
@click.option("--based-on", help=f"With fit: preset of all other constants.  [{FITTED_ON}]")
@options.no_code
def machine_command(
    preset: str | None,
    table: str | None,
    out: Path | None,
    based_on: str | None,
    may_run: bool,
) -> None:
    """Print every constant of a machine with its source.

    Without PRESET, the machines that there are. FILE is a machine of your own or a configuration,
    whose machine is then printed.

    A constant without a document says ESTIMATE. The range is where it may lie.

    fit TABLE makes a machine of what you measured: a CSV with the columns bytes, one_way_us (half
    a round trip of a ping-pong; or _s, _ms, _ns) and, if measured, messages_per_s (sent back to
    back). It says how well each constant is known.
    """
    if preset != FIT:
        for given, name in ((table, "TABLE"), (out, "--out"), (based_on, "--based-on")):
            if given is not None:
                raise ConfigError(f"{name}: expected with {FIT} alone: simmpp machine {FIT} TABLE")
    if preset is None:
        machines = ((name, load_preset(name).description) for name in preset_names())
        say(texts(("machine", "description"), machines, whole=1))
    elif preset == FIT:
        _fit(table, out, FITTED_ON if based_on is None else based_on)
    elif preset.endswith(SUFFIXES):
        _print_file(preset, may_run)
    else:
        _print_preset(preset)


def _print_preset(name: str) -> None:
    chosen = load_preset(name)
    say(f"{chosen.name}: {chosen.description}\n")
    rows = [
        (key, text, chosen.spans.get(key, ""), chosen.sources[key])
        for key, text in chosen.texts.items()
    ]
    _print([*rows, ("contention", NO_CONTENTION, "", _FREE)])


def _print_file(name: str, may_run: bool) -> None:
    """A machine of one's own, or that of a configuration."""
    data = read_yaml(Path(name)).data
    if isinstance(data, dict) and "constants" in data:
        own = load_own(name)
        say(f"{own.name}, based on {own.based_on}: {own.description}\n")
        _print_layers(layered(own.based_on, Constants(), own=own), NO_CONTENTION)
        return
    config = config_of(name, (), may_run=may_run)
    machine = config.machine_for(config.processors)
    say(f"{machine.name}: {counted(machine.processors, 'PE')} ({topology_of(machine)})\n")
    _print_layers(config.layers, machine.contention)


def _print_layers(layers: Layers, contention: str) -> None:
    of = "a choice: torus, levels or fat-tree"
    rows = [("topology", layers.words["topology"], "", of), *lines_of(layers)]
    rows.append(("service", layers.words["service"], "", "a choice: pe, thread or nic"))
    rows.append(("contention", contention, "", _FREE))
    _print(rows)


def _print(rows: Iterable[Sequence[str]]) -> None:
    say(texts(("constant", "value", "range", "source"), rows, whole=3))


def _fit(table: str | None, out: Path | None, base: str) -> None:
    """Print what a table tells; write the machine, if asked."""
    from simmpp.machine.fit import fit, read_table
    from simmpp.machine.fitted_file import rows_of, text_of

    if table is None:
        raise ConfigError(f"expected a table: simmpp machine {FIT} pingpong.csv")
    load_preset(base)
    if out is not None and out.suffix not in SUFFIXES:
        raise ConfigError(f"--out: value {str(out)!r}: expected a file .yaml")
    refuse_special(table)
    text = Path(table).read_text(encoding="utf-8-sig", errors="replace")
    found = fit(read_table(text, table), table)
    say(texts(("constant", "value", "range", "which is"), rows_of(found), whole=3))
    say(f"\ntimes lie {found.scatter:.1%} beside the fit (one standard deviation)")
    if out is not None:
        write_text(text_of(found, Path(table).name, base), out)
        wrote(out)
        go_on("machine", out)
