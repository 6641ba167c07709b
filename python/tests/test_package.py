"""Missions, planners, recordings and campaigns from Python."""

import json
import pickle
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import boundary_planner as b

LAKES = Path(__file__).parents[2] / "host-sim/scenarios/lakes"

ORACLE = [dict(x=2, z=1, label=-1), dict(x=2, z=18, label=1), dict(x=18, z=16, label=1), dict(x=18, z=2, label=-1)]
SOUGHT = dict(oracle=[], start=dict(x=3, z=3))
LINE = dict(slope=0.13, intercept=8.7)
BOAT = dict(kind="boat", reach=20, step=1, sharpest=0.5)

KINDS = [
    dict(algorithm="lookahead", steps=25, stop=dict(slope_arc_deg=20, audit=False)),
    dict(algorithm="lookahead", steps=14, noise=dict(p=0.9), readings=3),
    dict(algorithm="lookahead", steps=12, noise=dict(p=[8, 2]), stop=dict(slope_arc_deg=9.0)),
    dict(algorithm="cfc", steps=12, errors=dict(position=0.05, motion=0.1)),
    dict(algorithm="scc", steps=10, noise=dict(p=0.7, trusted_radius=1.0)),
    dict(algorithm="lookahead", steps=12, vehicle=dict(kind="car", radius=0.8), keep_out=[dict(x=6, z=7, radius=1.5)])
    | dict(start=dict(x=10, z=10, heading=1)),
    dict(algorithm="lookahead", steps=30, sensor=[dict(dropouts=0.1)], **SOUGHT),
    dict(algorithm="track", steps=60, truth=dict(circle=[11, 9, 5]), **SOUGHT),
    dict(algorithm="track", steps=40, front=dict(watch=8.0), noise=dict(p=0.9), **SOUGHT),
    dict(algorithm="lookahead", steps=40, area=dict(geojson=LAKES / "kyyvesi.geojson", cells=64), vehicle=BOAT)
    | dict(oracle=[], start=dict(lat=60.1990, lon=24.9020), truth=dict(slope=0.3, intercept=-40.0)),
]


def record(step):
    """A record of the trace, without what a planner does not know."""
    return json.dumps({key: value for key, value in step.items() if key not in ("record", "true_pose")})


@pytest.mark.parametrize("seed", range(1, 11))
@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_a_chain_of_plans_is_a_run(kind, seed):
    mission = b.Mission(**{"oracle": ORACLE, "truth": LINE, "seed": seed} | KINDS[kind])
    flight = mission.run()
    planner = mission.planner()
    for number, step in enumerate(flight.steps):
        motion = planner.plan()
        pose = step["pose"]
        if "lat" in motion.pose:
            pose = motion.pose  # nothing errs: it is the same place
        else:
            target = step.get("target", pose)
            assert motion.pose == pytest.approx({key: target[key] for key in motion.pose}, abs=1e-9)
        passed = step.get("readings", [])
        passed = passed[: len(passed) - (step["label"] is not None)]
        way = [{key: it[key] for key in ("x", "z", "label")} for it in passed]
        if number == 5:
            planner = pickle.loads(pickle.dumps(planner))
        planner.observe(pose, step["label"], way)
        assert record(planner.answer["step"]) == record(step)
    assert planner.plan() is None
    assert record(planner.answer["end"]) == record(flight.end)
    assert planner.stop == flight.end["reason"]
    if "front" not in flight.end:
        assert planner.estimate == flight.estimate


def test_a_file_and_keys_that_complete_it(tmp_path):
    path = tmp_path / "mission.toml"
    path.write_text('algorithm = "lookahead"\nsteps = 9\noracle = []\nstart = { x = 3, z = 3 }\n')
    keys = dict(algorithm="lookahead", steps=7, truth=LINE, **SOUGHT)
    assert b.Mission(path, steps=7, truth=LINE).run().trace == b.Mission(**keys).run().trace
    assert b.Planner(path).plan() == b.Planner(**keys).plan() == b.Mission(str(path)).planner().plan()
    assert repr(b.Mission(path, steps=7)) == f"Mission('{path}', steps=7)"


def test_what_a_flight_has():
    flight = b.Mission(**{"truth": LINE} | KINDS[7]).run()
    assert flight.track.shape == (len(flight.steps) + 1, 3)
    places, labels = flight.samples
    assert places.shape == (len(labels), 2) and set(labels.tolist()) == {-1, 1}
    assert len(flight.front) == flight.end["front"]["vertices"]
    assert flight.front[-1, 3] == flight.end["front"]["pieces"]
    from_middle = np.hypot(flight.front[:, 0] - 11, flight.front[:, 1] - 9)
    assert np.abs(from_middle - 5).max() < 1
    line = b.Mission(algorithm="lookahead", steps=20, oracle=ORACLE, truth=LINE).run()
    assert line.probability([[10, 8], [10, 12]]).tolist() == [0.0, 1.0]
    assert line.estimate["slope"] == pytest.approx(LINE["slope"], abs=0.01)
    assert flight.svg() == flight._repr_svg_() and "</svg>" in flight.svg() and "</html>" in flight.html()
    lake = b.Mission(**KINDS[9]).run().geojson()
    assert {it["properties"]["kind"] for it in lake["features"]} >= {"track", "sample"}


