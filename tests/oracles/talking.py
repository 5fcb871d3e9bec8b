"""Messages of the policy's own, and PEs that sleep until a time, as the oracle has them."""

from __future__ import annotations

import heapq
from types import SimpleNamespace

from oracles.costs import copy_ps
from oracles.network import distance, network_ps, receiving, sending
from oracles.state import PE, Message, Part
from oracles.stealing import Stealing
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.messages import REQUEST, USER
from simmpp.policy.policy import Hook
from simmpp.policy.reads import names_in

USER_BYTES = 32
LEAST_SLEEP_PS = 10**6


class Talking(Stealing):
    """The policy's hooks heard and idle."""

    def hear(self, clock: int, pe: PE, message: Message) -> int:
        """A message of the policy's own is unpacked; returns the end of the answer to it."""
        if self.rules.heard is None:
            return clock
        pe.clock = clock
        view = self.view_of_words(pe, message.source, self.rules.heard)
        view.words = list(message.parts[0].words)
        if int(self.rules.heard(view)) > 0:  # type: ignore[arg-type]
            return self.say(clock, pe, message.source, view.words)
        return clock

    def fall_asleep(self, time: int, pe: PE) -> None:
        """Nothing is to do: say what there is to say, then sleep."""
        pe.wish, clock, sent = 0, time, len(self.ledger.sent)
        if self.rules.idle is not None:
            pe.clock = time
            view = self.view_of_words(pe, None, self.rules.idle)
            pe.wish = int(self.rules.idle(view))  # type: ignore[arg-type]
            other = dict(enumerate(self.island_of(pe.number))).get(view.other, pe.number)
            clock = time if view.other == -1 else self.say(time, pe, other, view.words)
        clock = self.steal(clock, pe)
        if len(self.ledger.sent) > sent:
            self.schedule(clock, pe, "rest")
        else:
            self.sleep(time, pe)

    def rest(self, time: int, pe: PE) -> None:
        """What there was to say has been sent."""
        self.sample_loads(time)
        self.look_for_rounds(time, pe)
        pe.ended_load = pe.load
        if pe.inbox or pe.owes or self.has_ready(pe) or self.can_unpack(pe):
            self.begin(time, pe)
        else:
            self.sleep(time, pe)

    def sleep(self, time: int, pe: PE) -> None:
        """Until a message comes or the time has come that the policy wished for."""
        pe.asleep = True
        until = max(pe.wish, time, pe.last_woken + LEAST_SLEEP_PS)
        if pe.wish > 0 and pe.times_woken < self.most() and until <= CLOCK_LIMIT_PS:
            pe.instants += 1
            key = (until, 1, pe.number, pe.instants - 1, 0)
            heapq.heappush(self.queue, (key, "wake", (pe, pe.instants)))

    def wake(self, time: int, sleeper: tuple[PE, int]) -> None:
        """The time has come, unless the PE has done something else since."""
        pe, instants = sleeper
        if pe.asleep and pe.instants == instants:
            pe.asleep = False
            if self.look_for_rounds(time, pe):
                self.begin(time, pe)
                return
            pe.times_woken += 1
            pe.last_woken = time
            self.dispatch(time, pe)

    def begin(self, time: int, pe: PE) -> None:
        """An activity begins."""
        raise NotImplementedError

    def dispatch(self, time: int, pe: PE) -> None:
        """The policy decides."""
        raise NotImplementedError

    def get_on(self, pe: PE) -> None:
        """What bounds a policy's own messages begins anew."""
        pe.said = pe.times_woken = 0

    def most(self) -> int:
        """Messages that a PE may say, and times that it is woken, until it gets on."""
        return 2 * (len(self.islands[0]) - 1)

    def say(self, clock: int, pe: PE, other: int, words: list[int]) -> int:
        """Send words, if there are not too many already and there is such a PE."""
        if pe.said >= self.most() or other not in self.others(pe):
            self.ledger.dropped += 1
            return clock
        pe.said += 1
        return self.send(clock, pe, other, [Part(USER, USER_BYTES, words=tuple(words))])

    def view_of_words(self, pe: PE, other: int | None, hook: Hook) -> SimpleNamespace:
        """What a hook is shown of who has sent a message, or of nobody."""
        machine, draws = self.machine, "random" in names_in(hook)
        view = self.view(pe, pe.number if other is None else other, False, draws)
        view.waiting, view.unasked = len(pe.waiting), 0
        view.object = view.owner = -1
        view.object_bytes = view.test_ps = view.holders = view.requests = 0
        view.objects = view.fetch_ps = view.fetch_flight_ps = 0
        if other is None:
            send_ps = machine.send_startup_ps
            nic = machine.service == "nic"
            receipt_ps = machine.completion_ps if nic else machine.receive_startup_ps
        else:
            send_ps = sending(machine, pe.number, other, USER)
            receipt_ps = receiving(machine, pe.number, other)
        view.send_ps = send_ps + copy_ps(machine.pack[REQUEST], USER_BYTES)
        receipt_ps += copy_ps(machine.unpack[REQUEST], USER_BYTES)
        threads = machine.service == "thread"
        view.receive_ps = machine.handoff_ps if threads else receipt_ps
        if other is None:
            view.other, view.known_load, view.other_speed = -1, -1, 0
            view.age_ps, view.in_flight, view.hops, view.flight_ps = pe.clock, 0, 0, 0
            view.nothing_else, view.words = 1, [0, 0, 0, 0]
        else:
            view.hops = distance(machine, pe.number, other)
            view.flight_ps = network_ps(machine, pe.number, other, USER_BYTES)
            view.flight_ps += receipt_ps if threads else 0
        return view
