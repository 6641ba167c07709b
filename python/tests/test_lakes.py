"""Missions in ten lakes as maps have them. No motion leaves the water, by the geometry and the projection of others.

Forty missions, four in a lake; with `LONG=1` a thousand.
"""

from __future__ import annotations

import math
import os
import random
from collections import Counter
from pathlib import Path

import geopandas
import numpy as np
import pytest
import shapely
from boundary_planner import BoundaryError, Flight, Mission
from PIL import Image
from PIL.TiffImagePlugin import ImageFileDirectory_v2

LAKES = sorted((Path(__file__).parents[2] / "host-sim/scenarios/lakes").glob("*.geojson"))
VEHICLES = [
    {"kind": "boat", "reach": 10.0, "step": 0.5, "sharpest": 0.5},
    {"kind": "car", "reach": 10.0, "step": 0.5, "radius": 4.0},
    {"kind": "unicycle", "reach": 10.0, "step": 0.5},
]
COUNT = 1_000 if os.environ.get("LONG") else 40


def fly(number: int, lake: Path, water: shapely.Geometry) -> Flight:
    """A line or a spill somewhere in the lake, and a start on the water."""
    draw = random.Random(number)
    k = number // len(LAKES)
    noisy, follows = k // 3 % 2 == 1, k // 6 % 2 == 1
    angle, x, z = draw.uniform(0, math.tau), draw.uniform(-150, 150), draw.uniform(-150, 150)
    a, b = math.sin(angle), math.cos(angle)
    keys = {
        "algorithm": "track" if follows else "lookahead",
        "steps": 60 if noisy else 200,
        "seed": number,
        "area": {"geojson": str(lake)},
        "vehicle": VEHICLES[k % 3],
        "oracle": [],
        "truth": {"circle": [x, z, 80.0]} if follows else {"line": [a, b, -a * x - b * z]},
    }
    if noisy:
        keys["noise"] = {"p": 0.9, "trusted_radius": 0.0}
    if k % 2:
        keys["errors"] = {"position": 0.3}
    west, south, east, north = water.bounds
    for _ in range(1_000):
        lon, lat = draw.uniform(west, east), draw.uniform(south, north)
        if water.contains(shapely.Point(lon, lat)):
            try:
                return Mission(**keys, start={"lat": lat, "lon": lon}).run()
            except BoundaryError as refused:
                assert "start: found" in str(refused)  # too near the shore
    raise AssertionError("no start on the water")


def swept(pose: dict[str, float], step: dict, is_car: bool) -> shapely.Geometry:
    """What a motion passes over: a line, or the arc of a car."""
    end, turn = step["pose"], step["action"]["w"]
    if not is_car or abs(turn) < 1e-9:
        return shapely.LineString([(pose["x"], pose["z"]), (end["x"], end["z"])])
    radius, heading = step["action"]["v"] / turn, pose["heading"]
    angles = heading + turn * np.linspace(0.0, 1.0, 41)
    x = pose["x"] + radius * (np.sin(angles) - math.sin(heading))
    z = pose["z"] - radius * (np.cos(angles) - math.cos(heading))
    return shapely.LineString(np.column_stack([x, z]))


