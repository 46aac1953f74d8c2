"""What the builders make and the renderers draw: meshes with materials and named parts.

Axes of a model: origin on the ground under the middle of the object's length and width, x forward, y left,
z up, metres. Axes of the world: z up, metres; `base_link` of the rig's vehicle follows REP-103.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np


class Surface(IntEnum):
    """How a material's colour varies over its surface, in world coordinates."""

    PLAIN = 0
    ASPHALT = 1
    GRASS = 2
    PAVING = 3
    PLASTER = 4
    BRICK = 5
    FOLIAGE = 6
    CLOTH = 7


@dataclass(frozen=True)
class Material:
    """How a surface takes light.

    `colour` is linear RGB, 0 to 1. `gloss` is 0 (matt) to 1 (mirror-smooth). `f0` is the share of light
    reflected head-on. `metallic` is 0 to 1. `emission` is light given off, in multiples of `colour`.
    """

    name: str
    colour: tuple[float, float, float]
    gloss: float = 0.05
    f0: float = 0.02
    metallic: float = 0.0
    emission: float = 0.0
    surface: Surface = Surface.PLAIN


@dataclass(frozen=True)
class Mesh:
    """Triangles, corner by corner, so that both renderers take the same arrays.

    `positions` and `normals` are float32 of shape (n, 3, 3): triangle, corner, axis; metres and unit
    vectors, counter-clockwise seen from outside. `materials` is int32 (n,), an index into the model's
    materials. `parts` is int32 (n,): 0 for none, else one more than the index into the model's part names.
    """

    positions: np.ndarray
    normals: np.ndarray
    materials: np.ndarray
    parts: np.ndarray

    def __post_init__(self) -> None:
        count = len(self.positions)
        if self.positions.shape != (count, 3, 3) or self.normals.shape != (count, 3, 3):
            raise ValueError("positions and normals are (n, 3, 3)")
        if self.materials.shape != (count,) or self.parts.shape != (count,):
            raise ValueError("materials and parts are (n,)")


@dataclass(frozen=True)
class Model:
    """One thing that can stand in a scene.

    `object_class` is COCO's name (`car`, `truck`, `bus`, `person`, `bicycle`, `motorcycle`), or None for
    scenery, which has no truth. `label` is the finer kind (`sedan`, `pickup`). `size_lwh_m` is the size of
    the cuboid around it: length, width without mirrors, height. `part_centers_m` gives the centre of each
    named part in model axes, in the order in which `Mesh.parts` counts them.
    """

    label: str
    mesh: Mesh
    materials: tuple[Material, ...]
    object_class: str | None = None
    size_lwh_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    part_centers_m: dict[str, tuple[float, float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Instance:
    """A model in the world.

    `world_from_model` is a rigid 4x4 transform. `object_id` is above 0 and unique in the scene for objects
    with truth, 0 for scenery.
    """

    model: Model
    world_from_model: np.ndarray
    object_id: int = 0


@dataclass(frozen=True)
class Camera:
    """A pinhole camera in the world; its axes are optical: x right, y down, z forward.

    Pixels are counted from pixel centres: the middle of the first pixel is (0, 0), as OpenCV and ROS have
    it, while edges of boxes lie between pixels.
    """

    width_px: int
    height_px: int
    fx: float
    fy: float
    cx: float
    cy: float
    world_from_camera: np.ndarray

    def project(self, points_world_m: np.ndarray) -> np.ndarray:
        """Pixel x, pixel y and depth (m) of points (n, 3); x and y mean nothing where depth is not above 0."""
        camera_from_world = np.linalg.inv(self.world_from_camera)
        points = points_world_m @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
        depth = points[:, 2]
        safe = np.where(depth > 0.0, depth, 1.0)
        x = self.fx * points[:, 0] / safe + self.cx
        y = self.fy * points[:, 1] / safe + self.cy
        return np.stack([x, y, depth], axis=1)


@dataclass(frozen=True)
class Light:
    """The light of a scene.

    `sun_direction` points to the sun (unit vector, world axes). `sun` and `sky` scale the two lights;
    `sun` 0 is an overcast sky. `warmth` is 0 (noon) to 1 (dusk). `haze_per_m` is the share of light lost
    per metre. `wetness` is 0 (dry ground) to 1 (wet, reflecting). `headlights` switches lamps on.
    `seed` varies clouds.
    """

    sun_direction: tuple[float, float, float]
    sun: float = 2.6
    sky: float = 1.0
    warmth: float = 0.0
    haze_per_m: float = 0.0012
    wetness: float = 0.0
    headlights: bool = False
    seed: int = 0


@dataclass(frozen=True)
class Rendered:
    """One image with what each pixel shows.

    `image_bgr` is uint8 (h, w, 3), before noise and compression. `object_ids` is uint16 (h, w): 0 where no
    object with truth is seen. `part_ids` is uint8 (h, w), as `Mesh.parts`. `silhouettes_px` is, for each
    object id that touches the image, the number of pixels and the box (x_min, y_min, x_max, y_max; edges)
    it would have with nothing in front of it, clipped to the image.
    """

    image_bgr: np.ndarray
    object_ids: np.ndarray
    part_ids: np.ndarray
    silhouettes_px: dict[int, tuple[int, tuple[float, float, float, float]]]
