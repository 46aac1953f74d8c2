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
from dataclasses import dataclass

import loopback  # noqa: F401

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import array, sequence, uint8
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

POLL_SECONDS = 0.02


def announced(gid_length):
    """The type `rmw_dds_common/ParticipantEntitiesInfo` with ids of that length."""

    @dataclass
    @final
    class Gid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
        data: array[uint8, gid_length]

    @dataclass
    @final
    class NodeEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
        node_namespace: str
        node_name: str
        reader_gid_seq: sequence[Gid]
        writer_gid_seq: sequence[Gid]

    @dataclass
    @final
    class ParticipantEntitiesInfo(
        IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"
    ):
        gid: Gid
        node_entities_info_seq: sequence[NodeEntitiesInfo]

    return ParticipantEntitiesInfo


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--gid-length", type=int, required=True)
    parser.add_argument("--node", required=True)
    parser.add_argument("--seconds", type=float, default=20.0)
    args = parser.parse_args()

    participant = DomainParticipant(args.domain)
    topic = Topic(participant, "ros_discovery_info", announced(args.gid_length))
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
