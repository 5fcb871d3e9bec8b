"""Stealing of pixels in the oracle: a PE that holds nothing asks one after the other."""

from __future__ import annotations

from oracles.dispatch import Dispatch
from oracles.state import PE, Message, Part
from simmpp.machine.messages import STEAL

ANSWER_BYTES = 16


class Stealing(Dispatch):
    """Thieves and their victims."""

    def steal(self, clock: int, pe: PE) -> int:
        """Ask for pixels, if that may be; returns the end of that."""
        held = len(pe.ready) + len(pe.waiting) + len(pe.pixels) + len(pe.shares) + len(pe.inbox)
        if self.policy.steal == "none" or held > 0 or pe.stuck is not None or pe.awaits:
            return clock
        left = [other for other in self.others(pe) if other not in pe.asked]
        if not left:
            return clock
        loads = [self.known_load(clock, pe, other)[0] for other in left]
        victim = left[loads.index(max(loads))]
        pe.asked.add(victim)
        pe.awaits = True
        return self.send(clock, pe, victim, [Part(STEAL, 0, words=(pe.round,))])

    def answer_thief(self, clock: int, pe: PE, message: Message) -> int:
        """A thief gets half of the pixels that are left, from the end; returns the end of that."""
        if message.parts[0].pixels is not None:
            return clock
        kept = len(pe.pixels) - len(pe.pixels) // 2
        if message.parts[0].words != (pe.round,):
            kept = len(pe.pixels)
        given = tuple(pe.pixels[kept:])
        pe.pixels = pe.pixels[:kept]
        return self.send(clock, pe, message.source, [Part(STEAL, ANSWER_BYTES, pixels=given)])

    def take_pixels(self, pe: PE, part: Part) -> None:
        """A thief has its answer."""
        if part.pixels is not None:
            assert pe.awaits
            pe.awaits = False
        if part.pixels:
            assert not pe.pixels
            pe.pixels = list(part.pixels)
