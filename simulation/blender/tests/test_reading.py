"""Files and pieces of lines."""

import json

import pytest
from streams import a_rig, a_scene, an_object, text

from roadwatch_viewer.errors import MalformedLine, NewerVersion, ViewerError
from roadwatch_viewer.reading import LONGEST_LINE_BYTES, LineBuffer, Warnings, read_recording


def test_lines_come_out_whole_however_they_were_cut():
    whole = text([a_rig(), a_scene(0, 0, [an_object(1, (1, 2, 3))])]).encode()
    buffer, lines = LineBuffer(), []
    for start in range(0, len(whole), 7):
        lines += buffer.push(whole[start : start + 7])
    assert [json.loads(line)["type"] for line in lines] == ["rig", "scene"]


def test_a_line_without_end_is_not_waited_for():
    buffer = LineBuffer()
    with pytest.raises(MalformedLine, match="longer than"):
        for _ in range(LONGEST_LINE_BYTES // 65536 + 2):
            buffer.push(b"x" * 65536)


def test_bad_lines_of_a_file_are_counted_and_the_rest_is_read(tmp_path):
    path = tmp_path / "scene.jsonl"
    good = [a_rig(), a_scene(0, 0, []), a_scene(1, 10**8, [])]
    path.write_text(text(good[:2]) + "half a li\n" + text(good[2:]) + '{"type": "scene", "seq"')
    recording = read_recording(path)
    assert (len(recording.scenes), recording.left_out) == (2, 2)
    assert recording.seconds == pytest.approx(0.1)


@pytest.mark.parametrize("lines", [[], [a_rig()], [a_scene(0, 0, [])]])
def test_a_file_without_rig_or_scenes_says_how_to_make_one(tmp_path, lines):
    path = tmp_path / "scene.jsonl"
    path.write_text(text(lines))
    with pytest.raises(ViewerError, match="roadwatch export scene"):
        read_recording(path)


def test_a_newer_file_is_refused(tmp_path):
    path = tmp_path / "scene.jsonl"
    path.write_text(text([a_rig(version=9), a_scene(0, 0, [])]))
    with pytest.raises(NewerVersion, match="version 9"):
        read_recording(path)


def test_many_warnings_are_said_once_a_second_and_all_counted():
    said = []
    warnings = Warnings(said.append)
    for _ in range(1000):
        warnings.warn("bad line")
    assert (warnings.count, len(said)) == (1000, 1)
