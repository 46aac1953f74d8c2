"""A recording as keyframes, and pictures of it."""

import json
import math
from pathlib import Path

import pytest
from streams import FRONT, a_rig, a_scene, an_object, text

from roadwatch_viewer.errors import ViewerError
from roadwatch_viewer.reading import read_recording
from roadwatch_viewer.settings import Settings

T0 = 1_557_539_956_450_180_000
# Stamps that fall between Blender's frames, as those of cameras do.
STAMPS = [T0, T0 + 103_000_000, T0 + 198_500_000, T0 + 300_000_000, T0 + 1_000_000_000]


@pytest.fixture
def recording(tmp_path):
    """Track 1 turns through half a turn's seam, track 2 comes late and goes early."""
    yaws = [3.0, 3.1, -3.1, -3.0, -2.9]
    scenes = []
    for seq, (time_ns, yaw) in enumerate(zip(STAMPS, yaws, strict=True)):
        objects = [an_object(1, (20 + seq, 2, 0.75), yaw=yaw)]
        if seq in (1, 2):
            objects.append(an_object(2, (30, -seq, 0.75), yaw=None if seq == 2 else 0.0))
        scenes.append(a_scene(seq, time_ns, objects, ego=(4e6 + seq, 5e5, 10.0)))
    path = tmp_path / "scene.jsonl"
    path.write_text(text([a_rig([FRONT]), *scenes]))
    return read_recording(path)


@pytest.fixture
def replay(blender, recording):
    from roadwatch_viewer.replay import load_replay

    return load_replay(blender, recording, Settings(fps=25, labels=True, trail_s=0.5))


def track(viewer, number):
    return next(each for each in viewer.tracks.values() if each.root.name.split()[1] == str(number))


def curves(thing):
    action = thing.animation_data.action
    bag = action.layers[0].strips[0].channelbag(thing.animation_data.action_slot)
    return {(curve.data_path, curve.array_index): curve for curve in bag.fcurves}


def test_keyframes_stand_at_capture_time(replay):
    wanted = [1 + (stamp - T0) * 1e-9 * 25 for stamp in STAMPS]
    curve = curves(track(replay, 1).root)["location", 0]
    assert [point.co.x for point in curve.keyframe_points] == pytest.approx(wanted, abs=1e-4)
    assert [point.co.y for point in curve.keyframe_points] == pytest.approx(
        [20 + 2 * n for n in range(5)], abs=1e-3
    )
    assert {point.interpolation for point in curve.keyframe_points} == {"LINEAR"}


def test_the_yaw_goes_the_short_way(replay, blender):
    from roadwatch_viewer.replay import set_time

    values = [point.co.y for point in curves(track(replay, 1).root)["rotation_euler", 2].keyframe_points]
    assert all(abs(after - before) < 0.2 for before, after in zip(values, values[1:], strict=False))
    set_time(blender, 0.15, 25)
    assert abs(math.cos(track(replay, 1).root.rotation_euler.z) + 1.0) < 0.01


def test_a_track_is_seen_exactly_while_it_is_there(replay, blender):
    from roadwatch_viewer.replay import set_time

    for time_s, is_there in (
        (0.0, False),
        (0.05, False),
        (0.11, True),
        (0.25, True),
        (0.31, False),
        (0.9, False),
    ):
        set_time(blender, time_s, 25)
        seen = [each for each in track(replay, 2).objects() if each.type != "EMPTY" and not each.hide_render]
        assert bool(seen) == is_there, time_s


def test_an_arrow_is_gone_from_when_the_heading_is_lost(replay, blender):
    from roadwatch_viewer.replay import set_time

    (arrow,) = [each for each in track(replay, 2).objects() if each.name.endswith("arrow")]
    for time_s, is_hidden in ((0.15, False), (0.21, True)):
        set_time(blender, time_s, 25)
        assert arrow.hide_render is is_hidden


def test_the_vehicle_moves_and_the_clock_covers_the_recording(replay, blender):
    from roadwatch_viewer.replay import set_time

    assert (blender.frame_start, blender.frame_end, blender.render.fps) == (1, 26, 25)
    set_time(blender, 1.0, 25)
    assert tuple(replay.vehicle.base_link.location) == pytest.approx((4.0, 0.0, 0.0), abs=1e-3)


