"""Pictures of the scene: with Workbench, a second or two without a GPU, or Cycles, which always works."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy

from ..errors import ViewerError, make_folder_of
from ..settings import Settings
from .vehicle import Vehicle

EEVEE = "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE"
ENGINES = {"workbench": "BLENDER_WORKBENCH", "eevee": EEVEE, "cycles": "CYCLES"}
EGL_SURFACELESS = 0x31DD
"""EGL_PLATFORM_SURFACELESS_MESA: drawing without a display."""
BACKGROUND = (0.60, 0.68, 0.78)


def prepare(scene: bpy.types.Scene, settings: Settings) -> None:
    """Size, engine and look of pictures."""
    render = scene.render
    render.resolution_x, render.resolution_y = settings.width_px, settings.height_px
    render.resolution_percentage = 100
    render.engine = _engine(settings.engine)
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "Standard"
    _set_workbench(scene)
    scene.cycles.device = "CPU"
    scene.cycles.samples = settings.samples
    scene.cycles.use_denoising = True
    scene.cycles.max_bounces = 3
    if hasattr(scene, "eevee"):
        scene.eevee.taa_render_samples = settings.samples


def render_still(scene: bpy.types.Scene, path: Path) -> None:
    """Writes the scene as it is now to a PNG; with Cycles where the chosen engine cannot draw here."""
    make_folder_of(path)
    scene.render.filepath = str(path.resolve())
    try:
        _render()
    except RuntimeError as error:
        if scene.render.engine == "CYCLES":
            raise ViewerError(f"Blender cannot render: {error}") from error
        print(f"warning: {scene.render.engine} cannot draw here ({error}): using Cycles", file=sys.stderr)
        scene.render.engine = "CYCLES"
        _render()
    if not path.is_file():
        raise ViewerError(f"Blender wrote no picture to {path}: is the disk full, may you write there?")


def show_view(scene: bpy.types.Scene, vehicle: Vehicle, view: str) -> None:
    """Makes a view the scene's camera. Raises ViewerError for one that does not exist."""
    if view not in vehicle.view_names():
        raise ViewerError(f"no view {view!r}: there are {', '.join(vehicle.view_names())}")
    vehicle.look_through(view)
    for label in (each for each in scene.objects if each.type == "FONT"):
        for facing in label.constraints:
            facing.target = scene.camera


def _set_workbench(scene: bpy.types.Scene) -> None:
    shading = scene.display.shading
    shading.light, shading.color_type = "STUDIO", "MATERIAL"
    shading.studio_light = "paint.sl"
    # Shadows would take twenty seconds a picture without a GPU; dark patches under things do instead.
    shading.show_shadows = shading.show_cavity = False
    shading.show_specular_highlight = True
    shading.background_type, shading.background_color = "VIEWPORT", BACKGROUND
    scene.display.render_aa = "8"


def _engine(wanted: str) -> str:
    """Blender's name; `auto` is Workbench where there is something to draw with."""
    if wanted != "auto":
        return ENGINES[wanted]
    return ENGINES["workbench"] if _can_draw() else ENGINES["cycles"]


def _can_draw() -> bool:
    """Whether Blender will find OpenGL. Asked first, because without it Workbench ends the whole process."""
    if not bpy.app.background or not sys.platform.startswith("linux"):
        return True
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    for function in (egl.eglGetDisplay, egl.eglGetPlatformDisplay):
        function.restype = ctypes.c_void_p
    egl.eglGetDisplay.argtypes = [ctypes.c_void_p]
    egl.eglGetPlatformDisplay.argtypes = [ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p]
    egl.eglInitialize.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    displays = (egl.eglGetPlatformDisplay(EGL_SURFACELESS, None, None), egl.eglGetDisplay(None))
    return any(display and egl.eglInitialize(display, None, None) for display in displays)


def _render() -> None:
    with silence():
        bpy.ops.render.render(write_still=True)


@contextmanager
def silence() -> Iterator[None]:
    """Keeps Blender's progress, which its C++ side writes past Python's sys.stdout, off standard output."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
