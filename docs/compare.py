#!/usr/bin/env python3
"""Libraries for active learning beside our planners, on the same standard fields in one run.

    python3 -m venv venv
    venv/bin/pip install modAL-python==0.4.2.1 scikit-activeml==0.5.2 scikit-learn==1.5.2
    cargo build --release
    venv/bin/python docs/compare.py target/release/host-sim

Both libraries do margin sampling: they ask at the place of a pool that is nearest to the line of a linear SVC. They jump
anywhere in the pool, or they walk: then only places within 2 m count. Their estimate is the line of the SVC of all labels
so far. The slope error is the angle between the estimated and the true line, in degrees; of ours that of the centre.
Metres are those between the places. modAL 0.4.2.1 needs a scikit-learn that is so old.
"""

import argparse
import csv
import math
import statistics
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np
from modAL.models import ActiveLearner
from modAL.uncertainty import margin_sampling
from skactiveml.classifier import SklearnClassifier
from skactiveml.pool import UncertaintySampling
from sklearn.svm import SVC

SIDE = 20.0
POOL = 81  # places along each side of the area
REACH = 2.0
LABELS = (5, 10, 20)
PLANNERS = {
    "look-ahead, a label each motion": ["--algorithm", "lookahead", "--steps", str(max(LABELS))],
    "look-ahead, few labels": ["--algorithm", "lookahead", "--steps", "400", "--labels", None],
    "two chords": ["--algorithm", "chords", "--steps", "400", "--labels", None],
}


class LinearSvc(SVC):
    """A hard-margin linear SVC whose classes are as likely as they are near: what margin sampling reads."""

    def __init__(self):
        super().__init__(kernel="linear", C=1e6)

    def predict_proba(self, X):
        likely = 1.0 / (1.0 + np.exp(-np.clip(self.decision_function(X), -500, 500)))
        return np.column_stack([1.0 - likely, likely])


class Modal:
    name = "modAL"

    def __init__(self, places, labels):
        self.learner = ActiveLearner(LinearSvc(), margin_sampling, places, labels)

    def query(self, pool):
        return self.learner.query(pool)[0][0]

    def teach(self, place, label):
        self.learner.teach(place[None], [label])

    def normal(self):
        return self.learner.estimator.coef_[0]


class ActiveMl:
    name = "scikit-activeml"

    def __init__(self, places, labels):
        self.places, self.labels = places, labels
        self.classifier = SklearnClassifier(LinearSvc(), classes=[-1, 1])
        self.sampling = UncertaintySampling(method="margin_sampling", random_state=1)

    def query(self, pool):
        return self.sampling.query(self.places, self.labels, self.classifier, candidates=pool)[0]

    def teach(self, place, label):
        self.places = np.vstack([self.places, place])
        self.labels = np.append(self.labels, label)

    def normal(self):
        fitted = self.classifier.fit(self.places, self.labels)
        return fitted.estimator_.coef_[0]


def angle(normal, truth):
    """Between two lines by their normals, degrees."""
    cross = normal[0] * truth[1] - normal[1] * truth[0]
    dot = normal[0] * truth[0] + normal[1] * truth[1]
    return math.degrees(math.atan2(abs(cross), abs(dot)))


def by_library(library, field, pool, reach):
    """Slope error and metres after so many labels."""
    number = {name: float(value) for name, value in field.items()}
    places = np.array([[number[f"x{k}"], number[f"z{k}"]] for k in range(1, 5)])
    labels = np.array([int(number[f"label{k}"]) for k in range(1, 5)])
    truth = np.array([number["a"], number["b"]])
    left, at, metres, found = pool, places[0], 0.0, {}
    learner = library(places, labels)
    for asked in range(1, max(LABELS) + 1):
        near = np.flatnonzero(np.linalg.norm(left - at, axis=1) <= reach)
        index = near[learner.query(left[near])]
        place = left[index]
        left = np.delete(left, index, axis=0)
        metres, at = metres + np.linalg.norm(place - at), place
        learner.teach(place, 1 if place @ truth + number["c"] > 0 else -1)
        if asked in LABELS:
            found[asked] = (angle(learner.normal(), truth), metres)
    return found


def by_us(program, flags, fields, seed, folder):
    """The same of one of our planners. With few labels each count of them is a campaign of its own."""
    found = {at: [] for at in LABELS}
    for at in LABELS:
        rows = folder / "rows.csv"
        rows.unlink(missing_ok=True)
        flags_of = [str(at) if flag is None else flag for flag in flags]
        subprocess.run(
            [program, "campaign", "--fields", str(fields), "--seed", str(seed), "--csv", rows] + flags_of,
            check=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        with open(rows, newline="") as file:
            for row in csv.DictReader(file):
                if int(row["step"]) == at:
                    found[at].append((float(row["centre_deg"]), float(row["metres"])))
    return found


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program", type=Path, help="host-sim")
    arguments.add_argument("--fields", type=int, default=100)
    arguments.add_argument("--seed", type=int, default=1)
    arguments = arguments.parse_args()
    program = arguments.program.resolve()
    # modAL calls scikit-learn in an older way, which that tells at every query.
    warnings.simplefilter("ignore")
    side = np.linspace(0.0, SIDE, POOL)
    pool = np.array([[x, z] for x in side for z in side])
    results = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        fields_csv = folder / "fields.csv"
        subprocess.run(
            [program, "campaign", "--fields", str(arguments.fields), "--seed", str(arguments.seed), "--steps", "1"]
            + ["--fields-csv", fields_csv],
            check=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        with open(fields_csv, newline="") as file:
            fields = list(csv.DictReader(file))
        for library in (Modal, ActiveMl):
            for way, reach in (("jumps", math.inf), ("walks", REACH)):
                of_each = [by_library(library, field, pool, reach) for field in fields]
                found = {at: [of_field[at] for of_field in of_each] for at in LABELS}
                results.append((f"{library.name}, {way}", found))
        for name, flags in PLANNERS.items():
            results.append((name, by_us(program, flags, len(fields), arguments.seed, folder)))
    print(f"{len(fields)} standard fields, seed {arguments.seed}: slope error, degrees, median (90th percentile); metres")
    print("| planner | " + " | ".join(f"{at} labels" for at in LABELS) + " |")
    print("| --- |" + " --- |" * len(LABELS))
    for name, found in results:
        cells = []
        for at in LABELS:
            errors, metres = zip(*found[at])
            ninety = sorted(errors)[math.ceil(0.9 * len(errors)) - 1]
            cells.append(f"{statistics.median(errors):.3g} ({ninety:.3g}); {statistics.mean(metres):.1f}")
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    sys.exit(main())
