"""Image topics as cameras: what is published carries the images' stamps, and bad images hold up nobody."""

import itertools
import tomllib

import pytest

from daemon import ROOT
from images import SECOND, clip, compressed, raw
from messages import DELETEALL, OBJECTS, PER_CAMERA, nanos, stamps

DETECTIONS = PER_CAMERA["detections_2d"]
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
# The rig's cameras; those without traffic before them serve for bad images.
TOPICS = {
    "front": "/sensors/front/image_raw",
    "back": "/sensors/back/image_raw/compressed",
    "left": "/sensors/left/image_raw",
    "right": "/sensors/right/image_raw",
}
# One camera has a CameraInfo beside its images.
INFO_CAMERA, INFO = "left", "/sensors/left/camera_info"
# Longer than one image takes on a slow machine.
ANSWER_SECONDS = 5
# Warnings of one kind are said once in five seconds.
WARNING_SECONDS = 8
# A frame's time to the nanosecond, as no clip has it.
PERIOD_NS = 83_333_337
WARN = 30
# Of diagnostics.
STALE = 3


def rig_tables() -> str:
    rig = tomllib.loads((ROOT / "demo/rig.toml").read_text())
    tables = []
    for camera in rig["camera"]:
        if camera["name"] in TOPICS:
            keys = {**camera, "topic": TOPICS[camera["name"]]}
            if camera["name"] == INFO_CAMERA:
                keys["camera_info_topic"] = INFO
            lines = [f"{key} = {value!r}" for key, value in keys.items()]
            tables.append("\n".join(["[[camera]]", *lines]))
    return "\n\n".join(tables)


@pytest.fixture(scope="module")
def daemon(start, tmp_path_factory):
    config = tmp_path_factory.mktemp("inputs") / "inputs.toml"
    detector = f"""
[detector]
model = "{ROOT}/models/roadwatch_detector.onnx"
family = "yolov8"
score_threshold = 0.50
exclusive_classes = ["car", "bus", "truck"]

[locate]
method = "fused"
size_statistic = "average"

[ego]
odometry = "/odometry"

"""
    config.write_text(detector + rig_tables())
    return start(config=config)


class Camera:
    """A driver that publishes one image, and what the daemon makes of it."""

    clock = itertools.count(1_800_000_000 * SECOND + 123_456_789, PERIOD_NS)

    def __init__(self, node, name: str):
        self.node = node
        self.name = name
        self.kind = COMPRESSED if TOPICS[name].endswith("/compressed") else IMAGE
        self.publisher = node.publisher(TOPICS[name], self.kind)
        self.objects = node.subscribe(f"/roadwatch/{name}/objects", OBJECTS)
        self.detections = node.subscribe(f"/roadwatch/{name}/detections_2d", DETECTIONS)
        outputs = [self.objects, self.detections]
        assert node.wait(lambda: self.publisher.matched() == 1, 15), "the daemon does not listen"
        assert node.wait(lambda: all(output.matched() == 1 for output in outputs), 15)

    def stamp(self) -> int:
        return next(self.clock)

    def message(self, frame, stamp: int, **options) -> dict:
        if self.kind == COMPRESSED:
            return compressed(self.name, frame, stamp)
        return raw(self.name, frame, stamp, **options)

    def is_answered(self, stamp: int, seconds: float = ANSWER_SECONDS) -> bool:
        """Whether outputs of that stamp came."""
        outputs = [self.objects, self.detections]
        return self.node.wait(lambda: all(stamp in stamps(output) for output in outputs), seconds)

    def show(self, frame, **options) -> int:
        """Publishes one good image, and gives its stamp once its outputs are there."""
        stamp = self.stamp()
        self.publisher.publish(self.message(frame, stamp, **options))
        assert self.is_answered(stamp), f"nothing came of an image of {self.name}"
        return stamp

    def boxes(self, stamp: int) -> list[tuple]:
        """What was detected in the image of that stamp."""
        found = [one for one in self.detections.messages if nanos(one.header.stamp) == stamp]
        (message,) = found
        return [
            (one.results[0].hypothesis.class_id, one.bbox.center.position.x, one.bbox.center.position.y)
            for one in message.detections
        ]


@pytest.fixture(scope="module")
def cameras(node, daemon):
    """Every camera has shown one image, so the daemon has its publisher."""
    made = {name: Camera(node, name) for name in TOPICS}
    for name, camera in made.items():
        # A volatile writer owes nothing to a reader that it has just met.
        frame = clip(name, 1)[0]

        def shown():
            stamp = camera.stamp()
            camera.publisher.publish(camera.message(frame, stamp))
            return camera.is_answered(stamp, 1)

        assert node.wait(shown, 15), f"nothing comes of images of {name}"
    return made


