"""A mission on a robot, free of ROS: positions and labels come in, goals, paths and markers come out.

Times are seconds of one clock. Positions are of the map frame: metres, x east and y north, yaw from x to y. The planner
calls y z, and yaw heading.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from boundary_planner import BoundaryError, Mission, Motion, Planner

Point = tuple[float, float]


@dataclass(frozen=True)
class Pose:
    """A pose in the map frame."""

    x: float
    y: float
    yaw: float

    def off(self, other: Pose) -> tuple[float, float]:
        """Metres and radians between two poses."""
        turn = math.remainder(self.yaw - other.yaw, math.tau)
        return math.hypot(self.x - other.x, self.y - other.y), abs(turn)


@dataclass(frozen=True)
class Marker:
    """Something to draw: points, or a line through them."""

    name: str
    is_line: bool
    points: list[Point]
    colour: tuple[float, float, float]


@dataclass(frozen=True)
class Settings:
    """The node's parameters: docs/ros.md."""

    arrive_metres: float = 0.3
    arrive_radians: float = 0.3
    at_rest: bool = True
    rest_metres: float = 0.05
    rest_radians: float = 0.05
    rest_seconds: float = 1.0
    label_age: float = 1.0
    label_timeout: float = 10.0
    position_timeout: float = 2.0
    patience: float = 10.0
    attempts: int = 3
    motion_timeout: float = 300.0
    origin: tuple[float, float] = (0.0, 0.0)


