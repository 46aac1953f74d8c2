"""The part of the viewer that needs Blender's Python module bpy: objects, materials, cameras, keyframes."""

from ..errors import ViewerError

try:
    import bpy
except ImportError as error:
    raise ViewerError(
        "Blender's Python module bpy is not here: run this inside Blender, or make an environment with "
        "python3.11 (bpy 4.5 exists for no other) and install both packages into it: "
        "`pip install ./simulation './simulation/blender[blender]'`"
    ) from error

__all__ = ["bpy"]
