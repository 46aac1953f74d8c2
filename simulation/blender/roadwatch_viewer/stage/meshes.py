"""Blender's mesh data blocks: one for each shape and detail, shared by all objects that show it."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np

from .. import shapes
from ..kinds import BLOCK, MODELS, PAWN
from ..library import model_mesh
from ..mesh import TRACK, Mesh, with_footprint
from .materials import PREFIX, look_material

BLOCK_SIZE_M = (1.6, 1.6, 1.6)


class MeshStore:
    """Makes mesh data blocks when they are first wanted and keeps them."""

    def __init__(self) -> None:
        self._made: dict[tuple[str, ...], bpy.types.Mesh] = {}

    def body(self, kind: str, detail: str) -> bpy.types.Mesh:
        """The thing itself."""
        return self._get(("body", kind, detail), lambda: with_footprint(_shape(kind, detail)))

    def edges(self, kind: str, heading: str) -> bpy.types.Mesh:
        """Its box; `heading` is `known` or `unknown`, and an unknown one is dashed."""
        dashed = heading == "unknown"
        return self._get(("edges", kind, heading), lambda: shapes.edges(nominal_size(kind), dashed=dashed))

    def arrow(self, kind: str) -> bpy.types.Mesh:
        """Its heading."""
        return self._get(("arrow", kind), lambda: shapes.arrow(nominal_size(kind)))

    def make_all(self) -> None:
        """Makes what tracks can look like."""
        for kind in (*MODELS, BLOCK, PAWN):
            for detail in ("full", "simple"):
                self.body(kind, detail)
            for heading in ("known", "unknown"):
                self.edges(kind, heading)
            self.arrow(kind)

    def _get(self, key: tuple[str, ...], make: Callable[[], Mesh]) -> bpy.types.Mesh:
        if key not in self._made:
            self._made[key] = to_blender(" ".join(key), make())
        return self._made[key]


def nominal_size(kind: str) -> tuple[float, float, float]:
    """The size of a kind's meshes: an object scales them to its own."""
    if kind == BLOCK:
        return BLOCK_SIZE_M
    return model_mesh("pedestrian" if kind == PAWN else kind, "simple").size_lwh_m


def _shape(kind: str, detail: str) -> Mesh:
    if kind == BLOCK:
        return shapes.block(BLOCK_SIZE_M)
    if kind == PAWN:
        return shapes.pawn(nominal_size(PAWN))
    return model_mesh(kind, detail)


def to_blender(name: str, mesh: Mesh) -> bpy.types.Mesh:
    """A new data block; the slot of the track's look is `track_slot` of it."""
    made = bpy.data.meshes.new(PREFIX + name)
    count = len(mesh.triangles)
    made.vertices.add(len(mesh.vertices_m))
    made.vertices.foreach_set("co", np.ascontiguousarray(mesh.vertices_m, dtype=np.float32).ravel())
    made.loops.add(3 * count)
    made.loops.foreach_set("vertex_index", np.ascontiguousarray(mesh.triangles, dtype=np.int32).ravel())
    made.polygons.add(count)
    made.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    made.polygons.foreach_set("material_index", np.ascontiguousarray(mesh.look_of, dtype=np.int32))
    made.polygons.foreach_set("use_smooth", np.full(count, mesh.normals is not None))
    for look in mesh.looks:
        made.materials.append(look_material(look))
    made.update(calc_edges=True)
    if mesh.normals is not None:
        made.normals_split_custom_set_from_vertices(mesh.normals.astype(float).tolist())
    if TRACK in mesh.looks:
        made["track_slot"] = mesh.looks.index(TRACK)
    return made
