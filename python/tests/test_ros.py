"""The node of ROS 2: its logic as it is, the node with stand-ins for rclpy and messages."""

from __future__ import annotations

import importlib
import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from boundary_planner import BoundaryError, Mission, Planner

sys.path.insert(0, str(Path(__file__).parents[1] / "ros"))

from boundary_planner_ros.logic import Explorer, Pose, Settings

Label = Callable[[float, float], int]

LINE = """
algorithm = "lookahead"
steps = 60
stop = { slope_arc_deg = 1.0 }
oracle = [
  { x = 2, z = 1, label = -1 }, { x = 2, z = 8, label = 1 }, { x = 18, z = 16, label = 1 }, { x = 18, z = 5, label = -1 },
]
"""
FRONT = """
algorithm = "track"
steps = 200
oracle = []
area = { x = [0, 40], z = [0, 30] }
"""
CAR = LINE + 'vehicle = { kind = "car", reach = 5.0, step = 0.5, radius = 1.0 }\n'
START = Pose(4.0, 4.0, 0.5)


def line(x: float, z: float) -> int:
    return 1 if z > 0.41 * x + 3.5 else -1


def bloom(x: float, z: float) -> int:
    return 1 if math.hypot(x - 20, z - 15) < 8 else -1


def scenario(folder: Path, text: str) -> Path:
    path = folder / "mission.toml"
    path.write_text(text)
    return path


def directly(path: Path, label: Label) -> Planner:
    """The same mission by `Planner` alone."""
    planner = Mission(path).planner(pose={"x": START.x, "z": START.y, "heading": START.yaw})
    while motion := planner.plan():
        planner.observe(motion.pose, label(motion.pose["x"], motion.pose["z"]) if motion.wants_label else None)
    return planner


class Robot:
    """A simulated robot: a second after a goal is sent it is there, and its sensor reads all the time."""

    def __init__(self, explorer: Explorer, label: Label, begins: float = 100.0) -> None:
        self.explorer, self.label = explorer, label
        self.now, self.pose = begins, START
        self.goals: list[Pose] = []
        self.paths: list[list[Pose]] = []
        self._arrives = math.inf
        self.ends: Callable[[Pose], Pose] = lambda goal: goal
        self.is_heard = self.is_read = True

    def run(self, seconds: float = math.inf, goals: float = math.inf) -> None:
        until = self.now + min(seconds, 3000.0)
        while self.now < until and len(self.goals) < goals and not self.explorer.is_over:
            if self.now >= self._arrives:
                self.pose, self._arrives = self.ends(self.goals[-1]), math.inf
            if self.is_heard:
                self.explorer.position(self.now, self.pose)
            if self.is_read:
                self.explorer.read(self.now, self.label(self.pose.x, self.pose.y))
            if goal := self.explorer.tick(self.now):
                self.goals.append(goal)
                self.paths.append(self.explorer.path)
                self._arrives = self.now + 1.0
            self.now += 0.25


def known(explorer: Explorer) -> Planner:
    assert explorer.planner is not None
    return explorer.planner


@pytest.mark.parametrize(
    ("text", "label", "stop"),
    [(LINE, line, "known"), (CAR, line, "known"), (FRONT, bloom, "closed")],
    ids=["line", "car", "front"],
)
def test_a_mission_is_that_of_the_planner(tmp_path: Path, text: str, label: Label, stop: str) -> None:
    explorer = Explorer(scenario(tmp_path, text), None, Settings(arrive_metres=0.04))
    robot = Robot(explorer, label)
    robot.run()
    expected = directly(tmp_path / "mission.toml", label)
    assert known(explorer).answer == expected.answer
    assert expected.stop == stop and explorer.status == f"the mission has ended: {stop}"
    assert len(explorer.samples) > 5 and not explorer.is_trouble


def test_the_line_is_drawn_where_it_is(tmp_path: Path) -> None:
    explorer = Explorer(scenario(tmp_path, LINE))
    robot = Robot(explorer, line)
    robot.run(goals=1)
    assert explorer.markers == []
    robot.run()
    (x0, y0), (x1, y1) = explorer.line
    assert abs((y1 - y0) / (x1 - x0) - 0.41) < 0.02 and abs(y0 - (0.41 * x0 + 3.5)) < 0.2
    assert x1 - x0 > 5.0
    assert {it.name for it in explorer.markers} == {"label -1", "label 1", "estimate"}


