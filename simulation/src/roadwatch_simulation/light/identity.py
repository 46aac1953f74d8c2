"""The id pass: which object and part each pixel shows, and each object's silhouette drawn alone."""

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
# Left, top, width and height in pixels.
Region = tuple[int, int, int, int]
# Objects whose regions do not touch, with their regions.
Layer = dict[int, Region]
CHANNELS = 4
# Rounding in the projection of a bounding box stays far below this.
REGION_MARGIN_PX = 2


class IdentityPass:
    """Draws ids without smoothing, so that every pixel belongs to exactly one object and part."""

    def __init__(self, context: moderngl.Context, width_px: int, height_px: int) -> None:
        self._context = context
        self._size = (width_px, height_px)
        self._ids = context.renderbuffer(self._size, 2, dtype="u2")
        self._alone = context.renderbuffer(self._size, CHANNELS)
        self._scene_target = context.framebuffer([self._ids], context.depth_renderbuffer(self._size))
        self._alone_target = context.framebuffer([self._alone])
        self._programs = {
            (target, is_cut): build_program(
                context,
                "shape.vert",
                "identity.frag",
                (("MASK", int(target == "MASK")), ("CUTOUT", int(is_cut))),
            )
            for target in ("IDS", "MASK")
            for is_cut in (False, True)
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
        """Pixels and box of each object drawn alone.

        Objects whose regions keep clear of each other share a colour channel, so that few pictures have
        to be read back.
        """
        by_object: dict[int, list[Drawable]] = {}
        for item in items:
            if item.instance.object_id > 0:
                by_object.setdefault(item.instance.object_id, []).append(item)
        regions = {key: self._region(members, clip_from_world) for key, members in by_object.items()}
        layers = _layers({key: region for key, region in regions.items() if region})
        self._alone_target.use()
        self._context.enable_only(moderngl.NOTHING)
        found: Silhouettes = {}
        for start in range(0, len(layers), CHANNELS):
            batch = layers[start : start + CHANNELS]
            pixels = self._masks(batch, by_object, clip_from_world)
            for channel, layer in enumerate(batch):
                for object_id, (x, y, width, height) in layer.items():
                    mask = pixels[y : y + height, x : x + width, channel] > 0
                    if mask.any():
                        found[object_id] = _measure(mask, (x, y, width, height))
        return dict(sorted(found.items()))

    def _masks(
        self, batch: Sequence[Layer], by_object: dict[int, list[Drawable]], clip_from_world: np.ndarray
    ) -> np.ndarray:
        """One channel for each layer, above 0 where one of its objects is."""
        target = self._alone_target
        target.clear()
        for channel, layer in enumerate(batch):
            self._write_only(channel)
            for object_id in layer:
                for item in by_object[object_id]:
                    self._draw_item("MASK", item, clip_from_world)
        self._write_only(None)
        width, height = self._size
        raw = np.frombuffer(target.read(components=CHANNELS), dtype=np.uint8)
        return raw.reshape(height, width, CHANNELS)

    def _write_only(self, channel: int | None) -> None:
        """Lets drawing change one channel of the masks, or all of them again."""
        self._alone_target.color_mask = tuple(channel in (None, index) for index in range(CHANNELS))
        # moderngl hands a mask on only when a target is taken into use.
        self._alone_target.use()

    def _draw_item(self, target: str, item: Drawable, clip_from_world: np.ndarray) -> None:
        clip_from_model = matrix_bytes(clip_from_world @ item.world_from_model)
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


def _layers(regions: dict[int, Region]) -> list[Layer]:
    """Spreads objects over as few layers as the first fit gives, in order of their ids."""
    layers: list[Layer] = []
    for object_id, region in sorted(regions.items()):
        free = (layer for layer in layers if not any(_overlap(region, other) for other in layer.values()))
        layer = next(free, None)
        if layer is None:
            layer = {}
            layers.append(layer)
        layer[object_id] = region
    return layers


def _overlap(first: Region, second: Region) -> bool:
    return (
        first[0] < second[0] + second[2]
        and second[0] < first[0] + first[2]
        and first[1] < second[1] + second[3]
        and second[1] < first[1] + first[3]
    )


def _box_corners(item: Drawable) -> np.ndarray:
    """Homogeneous world corners (8, 4) of the box around the item's vertices."""
    low, high = item.buffers.low_m, item.buffers.high_m
    sides = list(zip(low, high, strict=True))
    corners = np.array([(x, y, z, 1.0) for x in sides[0] for y in sides[1] for z in sides[2]])
    return corners @ item.world_from_model.T


def _measure(mask: np.ndarray, region: Region) -> tuple[int, tuple[float, float, float, float]]:
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    left, top, _, _ = region
    box = (left + columns[0], top + rows[0], left + columns[-1] + 1, top + rows[-1] + 1)
    return int(np.count_nonzero(mask)), tuple(float(edge) for edge in box)
