"""Lens, sensor and compression."""

import cv2
import numpy as np
import pytest

from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.imaging import Imaging, apply, encode_jpeg

CLEAN = Imaging(noise=0.0)


def picture():
    rng = np.random.default_rng(4)
    small = rng.integers(30, 220, (12, 16, 3), dtype=np.uint8)
    return cv2.resize(small, (160, 120), interpolation=cv2.INTER_CUBIC)


def test_a_perfect_camera_changes_nothing():
    image = picture()
    np.testing.assert_array_equal(apply(image, CLEAN, np.random.default_rng(1)), image)


def test_the_same_seed_gives_the_same_picture():
    imaging = Imaging(2.0, 0.6, 4.0, 0.3, 0.2, (1.0, 1.0, 1.1), 0.2, 0.001)
    first, second = (apply(picture(), imaging, np.random.default_rng(8)) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_noise_has_the_given_deviation_at_mid_grey():
    grey = np.full((200, 200, 3), 128, dtype=np.uint8)
    noisy = apply(grey, Imaging(noise=4.0), np.random.default_rng(2)).astype(float)
    assert noisy.std() == pytest.approx(4.0, rel=0.05)
    assert noisy.mean() == pytest.approx(128.0, abs=0.2)


def test_a_stop_doubles_the_light():
    grey = np.full((8, 8, 3), 90, dtype=np.uint8)
    brighter = apply(grey, Imaging(noise=0.0, exposure_ev=1.0), np.random.default_rng(1))
    assert (brighter[0, 0, 0] / 90.0) ** 2.2 == pytest.approx(2.0, rel=0.02)


def test_white_balance_scales_blue_green_red():
    grey = np.full((8, 8, 3), 90, dtype=np.uint8)
    imaging = Imaging(noise=0.0, white_balance=(0.8, 1.0, 1.2))
    blue, green, red = apply(grey, imaging, np.random.default_rng(1))[0, 0]
    assert blue < green < red


def test_a_vignette_darkens_corners_only():
    grey = np.full((100, 160, 3), 128, dtype=np.uint8)
    dark = apply(grey, Imaging(noise=0.0, vignette=0.5), np.random.default_rng(1))
    assert dark[50, 80, 0] == 128
    assert (dark[0, 0, 0] / 128.0) ** 2.2 == pytest.approx(0.5, rel=0.05)


def test_motion_smears_along_its_direction_only():
    image = np.zeros((41, 41, 3), dtype=np.uint8)
    image[20, 20] = 255
    smeared = apply(image, Imaging(noise=0.0, motion_px=9.0), np.random.default_rng(1))
    rows, columns = np.nonzero(smeared[:, :, 0])
    assert set(rows) == {20}
    assert 8 <= columns.max() - columns.min() <= 10


def test_aberration_parts_the_colours_away_from_the_middle():
    image = np.zeros((101, 201, 3), dtype=np.uint8)
    image[:, 180:184] = 255
    parted = apply(image, Imaging(noise=0.0, aberration=0.02), np.random.default_rng(1)).astype(float)
    columns = np.arange(201)
    blue, green, red = (np.average(columns, weights=parted[50, :, channel]) for channel in range(3))
    assert blue < green - 1.0 < red - 2.0


def test_jpeg_comes_back_nearly_the_same():
    image = picture()
    again = cv2.imdecode(np.frombuffer(encode_jpeg(image, 95), np.uint8), cv2.IMREAD_COLOR)
    assert np.abs(again.astype(int) - image).mean() < 3.0


@pytest.mark.parametrize(
    "wrong", [{"noise": -1.0}, {"blur_px": float("nan")}, {"vignette": 1.0}, {"jpeg_quality": 0}]
)
def test_impossible_settings_are_refused(wrong):
    (name,) = wrong
    with pytest.raises(SimulationError, match=name):
        Imaging(**wrong)
