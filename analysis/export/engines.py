"""The engines by name, and a policy in one of them."""

from ...base.errors import InputError
from ...base.foreign_text import one_line
from ...base.nearest_names import unknown_name
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ..study.comparison import Comparison
from ..study.comparison_parts import PolicyResult
from .cesium import CESIUM
from .engine_settings import Asked, Engine, EngineSettings
from .godot import GODOT
from .threejs import THREEJS
from .unity import UNITY
from .unreal import UNREAL

ENGINES = {
    "unity": UNITY,
    "unreal": UNREAL,
    "godot": GODOT,
    "threejs": THREEJS,
    "cesium": CESIUM,
}


def require_counterpart(engine: str, policy: str) -> Engine:
    """Return an engine that has the thresholds of a policy.

    Raises `InputError` if there is no such engine (the nearest is suggested), or it has none.
    """
    if engine not in ENGINES:
        raise InputError(f"--engine: {unknown_name(engine, list(ENGINES))}")
    found = ENGINES[engine]
    if policy not in found.policies:
        raise InputError(
            f"{engine}: expected a policy that it has settings for, {' or '.join(found.policies)}, "
            f"got {one_line(policy, 60)}, which has no counterpart there; choose with --policy"
        )
    return found


def engine_settings(
    engine: str, spec: PolicySpec, scene: Scene | None, fovy_deg: float
) -> EngineSettings:
    """Return a policy as settings of an engine.

    Parameters
    ----------
    scene
        Whose levels are set; None will do where an engine has one setting for all.
    fovy_deg
        Vertical field of view, of which distances depend where the policy goes by heights.

    Raises
    ------
    InputError
        If the engine has no counterpart, or it needs a scene.
    """
    found = require_counterpart(engine, spec.name)
    if not 0.0 < fovy_deg < 180.0:
        raise InputError(f"--fovy-deg: expected more than 0 and less than 180, got {fovy_deg:g}")
    policy = spec.make()
    return found.set(Asked(spec.label, policy, scene, fovy_deg))


def exported_policy(comparison: Comparison, engine: str, wanted: str | None) -> PolicyResult:
    """Return the policy of a comparison that is meant: the first that the engine has, if any.

    Raises `InputError` if the comparison scored no such policy.
    """
    if wanted is not None:
        named = [p for p in comparison.ok if wanted in {p.label, p.name}]
        if not named:
            known = ", ".join(one_line(policy.label, 60) for policy in comparison.ok)
            raise InputError(
                f"--policy: expected one of {known}, got {one_line(wanted, 60)}; name one"
            )
        require_counterpart(engine, named[0].name)
        return named[0]
    if engine not in ENGINES:
        require_counterpart(engine, "")
    has = ENGINES[engine].policies
    ours = [policy for policy in comparison.ok if policy.name in has]
    if not ours:
        raise InputError(
            f"{engine}: expected a comparison of {' or '.join(has)}, got one without; compare one "
            "of them, or name it with its parameters and without a folder"
        )
    return ours[0]