def test_the_front_is_drawn_where_it_is(tmp_path: Path) -> None:
    explorer = Explorer(scenario(tmp_path, FRONT))
    Robot(explorer, bloom).run()
    vertices = [it for piece in explorer.front for it in piece]
    off = [abs(math.hypot(x - 20, y - 15) - 8) for x, y in vertices]
    assert len(off) > 40 and max(off) < 0.5 and explorer.line == []


def test_the_path_of_a_car_is_its_arc(tmp_path: Path) -> None:
    explorer = Explorer(scenario(tmp_path, CAR), None, Settings(arrive_metres=0.04))
    robot = Robot(explorer, line)
    robot.run()
    starts = [START, *robot.goals]
    bent = [path for path in robot.paths if len(path) > 2]
    assert len(bent) > 3
    for path, start, goal in zip(robot.paths, starts, robot.goals, strict=False):
        assert path[0].off(start)[0] < 1e-4 and path[-1] == goal
        if len(path) > 2:
            pieces = [a.off(b)[0] for a, b in zip(path, path[1:], strict=False)]
            assert max(pieces) < 1.01 * min(pieces) + 1e-3


def test_a_label_from_before_arrival_is_not_taken(tmp_path: Path) -> None:
    explorer = Explorer(scenario(tmp_path, LINE), None, Settings(label_age=5.0))
    robot = Robot(explorer, line)
    robot.run(goals=1)
    explorer.read(robot.now, -line(robot.goals[0].x, robot.goals[0].y))
    robot.is_read = False
    robot.run(4.0)
    assert len(robot.goals) == 1 and explorer.status == "at the goal: waits for a label" and not explorer.is_trouble
    robot.run(12.0)
    assert explorer.is_trouble, "after label_timeout somebody should look"
    robot.is_read = True
    robot.run(goals=2)
    assert [it[2] for it in explorer.samples] == [line(robot.goals[0].x, robot.goals[0].y)]


def test_a_label_on_the_way_is_taken_only_if_that_is_allowed_and_only_while_it_is_fresh(tmp_path: Path) -> None:
    path = scenario(tmp_path, LINE)
    for settings, age, is_taken in [
        (Settings(at_rest=False, label_age=1.0), 0.5, True),
        (Settings(at_rest=False, label_age=1.0), 1.5, False),
        (Settings(at_rest=True, label_age=1.0), 0.5, False),
    ]:
        explorer = Explorer(path, None, settings)
        explorer.position(0.0, START)
        explorer.position(2.0, START)
        goal = explorer.tick(2.0)
        assert goal is not None
        explorer.position(4.0, goal)
        explorer.position(6.0, goal)
        explorer.read(6.0 - age, -1)
        explorer.tick(6.0)
        assert len(explorer.samples) == is_taken, (settings, age)


def test_a_robot_that_stops_short_is_told_again_then_reported(tmp_path: Path) -> None:
    explorer = Explorer(scenario(tmp_path, LINE))
    robot = Robot(explorer, line)
    robot.ends = lambda goal: Pose(goal.x - 0.5, goal.y, goal.yaw)
    robot.run(goals=2)
    assert robot.goals[0] == robot.goals[1] and "0.50 m" in explorer.status and explorer.is_trouble
    robot.run()
    assert len(robot.goals) == 3 and explorer.is_halted and explorer.samples == []
    assert explorer.status.startswith("the robot rests 0.50 m and 0.00 rad off its goal, after 3")


def test_a_robot_that_stops_near_enough_is_taken_where_it_is(tmp_path: Path) -> None:
    explorer = Explorer(scenario(tmp_path, LINE))
    robot = Robot(explorer, line)
    robot.ends = lambda goal: Pose(goal.x - 0.2, goal.y, goal.yaw - math.tau + 0.1)
    robot.run(goals=2)
    assert math.dist(explorer.samples[0][:2], (robot.goals[0].x - 0.2, robot.goals[0].y)) < 1e-4
    robot = Robot(Explorer(tmp_path / "mission.toml"), line)
    robot.ends = lambda goal: Pose(goal.x, goal.y, goal.yaw - 0.5)
    robot.run()
    assert robot.explorer.is_halted and "0.50 rad" in robot.explorer.status


