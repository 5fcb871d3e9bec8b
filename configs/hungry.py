"""Who runs out of rays says so: one PE after the other is asked for work, and sends some if it has.

Work is moved by who needs it, not by who has too much (receiver-initiated: Eager, Lazowska and
Zahorjan 1986). Rays go to PEs that hold the object that they need next; what is not sent waits for
objects, as in object dataflow.
"""

from simmpp.policy import Policy, hook

WHO, LAST = 0, 1  # in memory: 1 + the PE that has asked me; how many PEs I have asked
HUNGRY, NOTHING = 1, 2  # the first word of a message


@hook
def idle(v):
    """Nothing to do: ask the next PE, and yet another one if I hear nothing for `patience`."""
    if v.load > 0:  # what my rays wait for will come
        return 0
    v.memory[LAST] += 1
    v.other = (v.me + 1 + v.memory[LAST] % (v.nb - 1)) % v.nb if v.nb > 1 else -1
    v.words[0] = HUNGRY
    return v.now_ps + v.patience


@hook
def heard(v):
    """Note who is hungry; answer who asks in vain, which then is idle again and asks another."""
    if v.words[0] != HUNGRY:
        return 0
    if v.load > v.min_load:
        v.memory[WHO] = 1 + v.other
        return 0
    v.words[0] = NOTHING
    return 1


@hook
def send(v):
    """Half of my rays to who has asked, once; nothing to anyone else."""
    if v.memory[WHO] != 1 + v.other:
        return 0
    v.memory[WHO] = 0
    return v.load // 2


@hook
def ask(v):
    """What waits is asked for, at once if nothing else is to do."""
    return 1


POLICY = Policy(
    "hungry",
    "Eager, Lazowska and Zahorjan 1986, receiver-initiated load sharing",
    send=send,
    ask=ask,
    heard=heard,
    idle=idle,
    candidates="holders",
    ask_at_least="ask_at_least",
    like="concurrent",
    parameters={"patience": 100_000_000},  # ps: 100 us
)
