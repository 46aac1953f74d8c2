"""Keyframes by the thousand: collected as numbers, then written as whole curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

_INTERPOLATION = {"CONSTANT": 0, "LINEAR": 1}
_TURNS = ("rotation_euler",)


@dataclass
class _Channel:
    interpolation: str
    frames: list[float] = field(default_factory=list)
    values: list[Sequence[float]] = field(default_factory=list)


class Recorder:
    """Takes down what properties are at which frame, fractions of frames included."""

    def __init__(self) -> None:
        self.frame = 1.0
        self._channels: dict[tuple[bpy.types.ID, str], _Channel] = {}

    def note(self, owner: bpy.types.ID, path: str, value: Sequence[float]) -> None:
        """The property is `value` now, and changes evenly from one such moment to the next."""
        self._take_down(owner, path, value, "LINEAR", self.frame)

    def note_step(
        self, owner: bpy.types.ID, path: str, value: Sequence[float], *, frame: float | None = None
    ) -> None:
        """The property is `value` from now on, or from another frame that is not before its last."""
        self._take_down(owner, path, value, "CONSTANT", self.frame if frame is None else frame)

    def _take_down(
        self, owner: bpy.types.ID, path: str, value: Sequence[float], interpolation: str, frame: float
    ) -> None:
        channel = self._channels.setdefault((owner, path), _Channel(interpolation))
        channel.frames.append(frame)
        channel.values.append(value)

    def write(self) -> int:
        """Makes the curves, one action for each owner; how many keyframes there are now."""
        curves: dict[bpy.types.ID, dict[str, _Channel]] = {}
        for (owner, path), channel in self._channels.items():
            curves.setdefault(owner, {})[path] = channel
        count = sum(_write_owner(owner, channels) for owner, channels in curves.items())
        self._channels.clear()
        return count


def _write_owner(owner: bpy.types.ID, channels: dict[str, _Channel]) -> int:
    curves = _new_curves(owner)
    count = 0
    for path, channel in channels.items():
        values = np.array(channel.values, dtype=float)
        if path in _TURNS:
            # The short way round: no step between two scenes is more than half a turn.
            values = np.unwrap(values, axis=0)
        for index in range(values.shape[1]):
            kept = _changes(values[:, index])
            frames = np.array(channel.frames)[kept]
            _write_curve(curves.new(path, index=index), frames, values[kept, index], channel.interpolation)
            count += len(frames)
    return count


def _changes(values: np.ndarray) -> np.ndarray:
    """Which values are needed: all but those that equal both neighbours."""
    if len(values) < 3:
        return np.ones(len(values), dtype=bool)
    same = values[1:] == values[:-1]
    inner = ~(same[:-1] & same[1:])
    return np.concatenate([[True], inner, [True]])


def _write_curve(curve: bpy.types.FCurve, frames: np.ndarray, values: np.ndarray, interpolation: str) -> None:
    points = curve.keyframe_points
    points.add(len(frames))
    points.foreach_set("co", np.stack([frames, values], axis=1).astype(np.float32).ravel())
    way = _INTERPOLATION[interpolation]
    points.foreach_set("interpolation", np.full(len(frames), way, dtype=np.int32))
    curve.update()


def _new_curves(owner: bpy.types.ID) -> bpy.types.bpy_prop_collection:
    """Where the owner's curves go: a channel bag since Blender 4.4, the action itself before."""
    animation = owner.animation_data_create()
    action = bpy.data.actions.new(owner.name)
    animation.action = action
    if not hasattr(action, "slots"):
        return action.fcurves
    slot = action.slots.new(owner.id_type, owner.name)
    animation.action_slot = slot
    strip = action.layers.new("scene").strips.new(type="KEYFRAME")
    return strip.channelbag(slot, ensure=True).fcurves
