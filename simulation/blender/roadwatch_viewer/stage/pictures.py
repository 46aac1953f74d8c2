"""Stills and clips of a replay, with the cameras' images under them where there are any."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import bpy

from ..dataset import CameraImages
from ..errors import ViewerError, make_folder_of
from ..reading import Recording
from ..replay import FIRST_FRAME, set_time
from ..settings import Settings
from .editing import edit
from .images import lay_over, show_behind
from .render import prepare, render_still, show_view, silence
from .viewer import Viewer

NS = 1e-9
Report = Callable[[int, int], None]


@dataclass
class Photographer:
    """Takes pictures of a replay that is in Blender already."""

    scene: bpy.types.Scene
    viewer: Viewer
    recording: Recording
    settings: Settings
    images: Mapping[str, CameraImages] = field(default_factory=dict)

    def __post_init__(self) -> None:
        prepare(self.scene, self.settings)
        frames = range(self.scene.frame_start, self.scene.frame_end + 1)
        stamps = {frame: self._stamp_ns((frame - FIRST_FRAME) / self.settings.fps) for frame in frames}
        for name, images in self.images.items():
            if name in self.viewer.vehicle.cameras:
                show_behind(self.viewer.vehicle.cameras[name], images, stamps)

    def still(self, view: str, since_s: float, path: Path, size_px: tuple[int, int] | None = None) -> None:
        """A PNG of a view at a time since the first scene; in its own size unless one is given."""
        self._check_time(since_s)
        has_image = self._set_view(view)
        if size_px is not None:
            self.scene.render.resolution_x, self.scene.render.resolution_y = size_px
        self._take(view, since_s, path, has_image)

    def clip(self, view: str, from_s: float, seconds: float, path: Path, report: Report) -> None:
        """An H.264 clip of a view; `report` hears how many frames are done, of how many."""
        self._check_time(from_s)
        has_image = self._set_view(view)
        fps = self.settings.fps
        count = max(round(min(seconds, self.recording.seconds - from_s) * fps), 1)
        with tempfile.TemporaryDirectory(prefix="roadwatch_viewer_") as folder:
            paths = [Path(folder) / f"{number:06d}.png" for number in range(count)]
            for number, each in enumerate(paths):
                self._take(view, from_s + number / fps, each, has_image)
                report(number + 1, count)
            render = self.scene.render
            encode(paths, path, fps, (render.resolution_x, render.resolution_y))

    def image_time_s(self, camera: str, since_s: float) -> float:
        """When the camera's image nearest to a time was captured, both since the first scene."""
        self._check_time(since_s)
        captured_ns = self.images[camera].nearest_stamp_ns(self._stamp_ns(since_s))
        captured_s = (captured_ns - self.recording.scenes[0].stamp_ns) * NS
        return min(max(captured_s, 0.0), self.recording.seconds)

    def _take(self, view: str, since_s: float, path: Path, has_image: bool) -> None:
        set_time(self.scene, since_s, self.settings.fps)
        render_still(self.scene, path)
        if has_image:
            images = self.images[view]
            lay_over(path, images, images.nearest(self._stamp_ns(since_s)))

    def _set_view(self, view: str) -> bool:
        """Through a camera with images, only boxes and arrows are drawn: whether it is one."""
        show_view(self.scene, self.viewer.vehicle, view)
        has_image = view in self.images
        self.scene.render.film_transparent = has_image
        self.viewer.show_only_marks(has_image)
        return has_image

    def _stamp_ns(self, since_s: float) -> int:
        return self.recording.scenes[0].stamp_ns + round(since_s / NS)

    def _check_time(self, since_s: float) -> None:
        if not 0.0 <= since_s <= self.recording.seconds:
            raise ViewerError(
                f"no scene at {since_s:g} s: the recording goes from 0 to {self.recording.seconds:.3f} s"
            )


def encode(paths: list[Path], clip: Path, fps: int, size_px: tuple[int, int]) -> None:
    """Makes an MP4 of pictures, with Blender's own encoder."""
    make_folder_of(clip)
    with edit("Roadwatch clip", size_px) as (scene, strips):
        strip = strips.new_image("pictures", str(paths[0]), channel=1, frame_start=1)
        for path in paths[1:]:
            strip.elements.append(path.name)
        scene.frame_start, scene.frame_end = 1, len(paths)
        render = scene.render
        render.fps, render.fps_base = fps, 1.0
        if hasattr(render.image_settings, "media_type"):
            # Since Blender 5 formats are sorted by what they are for.
            render.image_settings.media_type = "VIDEO"
        render.image_settings.file_format = "FFMPEG"
        render.ffmpeg.format, render.ffmpeg.codec = "MPEG4", "H264"
        render.ffmpeg.constant_rate_factor = "HIGH"
        render.filepath = str(clip.resolve())
        with silence():
            bpy.ops.render.render(animation=True, scene=scene.name)
    if not clip.is_file():
        raise ViewerError(f"Blender wrote no clip to {clip}: is its name one that ends with .mp4?")
