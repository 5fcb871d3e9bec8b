"""Stealing of pixels: a PE that holds no ray asks others for some that they have not started.

It asks the one of its island with the highest load that it knows of, equal ones in ring order, and
if that has none to give the next one: each once in an idle spell, which only rays or pixels end,
and one at a time. A question is a header; the answer says whose pixels, from which on, and how
many: half of those that are left (rounded down, so one stays), the last ones. That is always one
piece of ``pixels``, for who asks has none: it becomes the thief's. A spell ends with its round of
rays, too, and pixels are given in the round in which they were asked for only.

Why a run still ends: spells end with a message that brings rays or pixels, and who holds pixels
starts one, as its queue is empty, before it asks again. So between two tests or finished rays each
PE asks a bounded number of times.

Source: random work stealing (Blumofe and Leiserson 1999) with a victim that is known; half of what
is left as in Hendler and Shavit 2002.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import FOR_PIXELS, NONE, PIGGYBACK, Row, Run
from simmpp.engine.arrays.views import asked_in, messages, pes, pixels, rays, told_loads
from simmpp.engine.pe.peers import load_shown
from simmpp.engine.pe.sending import new_part, send
from simmpp.machine.messages import STEAL, STEAL_BYTES


@kernel
def steal(s: Run, me: int, now_ps: int) -> int:
    """A PE has nothing to do: if it holds no ray, ask the next victim; returns the end of that."""
    pe = pes(s)[me]
    # Then its inbox is empty, and so are the shares: the first ray of them would fit.
    if pe.load > 0 or pe.awaits == 1 or pe.asked == s.island - 1:
        return now_ps
    place = _victim(s, me, pe)
    asked_in(s)[me * s.island + place] = pe.spell
    pe.asked += 1
    pe.awaits = 1
    row = new_part(s, STEAL, pe.base + place, 0)
    messages(s)[row].purpose, messages(s)[row].last = FOR_PIXELS, pe.round
    return send(s, me, row, now_ps, False)


@kernel
def _victim(s: Run, me: int, pe: Row) -> int:
    """The place of the one of the highest known load, of those that were not asked in this
    spell."""
    victim, highest = NONE, NONE - 1
    for distance in range(1, s.island):
        place = (pe.place + distance) % s.island
        if asked_in(s)[me * s.island + place] != pe.spell:
            load = _known_load(s, me, pe, place)
            if load > highest:
                victim, highest = place, load
    return victim


@kernel
def _known_load(s: Run, me: int, pe: Row, place: int) -> int:
    """Of one that there may be no row of ``peers`` for."""
    if s.load_info != PIGGYBACK:
        return load_shown(s, pe.base + place)
    told = told_loads(s)[me * s.island + place]
    return told - 1 if told > 0 else s.initial_load


@kernel
def give_pixels(s: Run, me: int, question: Row, now_ps: int) -> int:
    """Answer a question with half of the pixels that are left; returns the end of that.

    With none if a round has begun since it was asked: then the thief may have some of its own.
    """
    pe, thief = pes(s)[me], question.source
    n = (pe.pixel_end - pe.pixel) // 2 if question.last == pe.round else 0
    pe.pixel_end -= n
    pe.n_ready -= n
    pe.load -= n
    row = new_part(s, STEAL, thief, STEAL_BYTES)
    messages(s)[row].first, messages(s)[row].n = pe.pixel_end, n
    return send(s, me, row, now_ps, False)


@kernel
def take_pixels(s: Run, me: int, m: Row, links: int) -> None:
    """The answer is here, over that many links."""
    pe = pes(s)[me]
    pe.awaits = 0
    if m.n == 0:
        return
    pe.pixel, pe.pixel_end = m.first, m.first + m.n
    pe.n_ready += m.n
    pe.load += m.n
    pe.peak_rays = max(pe.peak_rays, pe.load)
    for at in range(m.first, m.first + m.n):
        rays(s)[pixels(s)[at]].hops += links


@kernel
def end_spell(pe: Row) -> None:
    """Rays or pixels have come: when the PE holds none again it may ask all others again."""
    pe.spell += 1
    pe.asked = 0
