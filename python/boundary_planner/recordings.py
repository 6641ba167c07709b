"""What samples of your own determine, and many missions at once: what the commands of the command line do."""

from __future__ import annotations

import csv
import json
import os
import tempfile
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from operator import index
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from boundary_planner import _native
from boundary_planner.values import to_places

if TYPE_CHECKING:
    from distributed import Client


def command(*words: str | Path | float) -> str:
    """What a command of `host-sim` prints, as `command("size", "--format", "json")`."""
    return _native.command([str(word) for word in words])


def _flags(flags: dict[str, Any]) -> list[str]:
    """Keywords as flags: `told_speed=0` is `--told-speed 0`, `strict=True` is `--strict`."""
    words = []
    for key, value in flags.items():
        flag = "--" + key.rstrip("_").replace("_", "-")
        if isinstance(value, Mapping):
            value = [f"{name}={it}" for name, it in value.items()]
        if isinstance(value, (list, tuple)):
            value = ",".join(map(str, value))
        if value is True:
            words += [flag]
        elif value is not None and value is not False:
            words += [f"{flag}={value}"]
    return words


@contextmanager
def _folder() -> Iterator[Path]:
    """A folder for files in between, whose place is left out of messages."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            yield Path(folder)
        except _native.BoundaryError as why:
            raise _native.BoundaryError(str(why).replace(folder + os.sep, "")) from None


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
        estimate: dict[str, Any] | None = self.record.get("estimates", {}).get("centre")
        return estimate

    def _repr_svg_(self) -> str:
        return self.svg


def replay(
    samples: Any, labels: ArrayLike | None = None, /, *, geojson: bool = False, **flags: Any
) -> Replay:
    """What samples determine: of a file, of a data frame, or of places and labels.

    `flags` are those of `host-sim replay`, as `p=0.9`, `front=20`, `tolerance=0.5`. Labels are of the kinds that a file
    may have. `geojson` needs samples with latitude and longitude, or the system of their metres (`crs="EPSG:32633"`).
    Warns if no straight line fits.

    >>> replay("samples.csv", p=0.9)
    >>> replay(frame, columns={"x": "easting", "z": "northing", "label": "wet"})
    >>> replay(X, y)
    """
    with _folder() as folder:
        path = _samples_file(samples, labels, folder)
        svg, map_file = folder / "figure.svg", folder / "map.geojson"
        words = ["replay", *_flags(flags), "--format", "json", "--figure", str(svg)]
        if geojson:
            words += ["--geojson", str(map_file)]
        record = json.loads(_native.command([*words, "--", str(path)]))
        fit = record.get("fit")
        if fit and fit["verdict"] not in ("fits", "p too low"):
            warnings.warn(" ".join(filter(None, [fit["says"], fit["advice"]])), stacklevel=2)
        return Replay(record, svg.read_text(), json.loads(map_file.read_text()) if geojson else None)


def _samples_file(samples: Any, labels: ArrayLike | None, folder: Path) -> Path:
    """The samples as a file that the command reads."""
    if labels is not None:
        places, found = to_places(samples).tolist(), np.asarray(labels, dtype=object).ravel().tolist()
        if len(places) != len(found):
            raise _native.BoundaryError(f"labels: found {len(found)}, expected one for each of {len(places)} places")
        path = folder / "samples.csv"
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["x", "z", "label"])
            writer.writerows([*place, label] for place, label in zip(places, found))
    elif hasattr(samples, "to_crs"):
        path = folder / "samples.geojson"
        path.write_text((samples.to_crs(4326) if samples.crs else samples).to_json(), encoding="utf-8")
    elif hasattr(samples, "to_csv"):
        path = folder / "samples.csv"
        samples.to_csv(path, index=False)
    elif isinstance(samples, (str, Path)):
        path = Path(samples)
    else:
        raise TypeError(
            f"samples: found {type(samples).__name__}, expected a file, a data frame, or places and their labels"
        )
    return path


def campaign(
    fields: int | range = 1000,
    /,
    *,
    block: int = 50,
    client: Client | None = None,
    progress: bool = True,
    **flags: Any,
) -> list[dict[str, Any]]:
    """Fly standard fields, and return the rows that `host-sim campaign --csv` writes.

    `flags` are those of `host-sim campaign`, as `algorithm="lookahead"`, `p=0.9`. Fields are flown in blocks, by the
    workers of `client` (a `dask.distributed.Client`) if there is one: the rows are the same. `tqdm`, if it is installed,
    shows how far it is. `pandas.DataFrame(campaign(...))` is a table.
    """
    numbers = fields if isinstance(fields, range) else range(index(fields))
    if numbers.step != 1:
        raise _native.BoundaryError(f"fields: found {numbers}, expected numbers one after the other")
    for key in ("fronts", "patches"):
        if flags.get(key):
            advice = f'command("campaign", "--{key}", "--format", "json")'
            raise _native.BoundaryError(f"{key}: found, expected standard fields; {advice} has no rows but their means")
    starts = range(numbers.start, numbers.stop, block)
    counts = [min(block, numbers.stop - start) for start in starts]
    fly = partial(campaign_block, flags=flags)
    blocks: Iterable[list[dict[str, Any]]]
    if client is None:
        blocks = map(fly, starts, counts)
    else:
        futures = client.map(fly, starts, counts, pure=False)
        blocks = (future.result() for future in futures)
    if progress:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            pass
        else:
            blocks = tqdm(blocks, total=len(starts), unit="block")
    rows = [row for rows in blocks for row in rows]
    # With `compare` those of one planner follow those of the other, as without blocks.
    planners = list(dict.fromkeys(row.get("algorithm") for row in rows))
    return sorted(rows, key=lambda row: planners.index(row.get("algorithm")))


def campaign_block(start: int, count: int, flags: dict[str, Any]) -> list[dict[str, Any]]:
    """The rows of some fields: what a worker does."""
    with _folder() as folder:
        path = folder / "rows.csv"
        words = ["campaign", "--from", str(start), "--fields", str(count), "--csv", str(path), *_flags(flags)]
        _native.command(words)
        with path.open(newline="") as file:
            return [{key: _value(value) for key, value in row.items()} for row in csv.DictReader(file)]


def _value(text: str) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text or None
