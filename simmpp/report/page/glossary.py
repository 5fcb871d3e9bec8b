"""Words that a page explains, as the guide to the package does: simmpp/README.md has the texts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from typing import NamedTuple

FORMS = {
    "95 % interval": "95 % intervals?",
    "bandwidth": "bandwidth",
    "bound": "bound",
    "cell passing": "cell passing",
    "classical dataflow": "classical(?: dataflow| way)?",
    "concurrent dataflow": "concurrent(?: dataflow)?",
    "copying": "copying",
    "efficiency": "efficiency",
    "fraction x": "x(?= = |$)",
    "imbalance": "imbalance",
    "latency": "latency",
    "launches": "launches",
    "load": "loads?",
    "makespan": "makespans?",
    "message profit": "message profits?",
    "object dataflow": "object dataflow",
    "one hot PE": "one hot PE",
    "owner": "owners?",
    "PE": "PEs?",
    "particle passing": "particle passing",
    "place": "places?|cases?",
    "ray dataflow": "ray dataflow",
    "reading": "reading",
    "replica": "replicas?",
    "replicated scene": "replicated(?: scene)?",
    "replication": "replication",
    "resident": "resident",
    "seed": "seeds?",
    "speed-up": "speed-ups?",
    "startup": "startups?",
    "time profit": "time profits?",
    "utilisation": "utilisation",
}
"""Words of the guide, and how they occur: regular expressions of JavaScript."""


class Word(NamedTuple):
    """A word with what it means."""

    name: str
    forms: str
    text: str


@cache
def glossary() -> list[Word]:
    """Those of the guide that pages may have."""
    texts = dict(_guide())
    return [Word(name, forms, texts[name]) for name, forms in FORMS.items()]


def _guide() -> Iterator[tuple[str, str]]:
    """The table "Words" of the guide."""
    guide = files("simmpp").joinpath("README.md").read_text(encoding="utf-8")
    table = guide.partition("\n## Words\n")[2].partition("\n## ")[0]
    for line in table.splitlines():
        if line.startswith("| "):
            words, text = (cell.strip() for cell in line.strip("|").split("|"))
            for word in words.split(", "):
                yield word, text.replace("`", "").replace("*", "")
