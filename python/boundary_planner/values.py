"""Values of Python as the native module reads them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from boundary_planner._native import BoundaryError

File = tuple[str, str, str]
"""The name, the text and the folder of a scenario file."""

Told = tuple[str, File | None]
"""A scenario: its keys in JSON, and the file whose keys they complete."""


def read_file(path: str | Path | None) -> File | None:
    """A scenario file, read once."""
    if path is None:
        return None
    if not isinstance(path, (str, Path)):
        raise TypeError(f"found {type(path).__name__}, expected the path of a scenario file, or keys as keywords")
    return str(path), Path(path).read_text(encoding="utf-8"), str(Path(path).parent)


def to_json(value: Any) -> str:
    """JSON, of arrays and paths too."""
    return json.dumps(_plain(value))


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(it) for key, it in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(it) for it in value]
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)  # JSON has no such number: the native module reads its name, or refuses it with its key
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"found {type(value).__name__}, expected what JSON has: {value!r}")


def to_places(places: ArrayLike) -> NDArray[np.float64]:
    """Rows of two coordinates."""
    array = np.ascontiguousarray(places, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2:
        raise BoundaryError(f"places: found an array of shape {array.shape}, expected rows of x and z")
    return array
