"""Loads a recording through the panel's operator, and renders with the command. Run by test_addon.py."""

import sys
from pathlib import Path

import bpy

import roadwatch_viewer

bpy.ops.wm.read_factory_settings(use_empty=True)
roadwatch_viewer.register()
bpy.context.scene.roadwatch.recording = sys.argv[1]
assert bpy.ops.roadwatch.replay() == {"FINISHED"}
assert bpy.ops.roadwatch.look(camera="camera front") == {"FINISHED"}
assert (bpy.context.scene.render.resolution_x, bpy.context.scene.camera.name) == (960, "camera front")
try:
    bpy.context.scene.roadwatch.recording = "/nowhere.jsonl"
    bpy.ops.roadwatch.replay()
except RuntimeError as error:
    assert "cannot read /nowhere.jsonl" in str(error)
from roadwatch_viewer.cli import main

still = Path(sys.argv[1]).with_name("still.png")
settings = still.with_name("small.toml")
settings.write_text("width_px = 192\nheight_px = 108\nsamples = 1\n")
assert main(["replay", sys.argv[1], "--still", str(still), "--at", "0.2", "--settings", str(settings)]) == 0
assert still.read_bytes()[1:4] == b"PNG"
roadwatch_viewer.unregister()
print("done")
