#!/usr/bin/env python3
"""Says which ROS 2 nodes a participant announces, as `ros2 node list` finds them, over CycloneDDS on loopback only.

usage: cyclone_nodes.py --domain N --gid-length 16|24 --node /NAMESPACE/NAME [--seconds S]

Nodes are announced on `ros_discovery_info`, where ids have 24 bytes until Humble and 16 from Iron on. Waits for the node
and prints one JSON object: {"node": ..., "readers": R, "writers": W}, or ends non-zero when it does not come in time.
"""

import argparse
import json
import sys
import time

import loopback  # noqa: F401

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

import ros_idl

POLL_SECONDS = 0.02


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--gid-length", type=int, required=True)
    parser.add_argument("--node", required=True)
    parser.add_argument("--seconds", type=float, default=20.0)
    args = parser.parse_args()

    participant = DomainParticipant(args.domain)
    topic = Topic(participant, "ros_discovery_info", ros_idl.participant_entities_info(args.gid_length))
    qos = Qos(
        Policy.Reliability.Reliable(duration(seconds=1)),
        Policy.History.KeepLast(1),
        Policy.Durability.TransientLocal,
    )
    reader = DataReader(participant, topic, qos=qos)
    deadline = time.monotonic() + args.seconds
    while time.monotonic() < deadline:
        for message in reader.take(N=100):
            for node in getattr(message, "node_entities_info_seq", []):
                name = f"{node.node_namespace.rstrip('/')}/{node.node_name}"
                writers = len(node.writer_gid_seq)
                if name == args.node and writers > 1:
                    found = {"node": name, "readers": len(node.reader_gid_seq), "writers": writers}
                    print(json.dumps(found))
                    return
        time.sleep(POLL_SECONDS)
    sys.exit("not announced")


if __name__ == "__main__":
    main()
