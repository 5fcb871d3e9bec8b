"""``simmpp keys``: what can be set, what it takes and means, and where defaults come from."""

from __future__ import annotations

import json
from collections.abc import Iterator

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.tables import texts
from simmpp.commands.parts.terminal import say
from simmpp.config.keys import Key, find_keys, listed_keys
from simmpp.config.reading import MACHINE
from simmpp.config.schema import json_schema
from simmpp.machine.presets import DEFAULT_PRESET, load_preset, preset_names


@click.command(
    "keys",
    epilog=options.examples(
        "simmpp keys", "simmpp keys machine.send_startup", "simmpp keys --schema"
    ),
)
@click.argument("key", required=False)
@click.option("--schema", is_flag=True, help="Print a JSON schema, for editors, and nothing else.")
def keys_command(key: str | None, schema: bool) -> None:
    """Print what can be set in a configuration, or all about one KEY.

    KEY is one such as machine.send_startup, or one that holds others, such as memory. A constant
    of the machine is given for each machine of the package, with its source.
    """
    if schema:
        click.echo(json.dumps(json_schema(), indent=1))
        return
    chosen = find_keys(key) if key else listed_keys()
    if len(chosen) == 1:
        _print_one(chosen[0])
    else:
        rows = ((key.name, key.default, key.expect.takes, key.meaning) for key in chosen)
        say(texts(("key", "default", "takes", "meaning"), rows, whole=1))


def _print_one(key: Key) -> None:
    say(f"{key.name}: {key.meaning}\n")
    about = {"takes": key.expect.takes, "units": key.expect.unit, "default": key.default}
    for name, text in about.items():
        if text:
            say(f"{name:9}{text}")
    if constants := list(_constants(key)):
        say()
        say(texts(("machine", "value", "source"), constants))


def _constants(key: Key) -> Iterator[tuple[str, str, str]]:
    """The value and the source of a machine's constant in each preset, the default one first."""
    constant = key.name.removeprefix(f"{MACHINE}.")
    for name in sorted(preset_names(), key=lambda preset: preset != DEFAULT_PRESET):
        preset = load_preset(name)
        text = preset.text(constant, key.expect.write)
        if text and constant != key.name:
            yield name, text, preset.source(constant)
