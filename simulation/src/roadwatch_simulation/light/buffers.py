"""Models on the graphics side: vertices without repeats, triangles by surface, materials as a texture."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field

import moderngl
import numpy as np

from ..model import Material, Model, Surface

# Position, normal, then one word: material in the low 16 bits, part above.
VERTEX_DTYPE = np.dtype([("position", "<f4", 3), ("normal", "<f4", 3), ("tag", "<u4")])
FORMAT_FULL = "3f 3f 1u"
FORMAT_SHAPE = "3f 12x 1u"
FORMAT_POSITION = "3f 16x"
# Lamps and windows shine only when lamps are switched on; other emission (signals, screens) always does.
SWITCHED_WORDS = ("lamp", "head", "tail", "window")
# A scene has some dozens of models; a long run of scenes must not keep them all.
CACHED_MODELS = 512


@dataclass(frozen=True)
class SurfaceRange:
    """A run of indices whose triangles have one surface."""

    surface: Surface
    first: int
    count: int


@dataclass(frozen=True)
class Lamp:
    """Where a model's switched light comes from, in model axes: middle, mean normal, linear colour."""

    center_m: np.ndarray
    direction: np.ndarray
    colour: tuple[float, float, float]


@dataclass
class ModelBuffers:
    """One model's arrays on the graphics side, with its vertex arrays by program."""

    model: Model
    vertices: moderngl.Buffer
    indices: moderngl.Buffer
    materials: moderngl.Texture
    ranges: tuple[SurfaceRange, ...]
    lamps: tuple[Lamp, ...]
    low_m: np.ndarray
    high_m: np.ndarray
    center_m: np.ndarray
    radius_m: float
    arrays: dict[tuple[int, str], moderngl.VertexArray] = field(default_factory=dict)

    def array(
        self, context: moderngl.Context, program: moderngl.Program, layout: str
    ) -> moderngl.VertexArray:
        """The vertex array that feeds `program` with one of the FORMAT_ layouts."""
        key = (program.glo, layout)
        if key not in self.arrays:
            names = {
                FORMAT_FULL: ("in_position", "in_normal", "in_tag"),
                FORMAT_SHAPE: ("in_position", "in_tag"),
                FORMAT_POSITION: ("in_position",),
            }[layout]
            self.arrays[key] = context.vertex_array(
                program, [(self.vertices, layout, *names)], index_buffer=self.indices, index_element_size=4
            )
        return self.arrays[key]

    def release(self) -> None:
        """Frees what the graphics side holds."""
        for array in self.arrays.values():
            array.release()
        for resource in (self.vertices, self.indices, self.materials):
            resource.release()


def is_switched(material_name: str) -> bool:
    """True for emission that goes with the headlights: lamps of vehicles, lit windows."""
    return any(word in material_name.lower() for word in SWITCHED_WORDS)


def distinct_materials(model: Model) -> tuple[tuple[Material, ...], np.ndarray]:
    """The model's materials without repeats, and each triangle's index among them, int32 (n,)."""
    numbers: dict[Material, int] = {}
    slots = [numbers.setdefault(material, len(numbers)) for material in model.materials]
    return tuple(numbers), np.array(slots, dtype=np.int32)[model.mesh.materials]


def _material_texels(materials: tuple[Material, ...]) -> np.ndarray:
    """Two texels a material: colour and gloss; f0, metallic, emission and whether it is switched."""
    texels = np.zeros((2, len(materials), 4), dtype=np.float32)
    for index, material in enumerate(materials):
        texels[0, index] = (*material.colour, material.gloss)
        switched = float(is_switched(material.name))
        texels[1, index] = (material.f0, material.metallic, material.emission, switched)
    return texels


def _packed_vertices(model: Model, chosen: np.ndarray, order: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    mesh = model.mesh
    corners = np.zeros((len(order), 3), dtype=VERTEX_DTYPE)
    corners["position"] = mesh.positions[order]
    corners["normal"] = mesh.normals[order]
    tags = chosen.astype(np.uint32) | (mesh.parts.astype(np.uint32) << 16)
    corners["tag"] = tags[order][:, None]
    raw = corners.reshape(-1).view(np.dtype((np.void, VERTEX_DTYPE.itemsize)))
    unique, inverse = np.unique(raw, return_inverse=True)
    return unique, inverse.reshape(-1).astype(np.uint32)


def _ranges(surfaces: np.ndarray) -> tuple[SurfaceRange, ...]:
    """Runs of equal surface in sorted triangles."""
    ranges = []
    for surface in np.unique(surfaces):
        members = np.flatnonzero(surfaces == surface)
        ranges.append(SurfaceRange(Surface(int(surface)), int(members[0]) * 3, len(members) * 3))
    return tuple(ranges)


def _lamps(model: Model) -> tuple[Lamp, ...]:
    """The lamps of a vehicle: shining triangles by material, left and right apart."""
    mesh = model.mesh
    centers = mesh.positions.mean(axis=1)
    lamps = []
    for index, material in enumerate(model.materials):
        if material.emission <= 0.0 or not is_switched(material.name):
            continue
        for side in (centers[:, 1] > 0.0, centers[:, 1] <= 0.0):
            chosen = (mesh.materials == index) & side
            normal = mesh.normals[chosen].reshape(-1, 3).sum(axis=0)
            length = np.linalg.norm(normal)
            if chosen.any() and length > 0.0:
                center = centers[chosen].mean(axis=0).astype(float)
                lamps.append(Lamp(center, normal.astype(float) / length, material.colour))
    return tuple(lamps)


def upload(context: moderngl.Context, model: Model) -> ModelBuffers:
    """Puts a model's triangles, sorted by surface, and its materials on the graphics side."""
    distinct, chosen = distinct_materials(model)
    surfaces = np.array([int(material.surface) for material in distinct], dtype=np.int32)[chosen]
    order = np.argsort(surfaces, kind="stable")
    vertices, indices = _packed_vertices(model, chosen, order)
    texels = _material_texels(distinct)
    materials = context.texture((texels.shape[1], 2), 4, texels.tobytes(), dtype="f4")
    materials.filter = (moderngl.NEAREST, moderngl.NEAREST)
    points = model.mesh.positions.reshape(-1, 3).astype(float)
    low, high = points.min(axis=0), points.max(axis=0)
    center = (low + high) / 2.0
    return ModelBuffers(
        model=model,
        vertices=context.buffer(vertices.tobytes()),
        indices=context.buffer(indices.tobytes()),
        materials=materials,
        ranges=_ranges(surfaces[order]),
        lamps=_lamps(model),
        low_m=low,
        high_m=high,
        center_m=center,
        radius_m=float(np.linalg.norm(points - center, axis=1).max()),
    )


class BufferCache:
    """Buffers by the identity of their model, the longest unused given up first.

    An entry holds its model, so the identity of a model that is gone cannot come back as another's.
    """

    def __init__(self, context: moderngl.Context, capacity: int = CACHED_MODELS) -> None:
        self._context = context
        self._capacity = capacity
        self._entries: OrderedDict[int, ModelBuffers] = OrderedDict()

    def get(self, model: Model) -> ModelBuffers:
        """The model's buffers, made on first sight."""
        key = id(model)
        if key in self._entries:
            self._entries.move_to_end(key)
        else:
            self._entries[key] = upload(self._context, model)
        return self._entries[key]

    def trim(self) -> None:
        """Gives up what is beyond the capacity; call it between pictures only."""
        while len(self._entries) > self._capacity:
            _, oldest = self._entries.popitem(last=False)
            oldest.release()
