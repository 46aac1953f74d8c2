"""Chooses who speaks for the tests: rclpy where ROS 2 is sourced, CycloneDDS for Python elsewhere.

ROADWATCH_HARNESS=rclpy or =cyclone chooses by hand.
"""

import importlib
import importlib.util
import os

from adapter import Ros


def adapter_name() -> str:
    chosen = os.environ.get("ROADWATCH_HARNESS")
    return chosen or ("rclpy" if importlib.util.find_spec("rclpy") else "cyclone")


def connect(domain: int) -> Ros:
    """A node in that domain."""
    return importlib.import_module(f"adapter_{adapter_name()}").connect(domain)
