#!/usr/bin/env python3
"""Subscribes to a running node over CycloneDDS, on loopback only, and says what arrived.

usage: cyclone_reader.py --domain N [--config-node /roadwatch] --seconds S --topics JSON [--expect N]

`--topics` is a JSON list of topic names: absolute ones as they are, others below `--config-node`
("front/objects"). The last part of a name gives its type. Prints the line "ready" once all readers
exist and the line "matched" once each has found a writer, waits until every topic has had `--expect`
messages or `--seconds` have passed, and prints one JSON line per topic:

    {"topic", "count", "stamps", "frames", "objects"}

`stamps` are header stamps as "sec.nanosec" with nine digits, `objects` the number of objects per message.
"""

import argparse
import json
import time

import loopback  # noqa: F401  (before cyclonedds)

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

import ros_idl

LISTS = ("objects", "detections", "markers", "transforms")
POLL_SECONDS = 0.01


def qos_of(name):
    """What a ROS 2 subscriber of that topic asks for."""
    latched = name == "/tf_static"
    return Qos(
        Policy.Reliability.Reliable(duration(seconds=1)),
        Policy.History.KeepLast(1000),
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
    )


class Counter:
    """One reader and what it got."""

    def __init__(self, participant, name):
        self.name = name
        kind = ros_idl.TYPES[name.rsplit("/", 1)[-1]]
        topic = Topic(participant, "rt" + name, kind)
        self.reader = DataReader(participant, topic, qos=qos_of(name))
        self.stamps = []
        self.frames = set()
        self.objects = []

    def matched(self):
        return len(self.reader.get_matched_publications()) > 0

    def take(self):
        for message in self.reader.take(N=1000):
            info = getattr(message, "sample_info", None)
            if info is not None and info.valid_data:
                self.add(message)

    def add(self, message):
        listed = [getattr(message, name) for name in LISTS if hasattr(message, name)]
        items = listed[0] if listed else []
        header = message.header if hasattr(message, "header") else None
        if header is None and len(items):
            header = items[0].header
        if header is not None:
            self.stamps.append(f"{header.stamp.sec}.{header.stamp.nanosec:09d}")
            self.frames.add(header.frame_id)
        self.objects.append(len(items))

    def as_dict(self):
        return {
            "topic": self.name,
            "count": len(self.objects),
            "stamps": self.stamps,
            "frames": sorted(self.frames),
            "objects": self.objects,
        }


def absolute(name, node):
    return name if name.startswith("/") else f"{node}/{name}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--config-node", default="/roadwatch")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--topics", type=json.loads, required=True)
    parser.add_argument("--expect", type=int, default=None)
    args = parser.parse_args()

    deadline = time.monotonic() + args.seconds
    participant = DomainParticipant(args.domain)
    counters = [Counter(participant, absolute(name, args.config_node)) for name in args.topics]
    print("ready", flush=True)
    pending = True
    while time.monotonic() < deadline:
        if pending and all(counter.matched() for counter in counters):
            pending = False
            print("matched", flush=True)
        for counter in counters:
            counter.take()
        if args.expect is not None and all(complete(counter, args.expect) for counter in counters):
            break
        time.sleep(POLL_SECONDS)
    for counter in counters:
        print(json.dumps(counter.as_dict()), flush=True)


def complete(counter, expected):
    """Whether a topic has had its messages; the latched one has a single one."""
    return len(counter.objects) >= (1 if counter.name == "/tf_static" else expected)


if __name__ == "__main__":
    main()
