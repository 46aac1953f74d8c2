"""Thresholds: the nearest win, and nothing flickers at a border."""

import numpy as np
import pytest

from roadwatch_viewer.placement import Placed
from roadwatch_viewer.schema import SceneObject
from roadwatch_viewer.selection import Pace, Selector
from roadwatch_viewer.settings import Settings


def at(key, distance_m, *, score=0.9, state="confirmed"):
    seen = SceneObject(str(key), 1, "car", state, score, (distance_m, 0.0, 0.0), (4.0, 2.0, 1.5), 0.0)
    return Placed(seen, np.array([distance_m, 0.0, 0.0]), np.zeros(3), float(distance_m))


def keys(drawn):
    return {each.placed.seen.key for each in drawn}


def test_of_200_objects_the_25_nearest_are_drawn():
    rng = np.random.default_rng(1)
    objects = [at(key, far) for key, far in enumerate(rng.permutation(200) * 0.7)]
    chosen = Selector(Settings(most_objects=25)).select(tuple(objects))
    nearest = sorted(objects, key=lambda placed: placed.distance_m)[:25]
    assert [each.placed.seen.key for each in chosen] == [placed.seen.key for placed in nearest]


def test_jitter_at_the_border_changes_nothing():
    rng = np.random.default_rng(2)
    places = np.arange(200) * 0.7
    selector = Selector(Settings(most_objects=25))
    first = keys(selector.select(tuple(at(key, far) for key, far in enumerate(places))))
    for _ in range(200):
        jittered = places + rng.normal(0.0, 0.3, 200)
        assert keys(selector.select(tuple(at(key, far) for key, far in enumerate(jittered)))) == first


def test_one_that_is_clearly_nearer_takes_the_place_of_the_farthest():
    selector = Selector(Settings(most_objects=2, distance_margin_m=2.0))
    selector.select((at("a", 10), at("b", 20), at("c", 30)))
    assert keys(selector.select((at("a", 10), at("b", 20), at("c", 18.5)))) == {"a", "b"}
    assert keys(selector.select((at("a", 10), at("b", 20), at("c", 17.5)))) == {"a", "c"}


def test_one_that_many_have_passed_loses_its_place_though_they_are_hardly_nearer():
    selector = Selector(Settings(most_objects=1, distance_margin_m=5.0, rank_margin=3))
    selector.select((at("old", 10.0),))
    near = [at(f"new {number}", 9.0) for number in range(3)]
    assert keys(selector.select((at("old", 10.0), *near))) == {"old"}
    near.append(at("new 3", 9.0))
    assert "old" not in keys(selector.select((at("old", 10.0), *near)))


def test_range_and_score_let_what_is_shown_stay_within_their_margins():
    selector = Selector(Settings(range_m=50.0, range_margin_m=5.0, min_score=0.5, score_margin=0.1))
    assert keys(selector.select((at("a", 49), at("b", 51), at("c", 9, score=0.45)))) == {"a"}
    assert keys(selector.select((at("a", 54, score=0.45), at("b", 51)))) == {"a"}
    assert keys(selector.select((at("a", 56),))) == set()
    assert keys(selector.select((at("a", 54),))) == set()


def test_tentative_tracks_can_be_left_out():
    objects = (at("a", 1, state="tentative"), at("b", 2, state="untracked"), at("c", 3, state="coasting"))
    assert keys(Selector(Settings()).select(objects)) == {"a", "b", "c"}
    assert keys(Selector(Settings(show_tentative=False)).select(objects)) == {"b", "c"}


def test_settings_hold_from_the_next_scene_on():
    selector = Selector(Settings())
    objects = tuple(at(key, key) for key in range(10))
    assert len(selector.select(objects)) == 10
    selector.settings = Settings(most_objects=3)
    assert keys(selector.select(objects)) == {"0", "1", "2"}


def test_detail_falls_with_distance_and_does_not_flicker():
    selector = Selector(Settings(simple_beyond_m=50.0, boxes_beyond_m=100.0))
    chosen = selector.select((at("a", 40), at("b", 60), at("c", 120)))
    assert [each.detail for each in chosen] == ["full", "simple", "boxes"]
    chosen = selector.select((at("a", 54), at("b", 46), at("c", 95)))
    assert {each.placed.seen.key: each.detail for each in chosen} == {
        "a": "full",
        "b": "simple",
        "c": "boxes",
    }
    chosen = selector.select((at("a", 56), at("b", 44), at("c", 89)))
    assert {each.placed.seen.key: each.detail for each in chosen} == {
        "a": "simple",
        "b": "full",
        "c": "simple",
    }


def test_level_of_detail_is_the_finest_that_is_drawn():
    for level in ("simple", "boxes"):
        (chosen,) = Selector(Settings(level_of_detail=level)).select((at("a", 5),))
        assert chosen.detail == level


@pytest.mark.parametrize(("rate_hz", "drawn"), [(0.0, 100), (10.0, 100), (5.0, 50), (3.0, 30), (100.0, 100)])
def test_the_update_rate_is_kept_though_scenes_jitter(rate_hz, drawn):
    rng = np.random.default_rng(3)
    pace = Pace()
    moments = np.arange(100) * 0.1 + rng.uniform(-0.003, 0.003, 100)
    assert sum(pace.is_due(moment, rate_hz) for moment in moments) == pytest.approx(drawn, abs=1)