def test_a_robot_that_has_not_set_out_has_not_arrived(tmp_path: Path) -> None:
    text = LINE + "vehicle = { kind = 'unicycle', reach = 0.2, step = 0.1 }\n"
    robot = Robot(Explorer(scenario(tmp_path, text), None, Settings(arrive_radians=4.0)), line)
    robot.ends = lambda goal: START
    robot.run(8.0)
    assert len(robot.goals) == 1 and robot.explorer.samples == []


def test_a_robot_that_never_rests_is_broken_off(tmp_path: Path) -> None:
    explorer = Explorer(scenario(tmp_path, LINE), None, Settings(motion_timeout=60.0))
    robot = Robot(explorer, line)
    robot.run(goals=1)
    for k in range(300):
        explorer.position(robot.now, Pose(10.0 + math.cos(k), 10.0 + math.sin(k), 0.0))
        explorer.tick(robot.now)
        robot.now += 0.25
    assert explorer.is_halted and explorer.status.startswith("the motion does not end")


def test_nothing_is_done_without_a_position(tmp_path: Path) -> None:
    robot = Robot(Explorer(scenario(tmp_path, LINE)), line)
    robot.run(goals=3)
    robot.is_heard = False
    robot.run(20.0)
    assert len(robot.goals) == 3 and robot.explorer.status == "waits for a position" and robot.explorer.is_trouble
    robot.explorer.position(robot.now, Pose(math.nan, 0.0, 0.0))
    assert robot.explorer.tick(robot.now) is None
    robot.is_heard = True
    robot.run()
    assert known(robot.explorer).stop == "known"


@pytest.mark.parametrize(("text", "label"), [(LINE, line), (FRONT, bloom)], ids=["line", "front"])
def test_a_restart_goes_on_with_the_same_motions(tmp_path: Path, text: str, label: Label) -> None:
    path, saved = scenario(tmp_path, text), tmp_path / "state.json"
    whole = Robot(Explorer(path), label)
    whole.run()
    goals: list[Pose] = []
    for start in range(20):
        robot = Robot(Explorer(path, saved), label, begins=5.0)
        if start > 0:
            robot.pose = Pose(8.0, 3.0, 1.0)  # wherever somebody has put it
        robot.run(goals=7)
        # The goal that was sent last was under way, and is sent again.
        goals += robot.goals if robot.explorer.is_over else robot.goals[:-1]
        if robot.explorer.is_over:
            break
    assert goals == whole.goals and len(goals) > 10
    assert known(robot.explorer).answer == known(whole.explorer).answer
    assert robot.explorer.markers == whole.explorer.markers
    again = Explorer(path, saved)
    assert again.status == whole.explorer.status and again.tick(0.0) is None
    assert not list(tmp_path.glob("*.new"))


def test_a_state_that_is_no_good_is_refused(tmp_path: Path) -> None:
    path, saved = scenario(tmp_path, LINE), tmp_path / "state.json"
    Robot(Explorer(path, saved), line).run(goals=3)
    path.write_text(LINE.replace("x = 18", "x = 17"))
    with pytest.raises(BoundaryError, match=r"state\.json \(delete it to begin anew\): .*state: found another one"):
        Explorer(path, saved)
    path.write_text(LINE)
    saved.write_text(saved.read_text()[:-20])
    with pytest.raises(BoundaryError, match="delete it to begin anew"):
        Explorer(path, saved)


def test_a_label_that_contradicts_is_reported_and_a_restart_reads_it_anew(tmp_path: Path) -> None:
    path, saved = scenario(tmp_path, LINE), tmp_path / "state.json"
    robot = Robot(Explorer(path, saved), line)
    robot.run(goals=12)
    # A little off its goal, what the label must be is known by now.
    def ends(goal: Pose) -> Pose:
        motion = known(robot.explorer).plan()
        assert motion is not None
        return Pose(goal.x, goal.y - min(0.25, 0.4 * motion.drive), goal.yaw)

    robot.ends = ends
    robot.label = lambda x, z: -line(x, z)
    robot.run()
    assert robot.explorer.is_halted and robot.explorer.is_trouble and robot.explorer.tick(robot.now) is None
    assert "contradict" in robot.explorer.status
    done = json.loads(saved.read_text())["state"]["done"]
    assert len(done) == len(robot.goals) - 1
    robot = Robot(Explorer(path, saved), line)
    robot.run()
    assert known(robot.explorer).stop == "known"


