"""Starts the daemon as ROS 2's launch system starts any node.

    ros2 launch launch-scripts/roadwatch.launch.py config:=/path/to/config.toml

The daemon is one executable without an ament package, so it is found on PATH, or where `executable` says.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, TimerAction
from launch.substitutions import LaunchConfiguration

# What another start does not mend: done, wrong arguments, mistakes in the configuration.
FINAL_EXIT_CODES = (0, 2, 78)
RESPAWN_DELAY_SECS = 1.0
# The daemon works off what it holds for at most ten seconds, and a second signal ends it at once.
SIGTERM_TIMEOUT_SECS = "15"

# Name, default, meaning. What is empty is not passed on: parameter file and configuration decide.
ARGUMENTS = [
    ("config", None, "the configuration, a TOML file"),
    ("executable", "roadwatch", "the daemon, a name on PATH or a path"),
    ("name", "", "name of the node"),
    ("namespace", "", "namespace of the node, such as /vehicle"),
    ("params_file", "", "a YAML file of parameters"),
    ("log_level", "", "debug, info, warn or error"),
    ("use_sim_time", "", "true: take the time from /clock"),
    ("autostart", "", "false: wait for a lifecycle manager to configure and activate it"),
    ("autoware", "", "true: publish autoware_perception_msgs/DetectedObjects, too"),
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
        if values[key]:
            ros += ["-p", f"{parameter}:={values[key]}"]
    if values["log_level"]:
        ros += ["--log-level", values["log_level"]]
    return [values["executable"], "run", values["config"], *ros]


def daemon(cmd, respawn):
    """The process. `respawn` of ExecuteProcess would start it again whatever it ended with."""

    def start_again(event, context):
        if context.is_shutdown or event.returncode in FINAL_EXIT_CODES:
            return None
        return [TimerAction(period=RESPAWN_DELAY_SECS, actions=[daemon(cmd, respawn)])]

    return ExecuteProcess(
        cmd=cmd,
        output="screen",
        sigterm_timeout=SIGTERM_TIMEOUT_SECS,
        on_exit=start_again if respawn else None,
    )


def start(context):
    values = {name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS}
    respawn = values["respawn"].lower() == "true"
    return [daemon(command(values), respawn)]


def generate_launch_description():
    declared = []
    for name, default, meaning in ARGUMENTS:
        given = {} if default is None else {"default_value": default}
        declared.append(DeclareLaunchArgument(name, description=meaning, **given))
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
