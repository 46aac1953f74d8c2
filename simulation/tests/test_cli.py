"""The command line: what it writes, what it says, and its exit status."""

from __future__ import annotations

from pathlib import Path

import cv2
import pytest

from roadwatch_simulation.cli import main

SCENE = """
frames = 2
[environment]
kind = "plain"
[[rig.camera]]
name = "front"
width = 160
height = 90
fx = 120.0
position_m = [0.0, 0.0, 1.5]
[[object]]
kind = "sedan"
x_m = 12.0
y_m = 0.0
"""


@pytest.fixture
def scene(tmp_path) -> Path:
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


def test_check_says_what_a_sound_scene_holds(scene, capsys):
    assert main(["check", str(scene)]) == 0
    assert "2 frames at 10 Hz, 1 cameras, 1 objects; nothing wrong" in capsys.readouterr().out


def test_check_reports_mistakes_and_fails(scene, capsys):
    scene.write_text(SCENE.replace("frames = 2", "frames = 0\ncolour = 1"))
    assert main(["check", str(scene)]) == 1
    said = capsys.readouterr().err
    assert "scene.toml: frames: is 0" in said
    assert "scene.toml: colour: unknown key" in said


def test_render_writes_a_dataset_and_reports_progress_in_plain_lines(scene, tmp_path, capsys):
    assert main(["render", str(scene), "-o", str(tmp_path / "made")]) == 0
    assert (tmp_path / "made/truth.jsonl").exists()
    said = capsys.readouterr().err
    assert "pictures 2/2" in said
    assert "\r" not in said


def test_render_refuses_a_folder_that_exists(scene, tmp_path, capsys):
    assert main(["render", str(scene), "-o", str(tmp_path)]) == 1
    assert "exists already" in capsys.readouterr().err


def test_scenario_makes_clips(tmp_path, monkeypatch):
    from roadwatch_simulation.scenarios import paper

    monkeypatch.setattr(paper, "SIZE_PX", (192, 108))
    assert main(["scenario", "turntable", "--frames", "2", "--clips", "-o", str(tmp_path / "made")]) == 0
    assert (tmp_path / "made/camera.mp4").stat().st_size > 0


def test_picture_writes_one_image(scene, tmp_path):
    file = tmp_path / "look.png"
    assert main(["picture", str(scene), "--frame", "1", "--camera", "front", "-o", str(file)]) == 0
    assert cv2.imread(str(file)).shape == (90, 160, 3)


@pytest.mark.parametrize(
    ("options", "message"),
    [(["--frame", "7"], "frames 0 to 1"), (["--camera", "rear"], "the rig has front")],
)
def test_picture_names_what_there_is(scene, tmp_path, capsys, options, message):
    assert main(["picture", str(scene), *options, "-o", str(tmp_path / "look.png")]) == 1
    assert message in capsys.readouterr().err


def test_training_writes_pictures_and_labels(tmp_path):
    assert main(["training", "--seed", "2", "--count", "1", "--first", "4", "-o",
        str(tmp_path / "made")]) == 0
    assert (tmp_path / "made/images/000004.jpg").exists()


@pytest.mark.parametrize("command", [[], ["render"], ["scenario"], ["training"], ["check"], ["picture"]])
def test_help_teaches(command, capsys):
    with pytest.raises(SystemExit) as ended:
        main([*command, "--help"])
    assert ended.value.code == 0
    assert "usage: roadwatch-simulate" in capsys.readouterr().out
