"""Find and map a boundary from few yes-or-no readings.

`Mission` flies a scenario in a simulated world. `Planner` tells a robot of yours its motions. `replay` says what samples
that you have determine, and `LineClassifier` is the same as an estimator of scikit-learn. `campaign` flies many missions.

Scenarios have the keys of docs/reference/scenario.md, whether they stand in a TOML file or are arguments here.
"""

from boundary_planner._native import BoundaryError
from boundary_planner.mission import Flight, Mission
from boundary_planner.planner import Motion, Planner
from boundary_planner.recordings import Replay, campaign, command, replay

__all__ = [
    "BoundaryError",
    "Flight",
    "LineClassifier",
    "Mission",
    "Motion",
    "Planner",
    "Replay",
    "campaign",
    "command",
    "replay",
]


def __getattr__(name: str) -> object:
    if name == "LineClassifier":  # scikit-learn takes a second to import
        from boundary_planner.learn import LineClassifier

        return LineClassifier
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
