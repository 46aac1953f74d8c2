"""The viewer's collections: each kind of thing can be shown or hidden in Blender with one click."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

NAMES: tuple[str, ...] = ("vehicle", "ground", "tracks", "bodies", "boxes", "arrows", "labels", "trails")
TOP = "Roadwatch"


class Layers:
    """A collection `Roadwatch` in the scene, with one below it for each layer; an old one is cleared."""

    def __init__(self, scene: bpy.types.Scene) -> None:
        remove_old()
        self.top = bpy.data.collections.new(TOP)
        scene.collection.children.link(self.top)
        self._of: dict[str, bpy.types.Collection] = {}
        for name in NAMES:
            self._of[name] = bpy.data.collections.new(f"{TOP} {name}")
            self.top.children.link(self._of[name])

    def object(
        self, name: str, content: bpy.types.ID | None, layer: str, parent: bpy.types.Object | None = None
    ) -> bpy.types.Object:
        """A new object on a layer."""
        made = bpy.data.objects.new(name, content)
        made.parent = parent
        self._of[layer].objects.link(made)
        return made

    def empty(self, name: str, layer: str, parent: bpy.types.Object | None = None) -> bpy.types.Object:
        """A new object that only has a place."""
        made = self.object(name, None, layer, parent)
        made.empty_display_size = 0.3
        return made

    def set_visible(self, layer: str, is_visible: bool) -> None:
        """Whether pictures show a layer."""
        self._of[layer].hide_render = not is_visible


def remove_objects(objects: Iterable[bpy.types.Object]) -> None:
    """Takes objects out of Blender, with texts and curves that only they have."""
    gone = list(objects)
    curves = [each.data for each in gone if isinstance(each.data, bpy.types.Curve)]
    bpy.data.batch_remove(gone)
    bpy.data.batch_remove(curves)


def remove_old() -> None:
    """Removes what an earlier run of the viewer left in this file."""
    old = bpy.data.collections.get(TOP)
    if old is None:
        return
    remove_objects(old.all_objects)
    bpy.data.batch_remove([*old.children, old])
