"""Methods ``analytical`` and ``analytical-measured``: the paper's model of the two classical
dataflows (Nebel 1998, section 3) in place of a simulation.

It has one request per ray and missing object, one message of rays to every other PE at each step,
and neither a network nor a wait within a step, whatever the configuration says of these.
"""

from __future__ import annotations

from simmpp.machine.limits import total_compute_ps
from simmpp.methods.case import Case
from simmpp.model.analytical import analytical as formulas
from simmpp.model.analytical import rays_of
from simmpp.model.costs import costs_of
from simmpp.model.measured import measured
from simmpp.model.synchronous import Dataflow


def analytical(case: Case) -> dict[str, int]:
    """n and r from x and nb, without imbalance; rays without an object as fractions of a ray."""
    nb, rays = case.machine.processors, rays_of(case.workload)
    times = formulas(costs_of(case.machine, case.workload), [nb], [float(case.fraction)], rays)
    lacking = (1 - max(float(case.fraction), 1 / nb)) * float(rays.tests @ rays.repeats)
    makespan = times.object if case.policy.name == "object" else times.ray
    return _numbers(case, round(float(makespan[0, 0])), round(lacking), len(rays.tests))


def analytical_measured(case: Case) -> dict[str, int]:
    """n and r as counted by moving every ray of the workload on its placement."""
    dataflow: Dataflow = "object" if case.policy.name == "object" else "ray"
    counts = measured(case.workload, case.machine, case.place(), dataflow)
    return _numbers(case, counts.makespan_ps, counts.lacking, counts.steps)


def _numbers(case: Case, makespan_ps: int, lacking: int, steps: int) -> dict[str, int]:
    """The columns that the model knows; ``lacking`` rays did not have the object of a test."""
    nb = case.machine.processors
    of_object = case.policy.name == "object"
    asked, sent = (lacking, 0) if of_object else (0, lacking)
    ray_messages = 0 if of_object else steps * nb * (nb - 1)
    return {
        "makespan_ps": makespan_ps,
        "messages": 2 * asked + ray_messages,
        "request_messages": asked,
        "object_messages": asked,
        "ray_messages": ray_messages,
        "load_messages": 0,
        "rays": case.workload.n_rays,
        "tests": case.workload.n_tests,
        "rays_sent": sent,
        "objects_fetched": asked,
        "compute_ps": total_compute_ps(case.workload, case.machine),
    }