def test_the_update_rate_thins_a_replay(blender, recording):
    from roadwatch_viewer.replay import load_replay

    viewer = load_replay(blender, recording, Settings(update_rate_hz=5.0))
    assert len(curves(track(viewer, 1).root)["location", 0].keyframe_points) == 3


@pytest.fixture
def photographer(blender, recording, replay):
    from roadwatch_viewer.stage.pictures import Photographer

    settings = Settings(fps=25, width_px=192, height_px=108, samples=1)
    return Photographer(blender, replay, recording, settings)


def pixels(path):
    import bpy
    import numpy as np

    image = bpy.data.images.load(str(path))
    values = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def test_a_still_has_the_right_size_and_shows_something(photographer, tmp_path):
    photographer.still("overview", 0.11, tmp_path / "new" / "still.png")
    seen = pixels(tmp_path / "new" / "still.png")
    assert seen.shape == (108, 192, 4)
    assert seen[..., :3].std() > 0.02


def test_a_cameras_view_has_the_cameras_size(photographer, tmp_path):
    photographer.still("front", 0.0, tmp_path / "front.png")
    assert pixels(tmp_path / "front.png").shape == (540, 960, 4)


@pytest.mark.parametrize(
    ("view", "at_s", "said"), [("rear", 0.0, "overview, top, front"), ("top", 9.0, "from 0 to 1.000")]
)
def test_a_still_of_nothing_says_what_there_is(photographer, tmp_path, view, at_s, said):
    with pytest.raises(ViewerError, match=said):
        photographer.still(view, at_s, tmp_path / "still.png")


def test_a_clip_is_written(photographer, tmp_path):
    steps = []
    photographer.clip(
        "overview", 0.1, 0.12, tmp_path / "clip.mp4", lambda done, total: steps.append((done, total))
    )
    assert steps == [(1, 3), (2, 3), (3, 3)]
    assert (tmp_path / "clip.mp4").read_bytes()[4:8] == b"ftyp"


@pytest.fixture
def dataset(tmp_path):
    """Three images of camera `front`, each of one brightness."""
    import cv2
    import numpy as np

    folder = tmp_path / "rig"
    (folder / "front").mkdir(parents=True)
    stamps = []
    for number, brightness in enumerate((40, 120, 200)):
        cv2.imwrite(str(folder / "front" / f"{number:04d}.jpg"), np.full((540, 960, 3), brightness, np.uint8))
        stamps.append(f"{(T0 + number * 10**8) / 1e9:.9f}")
    lines = [f'{{"frame": {number}, "stamp": {{"front": {stamp}}}}}\n' for number, stamp in enumerate(stamps)]
    (folder / "frames.jsonl").write_text("".join(lines))
    return folder


def test_boxes_are_laid_over_the_image_nearest_in_time(blender, recording, replay, dataset, tmp_path):
    from roadwatch_viewer.dataset import read_images
    from roadwatch_viewer.stage.pictures import Photographer

    images = read_images(Path(dataset))
    made = Photographer(blender, replay, recording, Settings(fps=25), images)
    for at_s, brightness in ((0.0, 40), (0.11, 120), (0.9, 200)):
        made.still("front", at_s, tmp_path / "over.png")
        seen = pixels(tmp_path / "over.png")[..., :3] * 255
        assert abs(seen[500:, :, :] - brightness).max() < 4
        assert (abs(seen - brightness).max(axis=2) > 40).sum() > 500
    assert replay.vehicle.cameras["front"].data.background_images[0].image.name.startswith("0000.jpg")


def test_a_folder_without_images_is_refused(tmp_path):
    from roadwatch_viewer.dataset import read_images

    with pytest.raises(ViewerError, match="no rig dataset"):
        read_images(tmp_path)
    (tmp_path / "frames.jsonl").write_text(json.dumps({"frame": 0, "stamp": {"front": 1.5}}) + "\n")
    with pytest.raises(ViewerError, match="neither <camera>.mp4 nor <camera>/0000.jpg"):
        read_images(tmp_path)
