"""A configuration to begin with: what most users set, and below # whatever else can be set.

It is made from the declarations that ``simmpp keys`` prints. The costs of a machine are left out:
they are another table, ``simmpp machine``.
"""

from __future__ import annotations

import re
import textwrap

from simmpp.config.keys import REQUIRED, Key, listed_keys
from simmpp.config.reading import MACHINE, POLICY
from simmpp.policy.parameters import CLASSICAL, DEFAULT_POLICY

STARTED = {
    "scene": "mountain:4",
    "picture.resolution": "256",
    "machine.preset": "t3e",
    "processors": "64",
    "memory.fraction": "10%",
}
"""What is set; the policies are, too."""
EXAMPLES = {"policy.label": "eager"}
"""Of keys that have no default and whose text has no example."""
CHOICES = ("machine.preset", "machine.shape", "machine.contention")
"""What is no constant of a machine."""
LEFT_OUT = (
    *("scene.", "radiosity", "particles", "advise"),
    *("policy.name", "policy.file", "policy.set"),
)
"""Ways to say a scene that are not the text, what stands in place of a picture, what is for another
command, and what goes with files of one's own."""
WIDTH = 92
HEAD = """\
# A configuration of simmpp. Lines such as "#seeds: [0]" say what holds without them, or, where
# nothing does, an example: take the # away (and that of the line it is indented below) to say
# something else. `simmpp keys KEY` tells about one key, `simmpp machine t3e` lists what a machine
# costs, each a key below "machine".
#
#   simmpp run FILE      compares the policies
#   simmpp sweep FILE    compares them at all values under the key "sweep"
"""


def starter() -> str:
    """The text of a configuration with a comment for each key."""
    tops = [key for key in _shown() if "." not in key.name]
    return "\n".join([HEAD, *(f"{_block(key)}\n" for key in tops)])


def _shown() -> list[Key]:
    """The keys that are in it."""
    return [
        key
        for key in listed_keys()
        if not key.name.startswith(LEFT_OUT)
        if not key.name.startswith(f"{MACHINE}.") or key.name in CHOICES
    ]


def _block(key: Key, indent: str = "") -> str:
    """What a key means, the key, and the keys below it."""
    below = [other for other in _shown() if other.name.rpartition(".")[0] == key.name]
    name, is_set = key.name.rpartition(".")[2], key.name == POLICY or _is_set(key, below)
    mark = "" if is_set else "#"
    lines = [_about(key, indent)]
    if key.name == POLICY:
        lines += [f"{name}:", *(f"  - {policy}" for policy in CLASSICAL)]
        lines.append(f"  - name: {DEFAULT_POLICY}")
        indent = "  "
    elif below:
        lines.append(f"{indent}{mark}{name}:")
    else:
        lines.append(f"{indent}{mark}{name}: {_value(key)}")
    return "\n".join([*lines, *(_block(other, f"{indent}  ") for other in below)])


def _is_set(key: Key, below: list[Key]) -> bool:
    return any(name in STARTED for name in (key.name, *(other.name for other in below)))


def _about(key: Key, indent: str) -> str:
    """Its meaning, and what it takes, its unit and its default, as comments."""
    takes = key.expect.takes.removesuffix("a mapping of the keys below").removesuffix(", or ")
    default = f"default {key.default}" if key.default else ""
    facts = ["required" if key.default == REQUIRED else default, takes, key.expect.unit]
    lines = [
        line
        for text in (key.meaning, "; ".join(filter(None, facts)))
        for line in textwrap.wrap(text, WIDTH - len(indent), break_long_words=False)
    ]
    return "\n".join(f"{indent}# {line}" for line in lines)


def _value(key: Key) -> str:
    """What is set, or holds anyway, or may be set."""
    if key.name in STARTED:
        return STARTED[key.name]
    if key.name in EXAMPLES:
        return EXAMPLES[key.name]
    if key.default in ("none", "{}") and "none" not in key.expect.text:
        example = re.search("such as (.*)", key.expect.text)
        return example[1] if example else key.default
    own = re.search(rf"(\S+) for {DEFAULT_POLICY}\b", key.default)
    return own[1] if own else re.sub(r" \(.*\)$", "", key.default)
