"""Settings files: the example says the defaults, mistakes are said all at once with their places."""

from pathlib import Path

import pytest

from roadwatch_viewer.errors import ViewerError
from roadwatch_viewer.settings import Settings, load_settings

EXAMPLE = Path(__file__).parent.parent / "viewer.toml"


def test_the_example_has_every_key_with_its_default():
    assert load_settings(EXAMPLE) == Settings()
    assert all(f"\n{key} = " in EXAMPLE.read_text() for key in Settings.__dataclass_fields__)


def test_all_mistakes_are_said_with_file_line_and_key(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        'most_object = 3\n\nrange_m = "far"\nmin_score = 2\n'
        'level_of_detail = "fine"\nlabels = 1\nfps = 2.5\n[cars]\n'
    )
    with pytest.raises(ViewerError) as caught:
        load_settings(path)
    lines = str(caught.value).splitlines()
    wanted = [
        (1, "most_object"),
        (3, "range_m"),
        (4, "min_score"),
        (5, "level_of_detail"),
        (6, "labels"),
        (7, "fps"),
        (8, "cars"),
    ]
    assert len(lines) == len(wanted)
    for line, (number, key) in zip(lines, wanted, strict=True):
        assert line.startswith(f"{path}:{number}: {key}: ")


def test_what_is_no_toml_says_where(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("most_objects = \n")
    with pytest.raises(ViewerError, match=r"mine\.toml.*line 1"):
        load_settings(path)


def test_a_whole_number_will_do_for_metres(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("range_m = 40\n")
    assert load_settings(path) == Settings(range_m=40.0)