@pytest.mark.filterwarnings("ignore")
def test_no_motion_leaves_the_water() -> None:
    assert len(LAKES) == 10
    ends: Counter[str] = Counter()
    for number in range(COUNT):
        lake = LAKES[number % len(LAKES)]
        degrees = geopandas.read_file(lake).union_all()
        flight = fly(number, lake, degrees)
        west, south, east, north = degrees.bounds
        middle = f"+lat_0={(south + north) / 2:.4f} +lon_0={(west + east) / 2:.4f}"
        metres = geopandas.GeoSeries([degrees], crs=4326).to_crs(f"+proj=aeqd {middle} +datum=WGS84")[0]
        pose, is_car = flight.records[0]["pose"], flight.mission.keys["vehicle"]["kind"] == "car"
        for step in flight.steps:
            way = swept(pose, step, is_car)
            assert metres.covers(way), (number, lake.stem, step)
            pose = step["pose"]
            true = step.get("true_pose", pose)
            assert metres.covers(shapely.Point(true["x"], true["z"])), (number, lake.stem, step)
        ends[flight.end["reason"]] += 1
    print(dict(ends))
    assert ends.total() == COUNT


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("size", [200, 9])
@pytest.mark.parametrize("system", [32635, 32634, 4326])
@pytest.mark.parametrize("kind", ["asc", "tif"])
def test_a_raster_lies_where_its_system_says(kind: str, system: int, size: int, tmp_path: Path) -> None:
    """A spill as a grid of a map, by PROJ: UTM in its zone and beside it, and degrees; fine cells and coarse ones.

    A GeoTIFF says its system itself.

    Each label is that of the cell that PROJ finds, unless the place lies within a seventh of a cell of another.
    """
    lat, lon, radius = 60.2003, 24.9021, 90.0
    spill = geopandas.GeoSeries([shapely.Point(lon, lat)], crs=4326)
    spill = spill.to_crs(f"+proj=aeqd +lat_0={lat} +lon_0={lon} +datum=WGS84").buffer(radius, quad_segs=200)
    spill = spill.to_crs(system)[0]
    west, south, east, north = spill.bounds
    west, south, east, north = (5 * west - east) / 4, (5 * south - north) / 4, (5 * east - west) / 4, (5 * north - south) / 4
    dx, dy = (east - west) / size, (north - south) / size
    x, y = west + dx * (np.arange(size) + 0.5), north - dy * (np.arange(size) + 0.5)
    inside = shapely.contains_xy(spill, *np.meshgrid(x, y)).astype(int)
    rows = "\n".join(" ".join(map(str, row)) for row in inside)
    head = f"ncols {size}\nnrows {size}\nxllcorner {west!r}\nyllcorner {south!r}\ndx {dx!r}\ndy {dy!r}\n"
    (tmp_path / "spill.asc").write_text(head + rows)
    tags = ImageFileDirectory_v2()
    tags[33550], tags[33922] = (dx, dy, 0.0), (0.0, 0.0, 0.0, west, north, 0.0)
    tags.tagtype[33550] = tags.tagtype[33922] = 12
    own = [1024, 0, 1, 2, 2048, 0, 1, 4326] if system == 4326 else [1024, 0, 1, 1, 3072, 0, 1, system]
    tags[34735], tags.tagtype[34735] = (1, 1, 0, 2, *own), 3
    Image.fromarray(inside.astype(np.uint8)).save(tmp_path / "spill.tif", tiffinfo=tags)
    crs = {} if system == 4326 or kind == "tif" else {"crs": f"EPSG:{system}"}
    lake = next(it for it in LAKES if it.stem == "kyyvesi")
    flight = Mission(
        area={"geojson": str(lake)},
        algorithm="track",
        steps=150,
        oracle=[],
        start={"lat": lat, "lon": lon},
        vehicle=VEHICLES[2],
        truth={"raster": str(tmp_path / f"spill.{kind}"), "threshold": 0.5, **crs},
    ).run()
    labels = []
    for feature in flight.geojson()["features"]:
        if feature["geometry"]["type"] == "Point" and "label" in feature["properties"]:
            place = shapely.Point(feature["geometry"]["coordinates"])
            at = geopandas.GeoSeries([place], crs=4326).to_crs(system)[0]
            label = feature["properties"]["label"]
            near = [(at.x + u * dx / 7, at.y + v * dy / 7) for u in (-1, 0, 1) for v in (-1, 0, 1)]
            # Outside the raster the nearest cell counts.
            cells = {
                inside[min(max(int((north - q) // dy), 0), size - 1), min(max(int((p - west) // dx), 0), size - 1)]
                for p, q in near
            }
            labels.append(label)
            assert len(cells) == 2 or cells == {int(label == 1)}, feature
    assert min(labels.count(-1), labels.count(1)) > 10
