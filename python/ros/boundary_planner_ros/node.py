"""The node: ROS 2 around `logic.Explorer`."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path
from typing import Any

import rclpy
from geometry_msgs.msg import Point, PoseStamped, Quaternion
from nav_msgs.msg import Odometry, Path as PathMessage
from rclpy.executors import ExternalShutdownException
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from std_msgs.msg import Bool, Int8, String
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from boundary_planner_ros.logic import Explorer, Pose, Settings


def yaw(it: Any) -> float:
    """The yaw of a quaternion, radians."""
    return math.atan2(2.0 * (it.w * it.z + it.x * it.y), 1.0 - 2.0 * (it.y * it.y + it.z * it.z))


class BoundaryNode(Node):  # type: ignore[misc]
    """Subscribes to positions and labels, and publishes goals: docs/ros.md."""

    def __init__(self) -> None:
        super().__init__("boundary_planner")
        told = {it.name: self._parameter(it.name, it.default) for it in fields(Settings)}
        told["origin"] = tuple(told["origin"])
        saved = self._parameter("state_file", "")
        scenario = self._parameter("scenario", "")
        if not scenario:
            raise ValueError("the parameter scenario is empty: expected the path of a TOML file")
        self.explorer = Explorer(Path(scenario), Path(saved) if saved else None, Settings(**told))
        self.map_frame = self._parameter("map_frame", "map")
        self.base_frame = self._parameter("base_frame", "base_link")
        self._said: tuple[str, bool] | None = None
        self._is_held = False
        self._tf = self._nav2 = self._running = None

        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._goals = self.create_publisher(PoseStamped, "goal_pose", kept)
        self._paths = self.create_publisher(PathMessage, "~/path", kept)
        self._markers = self.create_publisher(MarkerArray, "~/markers", kept)
        self._status = self.create_publisher(String, "~/status", kept)
        self.create_subscription(Int8, "label", lambda it: self.explorer.read(self.now, it.data), 10)
        self.create_subscription(Bool, "label_bool", lambda it: self.explorer.read(self.now, 1 if it.data else -1), 10)
        self.create_service(Trigger, "~/stop", self._stop)
        if self._parameter("use_tf", False):
            from tf2_ros import Buffer, TransformListener

            self._tf = Buffer()
            self._listener = TransformListener(self._tf, self)
        else:
            self.create_subscription(Odometry, "odom", self._odometry, 10)
        if self._parameter("use_nav2", False):
            from nav2_msgs.action import NavigateToPose
            from rclpy.action import ActionClient

            self._action, self._nav2 = NavigateToPose, ActionClient(self, NavigateToPose, "navigate_to_pose")
        self.create_timer(0.1, self.tick)

    def _parameter(self, name: str, default: Any) -> Any:
        default = list(default) if isinstance(default, tuple) else default
        return self.declare_parameter(name, default).value

    @property
    def now(self) -> float:
        """Seconds of the node's clock."""
        return float(self.get_clock().now().nanoseconds) / 1e9

    def _odometry(self, it: Odometry) -> None:
        if it.header.frame_id != self.map_frame:
            found = f"odometry: found the frame {it.header.frame_id!r}, expected {self.map_frame!r}"
            self.get_logger().error(f"{found}: set map_frame or use_tf", throttle_duration_sec=5.0)
            return
        at = it.pose.pose
        self.explorer.position(self.now, Pose(at.position.x, at.position.y, yaw(at.orientation)))

    def _look_up(self) -> None:
        from tf2_ros import TransformException

        try:
            it = self._tf.lookup_transform(self.map_frame, self.base_frame, Time())
        except TransformException:
            return  # The explorer says that it waits.
        stamp, at = it.header.stamp, it.transform
        pose = Pose(at.translation.x, at.translation.y, yaw(at.rotation))
        self.explorer.position(stamp.sec + stamp.nanosec / 1e9, pose)

    def tick(self) -> None:
        """Goes on with the mission."""
        if self._tf is not None:
            self._look_up()
        if self._nav2 is not None and not self._nav2.server_is_ready():
            self._say("waits for navigate_to_pose", False)
            return
        goal = self.explorer.tick(self.now)
        if goal is not None:
            self._send(goal)
        if self.explorer.is_halted and not self._is_held:
            self._hold()
        self._say(self.explorer.status, self.explorer.is_trouble)

    def _say(self, status: str, is_trouble: bool) -> None:
        if (status, is_trouble) != self._said:
            self._said = status, is_trouble
            # Two calls: rclpy refuses another severity from the same one.
            if is_trouble:
                self.get_logger().error(status)
            else:
                self.get_logger().info(status)
            self._status.publish(String(data=status))
            self._draw()

    def _send(self, goal: Pose) -> None:
        path = PathMessage()
        path.header.frame_id = self.map_frame
        path.header.stamp = self.get_clock().now().to_msg()
        path.poses = [self._stamped(it) for it in self.explorer.path]
        self._paths.publish(path)
        if self._nav2 is None:
            self._goals.publish(self._stamped(goal))
        else:
            message = self._action.Goal()
            message.pose = self._stamped(goal)
            self._nav2.send_goal_async(message).add_done_callback(self._sent)

    def _sent(self, future: Any) -> None:
        self._running = future.result()
        if not self._running.accepted:
            # The robot rests, so the explorer sends the goal again.
            self.get_logger().error("navigate_to_pose has refused the goal")
            self._running = None
        elif self._is_held:
            self._running.cancel_goal_async()

    def _hold(self) -> None:
        """Stops the robot: its goal is cancelled, or the place where it is becomes its goal."""
        self._is_held = True
        if self._nav2 is not None:
            if self._running is not None:
                self._running.cancel_goal_async()
        elif self.explorer.pose is not None:
            self._goals.publish(self._stamped(self.explorer.pose))

    def _stop(self, _request: Any, response: Any) -> Any:
        self.explorer.halt("stopped by ~/stop; a restart goes on")
        self.tick()
        response.success, response.message = True, self.explorer.status
        return response

    def _stamped(self, pose: Pose) -> PoseStamped:
        it = PoseStamped()
        it.header.frame_id, it.header.stamp = self.map_frame, self.get_clock().now().to_msg()
        it.pose.position = Point(x=pose.x, y=pose.y, z=0.0)
        it.pose.orientation = Quaternion(x=0.0, y=0.0, z=math.sin(pose.yaw / 2), w=math.cos(pose.yaw / 2))
        return it

    def _draw(self) -> None:
        drawn = [Marker(action=Marker.DELETEALL)]
        for it in self.explorer.markers:
            marker = Marker(ns=it.name, type=Marker.LINE_STRIP if it.is_line else Marker.SPHERE_LIST)
            marker.header.frame_id = self.map_frame
            marker.pose.orientation.w = 1.0
            size = 0.1 if it.is_line else 0.3
            marker.scale.x = marker.scale.y = marker.scale.z = size
            marker.color.r, marker.color.g, marker.color.b = it.colour
            marker.color.a = 1.0
            marker.points = [Point(x=x, y=y, z=0.0) for x, y in it.points]
            drawn.append(marker)
        self._markers.publish(MarkerArray(markers=drawn))


def main() -> int:
    """Runs the node until it is shut down."""
    rclpy.init()
    try:
        rclpy.spin(BoundaryNode())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except (ValueError, OSError) as error:
        get_logger("boundary_planner").fatal(str(error))
        return 1
    finally:
        rclpy.try_shutdown()
    return 0
