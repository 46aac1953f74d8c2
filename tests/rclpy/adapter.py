"""What a test may ask of ROS, whichever library answers.

Received messages are plain: attributes, lists, numbers, text. Messages to be sent are dicts of the fields
that are not zero.
"""

import time
from abc import ABC, abstractmethod
from types import SimpleNamespace
from typing import Any, Callable

# Keeps everything that a test of some seconds receives.
DEPTH = 1000
# How long a caller waits for a service, and then for its answer.
PATIENCE_SECONDS = 10.0


class Subscription(ABC):
    """One reader; `messages` grows while somebody waits."""

    def __init__(self):
        self.messages: list[Any] = []

    @abstractmethod
    def matched(self) -> int:
        """How many publishers it gets messages from."""


class Publisher(ABC):
    @abstractmethod
    def publish(self, fields: dict) -> None: ...

    @abstractmethod
    def matched(self) -> int:
        """How many readers get what it publishes."""


class Ros(ABC):
    """A node of its own in one domain, on loopback."""

    @abstractmethod
    def subscribe(
        self,
        topic: str,
        type_name: str,
        reliability: str = "reliable",
        durability: str = "volatile",
        depth: int = DEPTH,
    ) -> Subscription: ...

    @abstractmethod
    def publisher(
        self,
        topic: str,
        type_name: str,
        reliability: str = "reliable",
        durability: str = "volatile",
        depth: int = 10,
    ) -> Publisher: ...

    @abstractmethod
    def call(self, service: str, type_name: str, request: dict) -> Any:
        """The answer; fails when there is none in time."""

    @abstractmethod
    def node_names(self) -> set[str]:
        """Full names of the other nodes that have been heard of."""

    @abstractmethod
    def close(self) -> None: ...

    @abstractmethod
    def poll(self) -> None:
        """Takes what has come, waiting for some milliseconds at most."""

    def wait(self, predicate: Callable[[], Any], seconds: float) -> bool:
        """Until `predicate` holds; False when it does not in time."""
        deadline = time.monotonic() + seconds
        while True:
            self.poll()
            if predicate():
                return True
            if time.monotonic() >= deadline:
                return False


def plain(value: Any, fields_of: Callable[[Any], list[str] | None]) -> Any:
    """A message as attributes and lists; `fields_of` names its fields, and is None for what is no message."""
    names = fields_of(value)
    if names is not None:
        return SimpleNamespace(**{name: plain(getattr(value, name), fields_of) for name in names})
    if isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, bytes) and len(value) == 1:
        return value[0]  # what rclpy makes of a field of the type `byte`
    if hasattr(value, "tolist"):
        return value.tolist()  # arrays of numbers
    return [plain(item, fields_of) for item in value]
