"""What the program's commands do, once what was typed is understood."""

from __future__ import annotations

import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import ViewerError, make_folder_of
from .follower import Address, Follower, State
from .progress import Progress, StatusLine
from .reading import read_recording
from .schema import Rig
from .settings import Settings, load_settings

if TYPE_CHECKING:
    import bpy

    from .live import LiveSession
    from .stage.pictures import Photographer

STEP_WAIT_S = 0.05
SETTINGS_CHECK_S = 1.0


@dataclass(frozen=True)
class Still:
    """A picture: where to, of what time (s since the first scene), from which view."""

    path: Path
    at_s: float


@dataclass(frozen=True)
class Clip:
    """A film: where to, from when (s since the first scene), how long."""

    path: Path
    from_s: float
    seconds: float


@dataclass(frozen=True)
class Outputs:
    """What a command leaves behind."""

    view: str
    still: Still | None = None
    clip: Clip | None = None
    blend: Path | None = None


def run_replay(recording: Path, images: Path | None, settings: Settings, outputs: Outputs) -> None:
    """Puts a recording into an empty Blender file and makes what is wanted of it."""
    photographer = _load(recording, images, settings)
    if outputs.still is not None:
        photographer.still(outputs.view, outputs.still.at_s, outputs.still.path)
        print(outputs.still.path)
    if outputs.clip is not None:
        clip = outputs.clip
        photographer.clip(outputs.view, clip.from_s, clip.seconds, clip.path, Progress("pictures"))
        print(clip.path)
    if outputs.blend is not None:
        _save(outputs.blend)


def run_side_by_side(
    recording: Path, images: Path, camera: str, view: str, settings: Settings, picture: Still
) -> None:
    """Makes one picture of a camera's image with boxes over it and, beside it, of the scene in Blender."""
    photographer = _load(recording, images, settings)
    from .stage.side_by_side import side_by_side

    side_by_side(photographer, camera, view, picture.at_s, picture.path)
    print(picture.path)


def _load(recording: Path, images: Path | None, settings: Settings) -> Photographer:
    """A recording in an empty Blender file, with the images of a rig dataset where one is given."""
    read = read_recording(recording)
    cameras = {}
    if images is not None:
        from .dataset import read_images

        cameras = read_images(images)
    scene = _empty_scene()
    from .replay import load_replay
    from .stage.pictures import Photographer

    viewer = load_replay(scene, read, settings, Progress("scenes"))
    _warn_distortion(read.rig)
    return Photographer(scene, viewer, read, settings, cameras)


def run_follow(
    address: Address, seconds: float | None, report: Path | None, settings: LiveSettings, outputs: Outputs
) -> None:
    """Follows a daemon until the time is up or Ctrl-C, then makes what is wanted of the last scene."""
    scene = _empty_scene()
    import bpy

    from .live import LiveSession
    from .stage.viewer import Viewer

    viewer = Viewer(scene, settings.now)
    viewer.warm_up()
    follower = Follower(address)
    session = LiveSession(follower, viewer, bpy.context.view_layer)
    follower.start()
    try:
        _step_until(session, seconds, settings)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
    finally:
        follower.stop()
    if session.delays.scenes:
        print(session.delays.line(), file=sys.stderr)
    if report is not None:
        _write_report(report, session)
    if session.delays.scenes == 0:
        raise ViewerError(
            f"no scene came from {address}: "
            "is the daemon running with [scene_stream] in its configuration, and is this its address?"
        )
    _finish_live(scene, session, settings.now, outputs)


class LiveSettings:
    """Settings that follow their file: read again when it changes, kept as they are while it has mistakes."""

    def __init__(self, path: Path | None, given: Settings) -> None:
        self.now = given
        self._path = path
        self._changed = self._stamp()
        self._checked_s = time.monotonic()

    def refresh(self) -> Settings | None:
        """New settings, or None; looks at the file once a second at most."""
        now_s = time.monotonic()
        if self._path is None or now_s - self._checked_s < SETTINGS_CHECK_S:
            return None
        self._checked_s = now_s
        changed = self._stamp()
        if changed == self._changed:
            return None
        self._changed = changed
        try:
            self.now = load_settings(self._path)
        except ViewerError as error:
            print(f"warning: {error}\nthe settings stay as they were", file=sys.stderr)
            return None
        print(f"settings read again from {self._path}", file=sys.stderr)
        return self.now

    def _stamp(self) -> tuple[int, int] | None:
        try:
            found = self._path.stat() if self._path else None
        except OSError:
            return None
        return (found.st_mtime_ns, found.st_size) if found else None


def _step_until(session: LiveSession, seconds: float | None, settings: LiveSettings) -> None:
    """Draws until the time is up. Raises ViewerError when the stream is refused."""
    status = StatusLine()
    began_s = time.monotonic()
    while seconds is None or time.monotonic() - began_s < seconds:
        session.step(STEP_WAIT_S)
        now = session.follower.status
        if now.state is State.REFUSED:
            raise ViewerError(now.said)
        status.say(now.said, session.status_line())
        changed = settings.refresh()
        if changed is not None:
            session.viewer.set_settings(changed)


def _finish_live(scene: bpy.types.Scene, session: LiveSession, settings: Settings, outputs: Outputs) -> None:
    from .stage.render import prepare, render_still, show_view

    prepare(scene, settings)
    if outputs.still is not None:
        show_view(scene, session.viewer.vehicle, outputs.view)
        render_still(scene, outputs.still.path)
        print(outputs.still.path)
    if outputs.blend is not None:
        _save(outputs.blend)


def _write_report(path: Path, session: LiveSession) -> None:
    follower = session.follower
    counted = {"overtaken": follower.overtaken, "lines_left_out": follower.warnings.count}
    drawn = {"first_seq": session.first_seq, "last_seq": session.last_seq}
    said = {"address": str(follower.address), **drawn, **session.delays.report(), **counted}
    make_folder_of(path)
    try:
        path.write_text(json.dumps(said, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise ViewerError(f"cannot write {path}: {error.strerror}") from error
    print(path)


def _warn_distortion(rig: Rig) -> None:
    bent = [camera.name for camera in rig.cameras if camera.has_distortion]
    if bent:
        print(f"warning: drawn without lens distortion: {', '.join(bent)}", file=sys.stderr)


def _empty_scene() -> bpy.types.Scene:
    """An empty file of Blender's; raises ViewerError where there is no Blender."""
    from .stage import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return bpy.context.scene


def _save(path: Path) -> None:
    import bpy

    from .stage.render import silence

    make_folder_of(path)
    try:
        with silence():
            bpy.ops.wm.save_as_mainfile(filepath=str(path.resolve()), compress=True)
    except RuntimeError as error:
        raise ViewerError(f"cannot save {path}: {error}") from error
    print(path)
