"""``simmpp reading``: everything that a reading sets with its source; and what it set in a run."""

from __future__ import annotations

from collections.abc import Iterable

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.tables import Fitting, texts
from simmpp.commands.parts.terminal import say
from simmpp.config.axes import keys_of
from simmpp.config.config import Config, point_at
from simmpp.config.defaults import READING
from simmpp.config.reading import Line, load_reading, reading_names


@click.command("reading", epilog=options.examples("simmpp reading plain", "simmpp reading"))
@click.argument("name", required=False)
def reading_command(name: str | None) -> None:
    """Print all that a reading sets with its source.

    Without NAME, the readings that there are. NAME may be a file of one's own.

    A reading gives defaults to policies, placement, memory and costs: what the paper is taken to
    mean where it leaves something open. A configuration chooses one by its key reading.
    """
    if name is None:
        readings = ((name, load_reading(name).description) for name in reading_names())
        say(texts(("reading", "description"), readings, whole=1))
        return
    reading = load_reading(name)
    say(f"{reading.name}: {reading.description}\n")
    say(_table("key", reading.lines))


def print_reading(config: Config, presets: Iterable[str] = ()) -> None:
    """Say what the reading sets in a configuration, and where its costs are left out.

    ``presets`` are those of the other machines that there are.
    """
    name, costs = config.reading.name, config.reading.costs
    if lines := config.lines_of_reading:
        say()
        say(_table(f"reading {name} sets", lines))
    others = [preset for preset in (config.preset, *presets) if preset not in costs]
    if costs and others:
        none = ", ".join(dict.fromkeys(others))
        say(f"reading {name} has costs for {', '.join(costs)}, none for {none}: not set")


def print_readings_of_sweep(config: Config) -> None:
    """The same for each reading that a sweep has; what the sweep sets no reading does."""
    axes = config.axes
    for of_reading in _choices(config, READING):
        numbers = [dict.fromkeys(axes, 0) | of | of_reading for of in _choices(config, "machine")]
        machines = [point_at(config, axes, chosen) for chosen in numbers]
        with_costs = (of for of in machines if of.preset in of.reading.costs)
        print_reading(next(with_costs, machines[0]), [of.preset for of in machines])


def _choices(config: Config, part: str) -> list[dict[str, int]]:
    """The number of each choice of each axis that sets a part's keys."""
    return [
        {name: n}
        for name, axis in config.axes.items()
        if any(key.split(".")[0] == part for key in keys_of(axis))
        for n in range(len(axis))
    ] or [{}]


def _table(heading: str, lines: Iterable[Line]) -> Fitting:
    rows = (
        (line.key, line.value, f"{line.source} (range {line.span})" if line.span else line.source)
        for line in lines
    )
    return texts((heading, "value", "source"), rows)
