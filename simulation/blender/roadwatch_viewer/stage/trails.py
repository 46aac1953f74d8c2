"""Where tracks have been: a thin tube for each, drawn in live mode from memory, in a replay by keyframes."""

from __future__ import annotations

from collections import deque

import bpy
import numpy as np

from .keyframes import Recorder
from .layers import Layers

POINTS = 24
RADIUS_M = 0.05
OVER_GROUND_M = 0.05


class Trail:
    """The way of one track over the last seconds, at its feet."""

    def __init__(self, name: str, material: bpy.types.Material, layers: Layers) -> None:
        self._curve = bpy.data.curves.new(f"{name} trail", "CURVE")
        self._curve.dimensions = "3D"
        self._curve.bevel_depth, self._curve.bevel_resolution = RADIUS_M, 0
        self._curve.materials.append(material)
        self.object = layers.object(f"{name} trail", self._curve, "trails")
        self._past: deque[tuple[float, np.ndarray]] = deque()
        self._frames: list[float] = []

    def add(self, time_s: float, feet_odom_m: np.ndarray, frame: float) -> None:
        """The track was here."""
        self._past.append((time_s, feet_odom_m + np.array([0.0, 0.0, OVER_GROUND_M])))
        self._frames.append(frame)

    def redraw(self, now_s: float, trail_s: float, origin_m: np.ndarray) -> None:
        """Live: the last `trail_s` seconds, as `POINTS` points evenly in time."""
        while self._past and self._past[0][0] < now_s - trail_s:
            self._past.popleft()
        self._frames.clear()
        if len(self._past) < 2:
            self._curve.splines.clear()
            return
        times = np.array([time_s for time_s, _ in self._past])
        places = np.array([place for _, place in self._past]) - origin_m
        wanted = np.linspace(times[0], times[-1], POINTS)
        self._set_points(np.stack([np.interp(wanted, times, places[:, axis]) for axis in range(3)], axis=1))

    def write(self, trail_s: float, fps: float, origin_m: np.ndarray, recorder: Recorder) -> None:
        """Replay: the whole way once, of which keyframes show the last `trail_s` seconds."""
        if len(self._past) < 2:
            return
        self._set_points(np.array([place for _, place in self._past]) - origin_m)
        self._curve.bevel_factor_mapping_start = self._curve.bevel_factor_mapping_end = "RESOLUTION"
        frames = np.array(self._frames)
        last = len(frames) - 1
        starts = np.interp(frames - trail_s * fps, frames, np.arange(len(frames))) / last
        for number, (frame, start) in enumerate(zip(frames, starts, strict=True)):
            recorder.frame = float(frame)
            recorder.note(self._curve, "bevel_factor_start", (float(start),))
            recorder.note(self._curve, "bevel_factor_end", (number / last,))
        recorder.frame = float(frames[-1] + trail_s * fps)
        recorder.note(self._curve, "bevel_factor_start", (1.0,))

    def _set_points(self, points: np.ndarray) -> None:
        splines = self._curve.splines
        if not splines or len(splines[0].points) != len(points):
            splines.clear()
            splines.new("POLY").points.add(len(points) - 1)
        weighted = np.hstack([points, np.ones((len(points), 1))]).astype(np.float32)
        splines[0].points.foreach_set("co", weighted.ravel())
        self._curve.update_tag()
