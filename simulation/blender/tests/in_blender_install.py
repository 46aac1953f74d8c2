"""Installs the zip as Blender's preferences do, and switches it on. Run by test_addon.py."""

import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
repositories = bpy.context.preferences.extensions.repos
repository = next(each for each in repositories if each.module == "user_default")
print(
    bpy.ops.extensions.package_install_files(
        filepath=sys.argv[1], repo=repository.module, enable_on_install=True
    )
)
print([each.module for each in bpy.context.preferences.addons])
assert "bl_ext.user_default.roadwatch_viewer" in bpy.context.preferences.addons
assert hasattr(bpy.context.scene, "roadwatch")
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.roadwatch_viewer")
assert not hasattr(bpy.context.scene, "roadwatch")
print("done")
