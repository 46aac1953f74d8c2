"""Scene descriptions on disk, TOML or JSON: read strictly, all mistakes reported together."""

from __future__ import annotations

import json
import math
import tomllib
from dataclasses import fields
from pathlib import Path as FilePath
from typing import Any

from . import catalogue
from .collisions import collisions
from .errors import SimulationError
from .imaging import Imaging
from .motion import Path, Waypoint, standing
from .rig_file import read_mounts
from .scene import LIGHT_KINDS, Environment, Scene, SceneObject
from .scenery import ENVIRONMENT_KINDS, Layout, build_place
from .table import Mistakes, Table

SCENE_KEYS = ("seed", "frames", "rate_hz", "environment", "imaging", "rig", "ego", "object")
ENVIRONMENT_KEYS = ("kind", "seed", "light", "sun_azimuth_deg", "sun_elevation_deg")
PLACE_KEYS = ("x_m", "y_m", "yaw_deg")
LANE_KEYS = ("lane", "along_m", "left_m", "speed_m_per_s")
MOTION_KEYS = (*PLACE_KEYS, *LANE_KEYS, "waypoints")
OBJECT_KEYS = ("name", "kind", "seed", "size_lwh_m", "colour", *MOTION_KEYS)
WAYPOINT_KEYS = ("time_s", "x_m", "y_m", "yaw_deg")
MOST_FRAMES = 100_000


def read_scene(file: FilePath) -> Scene:
    """The scene in a file. Raises SimulationError with every mistake in it, each with its place."""
    file = FilePath(file)
    mistakes = Mistakes()
    scene = _scene(Table(_load(file), "", mistakes, SCENE_KEYS), file.parent)
    if not mistakes:
        mistakes.extend(collisions(scene))
    if mistakes:
        raise SimulationError("\n".join(f"{file.name}: {mistake}" for mistake in mistakes))
    return scene


def _load(file: FilePath) -> Any:
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SimulationError(f"cannot read the scene `{file}`: {error}") from error
    try:
        return json.loads(text) if file.suffix == ".json" else tomllib.loads(text)
    except (json.JSONDecodeError, tomllib.TOMLDecodeError) as error:
        raise SimulationError(f"{file.name}: {error}") from error


def _scene(table: Table, folder: FilePath) -> Scene:
    environment = _environment(table)
    layout = build_place(environment.kind, environment.seed).layout
    return Scene(
        frames=table.integer("frames", least=1, most=MOST_FRAMES),
        rate_hz=table.number("rate_hz", 10.0, least=0.01, most=1000.0),
        cameras=read_mounts(table, folder),
        objects=tuple(_object(values, index, layout, table.mistakes)
                      for index, values in enumerate(table.tables("object"), start=1)),
        seed=table.integer("seed", 0),
        environment=environment,
        imaging=_imaging(table),
        ego=_ego(table, layout),
    )  # fmt: skip


def _environment(scene: Table) -> Environment:
    table = Table(scene.raw("environment") or {}, "[environment]", scene.mistakes, ENVIRONMENT_KEYS)
    usual = Environment()
    return Environment(
        kind=table.text("kind", usual.kind, among=ENVIRONMENT_KINDS),
        seed=table.integer("seed", usual.seed),
        light=table.text("light", usual.light, among=LIGHT_KINDS),
        sun_azimuth_deg=table.number("sun_azimuth_deg", usual.sun_azimuth_deg, least=-360.0, most=360.0),
        sun_elevation_deg=table.number("sun_elevation_deg", usual.sun_elevation_deg, least=2.0, most=90.0),
    )


def _imaging(scene: Table) -> Imaging:
    usual = Imaging()
    names = [field.name for field in fields(Imaging)]
    table = Table(scene.raw("imaging") or {}, "[imaging]", scene.mistakes, names)
    values: dict[str, Any] = {}
    for name in names:
        default = getattr(usual, name)
        if isinstance(default, tuple):
            values[name] = table.numbers(name, len(default), default)
        elif isinstance(default, int):
            values[name] = table.integer(name, default)
        else:
            values[name] = table.number(name, default)
    try:
        return Imaging(**values)
    except SimulationError as error:
        scene.mistakes.add("[imaging]", str(error))
        return usual


