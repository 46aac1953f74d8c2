"""The add-on: a panel `Roadwatch` in the 3D view's sidebar, and a command for Blender without a window."""

from __future__ import annotations

import atexit

import bpy

from ..cli import main
from . import live_view
from .operators import OPERATORS
from .panel import PANELS
from .properties import RoadwatchProperties

CLASSES = (RoadwatchProperties, *OPERATORS, *PANELS)
_commands: list[object] = []


def register() -> None:
    """Adds classes, the scene's property and the command `blender --command roadwatch_viewer`."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.roadwatch = bpy.props.PointerProperty(type=RoadwatchProperties)
    live_view.add_handlers()
    _commands.append(bpy.utils.register_cli_command("roadwatch_viewer", main))
    # Blender switches add-ons off before it ends; its Python module bpy does not, and crashes at the command.
    atexit.register(unregister)


def unregister() -> None:
    """Stops following and takes everything back; what was drawn stays."""
    atexit.unregister(unregister)
    live_view.stop()
    live_view.remove_handlers()
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
    del bpy.types.Scene.roadwatch
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
