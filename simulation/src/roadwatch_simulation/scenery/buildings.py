"""Buildings along a street: facades with recessed windows, shops, balconies, roofs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..model import Material, Surface
from .builder import MeshBuilder
from .palette import (
    CURTAIN, DARK_STEEL, FRAME_SHADES, GLASS, LIT_GLASS, ROOF_SHADES, WOOD, choice, painted, varied, wall,
)

RECESS_M = 0.14
"""How deep windows lie in a wall: enough for a shadow at the top of the glass."""


@dataclass(frozen=True)
class Facade:
    """How the street side of a building is divided; lengths in metres."""

    width_m: float
    floors: int
    floor_height_m: float
    ground_height_m: float
    columns: int
    window_width_m: float
    window_height_m: float
    shop: bool

    @property
    def height_m(self) -> float:
        """Up to the eaves."""
        return self.ground_height_m + (self.floors - 1) * self.floor_height_m


def add_building(
    builder: MeshBuilder, width_m: float, depth_m: float, rng: np.random.Generator, style: str, *,
    far: bool = False,
) -> float:
    """Adds a building behind the line y = 0 from x = 0 to `width_m`, its face towards -y.

    Gives its height (m). A far one has plain panes for windows.
    """
    facade = _divide(width_m, rng, style)
    walls = wall(rng)
    frame = painted(rng, FRAME_SHADES)
    if far:
        _add_plain_front(builder, facade, walls)
        builder.box((0, 0, 0), (facade.width_m, depth_m, facade.height_m), walls, ("-x", "+x", "+y"))
    else:
        _add_front(builder, facade, walls, frame, rng)
        _add_sides(builder, facade, depth_m, walls, frame)
    _add_roof(builder, facade, depth_m, rng, style)
    return facade.height_m


def _divide(width_m: float, rng: np.random.Generator, style: str) -> Facade:
    floors = {"house": (1, 3), "town": (2, 6), "tower": (6, 13), "hall": (1, 2)}[style]
    pitch = {"house": 3.2, "town": rng.uniform(2.2, 3.4), "tower": rng.uniform(2.0, 3.2), "hall": 5.5}[style]
    columns = max(1, int(width_m / pitch))
    floor_height = float(rng.uniform(2.7, 3.4)) if style != "hall" else float(rng.uniform(4.0, 6.5))
    shop = style in ("town", "tower") and rng.random() < 0.6
    wide = rng.uniform(0.40, 0.85 if style == "tower" else 0.6)
    return Facade(
        width_m, int(rng.integers(*floors)), floor_height,
        float(rng.uniform(3.4, 4.2)) if shop else floor_height + 0.2,
        columns, width_m / columns * wide, floor_height * rng.uniform(0.42, 0.62), bool(shop),
    )


def _add_front(builder, facade: Facade, walls: Material, frame: Material, rng: np.random.Generator) -> None:
    if facade.shop:
        _add_shop(builder, facade, walls, rng)
    else:
        _add_window_row(builder, facade, 0.0, facade.ground_height_m, walls, frame, rng, door=True)
    balconies = rng.random() < 0.3
    band = painted(rng, ((0.5, 0.48, 0.44), (0.3, 0.3, 0.3)), 0.1) if rng.random() < 0.4 else None
    for floor in range(1, facade.floors):
        base = facade.ground_height_m + (floor - 1) * facade.floor_height_m
        _add_window_row(builder, facade, base, facade.floor_height_m, walls, frame, rng)
        if band is not None:
            builder.box((0, -0.06, base - 0.1), (facade.width_m, 0, base + 0.08), band, ("-y", "+z", "-z"))
        if balconies:
            _add_balconies(builder, facade, base, rng)


def _add_plain_front(builder, facade: Facade, walls: Material) -> None:
    _wall_panels(builder, 0.0, facade.width_m, 0.0, facade.height_m, walls)
    left, right = _window_spans(facade)
    for floor in range(facade.floors):
        base = 1.0 if floor == 0 else facade.ground_height_m + (floor - 1) * facade.floor_height_m + 0.8
        _upright(builder, left, right, base, base + facade.window_height_m, -0.05, GLASS)


def _window_spans(facade: Facade) -> tuple[np.ndarray, np.ndarray]:
    pitch = facade.width_m / facade.columns
    middle = (np.arange(facade.columns) + 0.5) * pitch
    return middle - 0.5 * facade.window_width_m, middle + 0.5 * facade.window_width_m


def _add_window_row(builder, facade, base, height, walls, frame, rng, door=False) -> None:
    left, right = _window_spans(facade)
    sill = base + 0.42 * (height - facade.window_height_m) + 0.25
    sill = min(sill, base + height - facade.window_height_m - 0.15)
    head = sill + facade.window_height_m
    _wall_panels(builder, 0.0, facade.width_m, base, sill, walls)
    _wall_panels(builder, 0.0, facade.width_m, head, base + height, walls)
    _wall_panels(builder, np.append(0.0, right), np.append(left, facade.width_m), sill, head, walls)
    _add_openings(builder, left, right, sill, head, walls, frame, rng)
    if door:
        _add_door(builder, 0.5 * (left[0] + right[0]) if len(left) else 1.0, base, frame, rng)


def _wall_panels(builder, left, right, low, high, material) -> None:
    """Upright rectangles in the plane y = 0, facing -y."""
    left, right = np.atleast_1d(left).astype(float), np.atleast_1d(right).astype(float)
    _upright(builder, left, right, low, high, 0.0, material)


def _upright(builder, left, right, low, high, y, material) -> None:
    low, high = np.broadcast_to(low, left.shape), np.broadcast_to(high, left.shape)
    y = np.full(left.shape, y)
    corners = [(left, y, low), (right, y, low), (right, y, high), (left, y, high)]
    builder.quads(np.stack([np.stack(corner, 1) for corner in corners], 1), material)


def _add_openings(builder, left, right, low, high, walls, frame, rng) -> None:
    kinds = rng.random(len(left))
    for material, chosen in (
        (GLASS, kinds < 0.7), (CURTAIN, (kinds >= 0.7) & (kinds < 0.93)), (LIT_GLASS, kinds >= 0.93)
    ):
        if chosen.any():
            _upright(builder, left[chosen], right[chosen], low, high, RECESS_M, material)
    one = np.ones_like(left)
    outer, inner = 0.0 * one, RECESS_M * one
    for x, flip in ((left, False), (right, True)):
        reveal = [(x, outer, low * one), (x, inner, low * one), (x, inner, high * one),
            (x, outer, high * one)]
        builder.quads(_corners(reveal[::-1] if flip else reveal), walls)
    lintel = [(left, outer, high * one), (left, inner, high * one), (right, inner, high * one),
              (right, outer, high * one)]
    builder.quads(_corners(lintel), walls)
    builder.boxes(_points(left - 0.06, -0.07, low - 0.07), _points(right + 0.06, RECESS_M, low), frame,
                  ("-y", "+z", "-x", "+x"))
    middle = 0.5 * (left + right)
    _upright(builder, middle - 0.03, middle + 0.03, low, high, RECESS_M - 0.02, frame)
    rail = low + (high - low) * 0.66
    _upright(builder, left, right, rail, rail + 0.06, RECESS_M - 0.02, frame)
    for edge in (left, right - 0.07):
        _upright(builder, edge, edge + 0.07, low, high, RECESS_M - 0.02, frame)


def _corners(corners) -> np.ndarray:
    return np.stack([np.stack(corner, 1) for corner in corners], 1)


def _points(x, y, z) -> np.ndarray:
    x = np.atleast_1d(x).astype(float)
    return np.stack([x, np.broadcast_to(y, x.shape), np.broadcast_to(z, x.shape)], 1)


def _add_door(builder, middle, base, frame, rng) -> None:
    door = painted(rng)
    builder.box((middle - 0.62, -0.04, base), (middle + 0.62, 0, base + 2.3), frame, ("-x", "+x", "-y", "+z"))
    builder.box((middle - 0.52, -0.06, base), (middle + 0.52, 0, base + 2.2), door, ("-y",))
    builder.box((middle - 0.32, -0.07, base + 1.3), (middle + 0.32, 0, base + 2.0), GLASS, ("-y",))
    builder.box((middle - 0.9, -0.55, base), (middle + 0.9, 0, base + 0.12), frame)


def _add_shop(builder, facade: Facade, walls: Material, rng: np.random.Generator) -> None:
    height, width = facade.ground_height_m, facade.width_m
    accent = painted(rng)
    _wall_panels(builder, 0.0, width, 0.0, 0.4, walls)
    _wall_panels(builder, 0.0, width, height - 0.25, height, walls)
    builder.box((0.3, -0.12, height - 0.95), (width - 0.3, 0, height - 0.25), accent,
        ("-x", "+x", "-y", "+z", "-z"))
    _add_lettering(builder, width, height - 0.6, rng)
    count = max(1, int(width / rng.uniform(2.2, 4.0)))
    edges = np.linspace(0.0, width, count + 1)
    pane = LIT_GLASS if rng.random() < 0.2 else GLASS
    _upright(builder, edges[:-1], edges[1:], 0.4, height - 0.95, RECESS_M, pane)
    _upright(builder, np.zeros(1), np.array([width]), height - 0.95, height - 0.25, 0.0, walls)
    posts = np.clip(edges, 0.12, width - 0.12)
    builder.boxes(_points(posts - 0.12, -0.02, 0.0), _points(posts + 0.12, RECESS_M, height - 0.9), accent,
                  ("-x", "+x", "-y"))
    if rng.random() < 0.45:
        _add_awning(builder, width, height, rng)


def _add_lettering(builder, width, middle_z, rng) -> None:
    """Blocks of a sign's letters, in no script."""
    count = int(rng.integers(4, 11))
    start = width * 0.5 - count * 0.2
    if start < 0.5:
        return
    left = start + np.arange(count) * 0.4
    tall = rng.uniform(0.12, 0.22, count)
    letter = painted(rng, ((0.8, 0.8, 0.78), (0.05, 0.05, 0.05), (0.7, 0.6, 0.2)))
    builder.boxes(_points(left, -0.15, middle_z - tall), _points(left + 0.26, -0.12, middle_z + tall),
        letter, ("-y",))


