"""Roadwatch's scene in Blender: follow a running daemon, replay a recording.

The same package is an add-on of Blender (`register`, `unregister`) and a program
(`python -m roadwatch_viewer`).
Nothing here imports bpy until one of them runs.
"""

bl_info = {
    "name": "Roadwatch viewer",
    "description": "Follow a running Roadwatch daemon, or replay a recorded scene",
    "author": "The Roadwatch authors",
    "version": (0, 1, 0),
    "blender": (4, 2, 0),
    "location": "3D View > Sidebar > Roadwatch",
    "category": "3D View",
}


def register() -> None:
    """Blender calls this when the add-on is switched on."""
    from . import addon

    addon.register()


def unregister() -> None:
    """Blender calls this when the add-on is switched off."""
    from . import addon

    addon.unregister()
