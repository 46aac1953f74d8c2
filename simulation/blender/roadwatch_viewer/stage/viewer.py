"""The whole scene in Blender: takes scenes one after the other, from a daemon or a file."""

from __future__ import annotations

import bpy
import numpy as np

from ..placement import PlacedScene, Placement
from ..pose import Pose, euler_xyz
from ..schema import Rig, Scene
from ..selection import Drawn, Selector
from ..settings import Settings
from .ground import Ground, add_sun
from .keyframes import Recorder
from .layers import Layers, remove_objects
from .meshes import MeshStore
from .tracks import TrackObjects
from .trails import Trail
from .vehicle import Vehicle

FARTHEST_ORIGIN_M = 4000.0
"""Farther, single precision is coarser than half a millimetre: a live scene then takes a nearer origin."""

NS = 1e-9


class Viewer:
    """Blender's scene as the stream tells it.

    Blender's world is odom moved by `origin_m` (float64): the first pose of the vehicle. Scenes of a replay
    are recorded as keyframes; live, the properties themselves are set and nothing is kept.
    """

    def __init__(
        self, scene: bpy.types.Scene, settings: Settings, *, first_pose: Pose | None = None,
        recorder: Recorder | None = None,
    ) -> None:  # fmt: skip
        self.settings = settings
        self.recorder = recorder
        self.origin_m: np.ndarray | None = None if first_pose is None else first_pose.position_m.copy()
        self.tracks: dict[str, TrackObjects] = {}
        self._trails: dict[str, Trail] = {}
        self._drawn_at_s: dict[str, float] = {}
        self._layers = Layers(scene)
        self._meshes = MeshStore()
        self.vehicle = Vehicle(scene, self._layers, settings)
        self.ground = Ground(self._layers)
        add_sun(scene, self._layers)
        self._placement = Placement(first_pose)
        self._selector = Selector(settings)

    def warm_up(self) -> None:
        """Makes all meshes now, which takes a moment, so that no scene has to wait for them."""
        self._meshes.make_all()

    def set_rig(self, rig: Rig) -> None:
        """The stream's first line; cameras that are already up stay."""
        self._placement.base_frame = rig.base_frame
        self.vehicle.set_rig(rig)

    def set_settings(self, settings: Settings) -> None:
        """Thresholds hold from the next scene on."""
        self.settings = self._selector.settings = settings

    def draw(self, scene: Scene) -> list[Drawn]:
        """Puts a scene into Blender's data: which objects, and how finely."""
        placed = self._placement.place(scene)
        self._move_vehicle(placed)
        chosen = self._selector.select(placed.objects)
        now_s = scene.stamp_ns * NS
        for drawn in chosen:
            self._draw_track(drawn, now_s)
        gone = self.tracks.keys() - {drawn.placed.seen.key for drawn in chosen}
        for key in gone:
            self.tracks[key].hide(self.recorder)
        if self.recorder is None:
            self._redraw_trails(now_s)
            self._forget(gone, now_s)
        return chosen

    def show_only_marks(self, is_wanted: bool) -> None:
        """Whether pictures have nothing but boxes, arrows and labels, to be laid over a camera's image."""
        self.ground.set_visible(not is_wanted)
        self._layers.set_visible("bodies", not is_wanted)
        self._layers.set_visible("trails", not is_wanted)

    def finish(self) -> int:
        """Replay: writes the keyframes; how many."""
        if self.recorder is None:
            return 0
        for trail in self._trails.values():
            trail.write(self.settings.trail_s, self.settings.fps, self.origin_m, self.recorder)
        return self.recorder.write()

    def _move_vehicle(self, placed: PlacedScene) -> None:
        base_m = placed.odom_from_base.position_m
        is_live = self.recorder is None
        if self.origin_m is None or (is_live and np.abs(base_m - self.origin_m).max() > FARTHEST_ORIGIN_M):
            self.origin_m = base_m.copy()
        location = (base_m - self.origin_m).tolist()
        euler = euler_xyz(placed.odom_from_base.rotation[None])[0].tolist()
        base_link = self.vehicle.base_link
        base_link.location, base_link.rotation_euler = location, euler
        if self.recorder is not None:
            self.recorder.note(base_link, "location", location)
            self.recorder.note(base_link, "rotation_euler", euler)
        self.ground.follow(np.array(location), self.recorder)

    def _draw_track(self, drawn: Drawn, now_s: float) -> None:
        seen = drawn.placed.seen
        track = self.tracks.get(seen.key)
        if track is None:
            track = self.tracks[seen.key] = TrackObjects(drawn, self._layers, self._meshes)
        if self.settings.labels and track.label is None:
            track.add_label(seen.track_id, self.recorder)
        track.place(drawn, self.origin_m, self.recorder)
        self._drawn_at_s[seen.key] = now_s
        if self.settings.trail_s > 0.0:
            self._trail(track).add(now_s, _feet_m(drawn), self.recorder.frame if self.recorder else 0.0)

    def _trail(self, track: TrackObjects) -> Trail:
        if track.key not in self._trails:
            self._trails[track.key] = Trail(track.root.name, track.material, self._layers)
        return self._trails[track.key]

    def _redraw_trails(self, now_s: float) -> None:
        for trail in self._trails.values():
            trail.redraw(now_s, self.settings.trail_s, self.origin_m)

    def _forget(self, gone: set[str], now_s: float) -> None:
        """Removes tracks that have not been drawn for a while; all at once, for that is dear."""
        old = [key for key in gone if abs(now_s - self._drawn_at_s[key]) > self.settings.forget_after_s]
        objects: list[bpy.types.Object] = []
        for key in old:
            objects.extend(self.tracks.pop(key).objects())
            del self._drawn_at_s[key]
            if key in self._trails:
                objects.append(self._trails.pop(key).object)
        if objects:
            remove_objects(objects)


def _feet_m(drawn: Drawn) -> np.ndarray:
    return drawn.placed.position_m - np.array([0.0, 0.0, drawn.placed.seen.size_lwh_m[2] / 2.0])
