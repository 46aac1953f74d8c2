"""A stand-in for ROS 2's `launch` package: it records what launch files ask for, and starts nothing."""

import importlib.util
import sys
import types
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1]


class Recorded:
    """Anything that a launch file makes: what it was given."""

    def __init__(self, *given, **named):
        self.given, self.named = given, named


class LaunchConfiguration(Recorded):
    """The value of an argument, known when the file is run."""

    def perform(self, values):
        return values[self.given[0]]


def kind(name):
    return type(name, (Recorded,), {})


def install():
    """Puts the stand-in where `import launch` finds it."""
    modules = {
        "launch": {"LaunchDescription": kind("LaunchDescription")},
        "launch.actions": {
            name: kind(name)
            for name in [
                "DeclareLaunchArgument",
                "ExecuteProcess",
                "IncludeLaunchDescription",
                "OpaqueFunction",
                "TimerAction",
            ]
        },
        "launch.substitutions": {"LaunchConfiguration": LaunchConfiguration},
        "launch.launch_description_sources": {
            "PythonLaunchDescriptionSource": kind("PythonLaunchDescriptionSource")
        },
    }
    for name, contents in modules.items():
        module = types.ModuleType(name)
        module.__dict__.update(contents)
        sys.modules[name] = module


def launch_file(name):
    """A launch file as a module."""
    install()
    spec = importlib.util.spec_from_file_location(name.split(".")[0], FOLDER / name)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
