"""Materials: made once, shared by all objects; Workbench shows viewport colours, the others nodes."""

from __future__ import annotations

import bpy

from ..colours import linear_rgb
from ..mesh import Look

PREFIX = "roadwatch "


def look_material(look: Look) -> bpy.types.Material:
    """The material of a look; of the look of tracks it is a placeholder that each object replaces."""
    return _material(f"{look.name} {_digits(look.rgb)}", look.rgb, look.roughness, look.metallic)


def track_material(colour: int) -> bpy.types.Material:
    """The material of one of the palette's colours."""
    return _material(f"track {colour:02d}", linear_rgb(colour), 0.35, 0.0)


def _material(
    name: str, rgb: tuple[float, float, float], roughness: float, metallic: float
) -> bpy.types.Material:
    made = bpy.data.materials.get(PREFIX + name)
    if made is not None:
        return made
    made = bpy.data.materials.new(PREFIX + name)
    made.diffuse_color = (*rgb, 1.0)
    made.roughness, made.metallic = roughness, metallic
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*rgb, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    return made


def _digits(rgb: tuple[float, float, float]) -> str:
    return "-".join(f"{round(channel * 255):03d}" for channel in rgb)
