"""What the panel's buttons do."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..dataset import read_images
from ..errors import ViewerError
from ..follower import Address
from ..reading import read_recording
from ..replay import load_replay
from ..stage.pictures import Photographer
from ..stage.render import prepare
from ..stage.vehicle import look_through
from . import live_view


class ROADWATCH_OT_follow(bpy.types.Operator):
    """Show a running daemon's scene, and try again for as long as nobody listens there"""

    bl_idname = "roadwatch.follow"
    bl_label = "Follow"

    def execute(self, context: bpy.types.Context) -> set[str]:
        chosen = context.scene.roadwatch
        try:
            prepare(context.scene, chosen.to_settings())
            live_view.start(context.scene, Address(chosen.host, chosen.port), chosen.to_settings())
        except ViewerError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class ROADWATCH_OT_stop(bpy.types.Operator):
    """Let the daemon go; what was drawn last stays"""

    bl_idname = "roadwatch.stop"
    bl_label = "Stop"

    @classmethod
    def poll(cls, _: bpy.types.Context) -> bool:
        return live_view.is_following()

    def execute(self, _: bpy.types.Context) -> set[str]:
        live_view.stop()
        return {"FINISHED"}


class ROADWATCH_OT_replay(bpy.types.Operator):
    """Put a recorded scene into this file as keyframes"""

    bl_idname = "roadwatch.replay"
    bl_label = "Load"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        chosen = context.scene.roadwatch
        live_view.stop()
        try:
            recording = read_recording(Path(bpy.path.abspath(chosen.recording)))
            images = read_images(Path(bpy.path.abspath(chosen.dataset))) if chosen.dataset else {}
            settings = chosen.to_settings()
            windows = context.window_manager
            windows.progress_begin(0, len(recording.scenes))
            viewer = load_replay(
                context.scene, recording, settings, lambda done, _: windows.progress_update(done)
            )
            windows.progress_end()
            Photographer(context.scene, viewer, recording, settings, images)
        except ViewerError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        left_out = f", {recording.left_out} lines left out" if recording.left_out else ""
        self.report({"INFO"}, f"{len(recording.scenes)} scenes, {len(viewer.tracks)} tracks{left_out}")
        return {"FINISHED"}


class ROADWATCH_OT_look(bpy.types.Operator):
    """Look through a camera of the rig, with that camera's resolution"""

    bl_idname = "roadwatch.look"
    bl_label = "Look through"

    camera: bpy.props.StringProperty(options={"HIDDEN"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        camera = context.scene.objects.get(self.camera)
        if camera is None or camera.type != "CAMERA":
            self.report({"ERROR"}, f"no camera {self.camera!r} in this scene")
            return {"CANCELLED"}
        look_through(context.scene, camera)
        for area in context.screen.areas if context.screen else ():
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
        return {"FINISHED"}


OPERATORS = (ROADWATCH_OT_follow, ROADWATCH_OT_stop, ROADWATCH_OT_replay, ROADWATCH_OT_look)
