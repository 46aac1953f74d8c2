"""The viewer's settings: what is drawn of a scene, how finely and how often."""

from __future__ import annotations

import dataclasses
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import ViewerError

DETAILS: tuple[str, ...] = ("full", "simple", "boxes")
ENGINES: tuple[str, ...] = ("auto", "workbench", "eevee", "cycles")


@dataclass(frozen=True)
class Settings:
    """Every key of viewer.toml; units are in the names. See viewer.toml for what they mean."""

    most_objects: int = 60
    rank_margin: int = 5
    distance_margin_m: float = 2.0
    range_m: float = 150.0
    range_margin_m: float = 5.0
    min_score: float = 0.0
    score_margin: float = 0.05
    show_tentative: bool = True
    update_rate_hz: float = 0.0
    level_of_detail: str = "full"
    simple_beyond_m: float = 60.0
    boxes_beyond_m: float = 0.0
    labels: bool = False
    trail_s: float = 0.0
    forget_after_s: float = 10.0
    fps: int = 30
    ego_length_m: float = 4.6
    ego_width_m: float = 1.85
    ego_height_m: float = 1.5
    ego_center_x_m: float = 0.0
    engine: str = "auto"
    samples: int = 16
    width_px: int = 960
    height_px: int = 540


_BOUNDS: dict[str, tuple[float, float]] = {
    "most_objects": (0, 10_000),
    "rank_margin": (0, 10_000),
    "min_score": (0, 1),
    "score_margin": (0, 1),
    "fps": (1, 1000),
    "samples": (1, 4096),
    "width_px": (16, 16384),
    "height_px": (16, 16384),
    "ego_center_x_m": (-100, 100),
    "ego_length_m": (0.1, 100),
    "ego_width_m": (0.1, 100),
    "ego_height_m": (0.1, 100),
}
_CHOICES: dict[str, tuple[str, ...]] = {"level_of_detail": DETAILS, "engine": ENGINES}


def load_settings(path: Path) -> Settings:
    """The settings of a TOML file; keys that are not there keep their defaults.

    Raises ViewerError with all mistakes at once, each with file, line and key.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ViewerError(f"cannot read settings {path}: {error}") from error
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ViewerError(f"{path}: no TOML: {error}") from error
    mistakes = [
        f"{path}:{_line_of(text, key)}: {key}: {mistake}"
        for key, value in values.items()
        if (mistake := _mistake(key, value))
    ]
    if mistakes:
        raise ViewerError("\n".join(mistakes))
    return Settings(**{key: _typed(key, value) for key, value in values.items()})


def _mistake(key: str, value: Any) -> str | None:
    """What is wrong with a value, or None."""
    defaults = {field.name: field.default for field in dataclasses.fields(Settings)}
    if key not in defaults:
        return f"no such key; the keys are {', '.join(defaults)}"
    default = defaults[key]
    if isinstance(default, bool):
        return None if isinstance(value, bool) else f"{value!r} is neither true nor false"
    if isinstance(default, str):
        return None if value in _CHOICES[key] else f"{value!r} is none of {', '.join(_CHOICES[key])}"
    kinds = (int,) if isinstance(default, int) else (int, float)
    if isinstance(value, bool) or not isinstance(value, kinds):
        return f"{value!r} is no {'whole ' if kinds == (int,) else ''}number"
    low, high = _BOUNDS.get(key, (0, 1e9))
    return None if low <= value <= high else f"{value!r} is not between {low:g} and {high:g}"


def _typed(key: str, value: Any) -> Any:
    return type(getattr(Settings, key))(value)


def _line_of(text: str, key: str) -> int:
    """The line where a top-level key or table stands, from 1."""
    pattern = re.compile(rf"""^\s*\[*\s*["']?{re.escape(key)}["']?\s*[=.\]]""")
    lines = text.splitlines()
    return next((number for number, line in enumerate(lines, 1) if pattern.match(line)), 1)
