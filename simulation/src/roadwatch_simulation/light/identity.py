"""The id pass: which object and part each pixel shows, and each object's silhouette with nothing before it."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from ..model import Surface
from .buffers import FORMAT_POSITION, FORMAT_SHAPE
from .context import build_program
from .drawlist import Drawable
from .projection import NEAR_M, matrix_bytes

Silhouettes = dict[int, tuple[int, tuple[float, float, float, float]]]
Region = tuple[int, int, int, int]
# Rounding in the projection of a bounding box stays far below this.
REGION_MARGIN_PX = 2


class IdentityPass:
    """Draws ids without smoothing, so that every pixel belongs to exactly one object and part."""

    def __init__(self, context: moderngl.Context, width_px: int, height_px: int) -> None:
        self._context = context
        self._size = (width_px, height_px)
        self._ids = context.renderbuffer(self._size, 2, dtype="u2")
        self._alone = context.renderbuffer(self._size, 1)
        self._scene_target = context.framebuffer([self._ids], context.depth_renderbuffer(self._size))
        self._alone_target = context.framebuffer([self._alone])
        self._programs = {
            (target, cut): build_program(
                context, "shape.vert", "identity.frag", (("MASK", int(target == "MASK")), ("CUTOUT", int(cut)))
            )
            for target in ("IDS", "MASK")
            for cut in (False, True)
        }

    def draw(self, items: Sequence[Drawable], clip_from_world: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Object ids, uint16 (h, w), and part ids, uint8 (h, w)."""
        self._scene_target.use()
        self._scene_target.clear()
        self._context.enable_only(moderngl.DEPTH_TEST)
        for item in items:
            self._draw_item("IDS", item, clip_from_world)
        width, height = self._size
        raw = np.frombuffer(self._scene_target.read(components=2, dtype="u2", alignment=1), dtype="<u2")
        pixels = raw.reshape(height, width, 2)
        return pixels[:, :, 0].copy(), pixels[:, :, 1].astype(np.uint8)

    def silhouettes(self, items: Sequence[Drawable], clip_from_world: np.ndarray) -> Silhouettes:
        """Pixels and box of each object drawn alone."""
        by_object: dict[int, list[Drawable]] = {}
        for item in items:
            if item.instance.object_id > 0:
                by_object.setdefault(item.instance.object_id, []).append(item)
        self._alone_target.use()
        self._context.enable_only(moderngl.NOTHING)
        found: Silhouettes = {}
        for object_id, members in by_object.items():
            region = self._region(members, clip_from_world)
            mask = self._mask(members, clip_from_world, region) if region else None
            if mask is not None and mask.any():
                found[object_id] = _measure(mask, region)
        self._alone_target.scissor = None
        return found

    def _mask(self, members: Sequence[Drawable], clip_from_world: np.ndarray, region: Region) -> np.ndarray:
        target = self._alone_target
        target.scissor = region
        target.clear(viewport=region)
        for item in members:
            self._draw_item("MASK", item, clip_from_world)
        _, _, width, height = region
        raw = target.read(viewport=region, components=1, alignment=1)
        return np.frombuffer(raw, dtype=np.uint8).reshape(height, width) > 0

    def _draw_item(self, target: str, item: Drawable, clip_from_world: np.ndarray) -> None:
        clip_from_model = matrix_bytes(clip_from_world @ np.asarray(item.instance.world_from_model, dtype=float))
        for run in item.buffers.ranges:
            program = self._programs[(target, run.surface is Surface.FOLIAGE)]
            program["clip_from_model"].write(clip_from_model)
            if "object_id" in program:
                program["object_id"].value = item.instance.object_id
            layout = FORMAT_SHAPE if target == "IDS" else FORMAT_POSITION
            array = item.buffers.array(self._context, program, layout)
            array.render(vertices=run.count, first=run.first)

    def _region(self, members: Sequence[Drawable], clip_from_world: np.ndarray) -> Region | None:
        """The part of the image that the objects' bounding boxes can touch: x, y, width, height."""
        width, height = self._size
        clip = np.concatenate([_box_corners(item) for item in members]) @ clip_from_world.T
        if (clip[:, 3] < NEAR_M).all():
            return None
        if (clip[:, 3] < NEAR_M).any():
            return (0, 0, width, height)
        edges = (clip[:, :2] / clip[:, 3:] + 1.0) / 2.0 * (width, height)
        low = np.clip(np.floor(edges.min(axis=0)) - REGION_MARGIN_PX, 0, (width, height)).astype(int)
        high = np.clip(np.ceil(edges.max(axis=0)) + REGION_MARGIN_PX, 0, (width, height)).astype(int)
        if (high <= low).any():
            return None
        return (int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1]))


def _box_corners(item: Drawable) -> np.ndarray:
    """Homogeneous world corners (8, 4) of the box around the item's vertices."""
    low, high = item.buffers.low_m, item.buffers.high_m
    corners = np.array([(x, y, z, 1.0) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    return corners @ np.asarray(item.instance.world_from_model, dtype=float).T


def _measure(mask: np.ndarray, region: Region) -> tuple[int, tuple[float, float, float, float]]:
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    left, top, _, _ = region
    box = (left + columns[0], top + rows[0], left + columns[-1] + 1, top + rows[-1] + 1)
    return int(np.count_nonzero(mask)), tuple(float(edge) for edge in box)
