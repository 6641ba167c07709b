"""Missions in a simulated world."""

from __future__ import annotations

import json
import warnings
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from boundary_planner import _native
from boundary_planner.planner import Planner

Told = tuple[str, tuple[str, str, str] | None]


class Mission:
    """A scenario: keys of its own, and a TOML file whose other keys they complete.

    >>> Mission(oracle=[], truth={"slope": 0.4, "intercept": 3.5}, start={"x": 2, "z": 1}, algorithm="lookahead")
    >>> Mission("lake.toml", steps=200)
    """

    def __init__(self, path: str | Path | None = None, /, **keys: Any) -> None:
        self.keys = keys
        self._file: tuple[str, str, str] | None = None
        if path is not None:
            path = Path(path)
            self._file = (str(path), path.read_text(encoding="utf-8"), str(path.parent))

    @property
    def name(self) -> str:
        """What figures are called."""
        return Path(self._file[0]).stem if self._file else "mission"

    def _told(self) -> Told:
        return json.dumps(self.keys, default=_plain), self._file

    def run(self) -> Flight:
        """Fly it in the simulated world. Other Python threads go on meanwhile."""
        return Flight(self, _native.run(self._told()))

    def planner(self, **keys: Any) -> Planner:
        """A planner for a robot that somebody else moves; `keys` as `Planner` has them."""
        return Planner(self._file, **{**self.keys, **keys})

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
        """The recommended line: `slope`, `intercept`, and `angle` in degrees."""
        return self.end["estimates"].get("centre")

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
        """The map of a front: rows of x, z and the half-width that holds 90 %, metres."""
        places = [*(it for step in self.steps for it in step.get("mapped", ())), *self.end.get("mapped", ())]
        return np.array([[it["x"], it["z"], it["half_width"]] for it in places]).reshape(-1, 3)

    def probability(self, places: ArrayLike) -> NDArray[np.float64]:
        """The chance that the robot's sensor reads +1 at each place, by what is known in the end."""
        return self._native.chance(_places(places))

    def geojson(self) -> dict[str, Any]:
        """Track, samples and what was found, for a map; of an area from a map."""
        return json.loads(self._native.geojson())

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


def _places(places: ArrayLike) -> NDArray[np.float64]:
    array = np.ascontiguousarray(places, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2:
        raise _native.BoundaryError(f"places: found an array of shape {array.shape}, expected rows of x and z")
    return array


def _plain(value: Any) -> Any:
    """Arrays and numbers of numpy, as JSON has them."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"found {type(value).__name__}, expected what JSON has: {value!r}")
