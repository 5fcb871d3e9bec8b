"""Words that the page explains: on hover, on focus and at a tap."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from simmpp.report.page.glossary import glossary

MEANING = {word.name: word.text for word in glossary()}
FIRST = "#summary .answer a.term"


def test_a_word_is_explained_on_hover_and_on_focus(opened: Any, report: Path) -> None:
    page = opened(report).page
    tip, word = page.locator("#tip"), page.locator("#summary a.term", has_text="time profit").first
    assert not tip.is_visible()
    word.hover()
    assert tip.inner_text() == f"time profit: {MEANING['time profit']}"
    tip.hover()  # one can read on, and select
    assert tip.is_visible()
    page.locator("h1").hover()
    assert not tip.is_visible()
    word.focus()
    assert tip.is_visible()
    page.keyboard.press("Escape")
    assert not tip.is_visible()
    described = page.locator(f"#{word.get_attribute('aria-describedby')}")
    assert described.inner_text() == MEANING["time profit"]


def test_a_word_is_explained_at_a_tap_within_a_narrow_window(opened: Any, report: Path) -> None:
    found = opened(report, 400)
    page = found.page
    for word in page.locator("#summary a.term").all():
        word.tap()
        box = page.locator("#tip").bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= 400
        page.locator("#tip").tap()  # it may lie over the next word
        assert not page.locator("#tip").is_visible()
    assert "#word" not in page.url
    assert found.width_beyond_window() == 0


def test_headers_that_sort_explain_too(opened: Any, report: Path) -> None:
    page = opened(report).page
    page.locator("#all-points th button", has_text="makespan").focus()
    assert page.locator("#tip").inner_text() == f"makespan: {MEANING['makespan']}"


def test_only_words_that_occur_are_listed(opened: Any, report: Path, bench: Path) -> None:
    listed = {
        name: set(opened(path).page.locator("#words dt:visible").all_inner_texts())
        for name, path in (("report", report), ("bench", bench))
    }
    assert "efficiency" in listed["report"] - listed["bench"]
    assert listed["report"] <= MEANING.keys()
