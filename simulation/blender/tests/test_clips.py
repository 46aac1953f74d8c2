"""Datasets of clips, as the demo is: that the frame that is seen is the right one."""

import json
from pathlib import Path

import numpy as np
import pytest
from streams import dataset_lines, text

from roadwatch_viewer.dataset import read_images
from roadwatch_viewer.errors import ViewerError
from roadwatch_viewer.reading import read_recording
from roadwatch_viewer.settings import Settings

DEMO = Path(__file__).parents[3] / "demo"
LOOKED_AT = [0, 57, 58, 109]
"""Places in the demo's clips: the first, the last, and neighbours between."""


@pytest.fixture(scope="module")
def decoded():
    """The front camera's clip as another decoder has it, every fourth pixel: (frame, height, width, 3)."""
    av = pytest.importorskip("av")
    with av.open(str(DEMO / "front.mp4")) as clip:
        return np.stack([frame.to_ndarray(format="rgb24")[::4, ::4] for frame in clip.decode(video=0)])


@pytest.fixture
def demo_recording(tmp_path):
    """The demo's truth, each scene at the moment of the front camera's image."""
    path = tmp_path / "scene.jsonl"
    path.write_text(text(dataset_lines(DEMO, "front")))
    return read_recording(path)


@pytest.fixture
def photographer(blender, demo_recording):
    from roadwatch_viewer.replay import load_replay
    from roadwatch_viewer.stage.pictures import Photographer

    settings = Settings(width_px=192, height_px=108, samples=1)
    viewer = load_replay(blender, demo_recording, settings)
    return Photographer(blender, viewer, demo_recording, settings, read_images(DEMO))


def picture(path):
    """Pixels as bytes, the highest row first."""
    import bpy

    image = bpy.data.images.load(str(path))
    values = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
    image.pixels.foreach_get(values)
    return np.round(values.reshape(image.size[1], image.size[0], 4)[::-1, :, :3] * 255)


def most_alike(seen, decoded):
    """Which of the clip's frames it is, and how far off in the mean."""
    apart = [np.abs(frame - seen[::4, ::4]).mean() for frame in decoded.astype(float)]
    return int(np.argmin(apart)), min(apart)


def test_a_clip_has_one_image_for_each_stamp():
    images = read_images(DEMO)
    assert sorted(images) == ["back", "front", "front_left", "front_right", "left", "right"]
    front = images["front"]
    assert front.is_clip and front.file(57) == DEMO / "front.mp4"
    assert [front.nearest(stamp) for stamp in front.stamps_ns] == list(range(1, 111))
    assert front.nearest(front.stamps_ns[57] + 30_000_000) == 58
    assert front.nearest_stamp_ns(front.stamps_ns[57] + 30_000_000) == front.stamps_ns[57]


def test_images_of_a_clip_count_stamps_and_not_frames(tmp_path):
    (tmp_path / "left.mp4").touch()
    lines = [{"frame": 7, "stamp": {"right": 1.0}}, {"frame": 8, "stamp": {"left": 2.0}}]
    (tmp_path / "frames.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    images = read_images(tmp_path)
    assert list(images) == ["left"] and images["left"].numbers == (1,)


def test_the_image_under_the_boxes_is_the_one_of_that_moment(photographer, decoded, tmp_path):
    stamps_ns = photographer.images["front"].stamps_ns
    for place in LOOKED_AT:
        photographer.still("front", (stamps_ns[place] - stamps_ns[0]) * 1e-9, tmp_path / "seen.png")
        found, apart = most_alike(picture(tmp_path / "seen.png"), decoded)
        assert found == place and apart < 12.0


def test_blenders_window_has_the_same_image_behind_the_camera(photographer, blender):
    stamps_ns = photographer.images["front"].stamps_ns
    behind = photographer.viewer.vehicle.cameras["front"].data.background_images[0]
    assert behind.image.source == "MOVIE"
    for frame in (1, 40, 150):
        blender.frame_set(frame)
        # A movie one frame long shows its first frame and so many more.
        shown = behind.image_user.frame_offset
        assert abs(stamps_ns[shown] - stamps_ns[0] - (frame - 1) / 30 * 1e9) <= 42e6


def test_a_clip_of_another_length_is_refused(blender, tmp_path):
    import bpy
    from roadwatch_viewer.stage.images import show_behind

    (tmp_path / "front.mp4").symlink_to(DEMO / "front.mp4")
    (tmp_path / "frames.jsonl").write_text('{"frame": 0, "stamp": {"front": 1.5}}\n')
    camera = bpy.data.objects.new("front", bpy.data.cameras.new("front"))
    with pytest.raises(ViewerError, match=r"front\.mp4 has 110 frames, and 1 stamps"):
        show_behind(camera, read_images(tmp_path)["front"], {1: 0})


def test_side_by_side_is_of_the_image_nearest_in_time(photographer, decoded, tmp_path):
    from roadwatch_viewer.stage.side_by_side import side_by_side

    stamps_ns = photographer.images["front"].stamps_ns
    captured_s = (stamps_ns[57] - stamps_ns[0]) * 1e-9
    moment_s = side_by_side(photographer, "front", "overview", captured_s + 0.03, tmp_path / "a" / "b.png")
    assert moment_s == pytest.approx(captured_s, abs=1e-6)
    both = picture(tmp_path / "a" / "b.png")
    assert both.shape == (450, 1608, 3)
    assert (both[:, 800:808] == 255).all()
    left = both[np.arange(540) * 450 // 540][:, np.arange(960) * 800 // 960]
    assert most_alike(left, decoded)[0] == 57
    assert both[:, 808:].std() > 5


@pytest.mark.parametrize(
    ("camera", "name", "said"), [("rear", "a.png", "front_left"), ("front", "a.gif", r"\.png, \.jpg")]
)
def test_side_by_side_says_what_it_cannot_do(photographer, tmp_path, camera, name, said):
    from roadwatch_viewer.stage.side_by_side import side_by_side

    with pytest.raises(ViewerError, match=said):
        side_by_side(photographer, camera, "overview", 0.0, tmp_path / name)
