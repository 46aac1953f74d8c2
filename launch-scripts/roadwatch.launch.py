"""Starts the daemon as ROS 2's launch system starts any node.

    ros2 launch launch-scripts/roadwatch.launch.py config:=/path/to/config.toml

The daemon is one executable without an ament package, so it is found on PATH, or where `executable` says.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

# Name, default, meaning. What is empty is not passed on: the configuration decides.
ARGUMENTS = [
    ("config", None, "the configuration, a TOML file"),
    ("executable", "roadwatch", "the daemon, a name on PATH or a path"),
    ("name", "", "name of the node"),
    ("namespace", "", "namespace of the node, such as /vehicle"),
    ("params_file", "", "a YAML file of parameters"),
    ("log_level", "", "debug, info, warn or error"),
    ("use_sim_time", "false", "take the time from /clock"),
    ("autostart", "true", "configure and activate at once; false waits for a lifecycle manager"),
    ("autoware", "false", "publish autoware_perception_msgs/DetectedObjects, too"),
    ("remap", "", "further rules FROM:=TO, with blanks between them"),
    ("respawn", "true", "start the daemon again when it ends by a failure"),
]


def command(values):
    """The command line for these values of the arguments, by their names."""
    ros = ["--ros-args"]
    if values["name"]:
        ros += ["-r", f"__node:={values['name']}"]
    if values["namespace"]:
        ros += ["-r", f"__ns:={values['namespace']}"]
    for rule in values["remap"].split():
        ros += ["-r", rule]
    if values["params_file"]:
        ros += ["--params-file", values["params_file"]]
    for key, parameter in [
        ("use_sim_time", "use_sim_time"),
        ("autostart", "node.autostart"),
        ("autoware", "node.autoware"),
    ]:
        ros += ["-p", f"{parameter}:={values[key]}"]
    if values["log_level"]:
        ros += ["--log-level", values["log_level"]]
    return [values["executable"], "run", values["config"], *ros]


def start(context):
    values = {name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS}
    respawn = values["respawn"].lower() == "true"
    return [ExecuteProcess(cmd=command(values), output="screen", respawn=respawn, respawn_delay=1.0)]


def generate_launch_description():
    declared = []
    for name, default, meaning in ARGUMENTS:
        given = {} if default is None else {"default_value": default}
        declared.append(DeclareLaunchArgument(name, description=meaning, **given))
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
