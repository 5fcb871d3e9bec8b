"""``simmpp policy``: a policy of one's own begun and checked, and a list of all that there are."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.tables import texts
from simmpp.commands.parts.terminal import (
    FAILED,
    announce_compilation,
    go_on,
    progress_bars,
    say,
    wrote,
)
from simmpp.common.documented import fields_below
from simmpp.common.errors import ConfigError
from simmpp.common.files import write_text
from simmpp.policy.file import read_policy
from simmpp.policy.parameters import POLICIES, PolicyParameters
from simmpp.policy.reads import numbers_read
from simmpp.policy.view import View
from simmpp.studies.policies.beginning import beginning
from simmpp.studies.policies.contract import MACHINES, findings


@click.group(
    "policy",
    epilog=options.examples("simmpp policy new mine", "simmpp policy check mine.py"),
)
def policy_command() -> None:
    """Write a policy of your own, and check it.

    A policy is a Python file with a few hooks. A configuration names it: `policy: [object, {file:
    mine.py}]`. It is code, which who reads the configuration runs, unless with --no-code.
    """


@policy_command.command("new", epilog=options.examples("simmpp policy new mine"))
@click.argument("name")
def new(name: str) -> None:
    """Write NAME.py, a policy that runs, with comments on what to change."""
    path = Path(f"{name}.py")
    text = beginning(name)
    if path.exists():
        raise ConfigError(f"value {name!r}: expected a name whose file {path} is not there yet")
    write_text(text, path)
    wrote(path)
    go_on("policy", "check", path)


@policy_command.command("check", epilog=options.examples("simmpp policy check mine.py"))
@click.argument("file")
def check(file: str) -> None:
    """Hold the policy in FILE to what every policy has to keep; exit with 1 if it does not.

    On 50 random machines no ray may starve, and both engines and the hooks run as plain Python give
    the same integers; the picture is that of one processor alone. Says how long a hook takes.
    """
    policy = PolicyParameters(file=read_policy(file))
    announce_compilation()
    with progress_bars() as bars:
        bar = bars.add_task(f"checking {policy.title}", total=MACHINES)
        found = list(findings(policy, lambda: bars.advance(bar)))
    rows = ((each.check, "ok" if each.is_kept else "FAILED", each.text) for each in found)
    say(texts(("check", "verdict", "found"), rows))
    sys.exit(0 if all(each.is_kept for each in found) else FAILED)


@policy_command.command("list", epilog=options.examples("simmpp policy list"))
def list_all() -> None:
    """List the policies of the package, with their numbers and sources."""
    rows = ((name, _asked(name), _numbers(name), POLICIES[name].source) for name in POLICIES)
    say(texts(("policy", "hooks", "numbers", "source"), rows))


@policy_command.command("view", epilog=options.examples("simmpp policy view"))
def view() -> None:
    """List all that a hook may read."""
    say(
        texts(("field", "meaning"), ((name, text) for name, _, text in fields_below(View)), whole=1)
    )


def _asked(name: str) -> str:
    return ", ".join(POLICIES[name].hooks) or "none"


def _numbers(name: str) -> str:
    policy, defaults = POLICIES[name], PolicyParameters(name)
    named: dict[str, object] = {count: getattr(defaults, count) for count in numbers_read(policy)}
    if "min_load" in named:
        named["min_load"] = f"{float(defaults.min_load):.0%}"
    values = {**named, **policy.parameters, "steal": defaults.steal}
    return ", ".join(f"{key} {value}" for key, value in values.items())
