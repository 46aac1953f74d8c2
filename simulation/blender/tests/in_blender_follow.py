"""Follows before anyone listens, then through a loss, then is refused. Run by test_addon.py."""

import json
import socket
import sys
import time
from pathlib import Path

import bpy

import roadwatch_viewer

port, lines = int(sys.argv[1]), json.loads(Path(sys.argv[2]).read_text())
bpy.ops.wm.read_factory_settings(use_empty=True)
roadwatch_viewer.register()
from roadwatch_viewer.addon import live_view

bpy.context.scene.roadwatch.port = port
assert bpy.ops.roadwatch.follow() == {"FINISHED"}
assert bpy.app.timers.is_registered(live_view._tick)


def tick_until(happened, what):
    end_s = time.monotonic() + 20.0
    while time.monotonic() < end_s:
        began_s = time.monotonic()
        live_view._tick()
        assert time.monotonic() - began_s < 0.5, "Blender waited"
        if happened():
            return
        time.sleep(0.02)
    raise AssertionError(f"{what}: {live_view.status_lines()}")


def shown():
    return sum(bool(track.shown()) for track in live_view.viewer().tracks.values())


tick_until(lambda: "nobody listens" in live_view.status_lines()[0], "absent")
listener = socket.create_server(("127.0.0.1", port))
link, _ = listener.accept()
link.sendall(lines.encode())
tick_until(lambda: shown() == 5, "five objects")
bpy.context.scene.roadwatch.most_objects = 2
link.sendall((lines.splitlines()[1] + "\n").encode())
tick_until(lambda: shown() == 2, "two objects")
link.close()
tick_until(lambda: "closed the connection" in live_view.status_lines()[0], "gone")
link, _ = listener.accept()
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
bpy.context.scene.roadwatch.most_objects = 3
link.sendall(lines.encode() * 2)
tick_until(lambda: shown() == 3, "drawn again after the user deleted all")
link.close()
link, _ = listener.accept()
link.sendall(b'{"type": "rig", "schema": "roadwatch_scene", "version": 7, "cameras": []}\n')
tick_until(lambda: not live_view.is_following(), "refused")
assert "version 7" in live_view.status_lines()[0]
roadwatch_viewer.unregister()
print("done")
