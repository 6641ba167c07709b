"""Launches the node: `ros2 launch boundary_planner_ros boundary.launch.py scenario:=/path/to/mission.toml`."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description() -> LaunchDescription:
    usual = Path(get_package_share_directory("boundary_planner_ros")) / "config" / "parameters.yaml"
    arguments = {
        "scenario": ("", "the scenario, a TOML file"),
        "state_file": ("", "where the mission is saved; empty: nowhere"),
        "parameters": (str(usual), "a file of parameters"),
        "use_sim_time": ("false", "whether time is that of /clock"),
    }
    text = {name: ParameterValue(LaunchConfiguration(name), value_type=str) for name in ("scenario", "state_file")}
    sim = ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool)
    node = Node(
        package="boundary_planner_ros",
        executable="boundary_planner",
        name="boundary_planner",
        output="screen",
        parameters=[LaunchConfiguration("parameters"), {**text, "use_sim_time": sim}],
    )
    declared = (
        DeclareLaunchArgument(name, default_value=value, description=words)
        for name, (value, words) in arguments.items()
    )
    return LaunchDescription([*declared, node])
