"""Blender's video editor, for pictures that are made of pictures: clips, and panels beside each other."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def edit(
    name: str, size_px: tuple[int, int]
) -> Iterator[tuple[bpy.types.Scene, bpy.types.bpy_prop_collection]]:
    """A scene of its own, colours as they are stored, and its strips; gone afterwards."""
    scene = bpy.data.scenes.new(name)
    try:
        editor = scene.sequence_editor_create()
        scene.view_settings.view_transform = "Standard"
        scene.render.resolution_x, scene.render.resolution_y = size_px
        scene.render.resolution_percentage = 100
        yield scene, editor.strips if hasattr(editor, "strips") else editor.sequences
    finally:
        bpy.data.scenes.remove(scene)
