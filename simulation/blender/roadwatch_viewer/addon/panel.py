"""The panel in the 3D view's sidebar."""

from __future__ import annotations

import bpy

from ..stage.layers import TOP
from . import live_view

THRESHOLDS = ("most_objects", "range_m", "min_score", "show_tentative", "update_rate_hz")
DRAWING = ("level_of_detail", "simple_beyond_m", "boxes_beyond_m", "labels", "trail_s")


class _RoadwatchPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Roadwatch"


class VIEW3D_PT_roadwatch_follow(_RoadwatchPanel, bpy.types.Panel):
    """Follow a daemon."""

    bl_label = "Follow"

    def draw(self, context: bpy.types.Context) -> None:
        chosen, layout = context.scene.roadwatch, self.layout
        address = layout.row(align=True)
        address.prop(chosen, "host", text="")
        address.prop(chosen, "port", text="")
        buttons = layout.row(align=True)
        buttons.operator("roadwatch.follow", text="Follow", icon="PLAY")
        buttons.operator("roadwatch.stop", text="Stop", icon="PAUSE")
        said = layout.column(align=True)
        for line in live_view.status_lines():
            said.label(text=line)


class VIEW3D_PT_roadwatch_replay(_RoadwatchPanel, bpy.types.Panel):
    """Load a recording."""

    bl_label = "Replay"

    def draw(self, context: bpy.types.Context) -> None:
        chosen, layout = context.scene.roadwatch, self.layout
        for name in ("recording", "dataset", "fps"):
            layout.prop(chosen, name)
        layout.operator("roadwatch.replay", text="Load", icon="IMPORT")


class VIEW3D_PT_roadwatch_thresholds(_RoadwatchPanel, bpy.types.Panel):
    """How much is drawn, and how finely; while following it holds from the next scene on."""

    bl_label = "Thresholds"

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        for names in (THRESHOLDS, DRAWING):
            column = self.layout.column(align=True)
            for name in names:
                column.prop(context.scene.roadwatch, name)


class VIEW3D_PT_roadwatch_cameras(_RoadwatchPanel, bpy.types.Panel):
    """Look through a camera."""

    bl_label = "Cameras"

    def draw(self, context: bpy.types.Context) -> None:
        drawn = bpy.data.collections.get(f"{TOP} vehicle")
        cameras = [each for each in drawn.objects if each.type == "CAMERA"] if drawn else []
        if not cameras:
            self.layout.label(text="none yet: follow or load first")
        for camera in cameras:
            self.layout.operator(
                "roadwatch.look", text=camera.data.name, icon="CAMERA_DATA"
            ).camera = camera.name


PANELS = (
    VIEW3D_PT_roadwatch_follow,
    VIEW3D_PT_roadwatch_replay,
    VIEW3D_PT_roadwatch_thresholds,
    VIEW3D_PT_roadwatch_cameras,
)
