"""The Blender renderer: Cycles pictures of the same meshes, for figures and for convincing looks."""

from ..errors import SimulationError

try:
    import bpy  # noqa: F401
except ImportError as error:
    raise SimulationError(
        "Blender's Python module bpy 4.5 exists for CPython 3.11 only, and it is not installed here: "
        "make an environment with python3.11 and install `roadwatch-simulation[blender]` into it; "
        "everything but Cycles pictures works without it"
    ) from error

from .renderer import BlenderRenderer

__all__ = ["BlenderRenderer"]
