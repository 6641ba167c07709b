"""A planner for a robot that somebody else moves."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from boundary_planner import _native
from boundary_planner.values import Told, read_file, to_json, to_places


@dataclass(frozen=True)
class Motion:
    """A motion to make: turn, then drive (a car drives an arc), and end at a pose."""

    pose: dict[str, float]
    """Where it ends: `x`, `z` and `heading`, or `lat`, `lon` and `heading` in an area from a map."""
    turn: float
    """Radians."""
    drive: float
    """Metres."""
    wants_label: bool
    """Whether a label is wanted at its end."""
    chance: float | None
    """The chance that this label is +1."""
    bits: float | None
    """What it tells, on average."""


class Planner:
    """Tells motions, and is told what they came to.

    >>> planner = Planner(algorithm="lookahead", oracle=[], pose={"x": 2, "z": 1})
    >>> while motion := planner.plan():
    ...     pose = drive_to(motion)  # yours
    ...     planner.observe(pose, read_label() if motion.wants_label else None)
    >>> planner.stop, planner.estimate

    The keys are those of a scenario, and they complete a TOML file if one is given. `pose` is where the robot begins, and
    `samples` are labels of others that may be wrong. A planner can be pickled: it goes on where it was. So does a new one of
    the same keys with the `state` of the old one.
    """

    def __init__(
        self, path: str | Path | None = None, /, *, state: Mapping[str, Any] | None = None, **keys: Any
    ) -> None:
        self._begin((to_json(keys), read_file(path)), state)

    def _begin(self, begun: Told, state: Mapping[str, Any] | None = None) -> None:
        self._begun = begun
        again = _native.Planner.again
        self._native = _native.Planner(begun) if state is None else again(begun, to_json(dict(state)))
        self._ask()

    def _ask(self) -> None:
        self._answer: dict[str, Any] = json.loads(self._native.answer())

    def plan(self) -> Motion | None:
        """The next motion; None when the mission has ended. The same until `observe` is told of it."""
        answer = self._answer["next"]
        if answer is None:
            return None
        pose = {key: answer[key] for key in ("x", "z", "lat", "lon", "heading") if key in answer}
        why = self._answer["why"] or {"chance": None, "bits": None}
        return Motion(pose, answer["turn"], answer["drive"], answer["label"], why["chance"], why["bits"])

    def observe(
        self,
        pose: Mapping[str, float],
        label: int | bool | None,
        on_the_way: Iterable[Mapping[str, float]] = (),
    ) -> None:
        """Take in where the motion ended, and the label there: -1, 0 on the boundary, 1, or None if none was read.

        `pose` has the keys of `Motion.pose`. A label may be a bool: False is -1. `on_the_way` has what the sensor read
        before the end, as {"x": ..., "z": ..., "label": ...}.

        A label that contradicts what is known is a `BoundaryError`, and the planner stays as it was.
        """
        if not isinstance(pose, Mapping) or "heading" not in pose:
            raise _native.BoundaryError(f"pose: found {pose!r}, expected a table, with x, z (or lat, lon) and heading")
        if isinstance(label, (bool, np.bool_)):
            label = 1 if label else -1
        elif isinstance(label, (float, np.floating)) and label.is_integer():
            label = int(label)
        arrival = to_json({"pose": pose, "label": label, "on_the_way": list(on_the_way)})
        try:
            self._native.arrive(arrival)
        except _native.BoundaryError:
            self.__setstate__(self.__getstate__())
            raise
        self._ask()

    @property
    def stop(self) -> str | None:
        """Why the mission has ended, as in the trace; None before."""
        stop: str | None = self._answer["stop"]
        return stop

    @property
    def estimate(self) -> dict[str, Any] | None:
        """The recommended line: `slope`, `intercept`, and `angle` in degrees; of a front beside the robot alone."""
        estimate: dict[str, Any] | None = self.known["estimates"]["centre"]
        return estimate

    @property
    def known(self) -> dict[str, Any]:
        """What is known: `bits`, `slope_arcs`, `intercept`, `estimates`."""
        known: dict[str, Any] = self._answer["known"]
        return known

    @property
    def state(self) -> dict[str, Any]:
        """What was done so far, for a planner that goes on."""
        state: dict[str, Any] = json.loads(self._native.state())
        return state

    @property
    def answer(self) -> dict[str, Any]:
        """All of it, as docs/reference/next.md says."""
        return {**self._answer, "state": self.state}

    def probability(self, places: ArrayLike) -> NDArray[np.float64]:
        """As `Flight.probability`, by what is known now."""
        return self._native.chance(to_places(places))

    def __repr__(self) -> str:
        return f"<Planner: {self.stop or self.plan()}>"

    def __getstate__(self) -> dict[str, Any]:
        return {"begun": self._begun, "state": self.state}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._begin(state["begun"], state["state"])
