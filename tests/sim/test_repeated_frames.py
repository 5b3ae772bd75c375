"""What is kept from frame to frame: never seen by a policy, and never instead of a new count."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.base.errors import PolicyError
from lodbench.models.scene.motion import Motion
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import FrameLog

Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]


def test_views_of_earlier_frames_stay_as_they_were(
    run: Run, scripted: MakePolicy, make_scene: Callable[..., Scene]
) -> None:
    """No array that a policy was shown is used again for a later frame, where nodes move too."""
    motion = Motion(np.array([0, 1]), np.array([3.0, 1.0]), np.array([9.0, -4.0]), np.zeros(2))
    scene = make_scene([(-2.0, 0.0, -10.0), (0.0, 0.0, -8.0), (3.0, 0.0, -9.0)], motion=motion)
    names = ("ids", "xyz_m", "distance_m", "nearest_m", "area_px")
    shown: list[tuple[np.ndarray, bytes]] = []

    def keep(view: View, selection: Selection) -> Selection:
        arrays = [getattr(view, name) for name in names]
        arrays += [view.state.centers_m, view.completed.work_ms]
        shown.extend((array, array.tobytes()) for array in arrays)
        return selection

    run(scripted([0, 0, 1, 2, 2, 0], keep), 12, scene=scene)
    assert len(shown) == 12 * 7
    assert all(array.tobytes() == before for array, before in shown)


def test_speeds_go_by_where_candidates_were_whatever_is_kept_of_it(
    run: Run, scripted: MakePolicy, make_scene: Callable[..., Scene]
) -> None:
    """Apparent speeds are those of a view that is told nothing but cameras and centres."""
    motion = Motion(np.array([0]), np.array([3.0]), np.array([9.0]), np.zeros(1))
    scene = make_scene([(-2.0, 0.0, -10.0), (3.0, 0.0, -9.0)], motion=motion)
    kept = list[bool]()

    def compare(view: View, selection: Selection) -> Selection:
        last = view.state.last_placed
        kept.append(last is not None and last[0] is view.nodes)
        plain = View(replace(view.state, last_placed=None), view.ids, view.xyz_m)
        np.testing.assert_allclose(view.speed_deg_s, plain.speed_deg_s, rtol=1e-9, atol=1e-12)
        return selection

    run(scripted([0, 0, 1], compare), 12, scene=scene)
    assert any(kept)
    assert not kept[0]


@pytest.mark.parametrize("reused", [False, True])
def test_details_are_compared_by_value(run: Run, scripted: MakePolicy, *, reused: bool) -> None:
    """An array that a policy fills anew each frame counts as what it holds now, and so switches."""
    own = np.zeros(2)

    def fill(view: View, selection: Selection) -> Selection:
        detail = own if reused else np.empty(2)
        detail[:] = selection.detail
        return replace(selection, detail=detail)

    details = [[0, 0], [0, 0], [0, 1], [0, 1], [2, 1]]
    log = run(scripted(details, fill), 6, positions=[(0.0, 0.0, -10.0), (1.0, 0.0, -12.0)])
    assert log["toggles"].tolist() == [0, 0, 1, 0, 1, 0]
    assert log["triangles"].tolist() == [2000, 2000, 1250, 1250, 300, 300]
    assert log["reversals"].tolist() == [0] * 6


def test_a_repeated_selection_is_still_checked(run: Run, scripted: MakePolicy) -> None:
    """Numbers beside the same ids and details are looked at in every frame."""

    def spoil(view: View, selection: Selection) -> Selection:
        return replace(selection, render_scale=1.0 if view.frame < 3 else 2.0)

    with pytest.raises(PolicyError, match="frame 3: render_scale"):
        run(scripted([0], spoil), 5)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -1.0, 0.5, 3.0])
def test_every_new_detail_is_checked(run: Run, scripted: MakePolicy, wrong: float) -> None:
    """Among levels 0 to 2 that change, a detail that is none is refused; -0.0 is level 0."""

    def spoil(view: View, selection: Selection) -> Selection:
        detail = np.array([view.frame % 3, 2.0, -0.0])
        if view.frame == 4:
            detail[1] = wrong
        return replace(selection, detail=detail)

    places = [(0.0, 0.0, -10.0), (1.0, 0.0, -10.0), (2.0, 0.0, -10.0)]
    assert len(run(scripted([[0, 0, 0]], spoil), 4, positions=places)) == 4
    with pytest.raises(
        PolicyError, match="frame 4: detail of node 1: expected a level from 0 to 2"
    ):
        run(scripted([[0, 0, 0]], spoil), 6, positions=places)