def test_a_label_that_contradicts_is_refused_and_forgotten():
    planner, other = (b.Planner(algorithm="lookahead", oracle=ORACLE, readings=2) for _ in range(2))
    with pytest.raises(b.BoundaryError, match="contradict"):
        planner.observe({"x": 2.0, "z": 18.5, "heading": 0.0}, -1, [{"x": 2.0, "z": 10.0, "label": 1}])
    assert planner.known == other.known
    for _ in range(5):
        motion = planner.plan()
        assert motion == other.plan()
        for it in (planner, other):
            it.observe(motion.pose, 1 if motion.pose["z"] > 5 else -1)
        assert planner.answer == other.answer


def test_labels_may_be_of_any_type():
    answers = []
    for label in (-1, False, np.False_, np.int8(-1), -1.0, np.float32(-1)):
        planner = b.Planner(algorithm="lookahead", **SOUGHT)
        planner.observe({"x": np.float64(3), "z": 4, "heading": 0}, label)
        answers.append(planner.answer)
    assert all(it == answers[0] for it in answers)


@pytest.mark.parametrize(
    "begin, words",
    [
        (lambda: b.Mission(oracle=ORACLE).run(), "truth: found none"),
        (lambda: b.Mission(oracle=ORACLE, truth=dict(slope=np.nan, intercept=3)).run(), 'truth.slope: found "nan"'),
        (lambda: b.Mission(oracle=ORACLE, truth=LINE, orcale=[]).run(), "orcale: found an unknown key"),
        (lambda: b.Mission(oracle=ORACLE, truth=LINE, steps=10.0).run(), "steps: found 10.0, expected a whole number"),
        (lambda: b.Planner(oracle=[dict(x=2, z=1, label=3)]), "the request: oracle.*label: found 3, expected -1 or 1"),
        (lambda: b.Planner(**SOUGHT).observe({"x": 1, "z": 2}, 1), "pose: found .*heading"),
        (lambda: b.Planner(**SOUGHT).observe((1, 2, 0), 1), "pose: found .*heading"),
        (lambda: b.Planner(**SOUGHT).observe(dict(x=1, z=np.inf, heading=0), 1), "the request: pose"),
        (lambda: b.Planner(**SOUGHT).observe(dict(x=1, z=2, heading=0), 0.5), "the request: label"),
        (lambda: b.Planner(**SOUGHT).observe(dict(x=1, z=2, heading=0), "wet"), "the request: label"),
        (lambda: b.Planner(**SOUGHT).probability([1, 2]), "places: found an array of shape .2,., expected rows"),
        (lambda: b.Planner(**SOUGHT).probability([[1, np.nan]]), "must be finite"),
        (lambda: b.Mission(oracle=ORACLE, truth=LINE).run().geojson(), "found an area in metres"),
        (lambda: b.command("nope"), "nope: found no such command"),
        (lambda: b.replay("nope.csv"), "nope.csv: found no such file"),
        (lambda: b.replay("--help"), "--help: found no such file"),
        (lambda: b.replay([[1, 2], [3, 4]], [1]), "labels: found 1, expected one for each of 2 places"),
        (lambda: b.replay([1, 2], [1, -1]), "places: found an array of shape"),
        (lambda: b.replay([[1, 2], [3, 4]], ["wet", "dry"]), '^samples.csv:2: label: found "wet"'),
        (lambda: b.replay([[1, 2], [3, 4]], [1, -1], p=2), "--p: found 2, expected a probability above 0.5"),
        (lambda: b.replay(np.empty((0, 2)), []), "^samples.csv: found no rows"),
        (lambda: b.campaign(range(0, 10, 2)), "fields: found range"),
        (lambda: b.campaign(2, fronts=True), "fronts: found, expected standard fields"),
        (lambda: b.campaign(2, progress=False, algoritm="cfc"), "--algoritm: found an unknown flag"),
    ],
)
def test_errors_have_the_words_of_the_command_line(begin, words):
    with pytest.raises(b.BoundaryError, match=words):
        begin()


def test_what_is_no_value_is_a_type_error():
    for begin in (
        lambda: b.Mission({"oracle": []}),
        lambda: b.Mission(oracle={1, 2}).run(),
        lambda: b.Planner({"oracle": []}),
        lambda: b.replay(np.zeros((3, 2))),
        lambda: b.replay(None),
        lambda: b.campaign(10.0),
    ):
        with pytest.raises(TypeError, match="found|integer"):
            begin()
    with pytest.raises(FileNotFoundError):
        b.Mission("nope.toml")


