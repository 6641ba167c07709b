"""The estimator of scikit-learn, and libraries for active learning with it."""

import pickle
import warnings

import numpy as np
import pytest

pytest.importorskip("sklearn")

from sklearn.base import clone  # noqa: E402
from sklearn.utils.estimator_checks import parametrize_with_checks  # noqa: E402

from boundary_planner import LineClassifier  # noqa: E402


@parametrize_with_checks([LineClassifier(), LineClassifier(p=0.7, tolerance=0.1)])
def test_scikit_learn_checks(estimator, check):
    check(estimator)


def drawn(count, seed=1, wrong=0.0):
    rng = np.random.default_rng(seed)
    places = rng.uniform(0, 20, (count, 2))
    labels = np.where(places[:, 1] > 0.41 * places[:, 0] + 3.5, "wet", "dry")
    flipped = rng.uniform(size=count) < wrong
    return places, np.where(flipped, np.where(labels == "wet", "dry", "wet"), labels)


def twin(places, is_second, p, grid, angles=3000, offsets=1500):
    """The chance of the second label: lines drawn evenly, by angle and offset, and weighed by the labels."""
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    half = np.ptp(places, axis=0) / 2
    reach = np.maximum(1.25 * half, half.max() / 8)
    near, far = places - middle, grid - middle
    total, above = 0.0, np.zeros(len(grid))
    for angle in (np.arange(angles) + 0.5) / angles * 2 * np.pi:
        normal = np.array([np.cos(angle), np.sin(angle)])
        most = np.abs(normal) @ reach
        offset = (np.arange(offsets) + 0.5) / offsets * 2 * most - most
        agrees = ((near @ normal)[:, None] > offset) == is_second[:, None]
        weight = np.where(agrees, p, 1 - p).prod(axis=0) * most / offsets
        total += weight.sum()
        edges = np.linspace(-most, most, offsets + 1)
        above += np.interp(far @ normal, edges, np.concatenate([[0.0], weight.cumsum()]))
    return 1 - p + (2 * p - 1) * above / total


@pytest.mark.parametrize("p, count", [(0.7, 5), (0.9, 12)])
def test_chances_are_those_of_a_slow_twin(p, count):
    places, labels = drawn(count, wrong=0.1)
    model = LineClassifier(p=p).fit(places, labels)
    grid = np.random.default_rng(7).uniform(-10, 30, (10_000, 2))
    slow = twin(places, labels == "wet", p, grid)
    assert np.abs(model.predict_proba(grid)[:, 1] - slow).max() < 2e-3


def test_the_unit_does_not_matter():
    places, labels = drawn(30, wrong=0.1)
    chances = LineClassifier().fit(places, labels).predict_proba(places)
    for scale, move in ((1e-6, 0.0), (1e6, 0.0), (1.0, 5e5), (1e300, 0.0), (1e-300, 0.0)):
        other = places * scale + move
        assert LineClassifier().fit(other, labels).predict_proba(other) == pytest.approx(chances, abs=1e-3)


def test_the_mean_line_and_pickles():
    places, labels = drawn(60)
    model = LineClassifier(p=1.0).fit(places, labels)
    slope = -model.coef_[0, 0] / model.coef_[0, 1]
    assert slope == pytest.approx(0.41, abs=0.05)
    assert ((places @ model.coef_[0] + model.intercept_ > 0) == (labels == "wet")).all()
    again = pickle.loads(pickle.dumps(model))
    grid = np.random.default_rng(7).uniform(0, 20, (100, 2))
    assert (again.predict_proba(grid) == model.predict_proba(grid)).all()
    pickle.loads(pickle.dumps(clone(model)))


def test_columns_are_chosen():
    places, labels = drawn(30)
    wide = np.column_stack([labels == "wet", places])
    model = LineClassifier(columns=(1, 2)).fit(wide, labels)
    assert (model.predict_proba(wide) == LineClassifier().fit(places, labels).predict_proba(places)).all()
    assert model.coef_[0, 0] == 0.0


@pytest.mark.parametrize(
    "keys, words",
    [
        (dict(p=0.5), "p: found 0.5"),
        (dict(p="much"), "p: found 'much'"),
        (dict(p=np.nan), "p: found nan"),
        (dict(tolerance=-1), "tolerance: found -1"),
        (dict(tolerance=np.nan), "tolerance: found nan"),
        (dict(columns=(0, 0)), "columns: found .0, 0."),
        (dict(columns=("x", "z")), "columns: found"),
        (dict(columns=None), "columns: found None"),
        (dict(columns=(0, 5)), "minimum of 6 is required"),
        (dict(p=1.0), "no straight line separates the labels"),
    ],
)
def test_what_is_wrong_is_a_value_error(keys, words):
    places, labels = drawn(60, wrong=0.2)
    with pytest.raises(ValueError, match=words):
        LineClassifier(**keys).fit(places, labels)


def test_samples_at_one_place_are_refused():
    with pytest.raises(ValueError, match="found one place"):
        LineClassifier().fit([[1, 2], [1, 2]], ["wet", "dry"])


POOL = np.random.default_rng(5).uniform(0, 20, (400, 2))
TRUTH = np.where(POOL[:, 1] > 0.41 * POOL[:, 0] + 3.5, 1, 0)
FIRST = [int(np.flatnonzero(TRUTH == 0)[0]), int(np.flatnonzero(TRUTH == 1)[0])]


def test_modal_asks_with_it():
    pytest.importorskip("modAL", reason="modAL is not installed, or not for this scikit-learn")
    from modAL.models import ActiveLearner
    from modAL.uncertainty import uncertainty_sampling

    learner = ActiveLearner(LineClassifier(p=0.95), uncertainty_sampling, POOL[FIRST], TRUTH[FIRST])
    for _ in range(18):
        asked, place = learner.query(POOL)
        learner.teach(place, TRUTH[asked])
    assert learner.score(POOL, TRUTH) > 0.95


def test_scikit_activeml_asks_with_it():
    pytest.importorskip("skactiveml", reason="scikit-activeml is not installed")
    from skactiveml.classifier import SklearnClassifier
    from skactiveml.pool import UncertaintySampling
    from skactiveml.utils import MISSING_LABEL

    known = np.full(len(POOL), MISSING_LABEL)
    known[FIRST] = TRUTH[FIRST]
    model = SklearnClassifier(LineClassifier(p=0.95), classes=[0, 1])
    asks = UncertaintySampling(method="margin_sampling", random_state=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(18):
            asked = asks.query(POOL, known, model)
            known[asked] = TRUTH[asked]
        assert model.fit(POOL, known).score(POOL, TRUTH) > 0.95
