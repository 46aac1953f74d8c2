"""A place while it is being built: its mesh, its trees, and its layout for traffic."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..model import Instance, Material
from .builder import MeshBuilder, pose
from .layout import Bay, Footprint, Lane, Layout, Place, Raised
from .palette import GroundMaterials, ground_materials
from .trees import build_tree

FINE_RANGE_M = 65.0
"""Beyond this distance from the origin buildings and trees are built with less detail."""
DISTINCT_TREES = 6
"""Models a place draws its trees from; each stands turned at random, so more would hardly show."""


class Site:
    """What is being built. Coordinates are those of the builder's current frame."""

    def __init__(self, kind: str, seed: int) -> None:
        self.kind = kind
        self.rng = np.random.default_rng([seed, 11])
        self.builder = MeshBuilder()
        self.layout = Layout()
        self.ground: GroundMaterials = ground_materials(self.rng)
        self._trees: list[Instance] = []
        self._tree_seeds = self.rng.integers(0, 1 << 30, DISTINCT_TREES)

    def world(self, x_m: float, y_m: float) -> tuple[float, float]:
        """A place of the current frame in the world."""
        x, y, _, _ = self.builder.frame @ [x_m, y_m, 0.0, 1.0]
        return (float(x), float(y))

    def world_yaw(self, yaw_rad: float) -> float:
        """A direction of the current frame in the world."""
        return yaw_rad + math.atan2(self.builder.frame[1, 0], self.builder.frame[0, 0])

    def lane(self, start, end, width_m: float) -> None:
        """Notes a lane for vehicles."""
        self.layout.lanes.append(Lane(self.world(*start), self.world(*end), width_m))

    def walk(self, start, end, width_m: float) -> None:
        """Notes a strip for people on foot."""
        self.layout.walks.append(Lane(self.world(*start), self.world(*end), width_m))

    def crossing(self, start, end, width_m: float) -> None:
        """Notes a place where people cross the road."""
        self.layout.crossings.append(Lane(self.world(*start), self.world(*end), width_m))

    def bay(self, x_m: float, y_m: float, yaw_rad: float, length_m: float, width_m: float) -> None:
        """Notes a parking bay."""
        self.layout.bays.append(Bay(*self.world(x_m, y_m), self.world_yaw(yaw_rad), length_m, width_m))

    def obstacle(self, x_m: float, y_m: float, length_m: float, width_m: float, yaw_rad: float = 0.0) -> None:
        """Notes that something stands here."""
        place = self.world(x_m, y_m)
        self.layout.obstacles.append(Footprint(*place, self.world_yaw(yaw_rad), length_m, width_m))

    def raised(self, x_m: tuple[float, float], y_m: tuple[float, float], height_m: float) -> None:
        """Notes ground above the road."""
        first, second = self.world(x_m[0], y_m[0]), self.world(x_m[1], y_m[1])
        low, high = np.minimum(first, second), np.maximum(first, second)
        self.layout.raised.append(Raised((low[0], low[1], high[0], high[1]), height_m))

    def road(self, x_m: tuple[float, float], y_m: tuple[float, float]) -> None:
        """Asphalt at road level."""
        self.builder.ground(x_m, y_m, 0.0, self.ground.road)
        first, second = self.world(x_m[0], y_m[0]), self.world(x_m[1], y_m[1])
        low, high = np.minimum(first, second), np.maximum(first, second)
        self.layout.roads.append((float(low[0]), float(low[1]), float(high[0]), float(high[1])))

    def slab(
        self, x_m: tuple[float, float], y_m: tuple[float, float], height_m: float, material: Material
    ) -> None:
        """Ground raised by a kerb on all sides."""
        self.builder.ground(x_m, y_m, height_m, material)
        lower, upper = (x_m[0], y_m[0], -0.02), (x_m[1], y_m[1], height_m)
        self.builder.box(lower, upper, self.ground.kerb, ("-x", "+x", "-y", "+y"))
        self.raised(x_m, y_m, height_m)

    def put(
        self, add: Callable[[MeshBuilder, np.random.Generator], None], x_m: float, y_m: float, *,
        yaw_rad: float = 0.0, z_m: float = 0.0, size_m: tuple[float, float] = (0.4, 0.4),
    ) -> None:
        """Stands a piece of furniture somewhere and notes its footprint."""
        with self.builder.placed(x_m, y_m, yaw_rad, z_m):
            add(self.builder, self.rng)
        self.obstacle(x_m, y_m, *size_m, yaw_rad)

    def tree(self, x_m: float, y_m: float, z_m: float = 0.0, kind: str | None = None) -> None:
        """Plants a tree."""
        seed = int(self._tree_seeds[self.rng.integers(DISTINCT_TREES)])
        model = build_tree(seed, kind, far=self.is_far(x_m, y_m))
        yaw = self.rng.uniform(0.0, 2.0 * math.pi)
        self._trees.append(Instance(model, self.builder.frame @ pose(x_m, y_m, yaw, z_m)))
        self.obstacle(x_m, y_m, 0.5, 0.5)

    def is_far(self, x_m: float, y_m: float) -> bool:
        """Whether a place is too far from the origin for fine detail to show."""
        return math.hypot(*self.world(x_m, y_m)) > FINE_RANGE_M

    def place(self) -> Place:
        """What has been built."""
        return Place(self.kind, tuple(self.builder.instances(self.kind) + self._trees), self.layout)
