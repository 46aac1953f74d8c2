"""Starts the daemon beside Autoware: the scene as its detectors publish objects, on the topic its tracker reads.

    ros2 launch launch-scripts/autoware.launch.py config:=/path/to/config.toml

Autoware's sensing names images /sensing/camera/camera<N>/image_raw(/compressed); put those into the configuration's
tables (`topic = "/sensing/camera/camera0/image_raw/compressed"`). Its vehicle frame is base_link, and its own URDF owns
the cameras' frames, so the configuration should say `publish_tf = false` under [node].
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration

OBJECTS = "/perception/object_recognition/detection/objects"
REMAP = f"~/scene/detected_objects:={OBJECTS}"


def generate_launch_description():
    source = PythonLaunchDescriptionSource(str(Path(__file__).with_name("roadwatch.launch.py")))
    arguments = {
        "config": LaunchConfiguration("config"),
        "namespace": "/perception",
        "autoware": "true",
        "remap": REMAP,
    }
    return LaunchDescription(
        [
            DeclareLaunchArgument("config", description="the configuration, a TOML file"),
            IncludeLaunchDescription(source, launch_arguments=arguments.items()),
        ]
    )
