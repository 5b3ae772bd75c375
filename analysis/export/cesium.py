"""Cesium: the screen-space error up to which a tileset is not refined.

``error · height / (distance · 2 tan(fovy / 2))`` is compared with ``maximumScreenSpaceError``:
the rule of `screen-space-error`; `pixel-error` is the same on objects with levels.  What Cesium
does beyond that rule by default is turned off here, since it was not simulated.

Source: CesiumJS's reference of ``Cesium3DTileset``: maximumScreenSpaceError,
dynamicScreenSpaceError, foveatedScreenSpaceError, skipLevelOfDetail, cacheBytes.
"""

from ...policies.thresholds.screen_space_error import ScreenSpaceError
from .engine_settings import Asked, Engine, EngineSettings, Value


def _set_cesium(asked: Asked) -> EngineSettings:
    policy = asked.policy
    differs = ["distances are to boxes and regions there, to their spheres here"]
    beside: dict[str, Value] = {}
    if isinstance(policy, ScreenSpaceError):
        tolerance_px = policy.tolerance_px
        if policy.memory_bytes is not None:
            beside["cacheBytes"] = policy.memory_bytes
    else:
        tolerance_px = policy.threshold_px
        if policy.hysteresis:
            differs.append(
                f"Cesium has no hysteresis: hysteresis={policy.hysteresis:g} is lost; "
                "hysteresis=0 simulates that"
            )
    project: dict[str, Value] = {
        "maximumScreenSpaceError": tolerance_px,
        "dynamicScreenSpaceError": False,
        "foveatedScreenSpaceError": False,
        "skipLevelOfDetail": False,
    }
    return EngineSettings("cesium", asked.label, None, None, project | beside, (), tuple(differs))


CESIUM = Engine(("screen-space-error", "pixel-error"), _set_cesium)
