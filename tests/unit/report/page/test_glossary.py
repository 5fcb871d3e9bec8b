"""Pages explain words as the guide to the package does."""

from __future__ import annotations

import re
from pathlib import Path

import simmpp
from simmpp.report.page.glossary import FORMS, glossary


def test_all_words_are_the_guide_s() -> None:
    guide = Path(simmpp.__file__).with_name("README.md").read_text(encoding="utf-8")
    for word in glossary():
        assert any(
            line.startswith(f"| {word.name}")
            and re.sub("[`*]", "", line).endswith(f"| {word.text} |")
            for line in guide.splitlines()
        ), word


def test_each_word_has_its_own_form() -> None:
    for name, forms in FORMS.items():
        assert re.match(forms, f"{name}".removeprefix("fraction ")), name
        others = [other for other, each in FORMS.items() if re.fullmatch(each, name)]
        assert others in ([name], []), name
