"""A recording in Blender: every scene as keyframes at its capture time."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from .placement import first_known_pose
from .reading import Recording
from .selection import Pace
from .settings import Settings
from .stage.keyframes import Recorder
from .stage.viewer import Viewer

FIRST_FRAME = 1
NS = 1e-9
Report = Callable[[int, int], None]


def load_replay(
    scene: bpy.types.Scene, recording: Recording, settings: Settings, report: Report | None = None
) -> Viewer:
    """Puts the whole recording into Blender's scene; `report` hears how many scenes are done, of how many."""
    recorder = Recorder()
    viewer = Viewer(scene, settings, first_pose=first_known_pose(recording.scenes), recorder=recorder)
    viewer.set_rig(recording.rig)
    pace = Pace()
    for number, each in enumerate(recording.scenes, 1):
        since_s = (each.stamp_ns - recording.scenes[0].stamp_ns) * NS
        if pace.is_due(since_s, settings.update_rate_hz):
            recorder.frame = frame_at(since_s, settings.fps)
            viewer.draw(each)
        if report is not None:
            report(number, len(recording.scenes))
    viewer.finish()
    scene.render.fps, scene.render.fps_base = settings.fps, 1.0
    scene.frame_start = FIRST_FRAME
    scene.frame_end = int(frame_at(recording.seconds, settings.fps))
    set_time(scene, 0.0, settings.fps)
    return viewer


def frame_at(since_s: float, fps: float) -> float:
    """The frame, with its fraction, of a time since the first scene."""
    return FIRST_FRAME + since_s * fps


def set_time(scene: bpy.types.Scene, since_s: float, fps: float) -> None:
    """Moves Blender's clock to a time since the first scene, to a fraction of a frame."""
    frame = frame_at(since_s, fps)
    scene.frame_set(int(frame), subframe=frame - int(frame))
