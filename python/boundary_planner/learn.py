"""The distribution over straight lines, as an estimator of scikit-learn."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from operator import index
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.multiclass import check_classification_targets, type_of_target
from sklearn.utils.validation import check_is_fitted, validate_data

from boundary_planner import _native

CERTAIN = 1.0 - 1e-12


class LineClassifier(ClassifierMixin, BaseEstimator):
    """Which side of a straight line a place is on, by labels of two classes that are sometimes wrong.

    All lines across the ground around the samples are weighed by their labels. `predict_proba` averages over them, so
    it is near one half where the labels leave the side open: choose the next label there.

    Parameters
    ----------
    p : float, default=0.9
        How often labels are true, above 0.5. With 1 a line must separate the labels.
    tolerance : float, default=0.0
        How far positions may be off, in their unit: three standard deviations.
    columns : pair of int, default=(0, 1)
        The columns of X that are the position. Other columns are ignored.

    Attributes
    ----------
    classes_ : the two labels
    coef_, intercept_ : the mean line; `coef_ @ x + intercept_` is positive on the side of `classes_[1]`
    n_features_in_, feature_names_in_ : as of any estimator
    """

    _seen: tuple[NDArray[np.float64], NDArray[np.bool_]]
    _lines: _native.Lines
    classes_: NDArray[Any]

    def __init__(
        self, p: float = 0.9, tolerance: float = 0.0, columns: Sequence[int] = (0, 1)
    ) -> None:
        self.p = p
        self.tolerance = tolerance
        self.columns = columns

    def fit(self, X: ArrayLike, y: ArrayLike) -> LineClassifier:
        """Weigh all lines by these labels."""
        places, labels = validate_data(self, X, y, dtype=np.float64)
        check_classification_targets(labels)
        kind = type_of_target(labels, input_name="y", raise_unknown=True)
        self.classes_, numbers = np.unique(labels, return_inverse=True)
        if kind != "binary":
            raise ValueError(f"Only binary classification is supported. The type of the target is {kind}.")
        if len(self.classes_) < 2:
            raise ValueError(f"y: found one class, {self.classes_[0]!r}, expected two classes")
        if not (isinstance(self.p, Real) and 0.5 < self.p <= 1.0):
            raise ValueError(f"p: found {self.p!r}, expected a probability above 0.5, 1 at most")
        if not (isinstance(self.tolerance, Real) and 0.0 <= self.tolerance < np.inf):
            raise ValueError(f"tolerance: found {self.tolerance!r}, expected a finite number, 0 or more")
        seen, is_second = self._places(places), numbers == 1
        self._seen = (seen, is_second)
        self._lines = self._weigh(seen, is_second)
        if self.p == 1.0 and self.tolerance == 0.0:
            # A line that does not separate the labels has one of them at least on its wrong side.
            if np.abs(is_second - self._lines.chance(seen)).sum() > 0.5:
                raise ValueError("y: no straight line separates the labels, and with p=1 none may be wrong")
        a, b, c = self._lines.mean()
        self.coef_ = np.zeros((1, places.shape[1]))
        self.coef_[0, list(self.columns)] = [a, b]
        self.intercept_ = np.array([c])
        return self

    def _weigh(self, places: NDArray[np.float64], is_second: NDArray[np.bool_]) -> _native.Lines:
        return _native.Lines(places, is_second, min(float(self.p), CERTAIN), float(self.tolerance))

    def _places(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        try:
            first, second = map(index, self.columns)
        except (TypeError, ValueError):
            first = second = 0
        if first == second:
            raise ValueError(f"columns: found {self.columns!r}, expected two numbers of columns, as (0, 1)")
        if not (0 <= first < X.shape[1] and 0 <= second < X.shape[1]):
            found, least = f"{X.shape[1]} feature(s)", max(first, second) + 1
            raise ValueError(f"X: found {found}, minimum of {least} is required: columns={self.columns}")
        return np.ascontiguousarray(X[:, [first, second]])

    def _chance(self, X: ArrayLike) -> NDArray[np.float64]:
        check_is_fitted(self)
        places = validate_data(self, X, dtype=np.float64, reset=False)
        return self._lines.chance(self._places(places))

    def predict_proba(self, X: ArrayLike) -> NDArray[np.float64]:
        """The chance of each label at each place, as the sensor reads it: errors of labels included."""
        above = 1.0 - self.p + (2.0 * self.p - 1.0) * self._chance(X)
        return np.column_stack([1.0 - above, above])

    def decision_function(self, X: ArrayLike) -> NDArray[np.float64]:
        """The log odds that each place is on the side of `classes_[1]`."""
        chance = np.clip(self._chance(X), 1e-15, 1.0 - 1e-15)
        odds: NDArray[np.float64] = np.log(chance) - np.log1p(-chance)
        return odds

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """The likelier side of each place."""
        is_second = self._chance(X) > 0.5
        likelier: NDArray[Any] = self.classes_[is_second.astype(int)]
        return likelier

    def __getstate__(self) -> dict[str, Any]:
        state = dict(super().__getstate__())
        state.pop("_lines", None)
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        if "_seen" in state:
            self._lines = self._weigh(*self._seen)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.classifier_tags.multi_class = False
        tags.classifier_tags.poor_score = True  # on data that no straight line separates
        return tags
