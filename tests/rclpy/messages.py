"""What the daemon's messages are, and what all of them have."""

# The last part of a topic's name to its type.
PER_CAMERA = {
    "objects": "roadwatch_msgs/msg/ObjectArray",
    "detections_2d": "vision_msgs/msg/Detection2DArray",
    "detections_3d": "vision_msgs/msg/Detection3DArray",
    "markers": "visualization_msgs/msg/MarkerArray",
    "camera_info": "sensor_msgs/msg/CameraInfo",
}
PER_SCENE = {suffix: PER_CAMERA[suffix] for suffix in ["objects", "detections_3d", "markers"]}
OBJECTS = PER_CAMERA["objects"]

# visualization_msgs/Marker
CUBE = 1
DELETEALL = 3


def nanos(stamp) -> int:
    return stamp.sec * 1_000_000_000 + stamp.nanosec


def header(message):
    """A message's own, or that of the first marker, which is always there."""
    return message.markers[0].header if hasattr(message, "markers") else message.header


def stamps(subscription) -> list[int]:
    """Stamps of what has come, in nanoseconds."""
    return [nanos(header(message).stamp) for message in subscription.messages]


def by_stamp(subscription) -> dict:
    return {nanos(header(message).stamp): message for message in subscription.messages}