def _ego(scene: Table, layout: Layout) -> Path:
    if "ego" not in scene:
        return standing(0.0, 0.0, 0.0)
    return _motion(Table(scene.raw("ego"), "[ego]", scene.mistakes, MOTION_KEYS), layout)


def _object(values: Any, index: int, layout: Layout, mistakes: Mistakes) -> SceneObject:
    named = values.get("name") if isinstance(values, dict) else None
    where = f"[[object]] {index}" + (f" ({named})" if isinstance(named, str) else "")
    table = Table(values, where, mistakes, OBJECT_KEYS)
    kind = table.text("kind", among=catalogue.KINDS)
    size = table.numbers("size_lwh_m", 3)
    if size is not None and not all(0.2 <= side <= 30.0 for side in size):
        table.wrong("size_lwh_m", "every side has to be between 0.2 and 30 m")
        size = None
    colour = table.numbers("colour", 3)
    if colour is not None and not all(0.0 <= part <= 1.0 for part in colour):
        table.wrong("colour", "red, green and blue have to be between 0 and 1 (linear light)")
        colour = None
    name = table.text("name", f"{kind} {index}")
    return SceneObject(name, kind, table.integer("seed", index), _motion(table, layout), size, colour)


def _motion(table: Table, layout: Layout) -> Path:
    """A fixed place, a lane with a speed, or waypoints: exactly one of them."""
    ways = {"waypoints": ("waypoints",), "lane": ("lane",), "x_m": ("x_m", "y_m")}
    given = [name for name, keys in ways.items() if any(key in table for key in keys)]
    if len(given) != 1:
        said = " and ".join(f"`{name}`" for name in given) or "none"
        table.wrong("place", f"give one of `x_m` with `y_m`, `lane`, or `waypoints`; here: {said}")
        return standing(0.0, 0.0, 0.0)
    if given == ["waypoints"]:
        return _waypoints(table)
    if given == ["lane"]:
        return _on_lane(table, layout)
    yaw = math.radians(table.number("yaw_deg", 0.0))
    return standing(table.number("x_m"), table.number("y_m"), yaw)


def _waypoints(table: Table) -> Path:
    waypoints = []
    for index, values in enumerate(table.tables("waypoints"), start=1):
        point = Table(values, f"{table.where} waypoints {index}", table.mistakes, WAYPOINT_KEYS)
        yaw = math.radians(point.number("yaw_deg")) if "yaw_deg" in point else None
        waypoints.append(Waypoint(point.number("time_s"), point.number("x_m"), point.number("y_m"), yaw))
    if not waypoints:
        table.wrong("waypoints", "has to hold at least one waypoint")
        return standing(0.0, 0.0, 0.0)
    if any(after.time_s <= before.time_s for before, after in zip(waypoints, waypoints[1:], strict=False)):
        table.wrong("waypoints", "times have to rise from waypoint to waypoint")
        return standing(0.0, 0.0, 0.0)
    return Path(tuple(waypoints))


def _on_lane(table: Table, layout: Layout) -> Path:
    if not layout.lanes:
        table.wrong("lane", "there are no lanes in this environment")
        return standing(0.0, 0.0, 0.0)
    lane = layout.lanes[table.integer("lane", least=0, most=len(layout.lanes) - 1)]
    along = table.number("along_m", 0.0, least=0.0, most=lane.length_m)
    left = table.number("left_m", 0.0)
    speed = table.number("speed_m_per_s", 0.0, least=0.0)
    start = lane.at(along, left)
    left_to_go_m = lane.length_m - along
    if speed == 0.0 or left_to_go_m == 0.0:
        return standing(*start, lane.yaw_rad)
    end = lane.at(lane.length_m, left)
    return Path((Waypoint(0.0, *start), Waypoint(left_to_go_m / speed, *end)))