def _add_awning(builder, width, height, rng) -> None:
    cloth = Material("awning",
        varied(rng, choice(rng, ((0.5, 0.05, 0.05), (0.05, 0.2, 0.1), (0.7, 0.65, 0.5)))),
                     surface=Surface.CLOTH)
    low, high = height - 1.35, height - 0.95
    top = [[0.3, -1.2, low], [width - 0.3, -1.2, low], [width - 0.3, 0, high], [0.3, 0, high]]
    skirt = [[0.3, -1.2, low - 0.22], [width - 0.3, -1.2, low - 0.22], [width - 0.3, -1.2, low],
        [0.3, -1.2, low]]
    builder.quads(np.array([top, top[::-1], skirt, skirt[::-1]]), cloth)


def _add_balconies(builder, facade: Facade, base: float, rng: np.random.Generator) -> None:
    left, right = _window_spans(facade)
    chosen = rng.random(len(left)) < 0.4
    left, right = left[chosen] - 0.3, right[chosen] + 0.3
    builder.boxes(_points(left, -1.0, base), _points(right, 0, base + 0.14),
        painted(rng, ((0.4, 0.4, 0.38),)),
                  ("-x", "+x", "-y", "+z", "-z"))
    builder.boxes(_points(left, -1.0, base + 0.14), _points(right, -0.95, base + 1.05), DARK_STEEL,
        ("-y", "+y"))


