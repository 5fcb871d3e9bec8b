"""Who serves requests in the oracle: the PE itself, its thread, or its network card."""

from __future__ import annotations

from oracles.state import PE, WHOSE_LOAD, Message, Part
from oracles.talking import Talking
from simmpp.machine.messages import LOAD, MESSAGE_KINDS, OBJECT, REQUEST


class Serving(Talking):
    """What becomes of a message that has arrived, until its PE receives it or takes it over."""

    def arrive(self, time: int, message: Message) -> None:
        """A message lies in the inbox of its PE or thread, or is a get that is answered at once."""
        self.ledger.arrived(time, message)
        self.flying = [each for each in self.flying if each is not message]
        pe = self.pes[message.destination]
        if self.machine.service == "nic" and (message.count(REQUEST) or message.asks_for_load):
            self.answer_get(time, pe, message)
        elif self.machine.service == "thread":
            pe.to_be_served.append(message)
            if pe.thread_asleep:
                pe.thread_asleep = False
                self.schedule_thread(time, pe, "serve")
        else:
            self.put(time, pe, message)

    def put(self, time: int, pe: PE, message: Message) -> None:
        """A message lies before a PE; if it sleeps it wakes."""
        pe.inbox.append(message)
        self.note_memory(pe)
        if pe.asleep:
            pe.asleep = False
            self.schedule(time, pe, "begin")

    def answer_get(self, time: int, pe: PE, get: Message) -> None:
        """The network card sends an object, or the load in 8 bytes, without its PE."""
        self.ledger.received += 1
        (part,) = get.parts
        if part.obj == WHOSE_LOAD:
            answer = Part(LOAD, 8)
        else:
            answer = Part(OBJECT, self.object_bytes[part.obj], part.obj)
        back = Message(pe.number, get.source, pe.sends, (answer,), pe.ended_load, time)
        pe.sends += 1
        self.ledger.sent.append(back)
        self.ledger.did(pe, time, "answer", time, back)
        self.depart(time, back)

    def serve(self, time: int, pe: PE) -> None:
        """The thread unpacks the oldest message, or sleeps."""
        if not pe.to_be_served:
            pe.thread_asleep = True
            return
        message = pe.to_be_served.popleft()
        self.ledger.received += 1
        end = self.pay("service", pe, time, self.unpacking(pe, message))
        self.ledger.did(pe, time, "serve", end, message)
        self.ledger.open[-1 - pe.number] = (time, f"serve {MESSAGE_KINDS[message.kind]}", 0)
        pe.in_hand = message
        self.schedule_thread(end, pe, "served")

    def served(self, time: int, pe: PE) -> None:
        """The thread has unpacked a message: it hears the load, hands over, answers, goes on."""
        message = pe.in_hand
        assert message is not None
        self.hear_load(time, pe, message)
        wanted = [part.obj for part in message.parts if part.kind == REQUEST]
        end = time
        if wanted:
            answer = [Part(OBJECT, self.object_bytes[obj], obj) for obj in wanted]
            end = self.send(time, pe, message.source, answer, by_thread=True)
        if len(wanted) < len(message.parts):
            self.put(time, pe, message)
        self.ledger.end_activity(-1 - pe.number, end)
        if wanted:
            self.schedule_thread(end, pe, "serve")
        else:
            self.serve(end, pe)

    def hear_load(self, clock: int, pe: PE, message: Message) -> None:
        """What a header tells, and that rays or objects came from there."""
        if not (self.machine.service == "nic" and message.count(OBJECT)):
            pe.known_load[message.source] = message.load
            pe.heard[message.source] = clock
            pe.in_flight_to[message.source] = 0
        if message.carries:
            pe.peers.add(message.source)
