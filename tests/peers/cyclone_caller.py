#!/usr/bin/env python3
"""Calls a running node's list_parameters over CycloneDDS, as rmw_cyclonedds does, on loopback only.

usage: cyclone_caller.py --domain N [--calls K] [--seconds S]

Cyclone's clients put half their GUID and a number in front of each request, and look for both in front of the
answers. Prints one JSON object: {"answered": K, "foreign": F, "names": [...]}, where `foreign` counts answers to others.
"""

import argparse
import json
import random
import sys
import time
from dataclasses import dataclass

import loopback  # noqa: F401

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import int64, sequence, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

SERVICE = "roadwatch/list_parameters"
POLL_SECONDS = 0.002


@dataclass
@final
class Request(IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Request_"):
    guid: uint64
    number: int64
    prefixes: sequence[str]
    depth: uint64


@dataclass
@final
class Reply(IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Response_"):
    guid: uint64
    number: int64
    names: sequence[str]
    prefixes: sequence[str]


def wait(reached, deadline):
    while not reached():
        if time.monotonic() > deadline:
            sys.exit("not in time")
        time.sleep(POLL_SECONDS)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--calls", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=20.0)
    args = parser.parse_args()

    deadline = time.monotonic() + args.seconds
    qos = Qos(
        Policy.Reliability.Reliable(duration(seconds=1)),
        Policy.History.KeepLast(10),
        Policy.Durability.Volatile,
    )
    participant = DomainParticipant(args.domain)
    asking = DataWriter(participant, Topic(participant, f"rq/{SERVICE}Request", Request), qos=qos)
    answers = DataReader(participant, Topic(participant, f"rr/{SERVICE}Reply", Reply), qos=qos)
    wait(lambda: asking.get_matched_subscriptions() and answers.get_matched_publications(), deadline)

    guid = random.getrandbits(63)
    answered, foreign, names = 0, 0, []
    for number in range(1, args.calls + 1):
        asking.write(Request(guid, number, [], 0))
        while answered < number:
            if time.monotonic() > deadline:
                sys.exit(f"no answer to call {number}")
            for answer in answers.take(N=100):
                if getattr(answer, "guid", None) == guid and answer.number == number:
                    answered, names = number, list(answer.names)
                else:
                    foreign += 1
            time.sleep(POLL_SECONDS)
    print(json.dumps({"answered": answered, "foreign": foreign, "names": names}))


if __name__ == "__main__":
    main()
