"""Switches the add-on on and off and draws its panels. Run by test_addon.py."""

import bpy

import roadwatch_viewer


class Layout:
    """Takes what a panel draws and refuses what does not exist, as Blender's own layout would when drawn."""

    drawn = []

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties, name
        self.drawn.append(name)

    def operator(self, name, **_):
        group, operator = name.split(".")
        getattr(getattr(bpy.ops, group), operator).get_rna_type()
        self.drawn.append(name)
        return type("Properties", (), {})()

    def label(self, *, text):
        self.drawn.append(text)

    def row(self, **_):
        return self

    column = row


bpy.ops.wm.read_factory_settings(use_empty=True)
roadwatch_viewer.register()
from roadwatch_viewer.addon.panel import PANELS

for panel in PANELS:
    panel.draw(type("Self", (), {"layout": Layout()})(), bpy.context)
assert {"host", "port", "most_objects", "roadwatch.follow", "roadwatch.replay", "not following"} <= set(
    Layout.drawn
)
assert bpy.context.scene.roadwatch.to_settings().most_objects == 60
roadwatch_viewer.unregister()
assert not hasattr(bpy.types.Scene, "roadwatch") and not hasattr(bpy.types, "VIEW3D_PT_roadwatch_follow")
roadwatch_viewer.register()
roadwatch_viewer.unregister()
print("done")