def test_an_area_in_a_system_of_coordinates(tmp_path: Path) -> None:
    corners = [[500000.0 + x, 6650000.0 + z] for x, z in [(0, 0), (300, 0), (300, 200), (150, 120), (0, 200), (0, 0)]]
    (tmp_path / "lake.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [corners]}))
    text = """
algorithm = "track"
steps = 40
oracle = []
area = { geojson = "lake.geojson", crs = "EPSG:32633" }
vehicle = { kind = "unicycle", reach = 20.0, step = 1.0 }
"""
    settings = Settings(origin=(500000.0, 6650000.0))
    explorer = Explorer(scenario(tmp_path, text), tmp_path / "state.json", settings)
    robot = Robot(explorer, lambda x, z: 1 if x > 150 else -1)
    robot.pose = Pose(80.0, 60.0, 0.0)
    robot.run()
    assert len(explorer.samples) > 15
    for x, y, label in explorer.samples:
        assert min(math.dist((x, y), (goal.x, goal.y)) for goal in robot.goals) < 1e-3
        assert label == (1 if x > 150 else -1)
    assert explorer.front and all(abs(x - 150) < 10 for piece in explorer.front for x, _ in piece)
    assert Explorer(tmp_path / "mission.toml", tmp_path / "state.json", settings).markers == explorer.markers


# The node, with stand-ins.


class Message(SimpleNamespace):
    """A message: fields are there when they are asked for."""

    DELETEALL, LINE_STRIP, SPHERE_LIST = 3, 4, 7

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        setattr(self, name, Message())
        return getattr(self, name)


class Logger:
    def __init__(self) -> None:
        self.lines: list[tuple[str, str]] = []
        self._severities: dict[tuple[str, int], str] = {}

    def _log(self, severity: str, text: str) -> None:
        caller = sys._getframe(2)
        place = caller.f_code.co_filename, caller.f_lineno
        if self._severities.setdefault(place, severity) != severity:
            raise ValueError("Logger severity cannot be changed between calls.")
        self.lines.append((severity, text))

    def info(self, text: str, **_: Any) -> None:
        self._log("info", text)

    def error(self, text: str, **_: Any) -> None:
        self._log("error", text)

    def fatal(self, text: str, **_: Any) -> None:
        self._log("fatal", text)


class Node:
    given: dict[str, Any] = {}

    def __init__(self, name: str) -> None:
        self.seconds, self.logger = 100.0, Logger()
        self.published: dict[str, list[Any]] = {}
        self.heard: dict[str, Callable[[Any], None]] = {}
        self.services: dict[str, Callable[[Any, Any], Any]] = {}
        self.declared: dict[str, Any] = {}

    def declare_parameter(self, name: str, default: Any) -> Any:
        assert default is not None and not isinstance(default, tuple) and name not in self.declared
        value = self.given.get(name, default)
        assert type(value) is type(default), f"rclpy refuses another type: {name}"
        self.declared[name] = default
        return SimpleNamespace(value=value)

    def create_publisher(self, kind: Any, topic: str, _qos: Any) -> Any:
        self.published[topic] = []
        return SimpleNamespace(publish=self.published[topic].append)

    def create_subscription(self, kind: Any, topic: str, callback: Callable[[Any], None], _qos: Any) -> None:
        self.heard[topic] = callback

    def create_service(self, kind: Any, name: str, callback: Callable[[Any, Any], Any]) -> None:
        self.services[name] = callback

    def create_timer(self, _seconds: float, callback: Callable[[], None]) -> None:
        pass

    def get_logger(self) -> Logger:
        return self.logger

    def get_clock(self) -> Any:
        stamp = Message(nanoseconds=int(self.seconds * 1e9), to_msg=lambda: Message(sec=int(self.seconds), nanosec=0))
        return SimpleNamespace(now=lambda: stamp)


class ActionClient:
    """A server of actions that accepts goals, and notes what is cancelled."""

    def __init__(self, _node: Node, _kind: Any, name: str) -> None:
        self.name, self.is_ready, self.cancelled = name, False, 0
        self.goals: list[Any] = []

    def server_is_ready(self) -> bool:
        return self.is_ready

    def _cancel(self) -> None:
        self.cancelled += 1

    def send_goal_async(self, goal: Any) -> Any:
        self.goals.append(goal)
        handle = SimpleNamespace(accepted=True, cancel_goal_async=self._cancel)
        future = SimpleNamespace(result=lambda: handle)
        return SimpleNamespace(add_done_callback=lambda callback: callback(future))


class LookedUp(Exception):
    pass


class Buffer:
    transform: Any = None

    def lookup_transform(self, target: str, source: str, _time: Any) -> Any:
        assert (target, source) == ("map", "base_link")
        if self.transform is None:
            raise LookedUp
        return self.transform


@pytest.fixture
def module(monkeypatch: pytest.MonkeyPatch) -> Any:
    """`boundary_planner_ros.node` over the stand-ins."""
    messages = {
        "geometry_msgs.msg": ["Point", "PoseStamped", "Quaternion"],
        "nav_msgs.msg": ["Odometry", "Path"],
        "std_msgs.msg": ["Bool", "Int8", "String"],
        "std_srvs.srv": ["Trigger"],
        "visualization_msgs.msg": ["Marker", "MarkerArray"],
    }
    # `rclpy` itself, its parts, and what is imported only where it is asked for.
    parts: dict[str, dict[str, Any]] = {name: dict.fromkeys(all_, Message) for name, all_ in messages.items()}
    parts["rclpy"] = {"init": lambda: None, "try_shutdown": lambda: None, "spin": lambda node: None}
    parts["rclpy.executors"] = {"ExternalShutdownException": type("ExternalShutdownException", (Exception,), {})}
    log = Logger()
    parts["rclpy.logging"] = {"get_logger": lambda name: log}
    parts["rclpy.node"] = {"Node": Node}
    parts["rclpy.qos"] = {"DurabilityPolicy": Message(), "QoSProfile": Message}
    parts["rclpy.time"] = {"Time": Message}
    parts["rclpy.action"] = {"ActionClient": ActionClient}
    parts["nav2_msgs.action"] = {"NavigateToPose": SimpleNamespace(Goal=Message)}
    parts["tf2_ros"] = {"Buffer": Buffer, "TransformListener": Message, "TransformException": LookedUp}
    parts["tf2_ros"]["TransformListener"] = lambda buffer, node: None
    for name, names in parts.items():
        for above in (name.split(".")[0], name):
            if above not in sys.modules:
                monkeypatch.setitem(sys.modules, above, ModuleType(above))
        for key, value in names.items():
            setattr(sys.modules[name], key, value)
    monkeypatch.delitem(sys.modules, "boundary_planner_ros.node", raising=False)
    found = importlib.import_module("boundary_planner_ros.node")
    yield found
    sys.modules.pop("boundary_planner_ros.node")


def turned(yaw: float) -> Any:
    return Message(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))


