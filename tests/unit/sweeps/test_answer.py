"""Who wins in a sentence: rows on the left, the exact words on the right."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweep_rows import failed, row, timed

from simmpp.common.files import Row
from simmpp.sweeps.winners.answer import answer_of

OBJECT, RAY, BOTH = "object", "ray", "concurrent"


def case(times: dict[str, tuple[int, ...]], **cells: object) -> list[Row]:
    """Rows of one place: the makespans of each policy, seed by seed."""
    return [each for policy, of in times.items() for each in timed(policy, *of, **cells)]


def along(axis: str, cases: dict[object, dict[str, tuple[int, ...]]]) -> list[Row]:
    return [each for value, times in cases.items() for each in case(times, **{axis: value})]


RAY_WINS = {OBJECT: (300, 303, 306), RAY: (100, 101, 102)}
OBJECT_WINS = {OBJECT: (100, 101, 102), RAY: (104, 105, 106)}
OPEN = {OBJECT: (100, 120, 110), RAY: (105, 100, 120)}
EQUAL = {OBJECT: (7, 8, 9), RAY: (7, 8, 9)}

SENTENCES: dict[str, tuple[list[Row], list[str]]] = {
    "one case, sure": (
        case({OBJECT: (300, 310, 290), RAY: (100, 100, 100), BOTH: (900, 900, 900)}),
        [
            "Send the rays: ray dataflow is fastest; the next, object dataflow, takes 3 times as "
            "long (95 % interval 2.76 to 3.26 times, 3 seeds)."
        ],
    ),
    "one seed": (
        case({OBJECT: (105,), RAY: (100,)}),
        [
            "Send the rays: ray dataflow is fastest; the next, object dataflow, takes 5 % longer; "
            "how sure that is, one seed can't tell."
        ],
    ),
    "one case, open": (
        case(OPEN),
        [
            "Seeds can't tell who is fastest, ray dataflow or object dataflow: on average it is "
            "ray dataflow, and object dataflow takes 1.56 % longer (95 % interval 0.707 to 1.46 "
            "times, 3 seeds)."
        ],
    ),
    "equal": (case(EQUAL), ["Object dataflow and ray dataflow are equally fast, to the ps."]),
    "alone": (
        timed(RAY, 5, 6),
        ["Only ray dataflow was run: there is nothing to compare it with."],
    ),
    "no reference": (
        case({RAY: (200, 200), BOTH: (100, 101)}),
        [
            "Let each node choose: concurrent dataflow is fastest; the next, ray dataflow, takes "
            "1.99 times as long (95 % interval 1.87 to 2.12 times, 2 seeds)."
        ],
    ),
    "one winner everywhere": (
        along("processors", {4: RAY_WINS, 8: RAY_WINS, 64: RAY_WINS}),
        [
            "Send the rays: ray dataflow is fastest in all 3 cases (4 to 64 PEs); the next, object "
            "dataflow, takes 3 times as long, in each case beyond chance (95 % intervals, 3 "
            "seeds).",
            "The shortest time is 101 ps: ray dataflow, 4 PEs; on more PEs it takes longer.",
        ],
    ),
    "one winner, where seeds can tell": (
        along("processors", {4: RAY_WINS, 8: RAY_WINS, 64: OPEN}),
        [
            "Send the rays: ray dataflow is fastest in 2 of 3 cases (up to 8 PEs); the next, "
            "object dataflow, takes 3 times as long, in each case beyond chance (95 % intervals, 3 "
            "seeds).",
            "In 1 of 3 cases (64 PEs) seeds can't tell who is fastest, ray dataflow or object "
            "dataflow (on average the next takes 1.56 % longer).",
            "The shortest time is 101 ps: ray dataflow, 4 PEs; on more PEs it takes longer.",
        ],
    ),
    "winners in different regions": (
        along("fraction", {0.2: RAY_WINS, 0.4: RAY_WINS, 0.6: OBJECT_WINS, 1.0: EQUAL}),
        [
            "Who wins depends on the memory: ray dataflow is fastest in 2 of 4 cases (memory for "
            "up to 40 % of the scene), object dataflow in 1 (memory for 60 % of the scene); the "
            "next takes 4 % longer to 3 times as long, in each case beyond chance (95 % intervals, "
            "3 seeds).",
            "In 1 of 4 cases (memory for 100 % of the scene) object dataflow and ray dataflow are "
            "equally fast.",
            "The shortest time is 7 ps: object dataflow, memory for 100 % of the scene.",
        ],
    ),
    "several come next": (
        along("processors", {4: RAY_WINS, 8: RAY_WINS | {BOTH: (200, 200, 200)}}),
        [
            "Send the rays: ray dataflow is fastest in both cases (4 to 8 PEs); the next, object "
            "dataflow or concurrent dataflow, takes 1.98 to 3 times as long, in each case beyond "
            "chance (95 % intervals, 3 seeds).",
            "The shortest time is 101 ps: ray dataflow, 4 PEs; on more PEs it takes longer.",
            "Concurrent dataflow has no result in 1 of 2 cases.",
        ],
    ),
    "nobody wins": (
        along("processors", {4: OPEN, 8: OPEN}),
        [
            "In both cases (4 to 8 PEs) seeds can't tell who is fastest, ray dataflow or object "
            "dataflow (on average the next takes 1.56 % longer).",
            "The shortest time is 108 ps: ray dataflow, 4 PEs; on more PEs it takes longer.",
        ],
    ),
    "several cases with one seed": (
        along("scene", {s: {OBJECT: (200,), RAY: (100,)} for s in ("a", "b", "c", "d")}),
        [
            "Send the rays: ray dataflow is fastest in all 4 cases (4 scenes); the next, object "
            "dataflow, takes 2 times as long; how sure that is, one seed can't tell."
        ],
    ),
    "one of them with one seed": (
        along("processors", {4: RAY_WINS, 8: {OBJECT: (200,), RAY: (100,)}}),
        [
            "Send the rays: ray dataflow is fastest in both cases (4 to 8 PEs); the next, object "
            "dataflow, takes 2 to 3 times as long; how sure that is in 1 of them, one seed can't "
            "tell.",
            "The shortest time is 100 ps: ray dataflow, 8 PEs.",
        ],
    ),
    "one policy in several cases": (
        along("processors", {4: {RAY: (1, 2)}, 8: {RAY: (1, 2)}}),
        ["Only ray dataflow was run: there is nothing to compare it with."],
    ),
    "the ceiling does not fit": (
        case(RAY_WINS | {"replicated": (50, 51, 50)}, fraction=0.1),
        [
            "Send the rays: ray dataflow is fastest; the next, object dataflow, takes 3 times as "
            "long (the same in all 3 seeds).",
            "The whole scene in every memory (replicated, no dataflow) is the ceiling, not a "
            "choice: it does not fit, as it takes 10 times the memory for objects that the "
            "dataflows have. With it the job takes 0.498 times as long as with the fastest "
            "dataflow.",
        ],
    ),
    "the ceiling fits": (
        case(EQUAL | {"replicated": (14, 16, 18)}, fraction=1.0),
        [
            "Object dataflow and ray dataflow are equally fast, to the ps.",
            "Every memory has room for the whole scene: held there (replicated, no dataflow) the "
            "job takes 2 times as long as with the fastest dataflow.",
        ],
    ),
    "failures": (
        [
            *along("processors", {4: RAY_WINS, 8: RAY_WINS}),
            failed(BOTH, processors=4),
            *timed(BOTH, 900, 901, 902, processors=8),
        ],
        [
            "Send the rays: ray dataflow is fastest in both cases (4 to 8 PEs); the next, "
            "object dataflow, takes 3 times as long, in each case beyond chance (95 % intervals, 3 "
            "seeds).",
            "The shortest time is 101 ps: ray dataflow, 4 PEs; on more PEs it takes longer.",
            "Concurrent dataflow has no result in 1 of 2 cases.",
            "1 of 6 points failed (concurrent dataflow).",
        ],
    ),
    "nothing": ([failed()], ["No point has a result."]),
}


@pytest.mark.parametrize(("rows", "told"), SENTENCES.values(), ids=SENTENCES)
def test_what_rows_say(rows: list[Row], told: list[str]) -> None:
    assert [sentence.text for sentence in answer_of(rows)] == told


def answer_at(*of: tuple[float, int, dict[str, tuple[int, ...]]]) -> str:
    """The first sentence of cases of a fraction and a number of PEs."""
    rows = [each for x, nb, times in of for each in case(times, fraction=x, processors=nb)]
    return answer_of(rows)[0].text


def test_winners_that_no_axis_divides() -> None:
    told = answer_at(
        (0.2, 8, OBJECT_WINS), (0.2, 9, RAY_WINS), (0.4, 8, RAY_WINS), (0.4, 9, OBJECT_WINS)
    )
    assert told.startswith(
        "Who wins depends on the number of PEs and the memory: object dataflow is fastest in 2 of "
        "4 cases, ray dataflow in 2; the next takes"
    )
    told = answer_at((0.2, 8, RAY_WINS), (0.4, 9, OBJECT_WINS))  # nothing else is alike
    assert told.startswith("Who wins differs from case to case: ray dataflow is fastest in 1 of 2")


def test_an_axis_along_which_the_winner_stays_decides_nothing() -> None:
    told = answer_at(
        *((x, 8, RAY_WINS) for x in (0.2, 0.4, 0.8)), *((x, 64, OBJECT_WINS) for x in (0.2, 0.8))
    )
    assert told.startswith(
        "Who wins depends on the number of PEs, not on the memory: ray dataflow is fastest in 3 of "
        "5 cases (8 PEs), object dataflow in 2 (64 PEs);"
    )


CELLS = st.fixed_dictionaries(
    {
        "processors": st.sampled_from([2, 4]),
        "fraction": st.sampled_from(["", 0.1, 0.5, 1.0]),
        "scene": st.sampled_from("abcd"),
        "makespan_ps": st.integers(0, 3),
    }
)


@settings(max_examples=200, deadline=None)
@given(
    st.lists(
        st.builds(
            lambda make, policy, seed, cells: make(policy, seed, **cells),
            st.sampled_from([row, failed]),
            st.sampled_from([OBJECT, RAY, BOTH, "replicated", "label"]),
            st.integers(0, 2),
            CELLS,
        )
    )
)
def test_any_rows_have_an_answer(rows: list[Row]) -> None:
    for text, _ in answer_of(rows):
        assert text.endswith(".")
        assert "nan" not in text.replace("mountain", "")
        assert "  " not in text


def test_a_label_is_told_with_what_it_is_a_label_of() -> None:
    rows = case({OBJECT: (200, 200), "eager": (100, 100)})
    known = answer_of(rows, labels={"eager": "concurrent"})[0].text
    assert known.startswith("Let each node choose: eager (concurrent dataflow) is fastest;")
    assert answer_of(rows)[0].text.startswith("Eager is fastest;")


def test_further_axes_divide_the_winners() -> None:
    key = "machine.latency"
    rows = along(key, {"1 us": RAY_WINS, "9 us": OBJECT_WINS})
    assert answer_of(rows, (key,))[0].text.startswith(
        "Who wins depends on machine.latency: ray dataflow is fastest in 1 of 2 cases "
        "(machine.latency 1 us), object dataflow in 1 (machine.latency 9 us);"
    )


def test_the_points_of_a_sentence_are_the_winners() -> None:
    rows = along("processors", {4: RAY_WINS, 8: RAY_WINS})
    assert answer_of(rows)[0].points == (1, 3)  # ray dataflow at 4, at 8
    rows = along("processors", {4: RAY_WINS, 8: OPEN})
    assert [sentence.points for sentence in answer_of(rows)] == [(1,), (3,), (1,)]


def test_times_of_different_pictures_are_not_compared() -> None:
    rows = along("scene", {"a": RAY_WINS, "b": RAY_WINS})
    assert not any("shortest" in sentence.text for sentence in answer_of(rows))


def test_a_makespan_of_nothing_is_no_error() -> None:
    assert answer_of([row(OBJECT, makespan_ps=0), row(RAY, makespan_ps=0)])[0].text
    assert answer_of([row(OBJECT, makespan_ps=0), row(RAY, makespan_ps=5)])[0].text
