"""The demo's clips as messages that camera drivers publish."""

import functools

import cv2

from daemon import ROOT

SECOND = 1_000_000_000


@functools.cache
def clip(camera: str, count: int, every: int = 1) -> list:
    """Frames of a camera's clip, as arrays of blue, green, red."""
    video = cv2.VideoCapture(str(ROOT / f"demo/{camera}.mp4"))
    frames = []
    for at in range(count * every):
        came, frame = video.read()
        assert came, f"{camera}'s clip has only {at} frames"
        if at % every == 0:
            frames.append(frame)
    return frames


def header(camera: str, stamp_ns: int) -> dict:
    stamp = {"sec": stamp_ns // SECOND, "nanosec": stamp_ns % SECOND}
    return {"stamp": stamp, "frame_id": f"{camera}_optical_frame"}


def raw(camera: str, frame, stamp_ns: int, encoding: str = "bgr8", padding: int = 0) -> dict:
    """`sensor_msgs/Image`; `padding` bytes follow each row."""
    if encoding == "rgb8":
        frame = cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)
    elif encoding == "mono8":
        frame = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
    height, width = frame.shape[:2]
    rows = [row.tobytes() + bytes(padding) for row in frame]
    return {
        "header": header(camera, stamp_ns),
        "height": height,
        "width": width,
        "encoding": encoding,
        "step": len(rows[0]),
        "data": b"".join(rows),
    }


def compressed(camera: str, frame, stamp_ns: int) -> dict:
    """`sensor_msgs/CompressedImage`."""
    _, jpeg = cv2.imencode(".jpg", frame, [cv2.IMWRITE_JPEG_QUALITY, 95])
    return {"header": header(camera, stamp_ns), "format": "jpeg", "data": jpeg.tobytes()}