def odometry(pose: Pose, frame: str = "map") -> Any:
    at = Message(position=Message(x=pose.x, y=pose.y, z=0.0), orientation=turned(pose.yaw))
    return Message(header=Message(frame_id=frame), pose=Message(pose=at))


def begun(module: Any, folder: Path, **given: Any) -> Any:
    Node.given = {"scenario": str(scenario(folder, LINE)), **given}
    return module.BoundaryNode()


def pose_of(module: Any, stamped: Any) -> Pose:
    at = stamped.pose
    return Pose(at.position.x, at.position.y, module.yaw(at.orientation))


def lead(module: Any, node: Any, goals: list[Any], hear: Callable[[Pose], None], seconds: float = 500.0) -> None:
    """Moves the robot to each goal at once, in ticks of a tenth."""
    pose, sent = START, 0
    for _ in range(int(seconds * 10)):
        if len(goals) > sent:
            sent = len(goals)
            stamped = goals[-1]
            pose = pose_of(module, stamped if stamped.header.frame_id == "map" else stamped.pose)
        hear(pose)
        node.heard["label"](Message(data=line(pose.x, pose.y)))
        node.tick()
        node.seconds += 0.1
        if node.explorer.is_over:
            return


def test_the_node_publishes_what_the_logic_says(module: Any, tmp_path: Path) -> None:
    node = begun(module, tmp_path, state_file=str(tmp_path / "state.json"))
    goals = node.published["goal_pose"]
    lead(module, node, goals, lambda pose: node.heard["odom"](odometry(pose)))
    direct = directly(tmp_path / "mission.toml", line)
    assert node.published["~/status"][-1].data == "the mission has ended: known"
    assert len(goals) == len(node.published["~/path"]) == len(direct.answer["state"]["done"])
    # A quaternion rounds the heading.
    assert known(node.explorer).estimate["angle"] == pytest.approx(direct.estimate["angle"], abs=0.1)  # type: ignore[index]
    assert all(it.header.frame_id == "map" for it in goals)
    last = node.published["~/markers"][-1].markers
    assert last[0].action == Message.DELETEALL and {it.ns for it in last[1:]} == {"label -1", "label 1", "estimate"}
    assert sum(len(it.points) for it in last[1:] if it.ns.startswith("label")) == len(node.explorer.samples) > 10
    assert not [it for it in node.logger.lines if it[0] != "info"]


