"""ROS by rclpy."""

import array
import importlib
import os
import re
from typing import Any

# Before rclpy is imported: the daemon under test and this node share loopback only.
os.environ["ROS_LOCALHOST_ONLY"] = "1"

import rclpy  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy  # noqa: E402

from adapter import DEPTH, PATIENCE_SECONDS, Publisher, Ros, Subscription, plain  # noqa: E402

POLL_SECONDS = 0.005
NAME = "roadwatch_harness"


def connect(domain: int) -> Ros:
    return RclpyRos(domain)


def kind_of(type_name: str) -> Any:
    """The class of `pkg/msg/Type` or `pkg/srv/Type`."""
    package, module, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{module}"), name)


def filled(kind: Any, fields: dict) -> Any:
    """A message of plain values."""
    message = kind()
    types = kind.get_fields_and_field_types()
    for name, value in fields.items():
        if isinstance(value, dict):
            value = filled(type(getattr(message, name)), value)
        elif isinstance(value, bytes):
            value = array.array("B", value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            package, element = re.search(r"(\w+)/(\w+)", types[name]).groups()
            value = [filled(kind_of(f"{package}/msg/{element}"), item) for item in value]
        setattr(message, name, value)
    return message


def fields_of(value: Any) -> list[str] | None:
    if not hasattr(value, "get_fields_and_field_types"):
        return None
    return list(value.get_fields_and_field_types())


def qos(reliability: str, durability: str, depth: int) -> QoSProfile:
    return QoSProfile(
        reliability=ReliabilityPolicy[reliability.upper()],
        durability=DurabilityPolicy[durability.upper()],
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
    )


class RclpySubscription(Subscription):
    def __init__(self, node, topic: str, type_name: str, profile: QoSProfile):
        super().__init__()
        self.inner = node.create_subscription(kind_of(type_name), topic, self.take, profile)

    def take(self, message: Any) -> None:
        self.messages.append(plain(message, fields_of))

    def matched(self) -> int:
        return self.inner.get_publisher_count()


class RclpyPublisher(Publisher):
    def __init__(self, node, topic: str, type_name: str, profile: QoSProfile):
        self.kind = kind_of(type_name)
        self.inner = node.create_publisher(self.kind, topic, profile)

    def matched(self) -> int:
        return self.inner.get_subscription_count()

    def publish(self, fields: dict) -> None:
        self.inner.publish(filled(self.kind, fields))


class RclpyRos(Ros):
    def __init__(self, domain: int):
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node(
            NAME, context=self.context, enable_rosout=False, start_parameter_services=False
        )
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.clients: dict[str, Any] = {}

    def subscribe(self, topic, type_name, reliability="reliable", durability="volatile", depth=DEPTH):
        return RclpySubscription(self.node, topic, type_name, qos(reliability, durability, depth))

    def publisher(self, topic, type_name, reliability="reliable", durability="volatile", depth=10):
        return RclpyPublisher(self.node, topic, type_name, qos(reliability, durability, depth))

    def call(self, service, type_name, request):
        kind = kind_of(type_name)
        if service not in self.clients:
            self.clients[service] = self.node.create_client(kind, service)
        client = self.clients[service]
        assert self.wait(client.service_is_ready, PATIENCE_SECONDS), f"nobody offers {service}"
        future = client.call_async(filled(kind.Request, request))
        assert self.wait(future.done, PATIENCE_SECONDS), f"no answer from {service}"
        return plain(future.result(), fields_of)

    def node_names(self):
        nodes = self.node.get_node_names_and_namespaces()
        return {f"{namespace.rstrip('/')}/{name}" for name, namespace in nodes if name != NAME}

    def poll(self):
        self.executor.spin_once(timeout_sec=POLL_SECONDS)

    def close(self):
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)
