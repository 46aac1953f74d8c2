"""The tracked objects in Blender: an empty for each track, and under it what the track looks like."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import bpy
import numpy as np

from ..colours import colour_index
from ..kinds import kind_of, kind_without_heading
from ..selection import Drawn
from .keyframes import Recorder
from .layers import Layers
from .materials import track_material
from .meshes import MeshStore, nominal_size

LEAST_SIZE_M = 0.05
SIZE_STEP_M = 0.005
LABEL_HEIGHT_M = 1.0
LABEL_BOLD_M = 0.035
LABEL_OVER_BOX_M = 0.5


@dataclass(frozen=True)
class LookKey:
    """What a track may look like; a track whose class or heading changes has more than one."""

    kind: str
    detail: str
    heading: str


@dataclass
class TrackLook:
    """One look: the box carries the scale, body and arrow hang from it."""

    box: bpy.types.Object
    parts: tuple[bpy.types.Object, ...]
    nominal_m: tuple[float, float, float]


class TrackObjects:
    """One track in Blender: `root` is at the centre of its box."""

    def __init__(self, drawn: Drawn, layers: Layers, meshes: MeshStore) -> None:
        seen = drawn.placed.seen
        self.key = seen.key
        self.class_id = seen.class_id
        self._kind = kind_of(seen.class_id, seen.size_lwh_m)
        self._layers, self._meshes = layers, meshes
        self.material = track_material(colour_index(seen.key))
        self.root = layers.empty(f"track {seen.track_id} {seen.class_id}", "tracks")
        self.root["roadwatch_key"] = seen.key
        self.label: bpy.types.Object | None = None
        self._looks: dict[LookKey, TrackLook] = {}
        self._shown: LookKey | None = None
        self._size_m = (0.0, 0.0, 0.0)

    def place(self, drawn: Drawn, origin_m: np.ndarray, recorder: Recorder | None) -> None:
        """Puts the track where the scene has it. `origin_m` is Blender's origin in odom."""
        placed = drawn.placed
        location = (placed.position_m - origin_m).tolist()
        euler = placed.euler_rad.tolist()
        self.root.location = location
        self.root.rotation_euler = euler
        if recorder is not None:
            recorder.note(self.root, "location", location)
            recorder.note(self.root, "rotation_euler", euler)
        self._show(self._look_key(drawn), recorder)
        self._resize(placed.seen.size_lwh_m, recorder)

    def add_label(self, track_id: int, recorder: Recorder | None) -> None:
        """Writes the track's number over it, from when it is next shown."""
        self.label = self._new_label(track_id)
        _note_unseen_before((self.label,), recorder)

    def hide(self, recorder: Recorder | None) -> None:
        """The track is gone, for now or for good."""
        self._show(None, recorder)

    def objects(self) -> Iterable[bpy.types.Object]:
        """Everything in Blender that belongs to this track."""
        yield self.root
        if self.label is not None:
            yield self.label
        for look in self._looks.values():
            yield look.box
            yield from look.parts

    def shown(self) -> tuple[bpy.types.Object, ...]:
        """What of it is seen: box first, then body and arrow where there are any."""
        if self._shown is None:
            return ()
        look = self._looks[self._shown]
        return (look.box, *look.parts)

    def _look_key(self, drawn: Drawn) -> LookKey:
        seen = drawn.placed.seen
        if seen.class_id != self.class_id:
            self.class_id = seen.class_id
            self._kind = kind_of(seen.class_id, seen.size_lwh_m)
        if seen.yaw_rad is None:
            return LookKey(kind_without_heading(self._kind), drawn.detail, "unknown")
        return LookKey(self._kind, drawn.detail, "known")

    def _show(self, key: LookKey | None, recorder: Recorder | None) -> None:
        if key == self._shown:
            return
        before, self._shown = self._shown, key
        if before is not None:
            self._set_hidden((self._looks[before].box, *self._looks[before].parts), True, recorder)
        if key is not None:
            if key not in self._looks:
                self._looks[key] = self._new_look(key, recorder)
            # Another look has another scale.
            self._size_m = (0.0, 0.0, 0.0)
            self._set_hidden((self._looks[key].box, *self._looks[key].parts), False, recorder)
        if self.label is not None and (before is None) != (key is None):
            self._set_hidden((self.label,), key is None, recorder)

    def _set_hidden(
        self, objects: Iterable[bpy.types.Object], is_hidden: bool, recorder: Recorder | None
    ) -> None:
        for each in objects:
            each.hide_viewport = each.hide_render = is_hidden
            if recorder is not None:
                recorder.note_step(each, "hide_viewport", (float(is_hidden),))
                recorder.note_step(each, "hide_render", (float(is_hidden),))

    def _resize(self, size_lwh_m: tuple[float, float, float], recorder: Recorder | None) -> None:
        """Scales to a size; changes too small to be seen are left for later."""
        size = tuple(max(extent, LEAST_SIZE_M) for extent in size_lwh_m)
        if max(abs(now - new) for now, new in zip(self._size_m, size, strict=True)) < SIZE_STEP_M:
            return
        self._size_m = size
        look = self._looks[self._shown]
        scale = tuple(extent / nominal for extent, nominal in zip(size, look.nominal_m, strict=True))
        look.box.scale = scale
        if recorder is not None:
            recorder.note(look.box, "scale", scale)
        if self.label is not None:
            self.label.location.z = size[2] / 2.0 + LABEL_OVER_BOX_M

    def _new_look(self, key: LookKey, recorder: Recorder | None) -> TrackLook:
        name = self.root.name
        box = self._new_part(f"{name} box", self._meshes.edges(key.kind, key.heading), self.root, "boxes")
        parts = []
        if key.detail != "boxes":
            mesh = self._meshes.body(key.kind, key.detail)
            parts.append(self._new_part(f"{name} body", mesh, box, "bodies"))
        if key.heading == "known":
            parts.append(self._new_part(f"{name} arrow", self._meshes.arrow(key.kind), box, "arrows"))
        _note_unseen_before((box, *parts), recorder)
        return TrackLook(box, tuple(parts), nominal_size(key.kind))

    def _new_part(
        self, name: str, mesh: bpy.types.Mesh, parent: bpy.types.Object, layer: str
    ) -> bpy.types.Object:
        made = self._layers.object(name, mesh, layer, parent)
        if "track_slot" in mesh:
            slot = made.material_slots[mesh["track_slot"]]
            slot.link = "OBJECT"
            slot.material = self.material
        return made

    def _new_label(self, track_id: int) -> bpy.types.Object:
        text = bpy.data.curves.new(f"label {track_id}", "FONT")
        text.body, text.size, text.align_x = str(track_id), LABEL_HEIGHT_M, "CENTER"
        text.offset, text.extrude = LABEL_BOLD_M, LABEL_BOLD_M
        text.materials.append(self.material)
        made = self._layers.object(f"{self.root.name} label", text, "labels", self.root)
        made.hide_viewport = made.hide_render = True
        facing = made.constraints.new("COPY_ROTATION")
        facing.target = bpy.context.scene.camera
        return made


def _note_unseen_before(objects: Iterable[bpy.types.Object], recorder: Recorder | None) -> None:
    if recorder is None:
        return
    for each in objects:
        for path in ("hide_viewport", "hide_render"):
            recorder.note_step(each, path, (1.0,), frame=recorder.frame - 1.0)
