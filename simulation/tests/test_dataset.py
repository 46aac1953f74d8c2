"""Rig datasets, clips and training sets on disk: complete, repeatable, never half-written."""

from __future__ import annotations

import hashlib
import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from roadwatch_simulation import capture, dataset
from roadwatch_simulation.clips import encode_clip, write_clips_dataset
from roadwatch_simulation.dataset import stamp_text, write_dataset
from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.motion import straight, standing
from roadwatch_simulation.rig import mount
from roadwatch_simulation.scene import Environment, Scene, SceneObject
from roadwatch_simulation.training_set import TrainingRange, write_training_set

CAMERAS = (
    mount("front", (160, 90), 120.0, (0.0, 0.0, 1.5), delay_s=0.0371),
    mount("left", (160, 90), 120.0, (0.0, 0.0, 1.5), yaw_deg=30.0),
)


@pytest.fixture
def scene() -> Scene:
    things = (
        SceneObject("driver", "sedan", 1, straight((12.0, 0.0), (20.0, 0.0), 0.0, 8.0)),
        SceneObject("parked", "van", 2, standing(14.0, 7.0, 1.0)),
    )
    return Scene(frames=2, rate_hz=10.0, cameras=CAMERAS, objects=things, environment=Environment("plain", 1))


def digest(folder: Path) -> dict[str, str]:
    files = sorted(file for file in folder.rglob("*") if file.is_file())
    return {str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


def lines(file: Path) -> list[dict]:
    return [json.loads(line) for line in file.read_text().splitlines()]


def test_a_dataset_holds_everything_and_nothing_else(scene, tmp_path):
    write_dataset(scene, tmp_path / "made")
    names = set(digest(tmp_path / "made"))
    images = {f"{camera}/{frame:04d}.jpg" for camera in ("front", "left") for frame in (0, 1)}
    assert names == {"rig.toml", "frames.jsonl", "truth.jsonl"} | images
    assert [entry.name for entry in tmp_path.iterdir()] == ["made"]
    assert cv2.imread(str(tmp_path / "made/front/0000.jpg")).shape == (90, 160, 3)
    rig = tomllib.loads((tmp_path / "made/rig.toml").read_text())
    assert [camera["name"] for camera in rig["camera"]] == ["front", "left"]
    assert "delay_s" not in rig["camera"][0]


def test_truth_is_in_each_cameras_own_moment(scene, tmp_path):
    write_dataset(scene, tmp_path / "made")
    truth = lines(tmp_path / "made/truth.jsonl")
    assert [(line["frame"], line["camera"]) for line in truth] == [(0, "front"), (0, "left"), (1, "front"),
        (1, "left")]
    at = {line["camera"]: line["objects"] for line in truth if line["frame"] == 1}
    driver = {camera: next(o for o in objects if o["id"] == "1") for camera, objects in at.items()}
    assert driver["front"]["center_base_m"][0] == pytest.approx(12.0 + 8.0 * 0.1371, abs=1e-3)
    assert driver["left"]["center_base_m"][0] == pytest.approx(12.0 + 8.0 * 0.1, abs=1e-3)
    assert driver["front"]["stationary"] is False
    assert next(o for o in at["left"] if o["id"] == "2")["stationary"] is True


def test_stamps_keep_every_digit(scene, tmp_path):
    write_dataset(scene, tmp_path / "made")
    text = (tmp_path / "made/frames.jsonl").read_text()
    stamps = re.findall(r'"front": ([0-9.]+)', text)
    assert stamps == ["1700000000.037100000", "1700000000.137100000"]
    assert stamp_text(1_000_000_001) == "1.000000001"


def test_the_vehicles_pose_is_that_of_the_frames_own_moment(scene, tmp_path):
    """Whenever cameras fire: `front` does 37 ms later."""
    drive = replace(scene, ego=straight((0.0, 0.0), (10.0, 0.0), 0.0, 5.0))
    write_dataset(drive, tmp_path / "made")
    text = (tmp_path / "made/frames.jsonl").read_text()
    assert re.findall(r'"ego_stamp": ([0-9.]+)', text) == ["1700000000.000000000", "1700000000.100000000"]
    assert [line["ego_position_world_m"] for line in lines(tmp_path / "made/frames.jsonl")] == [
        [0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]
    assert all(line["ego_orientation_world_wxyz"] == [1.0, 0.0, 0.0, 0.0]
        for line in lines(tmp_path / "made/frames.jsonl"))


def test_the_same_scene_twice_gives_the_same_bytes(scene, tmp_path):
    for name in ("a", "b"):
        write_dataset(scene, tmp_path / name)
    assert digest(tmp_path / "a") == digest(tmp_path / "b")


def test_an_existing_folder_is_refused_and_left_alone(scene, tmp_path):
    (tmp_path / "made").mkdir()
    (tmp_path / "made/note").write_text("mine")
    with pytest.raises(SimulationError, match="exists already"):
        write_dataset(scene, tmp_path / "made")
    assert (tmp_path / "made/note").read_text() == "mine"


def test_nothing_half_written_stays_when_a_picture_fails(scene, tmp_path, monkeypatch):
    def fails(*_):
        raise SimulationError("no light")

    monkeypatch.setattr(capture.Studio, "capture", fails)
    with pytest.raises(SimulationError, match="no light"):
        write_dataset(scene, tmp_path / "made")
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_renderer_is_refused_before_anything_is_written(scene, tmp_path):
    with pytest.raises(SimulationError, match="there are light, blender"):
        write_dataset(scene, tmp_path / "made", renderer="chalk")
    assert list(tmp_path.iterdir()) == []


def test_clips_hold_every_frame_at_the_rate_and_repeat_exactly(scene, tmp_path):
    for name in ("a", "b"):
        write_clips_dataset(scene, tmp_path / name, crf=20)
    assert set(digest(tmp_path / "a")) == {"rig.toml", "frames.jsonl", "truth.jsonl", "front.mp4", "left.mp4"}
    assert digest(tmp_path / "a") == digest(tmp_path / "b")
    with av.open(str(tmp_path / "a/front.mp4")) as container:
        stream = container.streams.video[0]
        assert (stream.codec_context.name, stream.width, stream.height) == ("h264", 160, 90)
        assert stream.average_rate == 10
        times = [float(frame.time) for frame in container.decode(stream)]
    assert times == pytest.approx([0.0, 0.1])


def test_truth_beside_clips_is_that_of_what_is_seen_without_parts(scene, tmp_path):
    write_clips_dataset(scene, tmp_path / "clips")
    write_dataset(scene, tmp_path / "images")
    lean, full = lines(tmp_path / "clips/truth.jsonl"), lines(tmp_path / "images/truth.jsonl")
    for few, all_ in zip(lean, full, strict=True):
        seen = [thing for thing in all_["objects"] if thing["visible_px"]]
        for one, other in zip(few["objects"], seen, strict=True):
            assert one == {key: value for key, value in other.items() if key != "parts"}


def test_a_clip_of_nothing_or_of_odd_size_is_refused(tmp_path):
    with pytest.raises(SimulationError, match="holds no .jpg"):
        encode_clip(tmp_path, tmp_path / "a.mp4", 10.0)
    cv2.imwrite(str(tmp_path / "0000.jpg"), np.zeros((45, 80, 3), np.uint8))
    with pytest.raises(SimulationError, match="even width and height"):
        encode_clip(tmp_path, tmp_path / "a.mp4", 10.0)


def test_training_pictures_keep_their_number_and_bytes_whatever_the_range(tmp_path):
    write_training_set(TrainingRange(3, 0, 2), tmp_path / "all")
    write_training_set(TrainingRange(3, 1, 1), tmp_path / "second")
    assert (tmp_path / "all/images/000001.jpg").read_bytes() == (
        tmp_path / "second/images/000001.jpg").read_bytes()
    labels = lines(tmp_path / "all/labels.jsonl")
    assert [line["image"] for line in labels] == ["images/000000.jpg", "images/000001.jpg"]
    assert labels[1] == lines(tmp_path / "second/labels.jsonl")[0]
    wanted = {"class", "label", "silhouette_px", "visible_px", "occluded", "truncated", "box_px", "parts"}
    assert all(wanted <= set(thing) for line in labels for thing in line["objects"])


def test_an_interrupted_training_run_is_taken_up(tmp_path):
    class Stop(Exception):
        pass

    def stop(done, _):
        if done == 1:
            raise Stop

    wanted = TrainingRange(4, 0, 2)
    with pytest.raises(Stop):
        write_training_set(wanted, tmp_path / "made", progress=stop)
    assert not (tmp_path / "made").exists()
    with pytest.raises(SimulationError, match="unfinished run with other settings"):
        write_training_set(replace(wanted, count=3), tmp_path / "made")
    steps = []
    write_training_set(wanted, tmp_path / "made", progress=lambda done, total: steps.append((done, total)))
    assert steps == [(2, 2)]
    assert len(lines(tmp_path / "made/labels.jsonl")) == 2


def test_numbers_of_numpy_become_those_of_json():
    assert json.dumps(dataset.plain({"a": np.float32(0.5), "b": (np.int64(2), np.ones(2))})) == (
        '{"a": 0.5, "b": [2, [1.0, 1.0]]}'
    )
