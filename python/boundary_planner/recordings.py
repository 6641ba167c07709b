"""What samples of your own determine, and many missions at once: what the commands of the command line do."""

from __future__ import annotations

import csv
import io
import json
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from boundary_planner import _native


def command(*words: str | Path | float) -> str:
    """What a command of `host-sim` prints, as `command("size", "--format", "json")`."""
    return _native.command([str(word) for word in words])


def _flags(flags: dict[str, Any]) -> list[str]:
    """Keywords as flags: `from_=3` is `--from 3`, `strict=True` is `--strict`."""
    words = []
    for key, value in flags.items():
        flag = "--" + key.rstrip("_").replace("_", "-")
        if isinstance(value, (list, tuple)):
            value = ",".join(map(str, value))
        if value is True:
            words += [flag]
        elif value is not None and value is not False:
            words += [flag, str(value)]
    return words


@dataclass(frozen=True)
class Replay:
    """What samples determine."""

    record: dict[str, Any]
    """All of it: docs/reference/recordings.md."""
    svg: str
    """A figure. Notebooks show it."""
    geojson: dict[str, Any] | None
    """For a map, if it was asked for."""

    @property
    def estimate(self) -> dict[str, Any] | None:
        """The recommended line or None: `slope`, `intercept`, and `angle` in degrees."""
        return self.record.get("estimates", {}).get("centre")

    def _repr_svg_(self) -> str:
        return self.svg


def replay(
    samples: Any, labels: ArrayLike | None = None, /, *, geojson: bool = False, **flags: Any
) -> Replay:
    """What samples determine: of a file, of a data frame, or of places and labels.

    `flags` are those of `host-sim replay`, as `p=0.9`, `front=20`, `tolerance=0.5`. `geojson` needs samples with latitude
    and longitude, or the system of their metres (`crs="EPSG:32633"`).

    >>> replay("samples.csv", p=0.9)
    >>> replay(frame, columns="x=easting,z=northing,label=wet")
    >>> replay(X, y)
    """
    with tempfile.TemporaryDirectory() as folder:
        if labels is not None:
            path = Path(folder) / "samples.csv"
            rows = np.column_stack([np.asarray(samples, dtype=float), np.asarray(labels, dtype=float)])
            with path.open("w", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(["x", "z", "label"])
                writer.writerows([repr(x), repr(z), int(label)] for x, z, label in rows.tolist())
        elif hasattr(samples, "to_crs"):
            path = Path(folder) / "samples.geojson"
            path.write_text((samples.to_crs(4326) if samples.crs else samples).to_json())
        elif hasattr(samples, "to_csv"):
            path = Path(folder) / "samples.csv"
            samples.to_csv(path, index=False)
        else:
            path = Path(samples)
        svg = Path(folder) / "figure.svg"
        words = [str(path), *_flags(flags), "--format", "json", "--figure", str(svg)]
        map_file = Path(folder) / "map.geojson"
        if geojson:
            words += ["--geojson", str(map_file)]
        record = json.loads(_native.command(["replay", *words]))
        return Replay(record, svg.read_text(), json.loads(map_file.read_text()) if geojson else None)


def campaign(
    fields: int | range = 1000, /, *, block: int = 50, progress: bool = True, **flags: Any
) -> list[dict[str, Any]]:
    """Fly standard fields, and return the rows that `host-sim campaign --csv` writes.

    `flags` are those of `host-sim campaign`, as `algorithm="lookahead"`, `p=0.9`. Fields are flown in blocks; `tqdm`, if it
    is installed, shows how far it is. `pandas.DataFrame(campaign(...))` is a table.
    """
    numbers = range(fields) if isinstance(fields, int) else fields
    starts: Iterable[int] = range(numbers.start, numbers.stop, block)
    if progress:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            pass
        else:
            starts = tqdm(starts, unit="block")
    rows = []
    for start in starts:
        rows += campaign_block(start, min(block, numbers.stop - start), flags)
    return rows


def campaign_block(start: int, count: int, flags: dict[str, Any]) -> list[dict[str, Any]]:
    """The rows of some fields: what a worker does."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rows.csv"
        words = ["campaign", "--from", str(start), "--fields", str(count), "--csv", str(path), *_flags(flags)]
        _native.command(words)
        reader = csv.DictReader(io.StringIO(path.read_text()))
        return [{key: _value(value) for key, value in row.items()} for row in reader]


def _value(text: str) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text or None
