"""Every topic of docs/ros.md: its type, frame and stamps, and that all speak of the same things."""

import tomllib

import pytest

from daemon import CAMERAS, ROOT
from messages import CUBE, DELETEALL, PER_CAMERA, PER_SCENE, by_stamp, header, nanos, stamps

BASE_FRAME = "base_link"
# The clips begin anew within that: 110 frames at 12 Hz.
LONGER_THAN_CLIPS_NS = 9_500_000_000
RIG = {camera["name"]: camera for camera in tomllib.loads((ROOT / "demo/rig.toml").read_text())["camera"]}


@pytest.fixture(scope="module")
def heard(node):
    """Subscriptions to all topics, by camera (or "scene") and the last part of the topic's name."""
    wanted = [(camera, suffix, kind) for camera in CAMERAS for suffix, kind in PER_CAMERA.items()]
    wanted += [("scene", suffix, kind) for suffix, kind in PER_SCENE.items()]
    subscriptions = {
        (owner, suffix): node.subscribe(f"/roadwatch/{owner}/{suffix}", kind)
        for owner, suffix, kind in wanted
    }

    def has_all():
        front = stamps(subscriptions["front", "objects"])
        all_came = all(len(subscription.messages) >= 5 for subscription in subscriptions.values())
        return all_came and front[-1] - front[0] > LONGER_THAN_CLIPS_NS

    node.wait(has_all, 30)
    return subscriptions


def test_every_topic_arrives(heard):
    missing = [f"{owner}/{suffix}" for (owner, suffix), found in heard.items() if len(found.messages) < 5]
    assert not missing
    assert {found.matched() for found in heard.values()} == {1}


def test_headers_have_the_documented_frames(heard):
    for (owner, suffix), subscription in heard.items():
        optical = suffix in ("detections_2d", "camera_info")
        expected = f"{owner}_optical_frame" if optical else BASE_FRAME
        frames = {header(message).frame_id for message in subscription.messages}
        assert frames == {expected}, (owner, suffix)


def test_all_topics_of_a_camera_have_the_stamps_of_its_frames(heard):
    for owner, suffixes in [("scene", PER_SCENE), *((camera, PER_CAMERA) for camera in CAMERAS)]:
        lists = [stamps(heard[owner, suffix]) for suffix in suffixes]
        # Readers meet their writers one after the other, and the last message may be on its way.
        first, last = max(found[0] for found in lists), min(found[-1] for found in lists)
        shared = [[stamp for stamp in found if first <= stamp <= last] for found in lists]
        assert len(shared[0]) >= 4, owner
        assert all(found == shared[0] for found in shared), owner


def test_stamps_rise_also_when_clips_begin_anew(heard):
    front = stamps(heard["front", "objects"])
    assert front[-1] - front[0] > LONGER_THAN_CLIPS_NS
    for key, subscription in heard.items():
        found = stamps(subscription)
        assert all(before < after for before, after in zip(found, found[1:])), key


def test_topics_of_a_frame_speak_of_the_same_objects(heard):
    compared = 0
    for camera in CAMERAS:
        flat, solid, markers = (
            by_stamp(heard[camera, suffix]) for suffix in ["detections_2d", "detections_3d", "markers"]
        )
        for stamp, message in by_stamp(heard[camera, "objects"]).items():
            if not all(stamp in other for other in (flat, solid, markers)):
                continue
            assert message.camera == camera
            objects, boxes = message.objects, solid[stamp].detections
            assert [thing.position for thing in objects] == [box.bbox.center.position for box in boxes]
            assert [thing.class_id for thing in objects] == [
                box.results[0].hypothesis.class_id for box in boxes
            ]
            placed = [box for box in flat[stamp].detections if box.id]
            assert sorted(str(thing.track_id) for thing in objects) == sorted(box.id for box in placed)
            shapes = markers[stamp].markers
            assert shapes[0].action == DELETEALL
            assert sum(shape.type == CUBE and shape.ns.endswith("/box") for shape in shapes) == len(objects)
            compared += len(objects)
    assert compared > 20


def test_a_scene_has_each_object_once_whoever_saw_it(heard):
    seen = {camera: by_stamp(heard[camera, "objects"]) for camera in CAMERAS}
    compared = 0
    for message in heard["scene", "objects"].messages:
        assert message.camera == ""
        numbers = [thing.track_id for thing in message.objects]
        assert len(numbers) == len(set(numbers))
        for thing in message.objects:
            # All are where they are at the scene's moment, whenever they were seen.
            assert nanos(thing.header.stamp) == nanos(message.header.stamp) >= nanos(thing.seen_at)
            assert thing.predicted == (thing.state == "coasting" or thing.held)
            frames = [seen[camera].get(nanos(thing.seen_at)) for camera in thing.seen_by]
            frames = [frame for frame in frames if frame]
            if not frames or thing.predicted:
                continue
            (known,) = [one for one in frames[-1].objects if one.track_id == thing.track_id]
            assert known.uuid == thing.uuid
            assert known.box_px == thing.box_px
            compared += 1
    assert compared > 20


def test_camera_info_is_the_calibration(heard):
    for camera in CAMERAS:
        told, known = heard[camera, "camera_info"].messages[-1], RIG[camera]
        assert (told.width, told.height) == (known["width"], known["height"])
        k = [known["fx"], 0, known["cx"], 0, known["fy"], known["cy"], 0, 0, 1]
        assert told.k == pytest.approx(k)
        assert told.p == pytest.approx([*k[:3], 0, *k[3:6], 0, *k[6:], 0])


# Late: the daemon has been running since the tests above.
@pytest.mark.parametrize("joiner", ["first", "second"])
def test_a_late_joiner_gets_the_cameras_places(heard, node, joiner):
    late = node.subscribe("/tf_static", "tf2_msgs/msg/TFMessage", durability="transient_local")
    assert node.wait(lambda: late.messages, 10)
    (message,) = late.messages
    assert {one.child_frame_id for one in message.transforms} == {f"{name}_optical_frame" for name in CAMERAS}
    for one in message.transforms:
        known = RIG[one.child_frame_id.removesuffix("_optical_frame")]
        at, turned = one.transform.translation, one.transform.rotation
        assert one.header.frame_id == BASE_FRAME
        assert [at.x, at.y, at.z] == pytest.approx(known["position_m"], abs=1e-6)
        wxyz = [turned.w, turned.x, turned.y, turned.z]
        # Both signs are the same rotation.
        dot = sum(a * b for a, b in zip(wxyz, known["orientation_wxyz"]))
        assert abs(dot) == pytest.approx(1, abs=1e-6)