def _add_sides(builder, facade: Facade, depth_m: float, walls: Material, frame: Material) -> None:
    height = facade.height_m
    builder.box((0, 0, 0), (facade.width_m, depth_m, height), walls, ("-x", "+x", "+y"))
    for floor in range(facade.floors):
        base = 1.0 if floor == 0 else facade.ground_height_m + (floor - 1) * facade.floor_height_m + 0.9
        for y in np.arange(2.0, depth_m - 1.5, 4.0):
            for low_x, high_x, face in ((-0.03, 0, "-x"), (facade.width_m, facade.width_m + 0.03, "+x")):
                builder.box((low_x, y - 0.08, base - 0.08), (high_x, y + 1.18, base + 1.48), frame, (face,))
                builder.box((low_x * 1.3, y, base), (high_x + 0.01, y + 1.1, base + 1.4), GLASS, (face,))


def _add_roof(builder, facade: Facade, depth_m: float, rng: np.random.Generator, style: str) -> None:
    height, width = facade.height_m, facade.width_m
    roof = Material("roof", varied(rng, choice(rng, ROOF_SHADES)), surface=Surface.BRICK)
    if style == "house" or (style == "town" and rng.random() < 0.45):
        _add_pitched_roof(builder, width, depth_m, height, roof, rng)
        return
    parapet = painted(rng, ((0.4, 0.4, 0.39), (0.2, 0.2, 0.2), (0.6, 0.58, 0.54)), 0.1)
    builder.box((-0.1, -0.18, height), (width + 0.1, 0.2, height + 0.55), parapet,
        ("-x", "+x", "-y", "+y", "+z", "-z"))
    builder.box((0, 0, height), (width, depth_m, height + 0.3), parapet)
    if style != "hall" and rng.random() < 0.6:
        x = rng.uniform(0.2, 0.6) * width
        builder.box((x, depth_m * 0.4, height), (x + 3.0, depth_m * 0.4 + 3.0, height + 2.4), parapet)


def _add_pitched_roof(builder, width, depth, height, roof, rng) -> None:
    ridge, over = height + depth * rng.uniform(0.25, 0.45), 0.45
    left, right = -0.2, width + 0.2
    front = [[left, -over, height - 0.1], [right, -over, height - 0.1], [right, depth / 2, ridge],
             [left, depth / 2, ridge]]
    back = [[right, depth + over, height - 0.1], [left, depth + over, height - 0.1], [left, depth / 2, ridge],
            [right, depth / 2, ridge]]
    builder.quads(np.array([front, back]), roof)
    gables = [[[0, depth, height], [0, 0, height], [0, depth / 2, ridge - 0.1]],
              [[width, 0, height], [width, depth, height], [width, depth / 2, ridge - 0.1]]]
    builder.triangles(np.array(gables), WOOD if rng.random() < 0.3 else wall(rng))
    if rng.random() < 0.7:
        x = rng.uniform(0.1, 0.8) * width
        builder.box((x, depth * 0.5, height), (x + 0.7, depth * 0.5 + 0.7, ridge + 0.9), wall(rng))
