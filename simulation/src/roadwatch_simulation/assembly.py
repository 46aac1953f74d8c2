"""Puts patches, materials and named parts together into a `Model` of an exact size."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.geometry import Patch
from roadwatch_simulation.model import Material, Mesh, Model

Size = tuple[float, float, float]


class Assembly:
    """A model while it is being built: add patches, then take the `Model`."""

    def __init__(self) -> None:
        self._patches: list[Patch] = []
        self._material_of: list[int] = []
        self._part_of: list[int] = []
        self._materials: dict[Material, int] = {}
        self._parts: dict[str, int] = {}

    def add(self, patch: Patch, material: Material, part: str | None = None) -> None:
        """Adds a patch of one material, to a named part or to none."""
        if len(patch.positions) == 0:
            return
        self._patches.append(patch)
        self._material_of.append(self._materials.setdefault(material, len(self._materials)))
        self._part_of.append(0 if part is None else self._parts.setdefault(part, len(self._parts) + 1))

    def add_both_sides(self, patch: Patch, material: Material, part: str | None = None) -> None:
        """Adds a patch on the left and its mirror image on the right; `part` gets `_left` and `_right`."""
        self.add(patch, material, None if part is None else f"{part}_left")
        self.add(patch.mirrored(), material, None if part is None else f"{part}_right")

    def finish(self, label: str, object_class: str, size: Size | None, mirrors: str = "mirror_") -> Model:
        """The model, stretched to `size` (m; None keeps it as built), standing on the ground in its middle.

        Parts whose names start with `mirrors` do not count towards the size.
        """
        positions = np.concatenate([patch.positions for patch in self._patches])
        normals = np.concatenate([patch.normals for patch in self._patches])
        counts = [len(patch.positions) for patch in self._patches]
        parts = np.repeat(np.array(self._part_of, dtype=np.int32), counts)
        outside = [number for name, number in self._parts.items() if name.startswith(mirrors)]
        positions, normals, size = _fitted(positions, normals, ~np.isin(parts, outside), size)
        mesh = Mesh(
            positions.astype(np.float32),
            normals.astype(np.float32),
            np.repeat(np.array(self._material_of, dtype=np.int32), counts),
            parts,
        )
        centers = {name: _center(positions[parts == number]) for name, number in self._parts.items()}
        return Model(label, mesh, tuple(self._materials), object_class, size, centers)


def _fitted(
    positions: np.ndarray, normals: np.ndarray, counted: np.ndarray, size: Size | None
) -> tuple[np.ndarray, np.ndarray, Size]:
    points = positions[counted].reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    target = high - low if size is None else np.asarray(size, dtype=float)
    scale = target / (high - low)
    origin = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    stretched = normals / scale
    stretched /= np.linalg.norm(stretched, axis=2, keepdims=True)
    length, width, height = (float(extent) for extent in target)
    return (positions - origin) * scale, stretched, (length, width, height)


def _center(triangles: np.ndarray) -> Size:
    points = triangles.reshape(-1, 3)
    x, y, z = ((points.min(axis=0) + points.max(axis=0)) / 2).tolist()
    return (x, y, z)
