from dataclasses import dataclass

from .stages import find_stage


@dataclass
class Plan:
    count: int
    duration_s: float


def path_plan(paths, *, quick):
    return Plan(paths or (4 if quick else 10), 6.0 if quick else 12.0)


def load_paths(traces, scene, place, *, plan, seconds, seed):
    st = find_stage(scene)
    return [st.move(traces[0], plan.duration_s, seed + i) for i in range(plan.count)]