def test_a_spoilt_state_is_refused():
    planner = b.Mission(**KINDS[0], oracle=ORACLE).planner()
    for _ in range(4):
        motion = planner.plan()
        planner.observe(motion.pose, 1 if motion.pose["z"] > 9 else -1)
    good = json.dumps(planner.__getstate__()["state"])
    refused = 0
    for place, digit in enumerate(good):
        if digit.isdigit():
            spoilt = good[:place] + str((int(digit) + 1) % 10) + good[place + 1 :]
            try:
                state = json.loads(spoilt)
            except json.JSONDecodeError:
                continue
            if state == json.loads(good):
                continue  # a last digit beyond those of a float
            with pytest.raises(b.BoundaryError):
                b.Planner.__new__(b.Planner).__setstate__(planner.__getstate__() | {"state": state})
            refused += 1
    assert refused > 50
    other = b.Mission(**KINDS[0] | {"seed": 9}, oracle=ORACLE).planner()
    with pytest.raises(b.BoundaryError):
        other.__setstate__(other.__getstate__() | {"state": json.loads(good)})


def wet(places):
    return np.where(places[:, 1] > 0.41 * places[:, 0] + 3.5, 1, -1)


def test_replay_takes_arrays_frames_and_files(tmp_path):
    pandas = pytest.importorskip("pandas")
    places = np.random.default_rng(2).uniform(0, 20, (40, 2))
    labels = wet(places)
    frame = pandas.DataFrame({"x": places[:, 0], "z": places[:, 1], "label": labels})
    path = tmp_path / "samples.csv"
    frame.to_csv(path, index=False)
    told = b.replay(places, labels)
    assert abs(told.estimate["slope"] - 0.41) < 0.1 and "</svg>" in told._repr_svg_()
    others = frame.rename(columns={"x": "easting", "z": "northing", "label": "is_wet"})
    for again in (
        b.replay(frame),
        b.replay(path),
        b.replay(str(path)),
        b.replay(frame[["x", "z"]], frame.label),
        b.replay(places, labels > 0),
        b.replay(places, np.where(labels > 0, "yes", "no")),
        b.replay(places, labels + np.linspace(0, 0.1, 40), threshold=0.5),
        b.replay(others, columns={"x": "easting", "z": "northing", "label": "is_wet"}),
    ):
        assert again.estimate == told.estimate
    missing = labels.astype(float)
    missing[3] = np.nan
    assert b.replay(places, missing).record["skipped"] == {"rows": 1, "first": 5}
    assert b.replay(places, [None, *labels[1:]]).record["skipped"]["rows"] == 1
    degrees = pandas.DataFrame({"lat": 60 + places[:, 1] / 1e4, "lon": 25 + places[:, 0] / 1e4, "label": labels})
    assert {"centre", "sample"} <= {it["properties"]["kind"] for it in b.replay(degrees, geojson=True).geojson["features"]}


def test_replay_takes_geopandas():
    geopandas = pytest.importorskip("geopandas")
    places = np.random.default_rng(2).uniform(0, 200, (40, 2))
    points = geopandas.points_from_xy(400_000 + places[:, 0], 6_600_000 + places[:, 1], crs=32633)
    frame = geopandas.GeoDataFrame({"label": wet(places)}, geometry=points)
    answer = b.replay(frame, geojson=True)
    assert len(geopandas.GeoDataFrame.from_features(answer.geojson, crs=4326)) > 40


def test_replay_warns_where_no_line_fits():
    places = np.random.default_rng(3).uniform(0, 20, (200, 2))
    with pytest.warns(UserWarning, match="line"):
        b.replay(places, np.where(np.hypot(*(places - 10).T) < 6, 1, -1), p=0.95)


def test_rows_do_not_depend_on_blocks():
    rows = b.campaign(12, block=12, progress=False, compare=["cfc", "lookahead"])
    assert b.campaign(12, block=5, progress=False, compare=["cfc", "lookahead"]) == rows
    assert b.campaign(range(7, 12), progress=False, compare="cfc,lookahead") == [it for it in rows if it["field"] >= 7]
    assert rows[0]["algorithm"] == "cfc" and isinstance(rows[0]["bits"], float)


def test_a_dask_cluster_flies_the_same_rows():
    distributed = pytest.importorskip("distributed")
    flags = dict(progress=False, algorithm="lookahead", p=0.9, labels=10)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            assert b.campaign(23, block=4, client=client, **flags) == b.campaign(23, **flags)
            with pytest.raises(b.BoundaryError, match="--p: found 2"):
                b.campaign(23, client=client, **flags | {"p": 2})


class Counter(threading.Thread):
    """Counts on, as long as it gets the lock of the interpreter."""

    def __init__(self):
        super().__init__(daemon=True)
        self.count, self.goes_on = 0, True

    def run(self):
        while self.goes_on:
            self.count += 1
            time.sleep(1e-4)


@pytest.mark.parametrize(
    "work",
    [
        lambda: b.command("campaign", "--fields", 200, "--algorithm", "lookahead"),
        b.Mission(algorithm="lookahead", steps=60, noise=dict(p=0.7), oracle=ORACLE, truth=LINE).run,
    ],
)
def test_other_threads_go_on(work):
    counter = Counter()
    counter.start()
    while counter.count < 3:
        time.sleep(1e-4)
    before = counter.count
    work()
    progress = counter.count - before
    counter.goes_on = False
    assert progress > 20
