"""ROS by CycloneDDS for Python: names, types and services as `rmw_cyclonedds` puts them on the wire."""

import dataclasses
import random
import sys
import time
import types
from pathlib import Path
from typing import Any, get_type_hints

sys.path.insert(0, str(Path(__file__).parent.parent / "peers"))
import loopback  # noqa: E402, F401  (before cyclonedds)

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import final  # noqa: E402
from cyclonedds.idl.types import array, int64, uint64  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402

import ros_idl  # noqa: E402
from adapter import DEPTH, PATIENCE_SECONDS, Publisher, Ros, Subscription, plain  # noqa: E402

POLL_SECONDS = 0.005
# How long a publisher waits for a slow reader.
BLOCKING = duration(seconds=1)
RELIABILITY = {
    "reliable": Policy.Reliability.Reliable(BLOCKING),
    "best_effort": Policy.Reliability.BestEffort,
}
DURABILITY = {
    "volatile": Policy.Durability.Volatile,
    "transient_local": Policy.Durability.TransientLocal,
}


def connect(domain: int) -> Ros:
    return CycloneRos(domain)


def types_by_ros_name() -> dict[str, type]:
    """`pkg::msg::dds_::Type_` as `pkg/msg/Type`, of everything in `ros_idl`."""
    found = {}
    for kind in vars(ros_idl).values():
        if isinstance(kind, type) and issubclass(kind, IdlStruct) and kind is not IdlStruct:
            name = kind.__idl_typename__
            found[name.replace("::dds_", "").replace("::", "/").removesuffix("_")] = kind
    return found


TYPES = types_by_ros_name()


def with_header(kind: type) -> type:
    """A service's message as `rmw_cyclonedds` sends it: behind half the client's GUID and a number."""
    fields = {"client": uint64, "number": int64, **get_type_hints(kind, include_extras=True)}
    made = types.new_class(
        kind.__name__,
        (IdlStruct,),
        {"typename": kind.__idl_typename__},
        lambda body: body.update(__annotations__=fields, __module__=__name__),
    )
    return final(dataclasses.dataclass(made))


def fields_of(value: Any) -> list[str] | None:
    if not isinstance(value, IdlStruct):
        return None
    return [field.name for field in dataclasses.fields(value)]


def filled(hint: Any, value: Any = None) -> Any:
    """A value of an IDL type from plain ones; what is not given is zero or empty."""
    if isinstance(hint, type) and issubclass(hint, IdlStruct):
        given = dict(value or {})
        hints = get_type_hints(hint, include_extras=True)
        made = hint(**{name: filled(hints[name], given.pop(name, None)) for name in hints})
        assert not given, f"{hint.__name__} has no {list(given)}"
        return made
    if hint in (str, bool):
        return hint() if value is None else value
    for annotation in getattr(hint, "__metadata__", ()):
        kind = type(annotation).__name__
        if kind == "sequence" and isinstance(value, (bytes, bytearray)):
            return value
        if kind == "sequence":
            return [filled(annotation.subtype, item) for item in value or []]
        if isinstance(annotation, array):
            items = value or [None] * annotation.length
            return [filled(annotation.subtype, item) for item in items]
    return 0 if value is None else value


def qos(reliability: str, durability: str, depth: int) -> Qos:
    return Qos(RELIABILITY[reliability], DURABILITY[durability], Policy.History.KeepLast(depth))


class CycloneSubscription(Subscription):
    def __init__(self, participant, dds_name: str, kind: type, qos: Qos):
        super().__init__()
        self.reader = DataReader(participant, Topic(participant, dds_name, kind), qos=qos)

    def matched(self) -> int:
        return len(self.reader.get_matched_publications())

    def take(self) -> None:
        for message in self.reader.take(N=DEPTH):
            if message.sample_info.valid_data:
                self.messages.append(plain(message, fields_of))


class CyclonePublisher(Publisher):
    def __init__(self, participant, dds_name: str, kind: type, qos: Qos):
        self.kind = kind
        self.writer = DataWriter(participant, Topic(participant, dds_name, kind), qos=qos)

    def matched(self) -> int:
        return len(self.writer.get_matched_subscriptions())

    def publish(self, fields: dict) -> None:
        self.writer.write(filled(self.kind, fields))


class Client:
    """Calls one service."""

    def __init__(self, ros: "CycloneRos", service: str, type_name: str):
        request, response = (with_header(TYPES[f"{type_name}_{end}"]) for end in ("Request", "Response"))
        profile = qos("reliable", "volatile", 10)
        self.ros = ros
        self.service = service
        self.replies = CycloneSubscription(ros.participant, f"rr{service}Reply", response, profile)
        self.requests = CyclonePublisher(ros.participant, f"rq{service}Request", request, profile)
        self.me = random.getrandbits(63)
        self.number = 0

    def call(self, request: dict) -> Any:
        found = self.ros.wait(lambda: self.replies.matched() and self.requests.matched(), PATIENCE_SECONDS)
        assert found, f"nobody offers {self.service}"
        self.number += 1
        self.requests.publish({"client": self.me, "number": self.number, **request})
        answered = self.ros.wait(self.answer, PATIENCE_SECONDS)
        assert answered, f"no answer from {self.service}"
        return self.answer()

    def answer(self) -> Any:
        self.replies.take()
        mine = (reply for reply in self.replies.messages if reply.client == self.me)
        return next((reply for reply in mine if reply.number == self.number), None)


class CycloneRos(Ros):
    def __init__(self, domain: int):
        self.participant = DomainParticipant(domain)
        self.subscriptions: list[CycloneSubscription] = []
        self.clients: dict[str, Client] = {}
        self.graph = self.subscription(
            "ros_discovery_info",
            "rmw_dds_common/msg/ParticipantEntitiesInfo",
            qos("reliable", "transient_local", 1),
        )

    def subscription(self, dds_name: str, type_name: str, profile: Qos) -> CycloneSubscription:
        made = CycloneSubscription(self.participant, dds_name, TYPES[type_name], profile)
        self.subscriptions.append(made)
        return made

    def subscribe(self, topic, type_name, reliability="reliable", durability="volatile", depth=DEPTH):
        return self.subscription(f"rt{topic}", type_name, qos(reliability, durability, depth))

    def publisher(self, topic, type_name, reliability="reliable", durability="volatile", depth=10):
        profile = qos(reliability, durability, depth)
        return CyclonePublisher(self.participant, f"rt{topic}", TYPES[type_name], profile)

    def call(self, service, type_name, request):
        if service not in self.clients:
            self.clients[service] = Client(self, service, type_name)
        return self.clients[service].call(request)

    def node_names(self):
        nodes = [node for told in self.graph.messages for node in told.node_entities_info_seq]
        return {f"{node.node_namespace.rstrip('/')}/{node.node_name}" for node in nodes}

    def poll(self):
        for subscription in self.subscriptions:
            subscription.take()
        time.sleep(POLL_SECONDS)

    def close(self):
        self.subscriptions.clear()
        self.clients.clear()
        self.graph = None
        self.participant = None