def test_the_node_stops_the_robot(module: Any, tmp_path: Path) -> None:
    node = begun(module, tmp_path)
    goals = node.published["goal_pose"]
    lead(module, node, goals, lambda pose: node.heard["odom"](odometry(pose)), seconds=3.0)
    here = Pose(7.0, 5.0, 1.0)
    node.heard["odom"](odometry(here))
    answer = node.services["~/stop"](None, Message())
    assert answer.success and "stopped" in answer.message
    assert pose_of(module, goals[-1]).off(here) < (1e-9, 1e-9)
    count = len(goals)
    lead(module, node, [], lambda pose: node.heard["odom"](odometry(pose)), seconds=3.0)
    assert len(goals) == count


def test_the_node_ignores_odometry_of_another_frame(module: Any, tmp_path: Path) -> None:
    node = begun(module, tmp_path)
    lead(module, node, node.published["goal_pose"], lambda pose: node.heard["odom"](odometry(pose, "odom")), seconds=5.0)
    assert node.published["goal_pose"] == [] and "expected 'map'" in node.logger.lines[0][1]


def test_the_node_sends_goals_to_nav2_and_cancels_them(module: Any, tmp_path: Path) -> None:
    node = begun(module, tmp_path, use_nav2=True)
    nav2, hear = node._nav2, lambda pose: node.heard["odom"](odometry(pose))
    lead(module, node, nav2.goals, hear, seconds=3.0)
    assert nav2.goals == [] and node.published["~/status"][-1].data == "waits for navigate_to_pose"
    nav2.is_ready = True
    lead(module, node, nav2.goals, hear, seconds=8.0)
    assert len(nav2.goals) > 2 and node.published["goal_pose"] == [] and nav2.cancelled == 0
    node.services["~/stop"](None, Message())
    assert nav2.cancelled == 1


def test_the_node_takes_positions_from_tf_by_their_stamps(module: Any, tmp_path: Path) -> None:
    node = begun(module, tmp_path, use_tf=True)
    assert "odom" not in node.heard

    def hear(pose: Pose) -> None:
        stamp = Message(sec=int(node.seconds), nanosec=int(node.seconds % 1 * 1e9))
        at = Message(translation=Message(x=pose.x, y=pose.y), rotation=turned(pose.yaw))
        Buffer.transform = Message(header=Message(stamp=stamp), transform=at)

    node.tick()
    lead(module, node, node.published["goal_pose"], hear, seconds=10.0)
    count = len(node.published["goal_pose"])
    assert count > 2
    lead(module, node, [], lambda pose: None, seconds=5.0)
    assert node.published["~/status"][-1].data == "waits for a position"
    Buffer.transform = None


def test_labels_may_be_booleans(module: Any, tmp_path: Path) -> None:
    node = begun(module, tmp_path)
    for told, label in [(True, 1), (False, -1)]:
        node.heard["label_bool"](Message(data=told))
        assert node.explorer._label == (node.now, label)


def test_the_program_says_what_is_wrong(module: Any, tmp_path: Path) -> None:
    Node.given = {}
    assert module.main() == 1
    Node.given = {"scenario": str(tmp_path / "none.toml")}
    assert module.main() == 1
    first, second = module.get_logger("").lines
    assert first == ("fatal", "the parameter scenario is empty: expected the path of a TOML file")
    assert "none.toml" in second[1]


def test_the_file_of_parameters_has_them_all_with_their_defaults(module: Any, tmp_path: Path) -> None:
    node = begun(module, tmp_path, use_tf=True, use_nav2=True)
    lines = (Path(__file__).parents[1] / "ros/config/parameters.yaml").read_text().splitlines()[2:]
    pairs = dict(line.split("#")[0].strip().split(": ") for line in lines)
    told = {key: json.loads(text) if text[0] in "tf[0123456789" else text for key, text in pairs.items()}
    assert told == {key: value for key, value in node.declared.items() if key not in ("scenario", "state_file")}
