"""What a camera saw and what the daemon made of it, at the same moment, in one picture."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import bpy

from ..errors import ViewerError, make_folder_of
from .editing import edit
from .pictures import Photographer
from .render import silence

HEIGHT_PX, GAP_PX = 450, 8
OTHER_WIDTH_PX = 800
FONT_PX = 21
CAPTION_INSET_PX = 16
FORMATS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG"}
JPEG_QUALITY = 94
PAPER = (1.0, 1.0, 1.0)
INK, INK_GROUND = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 0.55)


@dataclass(frozen=True)
class Panel:
    """A picture that is `width_px` wide and `HEIGHT_PX` high, and the words in its corner."""

    path: Path
    width_px: int
    caption: str


def side_by_side(photographer: Photographer, camera: str, view: str, since_s: float, path: Path) -> float:
    """Writes a picture: left a camera's image with boxes and arrows over it, right a view of the scene.

    Both are of the moment of that camera's image nearest to `since_s` (s since the first scene), which is
    returned.
    """
    if path.suffix.lower() not in FORMATS:
        raise ViewerError(f"{path}: the picture's name has to end with one of {', '.join(FORMATS)}")
    vehicle = photographer.viewer.vehicle
    with_images = [name for name in vehicle.cameras if name in photographer.images]
    if camera not in with_images:
        raise ViewerError(f"no images of a camera {camera!r}: there are those of {', '.join(with_images)}")
    moment_s = photographer.image_time_s(camera, since_s)
    width_px, height_px = vehicle.size_px(camera)
    camera_width_px = round(width_px * HEIGHT_PX / height_px)
    with tempfile.TemporaryDirectory(prefix="roadwatch_viewer_") as folder:
        panels = (
            Panel(Path(folder) / "camera.png", camera_width_px, f"camera {camera}, {moment_s:.1f} s"),
            Panel(Path(folder) / "scene.png", OTHER_WIDTH_PX, "the same scene in Blender"),
        )
        for panel, seen in zip(panels, (camera, view), strict=True):
            photographer.still(seen, moment_s, panel.path, (panel.width_px, HEIGHT_PX))
        _join(panels, path)
    return moment_s


def _join(panels: tuple[Panel, ...], path: Path) -> None:
    """Puts panels into one row, from left to right."""
    make_folder_of(path)
    file_format = FORMATS[path.suffix.lower()]
    width_px = sum(panel.width_px for panel in panels) + GAP_PX * (len(panels) - 1)
    with edit("Roadwatch side by side", (width_px, HEIGHT_PX)) as (scene, strips):
        paper = _new_effect(strips, "paper", "COLOR", 1)
        paper.color = PAPER
        left_px = 0
        for number, panel in enumerate(panels):
            picture = strips.new_image(
                panel.caption, str(panel.path), channel=2 + 2 * number, frame_start=1, fit_method="ORIGINAL"
            )
            picture.blend_type = "ALPHA_OVER"
            # The editor measures from the middle.
            picture.transform.offset_x = left_px + (panel.width_px - width_px) / 2.0
            caption = _new_effect(strips, panel.caption, "TEXT", 3 + 2 * number)
            place = ((left_px + CAPTION_INSET_PX) / width_px, 1.0 - CAPTION_INSET_PX / HEIGHT_PX)
            _write_caption(caption, panel.caption, place)
            left_px += panel.width_px + GAP_PX
        scene.frame_start = scene.frame_end = 1
        stored = scene.render.image_settings
        stored.file_format, stored.color_mode = file_format, "RGB"
        stored.compression, stored.quality = 100, JPEG_QUALITY
        scene.render.filepath = str(path.resolve())
        _leave_notes_out(scene.render)
        # Named as an argument, the scene would be rendered at the frame of the one in the context.
        try:
            with silence(), bpy.context.temp_override(scene=scene):
                bpy.ops.render.render(write_still=True)
        except RuntimeError as error:
            raise ViewerError(f"Blender wrote no picture to {path}: {error}") from error
    if not path.is_file():
        raise ViewerError(f"Blender wrote no picture to {path}: is the disk full, may you write there?")


def _leave_notes_out(render: bpy.types.RenderSettings) -> None:
    """Keeps the date and the time that rendering took out of the file: the same scene makes the same bytes."""
    for name in (each.identifier for each in render.bl_rna.properties):
        if name.startswith("use_stamp"):
            setattr(render, name, False)


def _write_caption(strip: bpy.types.Strip, words: str, place: tuple[float, float]) -> None:
    """Words in a box, its upper left corner at a place counted in shares of the whole picture."""
    strip.text, strip.font_size, strip.location = words, FONT_PX, place
    strip.color, strip.use_box, strip.box_color = INK, True, INK_GROUND
    strip.box_margin = 0.005
    strip.blend_type = "ALPHA_OVER"
    if hasattr(strip, "anchor_x"):
        strip.anchor_x, strip.anchor_y, strip.alignment_x = "LEFT", "TOP", "LEFT"
    else:
        strip.align_x, strip.align_y = "LEFT", "TOP"


def _new_effect(strips: bpy.types.bpy_prop_collection, name: str, kind: str, channel: int) -> bpy.types.Strip:
    """One frame long; Blender 5 counts lengths where earlier ones count ends."""
    takes_length = "length" in strips.bl_rna.functions["new_effect"].parameters
    last = {"length": 1} if takes_length else {"frame_end": 2}
    return strips.new_effect(name, kind, channel, 1, **last)
