"""Every model stands on the ground, has its exact size, its named parts, and follows from its seed."""

from __future__ import annotations

import numpy as np
import pytest

from roadwatch_simulation import catalogue
from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.materials import car_colour
from roadwatch_simulation.model import Model

FOUR_WHEELED = ("sedan", "compact", "suv", "pickup", "minivan", "wagon", "sports", "van", "bus", "truck")
FOUR_WHEEL_PARTS = {
    "tyre_front_left", "tyre_front_right", "tyre_rear_left", "tyre_rear_right", "mirror_left", "mirror_right",
    "plate_front", "plate_rear", "headlamp_left", "headlamp_right", "taillamp_left", "taillamp_right",
}  # fmt: skip
CLASSES = {
    "sedan": "car", "compact": "car", "suv": "car", "minivan": "car", "wagon": "car", "sports": "car",
    "pickup": "truck", "van": "truck", "truck": "truck", "bus": "bus", "pedestrian": "person",
    "bicycle": "bicycle", "motorcycle": "motorcycle",
}  # fmt: skip
LARGEST_M = {
    "sedan": (4.8, 1.8, 1.7), "compact": (4.2, 1.8, 1.5), "suv": (5.1, 2.1, 1.6), "pickup": (6.0, 2.0, 1.8),
    "minivan": (5.4, 2.1, 1.8), "wagon": (4.8, 1.8, 1.6), "sports": (5.0, 1.9, 1.2),
}  # fmt: skip
"""METHOD.md section 2: maxima of the paper's car categories."""

SEEDS = (0, 7, 4242)


def points_of(model: Model, without_mirrors: bool = True) -> np.ndarray:
    names = list(model.part_centers_m)
    mirrors = [number + 1 for number, name in enumerate(names) if name.startswith("mirror_")]
    kept = ~np.isin(model.mesh.parts, mirrors) if without_mirrors else slice(None)
    return model.mesh.positions[kept].reshape(-1, 3)


def part_points(model: Model, name: str) -> np.ndarray:
    number = list(model.part_centers_m).index(name) + 1
    return model.mesh.positions[model.mesh.parts == number].reshape(-1, 3)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", catalogue.KINDS)
def test_a_model_fills_its_size_exactly_and_stands_on_the_ground(kind: str, seed: int) -> None:
    model = catalogue.build(kind, seed)
    points = points_of(model)
    length, width, height = model.size_lwh_m
    assert points.min(axis=0) == pytest.approx((-length / 2, -width / 2, 0.0), abs=1e-4)
    assert points.max(axis=0) == pytest.approx((length / 2, width / 2, height), abs=1e-4)
    assert model.object_class == CLASSES[kind]


@pytest.mark.parametrize("kind", catalogue.KINDS)
def test_a_size_that_is_asked_for_is_kept(kind: str) -> None:
    length, width, height = catalogue.build(kind, 3).size_lwh_m
    asked = (length * 1.06, width * 0.95, height * 1.04)
    model = catalogue.build(kind, 3, size_lwh_m=asked)
    points = points_of(model)
    assert model.size_lwh_m == pytest.approx(asked)
    assert points.max(axis=0) - points.min(axis=0) == pytest.approx(asked, abs=1e-4)


@pytest.mark.parametrize("kind", sorted(LARGEST_M))
def test_drawn_sizes_stay_below_the_maxima_of_the_tables(kind: str) -> None:
    sizes = np.array([catalogue.build(kind, seed).size_lwh_m for seed in range(8)])
    assert (sizes <= np.array(LARGEST_M[kind]) + 1e-6).all()
    assert (sizes.std(axis=0) > 0.001).all()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", FOUR_WHEELED)