class Explorer:
    """Leads a robot through a mission.

    Call `position` and `read` whenever something arrives, and `tick` a few times a second. `tick` returns a goal if one is
    to be sent. The mission is saved after each motion: a new `Explorer` with the same files goes on.
    """

    def __init__(self, scenario: Path, saved: Path | None = None, settings: Settings = Settings()) -> None:
        self.settings = settings
        self.status = "waits for a position"
        self.is_trouble = False
        """Whether somebody should look at the status."""
        self.is_halted = False
        """Whether the mission was broken off. A restart goes on."""
        self.pose: Pose | None = None
        self.planner: Planner | None = None
        self._mission = Mission(scenario)
        self._saved = saved
        self._heard = self._rested = self._since = -math.inf
        self._resting: Pose | None = None
        self._label: tuple[float, int] | None = None
        self._motion: Motion | None = None
        self._goal: Pose | None = None
        self._attempt = 0
        self._arrived: float | None = None
        self._shift: Point | None = None
        self._front: list[dict[str, Any]] = []
        if saved is not None and saved.exists():
            self._resume(saved)
            if self.is_over:
                self._next(0.0)

    def position(self, time: float, pose: Pose) -> None:
        """Takes in where the robot is."""
        if not all(map(math.isfinite, (pose.x, pose.y, pose.yaw))):
            return
        still = self._resting and self._resting.off(pose)
        if not still or still[0] > self.settings.rest_metres or still[1] > self.settings.rest_radians:
            self._resting, self._rested = pose, time
        self.pose, self._heard = pose, time

    def read(self, time: float, label: int) -> None:
        """Takes in a label: -1, 0 on the boundary, or 1."""
        if label in (-1, 0, 1):
            self._label = time, label
        else:
            self._say(f"the label {label} is ignored: expected -1, 0 or 1", True)

    def halt(self, why: str) -> None:
        """Breaks the mission off."""
        if not self.is_over:
            self.is_halted = True
            self._goal = None
            self._say(why, True)

    @property
    def is_over(self) -> bool:
        """Whether the mission has ended, or was broken off."""
        return self.is_halted or (self.planner is not None and self.planner.stop is not None)

    def tick(self, now: float) -> Pose | None:
        """Goes on with the mission. Returns a goal if one is to be sent now."""
        if self.is_over:
            return None
        if self.pose is None or now - self._heard > self.settings.position_timeout:
            self._say("waits for a position", self.pose is not None)
            return None
        try:
            if self._goal is not None:
                return self._go_on(now, self.pose, self._goal)
            if self.planner is None:
                if self.settings.at_rest and not self._is_still:
                    self._say("waits for the robot to rest")
                    return None
                self.planner = self._mission.planner(pose=self._told(self.pose))
                self._save()
            return self._next(now)
        except (BoundaryError, OSError) as error:
            self.halt(str(error))
            return None

    @property
    def _is_still(self) -> bool:
        return self._heard - self._rested >= self.settings.rest_seconds

    def _next(self, now: float) -> Pose | None:
        """The goal of the next motion, if there is one."""
        assert self.planner is not None
        self._goal, self._arrived, self._attempt, self._since = None, None, 1, now
        self._motion = self.planner.plan()
        if self._motion is None:
            self._say(f"the mission has ended: {self.planner.stop}")
            return None
        to = self._motion.pose
        self._goal = Pose(to["x"] - self.settings.origin[0], to["z"] - self.settings.origin[1], to["heading"])
        step = len(self.planner.state["done"]) + 1
        self._say(f"motion {step}: goes to ({self._goal.x:.2f}, {self._goal.y:.2f})")
        return self._goal

    def _go_on(self, now: float, pose: Pose, goal: Pose) -> Pose | None:
        """Sees whether the motion has ended. Returns the next goal, or the same one if it is to be sent again."""
        assert self._motion is not None
        it = self.settings
        metres, radians = pose.off(goal)
        # A robot that has not set out has not arrived, however short the motion.
        is_turn = self._motion.drive == 0.0
        nearest = it.arrive_metres if is_turn else min(it.arrive_metres, self._motion.drive / 2)
        closest = min(it.arrive_radians, abs(self._motion.turn) / 2) if is_turn else it.arrive_radians
        if metres <= nearest and radians <= closest and (self._is_still or not it.at_rest):
            if self._arrived is None:
                self._arrived = now
            self._since = now
            label = self._label_here(now) if self._motion.wants_label else None
            if label is None and self._motion.wants_label:
                self._say("at the goal: waits for a label", now - self._arrived > it.label_timeout)
                return None
            self._observe(pose, label)
            return self._next(now)
        self._arrived = None
        off = f"{metres:.2f} m and {radians:.2f} rad off its goal"
        if now - self._since > it.motion_timeout:
            self.halt(f"the motion does not end: the robot is {off}")
        elif self._is_still and now - max(self._since, self._rested) > it.patience:
            if self._attempt >= it.attempts:
                self.halt(f"the robot rests {off}, after {self._attempt} attempts")
                return None
            self._attempt, self._since = self._attempt + 1, now
            self._say(f"the robot rests {off}: attempt {self._attempt}", True)
            return goal
        return None

    def _label_here(self, now: float) -> int | None:
        """The label that was read at the end of the motion, if one was."""
        if self._label is None or self._arrived is None:
            return None
        time, label = self._label
        is_early = self.settings.at_rest and time < self._arrived
        return None if is_early or now - time > self.settings.label_age else label

    def _observe(self, pose: Pose, label: int | None) -> None:
        assert self.planner is not None
        told = self._told(pose)
        self.planner.observe(told, label)
        done = self.planner.answer["state"]["done"][-1]
        # An area in a system of coordinates is shifted by whole metres.
        self._shift = float(round(told["x"] - done["x"])), float(round(told["z"] - done["z"]))
        self._front += self.planner.answer["step"].get("mapped", ())
        self._label = None
        self._save()

    def _told(self, pose: Pose) -> dict[str, float]:
        """A pose as the scenario has them."""
        east, north = self.settings.origin
        return {"x": pose.x + east, "z": pose.y + north, "heading": pose.yaw}

    def _point(self, at: dict[str, float]) -> Point:
        """A position of an answer in the map frame."""
        (x, y), (east, north) = self._shift or (0.0, 0.0), self.settings.origin
        return at["x"] + x - east, at["z"] + y - north

    def _save(self) -> None:
        if self._saved is not None and self.planner is not None:
            kept = {"shift": self._shift, "front": self._front, "state": self.planner.answer["state"]}
            new = self._saved.with_name(self._saved.name + ".new")
            with new.open("w", encoding="utf-8") as file:
                json.dump(kept, file)
                file.flush()
                os.fsync(file.fileno())
            os.replace(new, self._saved)

    def _resume(self, saved: Path) -> None:
        try:
            kept = json.loads(saved.read_text(encoding="utf-8"))
            state = kept["state"]
            self.planner = self._mission.planner(pose=state["start"], state=state)
            self._shift, self._front = kept["shift"], kept["front"]
        except (ValueError, KeyError, TypeError) as error:
            raise BoundaryError(f"{saved} (delete it to begin anew): {error}") from error

    def _say(self, status: str, is_trouble: bool = False) -> None:
        self.status, self.is_trouble = status, is_trouble

    @property
    def path(self) -> list[Pose]:
        """The way of the motion that is being made: from its start to its goal, along the arc of a car."""
        if self.planner is None or self._motion is None or self._goal is None:
            return []
        state = self.planner.answer["state"]
        if state["done"]:
            (x, y), yaw = self._point(state["done"][-1]), state["done"][-1]["heading"]
        else:
            (east, north), yaw = self.settings.origin, state["start"]["heading"]
            x, y = state["start"]["x"] - east, state["start"]["z"] - north
        turn, drive, goal = self._motion.turn, self._motion.drive, self._goal
        bearing = math.atan2(goal.y - y, goal.x - x)
        if abs(math.remainder(bearing - goal.yaw, math.tau)) < abs(turn) / 4 or drive == 0.0 or turn == 0.0:
            return [Pose(x, y, yaw if drive == 0.0 else goal.yaw), goal]
        radius, parts = drive / turn, 16
        x, y = x - radius * math.sin(yaw), y + radius * math.cos(yaw)
        headings = (yaw + turn * part / parts for part in range(parts))
        return [*(Pose(x + radius * math.sin(it), y - radius * math.cos(it), it) for it in headings), goal]

    @property
    def samples(self) -> list[tuple[float, float, int]]:
        """Where labels were read: x, y and the label."""
        done = self.planner.answer["state"]["done"] if self.planner else []
        return [(*self._point(it), it["label"]) for it in done if it["label"] is not None]

    @property
    def front(self) -> list[list[Point]]:
        """The map of a front, in pieces."""
        end = (self.planner.answer["end"] if self.planner else None) or {}
        pieces: list[list[Point]] = []
        for it in [*self._front, *end.get("mapped", ())]:
            if it.get("begins") or not pieces:
                pieces.append([])
            pieces[-1].append(self._point(it["vertex"]))
        return pieces

    @property
    def line(self) -> list[Point]:
        """The estimated line as far as samples reach, unless a front is followed; two points, or none."""
        if self.planner is None or not self.samples or self.planner.known["bits"] <= 0.0:
            return []
        line = self.planner.estimate
        if self._front or "front" in (self.planner.answer["step"] or {}) or line is None or line["slope"] is None:
            return []
        x0, y0 = self._point({"x": 0.0, "z": line["intercept"]})
        cos, sin = math.cos(math.radians(line["angle"])), math.sin(math.radians(line["angle"]))
        along = [(x - x0) * cos + (y - y0) * sin for x, y, _ in self.samples]
        return [(x0 + t * cos, y0 + t * sin) for t in (min(along), max(along))]

    @property
    def markers(self) -> list[Marker]:
        """What to draw: samples by their labels, and the line or the front."""
        colours = {1: (0.1, 0.4, 0.9), 0: (0.5, 0.5, 0.5), -1: (0.9, 0.5, 0.1)}
        drawn = [
            Marker(f"label {label}", False, [(x, y) for x, y, it in self.samples if it == label], colour)
            for label, colour in colours.items()
        ]
        drawn += [Marker(f"front {k}", True, piece, (0.8, 0.1, 0.3)) for k, piece in enumerate(self.front)]
        drawn.append(Marker("estimate", True, self.line, (0.8, 0.1, 0.3)))
        return [it for it in drawn if len(it.points) > it.is_line]
