"""What the panel shows and changes: kept in the file, one for each of Blender's scenes."""

from __future__ import annotations

import dataclasses

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..settings import DETAILS, Settings
from . import live_view

DEFAULTS = Settings()
DETAIL_ITEMS = [(name, name.capitalize(), f"Draw {name} at the finest") for name in DETAILS]


def _changed(properties: RoadwatchProperties, _: bpy.types.Context) -> None:
    live_view.set_settings(properties.to_settings())


def _metres(name: str, key: str, text: str) -> FloatProperty:
    default = getattr(DEFAULTS, key)
    return FloatProperty(
        name=name, description=text, default=default, min=0.0, soft_max=500.0, update=_changed
    )


class RoadwatchProperties(bpy.types.PropertyGroup):
    """`scene.roadwatch`."""

    host: StringProperty(
        name="Host", description="Where the daemon's scene stream listens", default="127.0.0.1"
    )
    port: IntProperty(name="Port", description="[scene_stream] of the daemon", default=7600, min=1, max=65535)
    recording: StringProperty(
        name="Recording", description="scene.jsonl of roadwatch export scene", subtype="FILE_PATH"
    )
    dataset: StringProperty(
        name="Images", description="Rig dataset whose images stand behind the cameras", subtype="DIR_PATH"
    )
    fps: IntProperty(
        name="Frames a second",
        description="Of Blender's clock, in a replay",
        default=DEFAULTS.fps,
        min=1,
        max=1000,
    )
    most_objects: IntProperty(
        name="Most objects",
        description="The nearest win",
        default=DEFAULTS.most_objects,
        min=0,
        soft_max=500,
        update=_changed,
    )
    range_m: _metres("Range", "range_m", "Nothing farther from the vehicle, m")
    min_score: FloatProperty(
        name="Least score",
        description="Of the detector",
        default=DEFAULTS.min_score,
        min=0.0,
        max=1.0,
        update=_changed,
    )
    show_tentative: BoolProperty(
        name="Tentative tracks",
        description="Seen too seldom to be sure",
        default=DEFAULTS.show_tentative,
        update=_changed,
    )
    update_rate_hz: FloatProperty(
        name="Scenes a second",
        description="At most; 0 draws all",
        default=DEFAULTS.update_rate_hz,
        min=0.0,
        soft_max=60.0,
        update=_changed,
    )
    level_of_detail: EnumProperty(
        name="Detail",
        description="The finest that is drawn",
        items=DETAIL_ITEMS,
        default=DEFAULTS.level_of_detail,
        update=_changed,
    )
    simple_beyond_m: _metres("Simple beyond", "simple_beyond_m", "Simple models from here on, m; 0: never")
    boxes_beyond_m: _metres("Boxes beyond", "boxes_beyond_m", "Only boxes from here on, m; 0: never")
    labels: BoolProperty(
        name="Numbers", description="The track's number over it", default=DEFAULTS.labels, update=_changed
    )
    trail_s: FloatProperty(
        name="Trail",
        description="Where each object has been for so long, s",
        default=DEFAULTS.trail_s,
        min=0.0,
        soft_max=30.0,
        update=_changed,
    )

    def to_settings(self) -> Settings:
        """The settings as the panel has them; keys that it does not show keep their defaults."""
        shown = {
            key: getattr(self, key) for key in self.__annotations__ if key in Settings.__dataclass_fields__
        }
        return dataclasses.replace(DEFAULTS, **shown)