@pytest.fixture(scope="module")
def rosout(node):
    return node.subscribe("/rosout", "rcl_interfaces/msg/Log", durability="transient_local")


@pytest.mark.parametrize("name", ["front", "back"])
def test_outputs_carry_exactly_the_stamps_of_the_images(cameras, name):
    camera = cameras[name]
    before = len(camera.objects.messages)
    shown = [camera.show(frame) for frame in clip(name, 5, every=5)]
    assert stamps(camera.objects)[before:] == shown
    assert stamps(camera.detections)[-len(shown) :] == shown
    assert sum(len(message.objects) for message in camera.objects.messages[before:]) >= len(shown)


def odometry(stamp: int, x_m: float, child: str = "base_link") -> dict:
    position = {"x": x_m, "y": 0.0, "z": 0.0}
    pose = {"position": position, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
    return {
        "header": {"stamp": {"sec": stamp // SECOND, "nanosec": stamp % SECOND}, "frame_id": "odom"},
        "child_frame_id": child,
        "pose": {"pose": pose, "covariance": [0.01] * 36},
    }


def test_odometry_tells_where_the_vehicle_is(node, cameras):
    camera = cameras["front"]
    known = [message.ego_motion for message in camera.objects.messages]
    assert known and set(known) == {"none"}, "nobody has told yet"
    publisher = node.publisher("/odometry", "nav_msgs/msg/Odometry")
    assert node.wait(lambda: publisher.matched() == 1, 15), "the daemon does not listen"
    frame = clip("front", 1)[0]

    def is_measured():
        stamp = camera.stamp()
        # Around the capture; one of another frame of the vehicle says nothing.
        publisher.publish(odometry(stamp - 10_000_000, 1.0))
        publisher.publish(odometry(stamp - 5_000_000, 900.0, child="trailer"))
        publisher.publish(odometry(stamp + 10_000_000, 1.1))
        camera.publisher.publish(camera.message(frame, stamp))
        camera.is_answered(stamp, 2)
        found = [one for one in camera.objects.messages if nanos(one.header.stamp) == stamp]
        return bool(found) and found[0].ego_motion == "measured"

    assert node.wait(is_measured, 20)
    seen = [one for message in camera.objects.messages for one in message.objects]
    assert all(one.motion_known and one.state in ("tentative", "confirmed") for one in seen)


@pytest.mark.parametrize("name", ["front", "back"])
def test_the_same_images_give_the_same_boxes(cameras, name):
    camera = cameras[name]
    frames = clip(name, 5, every=5)
    first, second = ([camera.boxes(camera.show(frame)) for frame in frames] for _ in range(2))
    assert any(first)
    assert first == second


def test_encodings_of_the_same_pixels_give_the_same_boxes(cameras):
    camera, frame = cameras["front"], clip("front", 1)[0]
    expected = camera.boxes(camera.show(frame, encoding="bgr8"))
    assert expected
    assert camera.boxes(camera.show(frame, encoding="rgb8")) == expected
    assert camera.boxes(camera.show(frame, encoding="bgr8", padding=64)) == expected


def test_grey_images_are_looked_at(cameras):
    camera, frame = cameras["front"], clip("front", 1)[0]
    assert camera.boxes(camera.show(frame, encoding="mono8"))


def warned(rosout, *words) -> list:
    return [log for log in rosout.messages if log.level == WARN and all(word in log.msg for word in words)]


def assert_refused(daemon, camera, rosout, spoil, *words):
    """Bad images give no outputs and a warning, and the camera goes on with the next good one.

    `spoil` gets a camera, a good message and its stamp, publishes what is bad, and gives the stamp of that.
    """
    node, frame = camera.node, clip(camera.name, 1)[0]
    before = len(warned(rosout, *words))
    good, bad = [camera.show(frame)], []

    def is_warned():
        stamp = camera.stamp()
        bad.append(spoil(camera, camera.message(frame, stamp), good))
        good.append(camera.show(frame))
        return len(warned(rosout, *words)) > before

    assert node.wait(is_warned, WARNING_SECONDS), f"no warning with {words}"
    came = stamps(camera.objects)
    assert [came.count(stamp) for stamp in good] == [1] * len(good)
    assert not (set(bad) - set(good)) & set(came)
    assert daemon.is_running()
    assert daemon.said("WARN", *words)


def changed(**fields):
    """Another value in the place of a good one."""

    def spoil(camera, message, _):
        camera.publisher.publish({**message, **fields})
        return in_nanos(message)

    return spoil


def in_nanos(message: dict) -> int:
    stamp = message["header"]["stamp"]
    return stamp["sec"] * SECOND + stamp["nanosec"]


def restamped(camera, message, stamp: int) -> int:
    header = {**message["header"], "stamp": {"sec": stamp // SECOND, "nanosec": stamp % SECOND}}
    camera.publisher.publish({**message, "header": header})
    return stamp


@pytest.mark.parametrize(
    ("name", "fields", "word"),
    [
        ("left", {"step": 960}, "step"),
        ("left", {"encoding": "rgb565"}, "rgb565"),
        ("left", {"width": 480}, "480"),
        ("left", {"data": bytes(1000)}, "1000 bytes"),
        ("back", {"data": b"no picture"}, "/sensors/back/image_raw/compressed"),
    ],
    ids=["step", "encoding", "size", "length", "jpeg"],
)
def test_an_image_that_cannot_be_read_is_left_out(daemon, cameras, rosout, name, fields, word):
    assert_refused(daemon, cameras[name], rosout, changed(**fields), word)


def test_a_stamp_that_stands_still_is_left_out(daemon, cameras, rosout):
    def spoil(camera, message, good):
        return restamped(camera, message, good[-1])

    assert_refused(daemon, cameras["front"], rosout, spoil, "stands still")


def test_a_stamp_that_jumps_back_is_left_out(daemon, cameras, rosout):
    def spoil(camera, message, good):
        return restamped(camera, message, good[-1] - 1_000_000)

    assert_refused(daemon, cameras["left"], rosout, spoil, "jumps back")


def test_a_second_publisher_is_left_out(daemon, cameras, rosout, node):
    right = cameras["right"]
    second = node.publisher(TOPICS["right"], IMAGE)
    assert node.wait(lambda: second.matched() == 1, 10)

    def spoil(camera, message, _):
        second.publish(message)
        return in_nanos(message)

    assert_refused(daemon, right, rosout, spoil, "two publishers", TOPICS["right"])


def camera_info(name: str, focal_share: float = 1.0) -> dict:
    """What the rig says of a camera, with another focal length if need be."""
    rig = tomllib.loads((ROOT / "demo/rig.toml").read_text())
    (camera,) = [one for one in rig["camera"] if one["name"] == name]
    fx, fy = (camera[key] * focal_share for key in ("fx", "fy"))
    return {
        "header": {"frame_id": f"{name}_optical_frame"},
        "height": camera["height"],
        "width": camera["width"],
        "distortion_model": "plumb_bob",
        "k": [fx, 0.0, camera["cx"], 0.0, fy, camera["cy"], 0.0, 0.0, 1.0],
    }


def test_nothing_is_made_of_images_while_their_camera_info_contradicts_the_rig(cameras, rosout, node):
    camera, frame = cameras[INFO_CAMERA], clip(INFO_CAMERA, 1)[0]
    infos = node.publisher(INFO, "sensor_msgs/msg/CameraInfo")
    assert node.wait(lambda: infos.matched() == 1, 10)

    def refused():
        infos.publish(camera_info(INFO_CAMERA, 1.1))
        stamp = camera.stamp()
        camera.publisher.publish(camera.message(frame, stamp))
        return not camera.is_answered(stamp, 0.5) and warned(rosout, INFO, "contradicts the rig", "fx is")

    assert node.wait(refused, WARNING_SECONDS)

    def answered():
        infos.publish(camera_info(INFO_CAMERA))
        stamp = camera.stamp()
        camera.publisher.publish(camera.message(frame, stamp))
        return camera.is_answered(stamp, 0.5)

    assert node.wait(answered, 10), "the rig's own calibration is refused"


def test_a_camera_that_falls_silent_is_stale_and_its_markers_are_taken_away(cameras, node):
    camera, frame = cameras["right"], clip("right", 1)[0]
    markers = node.subscribe("/roadwatch/right/markers", PER_CAMERA["markers"])
    diagnostics = node.subscribe("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    assert node.wait(lambda: markers.matched() == 1 and diagnostics.matched() == 1, 10)
    camera.show(frame)

    def stale():
        statuses = [one for array in diagnostics.messages[-1:] for one in array.status]
        return any(one.name == "roadwatch: camera right" and one.level == STALE for one in statuses)

    assert node.wait(stale, 6)

    def taken_away():
        """The last word is of no image."""
        last = markers.messages[-1]
        of_an_image = nanos(last.markers[0].header.stamp) in stamps(camera.objects)
        return not of_an_image and [marker.action for marker in last.markers] == [DELETEALL]

    assert node.wait(taken_away, 2)
    # And it is well again with the next image.
    camera.show(frame)
    assert node.wait(lambda: not stale(), 6)