def test_vehicles_have_every_named_part_in_its_place(kind: str, seed: int) -> None:
    model = catalogue.build(kind, seed)
    centers = model.part_centers_m
    assert set(centers) == FOUR_WHEEL_PARTS
    for name, (x, y, z) in centers.items():
        points = part_points(model, name)
        assert (x, y, z) == pytest.approx((points.min(axis=0) + points.max(axis=0)) / 2, abs=1e-4), name
        assert (y > 0) == name.endswith("left") or name.startswith("plate"), name
        assert (x > 0) == ("front" in name or "head" in name or "mirror" in name), name
        assert 0.0 < z < model.size_lwh_m[2], name


@pytest.mark.parametrize("kind", FOUR_WHEELED)
def test_all_four_tyres_touch_the_ground(kind: str) -> None:
    model = catalogue.build(kind, 11)
    for name in model.part_centers_m:
        if name.startswith("tyre_"):
            assert part_points(model, name)[:, 2].min() == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("kind", FOUR_WHEELED)
def test_mirrors_stick_out_on_both_sides(kind: str) -> None:
    model = catalogue.build(kind, 5)
    half = model.size_lwh_m[1] / 2
    assert part_points(model, "mirror_left")[:, 1].max() > half + 0.05
    assert part_points(model, "mirror_right")[:, 1].min() < -half - 0.05


@pytest.mark.parametrize("kind", ("bicycle", "motorcycle"))
def test_two_wheelers_have_a_tyre_at_each_end(kind: str) -> None:
    centers = catalogue.build(kind, 2).part_centers_m
    assert centers["tyre_front"][0] > 0.3
    assert centers["tyre_rear"][0] < -0.3


@pytest.mark.parametrize("kind", catalogue.KINDS)
def test_meshes_are_sound_and_light(kind: str) -> None:
    mesh = catalogue.build(kind, 9).mesh
    assert np.isfinite(mesh.positions).all()
    assert np.linalg.norm(mesh.normals, axis=2) == pytest.approx(1.0, abs=1e-3)
    assert 1_000 < len(mesh.positions) < 12_500
    assert mesh.positions.dtype == mesh.normals.dtype == np.float32


@pytest.mark.parametrize("kind", catalogue.KINDS)
def test_normals_point_to_the_side_from_which_corners_run_counter_clockwise(kind: str) -> None:
    mesh = catalogue.build(kind, 1).mesh
    corners = mesh.positions.astype(float)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    agree = np.einsum("ij,ij->i", faces, mesh.normals.mean(axis=1)) > 0
    assert agree.mean() > 0.999


@pytest.mark.parametrize("kind", catalogue.KINDS)
def test_the_skin_faces_outwards(kind: str) -> None:
    """A closed body seen from outside encloses a volume above zero."""
    corners = catalogue.build(kind, 1).mesh.positions.astype(float)
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    assert volume > 0.02


@pytest.mark.parametrize("kind", catalogue.KINDS)
def test_the_same_seed_gives_the_same_model_and_another_seed_another(kind: str) -> None:
    first = catalogue.build(kind, 21)
    catalogue.build.cache_clear()
    again = catalogue.build(kind, 21)
    other = catalogue.build(kind, 22)
    assert first is not again
    assert np.array_equal(first.mesh.positions, again.mesh.positions)
    assert first.materials == again.materials
    assert first.mesh.positions.shape != other.mesh.positions.shape or not np.allclose(
        first.mesh.positions, other.mesh.positions
    )


@pytest.mark.parametrize("kind", catalogue.KINDS)
def test_a_colour_that_is_asked_for_is_worn(kind: str) -> None:
    colour = (0.123, 0.234, 0.345)
    model = catalogue.build(kind, 6, colour=colour)
    assert colour in [material.colour for material in model.materials]


def test_most_cars_are_white_black_grey_or_silver() -> None:
    rng = np.random.default_rng(1)
    plain = [max(colour) - min(colour) < 0.06 for colour in (car_colour(rng) for _ in range(1000))]
    assert 0.75 < np.mean(plain) < 0.90


def test_an_unknown_kind_is_refused_with_the_kinds_there_are() -> None:
    with pytest.raises(SimulationError, match="hovercraft.*sedan.*motorcycle"):
        catalogue.build("hovercraft", 0)
