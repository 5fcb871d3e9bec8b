"""``simmpp machine``: every constant of a preset with its source."""

from __future__ import annotations

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.tables import texts
from simmpp.commands.parts.terminal import say
from simmpp.machine.presets import load_preset, preset_names
from simmpp.machine.torus import LINKS, NO_CONTENTION


@click.command("machine", epilog=options.examples("simmpp machine t3e", "simmpp machine"))
@click.argument("preset", required=False)
def machine_command(preset: str | None) -> None:
    """Print every constant of a machine with its source.

    Without PRESET, the machines that there are.

    A constant without a document says ESTIMATE and the range it may lie in.
    """
    if preset is None:
        machines = ((name, load_preset(name).description) for name in preset_names())
        say(texts(("machine", "description"), machines, whole=1))
        return
    chosen = load_preset(preset)
    rows = [(key, text, chosen.sources[key]) for key, text in chosen.texts.items()]
    free = f"a choice, not a constant; {LINKS}: each link and port serves one message at a time"
    rows.append(("contention", NO_CONTENTION, free))
    say(f"{chosen.name}: {chosen.description}\n")
    say(texts(("constant", "value", "source"), rows))
