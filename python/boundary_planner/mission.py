"""Missions in a simulated world."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from boundary_planner import _native
from boundary_planner.planner import Planner
from boundary_planner.values import read_file, to_json, to_places


class Mission:
    """A scenario: keys of its own, and a TOML file whose other keys they complete.

    >>> Mission(oracle=[], truth={"slope": 0.4, "intercept": 3.5}, start={"x": 2, "z": 1}, algorithm="lookahead")
    >>> Mission("lake.toml", steps=200)
    """

    def __init__(self, path: str | Path | None = None, /, **keys: Any) -> None:
        self.keys = keys
        self._file = read_file(path)

    @property
    def name(self) -> str:
        """What figures are called."""
        return Path(self._file[0]).stem if self._file else "mission"

    def run(self) -> Flight:
        """Fly it in the simulated world. Other Python threads go on meanwhile."""
        return Flight(self, _native.run((to_json(self.keys), self._file)))

    def planner(self, *, state: Mapping[str, Any] | None = None, **keys: Any) -> Planner:
        """A planner for a robot that somebody else moves; `keys` take the place of the mission's."""
        planner = Planner.__new__(Planner)
        planner._begin((to_json({**self.keys, **keys}), self._file), state)
        return planner

    def __repr__(self) -> str:
        keys = ", ".join(f"{key}={value!r}" for key, value in self.keys.items())
        return f"Mission({', '.join(filter(None, [repr(self._file[0]) if self._file else '', keys]))})"


class Flight:
    """A mission that was flown: its trace, arrays and pictures. Positions are in metres, headings in radians."""

    def __init__(self, mission: Mission, native: _native.Flight) -> None:
        self.mission = mission
        self._native = native
        for doubt in native.doubts():
            warnings.warn(f"{mission.name}: {doubt}", stacklevel=3)
        if native.refusal:
            warnings.warn(f"{mission.name}: {native.refusal}", stacklevel=3)

    @property
    def refusal(self) -> str | None:
        """Why it was broken off, if a label contradicted what was known."""
        return self._native.refusal

    @cached_property
    def trace(self) -> str:
        """The trace, as JSON Lines: docs/reference/trace.md."""
        return self._native.trace()

    @cached_property
    def records(self) -> list[dict[str, Any]]:
        """The records of the trace."""
        return [json.loads(line) for line in self.trace.splitlines()]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The records of its steps."""
        return self.records[1:-1]

    @property
    def end(self) -> dict[str, Any]:
        """The record of its end."""
        return self.records[-1]

    @property
    def estimate(self) -> dict[str, Any] | None:
        """The recommended line: `slope`, `intercept`, and `angle` in degrees; None of a front, which `front` has."""
        estimate: dict[str, Any] | None = self.end["estimates"]["centre"]
        return estimate

    @property
    def track(self) -> NDArray[np.float64]:
        """Where it was at the start and after each step: rows of x, z and heading."""
        poses = [self.records[0]["pose"], *(step["pose"] for step in self.steps)]
        return np.array([[pose["x"], pose["z"], pose["heading"]] for pose in poses])

    @property
    def samples(self) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
        """Places and labels, the given ones first, as X and y."""
        given = [(it["x"], it["z"], it["label"]) for it in self.records[0]["oracle"]]
        read = [
            (step["pose"]["x"], step["pose"]["z"], step["label"])
            for step in self.steps
            if step["label"] is not None
        ]
        rows = np.array(given + read, dtype=float).reshape(-1, 3)
        return rows[:, :2], rows[:, 2].astype(np.int8)

    @property
    def front(self) -> NDArray[np.float64]:
        """The map of a front: rows of x, z, the half-width that holds 90 %, and the number of the piece; metres."""
        rows: list[list[float]] = []
        piece = 0
        for record in [*self.steps, self.end]:
            for place in record.get("mapped", ()):
                piece += place.get("begins", False)
                at = place["vertex"]
                rows.append([at["x"], at["z"], at["half_width"], piece])
        return np.array(rows, dtype=float).reshape(-1, 4)

    def probability(self, places: ArrayLike) -> NDArray[np.float64]:
        """The chance that the robot's sensor reads +1 at each place, by what is known in the end.

        Places are rows of x and z, metres: in an area from a map to the east and the north of the middle of its bounds.
        Of a front that was followed the answer is good beside the robot alone; `front` has the map.
        """
        return self._native.chance(to_places(places))

    def geojson(self) -> dict[str, Any]:
        """Track, samples and what was found, for a map; of an area from a map."""
        features: dict[str, Any] = json.loads(self._native.geojson())
        return features

    def svg(self) -> str:
        """A figure. Notebooks show it."""
        return self._native.svg(self.mission.name)

    def html(self) -> str:
        """A page to step through the mission, in one file."""
        return self._native.html(self.mission.name)

    def _repr_svg_(self) -> str:
        return self.svg()

    def __repr__(self) -> str:
        return f"<Flight of {self.mission.name}: {len(self.steps)} steps, {self.end['reason']}>"
