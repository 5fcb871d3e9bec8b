"""Every relative link and every #anchor of the guides leads somewhere."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GUIDES = [
    ROOT / "README.md",
    *(
        guide
        for folder in ("simmpp", "configs", "experiments", "tests")
        for guide in sorted((ROOT / folder).rglob("*.md"))
    ),
]
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")


def links(guide: Path) -> Iterator[str]:
    for target in LINK.findall(FENCED.sub("", guide.read_text(encoding="utf-8"))):
        if "://" not in target:
            yield target


def anchors(guide: Path) -> set[str]:
    """Of its headings, as GitHub makes them."""
    text = FENCED.sub("", guide.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: str(guide.relative_to(ROOT)))
def test_links_lead_somewhere(guide: Path) -> None:
    for target in links(guide):
        path, _, anchor = target.partition("#")
        goal = (guide.parent / path).resolve() if path else guide
        assert goal.exists(), f"{guide}: {target}"
        assert not anchor or anchor in anchors(goal), f"{guide}: {target}"


def test_links_and_anchors_are_seen() -> None:
    readme = ROOT / "README.md"
    assert "configs/README.md#keys" in links(readme)
    assert "two-commands" in anchors(readme)
