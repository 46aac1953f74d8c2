#!/usr/bin/env python3
"""Reads a recorded bag with two independent readers and says what they found.

usage: read_bag.py FOLDER

Every message is decoded with the schemas inside the bag, once by `rosbags` and once by `mcap` with
`mcap-ros2-support`. Prints one JSON object:

    {"rosbags": {TOPIC: {"type", "count", "stamps", "frames", "objects", "offered_qos"}},
     "mcap": {TOPIC: {"type", "count", "stamps", "frames", "objects"}},
     "agree": BOOL, "duration_ns": N, "start_ns": N, "message_count": N}

`stamps` are header stamps as "sec.nanosec" with nine digits, `frames` the distinct frame ids of the
headers, `objects` the number of objects per message. Ends non-zero when a reader fails.
"""

import json
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

# The field of each message type that lists its objects.
LISTS = ("objects", "detections", "markers", "transforms")


def stamp_text(stamp):
    return f"{stamp.sec}.{stamp.nanosec:09d}"


def header_of(message):
    """The header of a message; a list of transforms has its headers inside."""
    if hasattr(message, "header"):
        return message.header
    first = next((getattr(message, name) for name in LISTS if hasattr(message, name)), None)
    return first[0].header if first is not None and len(first) else None


class Tally:
    """What was read from one topic."""

    def __init__(self, ros_type):
        self.ros_type = ros_type
        self.stamps = []
        self.frames = set()
        self.objects = []

    def add(self, message):
        header = header_of(message)
        if header is not None:
            self.stamps.append(stamp_text(header.stamp))
            self.frames.add(header.frame_id)
        listed = [len(getattr(message, name)) for name in LISTS if hasattr(message, name)]
        self.objects.append(listed[0] if listed else 0)

    def as_dict(self):
        return {
            "type": self.ros_type,
            "count": len(self.objects),
            "stamps": self.stamps,
            "frames": sorted(self.frames),
            "objects": self.objects,
        }


def read_with_rosbags(folder):
    """Topics as `rosbags` reads them, and the bag's own numbers."""
    # The store starts empty, so that only the schemas of the bag are used.
    store = get_typestore(Stores.EMPTY)
    with Reader(folder) as reader:
        for connection in reader.connections:
            types = get_types_from_msg(connection.msgdef.data, connection.msgtype)
            store.register({name: type_ for name, type_ in types.items() if name not in store.types})
        tallies = {c.topic: Tally(c.msgtype) for c in reader.connections}
        for connection, _, raw in reader.messages():
            message = store.deserialize_cdr(raw, connection.msgtype)
            tallies[connection.topic].add(message)
            # Written again by somebody else, the message must be the same bytes; the end may be padded.
            again = bytes(store.serialize_cdr(message, connection.msgtype))
            if again.rstrip(b"\0") != bytes(raw).rstrip(b"\0"):
                sys.exit(f"{connection.topic}: other bytes than an independent writer's")
        found = {topic: tally.as_dict() for topic, tally in tallies.items()}
        for connection in reader.connections:
            qos = connection.ext.offered_qos_profiles[0]
            found[connection.topic]["offered_qos"] = {
                "durability": qos.durability.name.lower(),
                "reliability": qos.reliability.name.lower(),
                "depth": qos.depth,
            }
        numbers = {
            "start_ns": reader.start_time,
            "duration_ns": reader.duration,
            "message_count": reader.message_count,
        }
    return found, numbers


def read_with_mcap(folder):
    """Topics as `mcap` reads them."""
    tallies = {}
    for path in sorted(Path(folder).glob("*.mcap")):
        with path.open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            for schema, channel, _, message in reader.iter_decoded_messages():
                tallies.setdefault(channel.topic, Tally(schema.name)).add(message)
    return {topic: tally.as_dict() for topic, tally in tallies.items()}


def main():
    folder = Path(sys.argv[1])
    by_rosbags, numbers = read_with_rosbags(folder)
    by_mcap = read_with_mcap(folder)
    without_qos = {
        topic: {key: value for key, value in found.items() if key != "offered_qos"}
        for topic, found in by_rosbags.items()
        if found["count"]
    }
    agree = without_qos == by_mcap
    print(json.dumps({"rosbags": by_rosbags, "mcap": by_mcap, "agree": agree, **numbers}))
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
