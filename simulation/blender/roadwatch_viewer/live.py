"""Following a daemon in Blender: one step draws the newest scene, and says how long that took."""

from __future__ import annotations

import time

import bpy

from .delays import Delays
from .follower import Follower, Received
from .selection import Pace
from .stage.viewer import Viewer

NS = 1e-9


class LiveSession:
    """Moves scenes from a follower into Blender. Blender's main thread calls `step`, over and over."""

    def __init__(self, follower: Follower, viewer: Viewer, view_layer: bpy.types.ViewLayer) -> None:
        self.follower, self.viewer = follower, viewer
        self.delays = Delays()
        self.drawn_objects = 0
        self.first_seq: int | None = None
        self.last_seq: int | None = None
        self.view_layer = view_layer
        self._pace = Pace()
        self._pending: Received | None = None

    def step(self, timeout_s: float = 0.0) -> bool:
        """Draws the newest scene if there is one and it is due; waits for one at most `timeout_s`."""
        rig, newest = self.follower.take(timeout_s)
        if rig is not None:
            self.viewer.set_rig(rig)
        self._pending = newest or self._pending
        if self._pending is None or not self._pace.is_due(
            time.monotonic(), self.viewer.settings.update_rate_hz
        ):
            return False
        received = self._pending
        began_s = time.monotonic()
        self.drawn_objects = len(self.viewer.draw(received.scene))
        self.view_layer.update()
        now_s = time.monotonic()
        # Only now: a scene that could not be drawn is drawn by the next step, on a viewer made anew.
        self._pending = None
        self.last_seq = received.scene.seq
        if self.first_seq is None:
            self.first_seq = self.last_seq
        self.delays.note(
            from_line_s=now_s - received.received_s,
            from_stamp_s=(time.time_ns() - received.scene.stamp_ns) * NS,
            update_s=now_s - began_s,
        )
        return True

    def status_line(self) -> str:
        """What is going on, in one line."""
        said = self.follower.status.said
        if self.delays.scenes == 0:
            return said
        counts = f"{self.drawn_objects} objects, {self.delays.scenes} scenes drawn"
        left_out = self.follower.warnings.count
        lines = f", {left_out} lines left out" if left_out else ""
        return f"{said}; {counts}, {self.follower.overtaken} overtaken{lines}; {self.delays.line()}"
