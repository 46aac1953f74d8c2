"""Following from Blender's window: a timer moves scenes in, so that Blender never waits."""

from __future__ import annotations

import sys
import traceback

import bpy
from bpy.app.handlers import persistent

from ..follower import Address, Follower, State
from ..live import LiveSession
from ..settings import Settings
from ..stage.viewer import Viewer

TICK_S = 0.02
REDRAW_EVERY_TICKS = 25

_session: LiveSession | None = None
_last_words = "not following"
_ticks = 0
_said = ""


def start(scene: bpy.types.Scene, address: Address, settings: Settings) -> None:
    """Follows a daemon from now on; whoever was followed is let go."""
    global _session
    stop()
    follower = Follower(address)
    _session = LiveSession(follower, _new_viewer(scene, settings), scene.view_layers[0])
    follower.start()
    bpy.app.timers.register(_tick, first_interval=TICK_S, persistent=True)


def stop() -> None:
    """Lets the daemon go; what was drawn last stays."""
    global _session, _last_words
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    if _session is not None:
        _session.follower.stop()
        _last_words = _session.status_line()
    _session = None


def is_following() -> bool:
    return _session is not None


def set_settings(settings: Settings) -> None:
    """Thresholds hold from the next scene on."""
    if _session is not None:
        _session.viewer.set_settings(settings)


def viewer() -> Viewer | None:
    """What is drawing now, if somebody is followed."""
    return _session.viewer if _session is not None else None


def status_lines() -> list[str]:
    """For the panel: the follower's state, then counts and delays."""
    return (_session.status_line() if _session is not None else _last_words).split("; ")


def _new_viewer(scene: bpy.types.Scene, settings: Settings) -> Viewer:
    made = Viewer(scene, settings)
    made.warm_up()
    return made


def _tick() -> float | None:
    """Draws what came; Blender calls it again after the seconds that it returns."""
    global _ticks
    if _session is None:
        return None
    try:
        _session.step()
    except ReferenceError:
        # The user deleted some of what was drawn, or went to another file: draw it all anew.
        _rebuild()
    except Exception:
        traceback.print_exc()
        print("error: following stopped; what is above is a mistake of the viewer", file=sys.stderr)
        stop()
        return None
    _say()
    _ticks += 1
    if _ticks % REDRAW_EVERY_TICKS == 0:
        _redraw_panels()
    if _session.follower.status.state is State.REFUSED:
        stop()
        _redraw_panels()
        return None
    return TICK_S


def _say() -> None:
    """News of the connection, once each, on standard error."""
    global _said
    said = _session.follower.status.said
    if said != _said:
        _said = said
        print(f"roadwatch: {said}", file=sys.stderr, flush=True)


def _redraw_panels() -> None:
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in (each for each in area.regions if each.type == "UI"):
                    region.tag_redraw()


def _rebuild() -> None:
    """New objects in the present file; the daemon's first line is asked of the viewer that knew it."""
    scene = bpy.context.scene
    old = _session.viewer
    _session.viewer = _new_viewer(scene, old.settings)
    _session.view_layer = scene.view_layers[0]
    if old.vehicle.rig is not None:
        _session.viewer.set_rig(old.vehicle.rig)


@persistent
def _after_undo(*_: object) -> None:
    """Undo makes every reference to Blender's data void."""
    if _session is not None:
        _rebuild()


@persistent
def _before_load(*_: object) -> None:
    """Another file is opened: following ends with this one."""
    stop()


def _handlers() -> list[tuple[list, object]]:
    handlers = bpy.app.handlers
    return [
        (handlers.undo_post, _after_undo),
        (handlers.redo_post, _after_undo),
        (handlers.load_pre, _before_load),
    ]


def add_handlers() -> None:
    for called, handler in _handlers():
        called.append(handler)


def remove_handlers() -> None:
    for called, handler in _handlers():
        if handler in called:
            called.remove(handler)
