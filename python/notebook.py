# %% [markdown]
# # From labelled samples to a map, and from a made-up world to a plot
#
# A boat has read whether there is oil in the water at some places. Where is the edge of the spill, and where is the next
# reading worth most? `notebook.ipynb` is made of `notebook.py`; it needs `matplotlib` and `scikit-learn`.

# %%
import csv
import warnings

import matplotlib.pyplot as plt
import numpy as np

import boundary_planner as b

WET, DRY, INK = "#c2571a", "#2b6f9e", "#222222"
plt.rcParams.update({"figure.figsize": (7, 5), "axes.spines.top": False, "axes.spines.right": False})

# %% [markdown]
# ## A CSV with labels
#
# Yours has columns `lat`, `lon` and `label`, or `x` and `z` in metres; other names can be told. This one is made up: 150
# places along a zigzag, and one label in ten is wrong.

# %%
rng = np.random.default_rng(4)
along = np.linspace(0, 1, 150)
east, north = 900 * along, 250 + 220 * np.sin(along * 9 * np.pi) + rng.normal(0, 8, 150)
is_oil = north > 0.35 * east + 90
is_oil ^= rng.uniform(size=150) < 0.1
with open("samples.csv", "w", newline="") as file:
    writer = csv.writer(file)
    writer.writerow(["lat", "lon", "label"])
    writer.writerows(zip(60.15 + north / 111_400, 24.9 + east / 55_500, is_oil.astype(int)))

answer = b.replay("samples.csv", p=0.9, geojson=True)
print(answer.record["fit"]["says"])
answer

# %% [markdown]
# ## On a map
#
# The answer is GeoJSON as well: the ground on either side, the line, and the samples. `geopandas` draws it, if it is
# installed; QGIS opens the file.

# %%
features = answer.geojson["features"]
figure, axes = plt.subplots()
try:
    import geopandas
except ImportError:
    print("geopandas is not installed: in degrees")
    for feature in features:
        told, places = feature["properties"], feature["geometry"]["coordinates"]
        colour = WET if told.get("label", 0) > 0 else DRY
        if told["kind"] == "ground":
            axes.fill(*np.transpose(places[0]), color=colour, alpha=0.2, linewidth=0)
        elif told["kind"] == "centre":
            axes.plot(*np.transpose(places), color=INK)
        elif told["kind"] == "sample":
            axes.plot(*places, ".", color=colour)
    axes.set_aspect(1 / np.cos(np.radians(60.15)))
    axes.set(xlabel="longitude", ylabel="latitude")
else:
    frame = geopandas.GeoDataFrame.from_features(features, crs=4326)
    frame = frame.to_crs(frame.estimate_utm_crs())
    ground, samples = frame[frame.kind == "ground"], frame[frame.kind == "sample"]
    ground.plot(ax=axes, color=[WET if it > 0 else DRY for it in ground.label], alpha=0.2)
    frame[frame.kind == "centre"].plot(ax=axes, color=INK)
    samples.plot(ax=axes, color=[WET if it > 0 else DRY for it in samples.label], markersize=14)
    axes.set(xlabel=f"easting, metres ({frame.crs.name})", ylabel="northing, metres")
    axes.ticklabel_format(style="plain", useOffset=False)
axes.set_title("Oil (orange) or none (blue): shaded where all lines of the 90 % set agree")
plt.show()

# %% [markdown]
# ## Where the next reading is worth most
#
# The estimator of scikit-learn gives the chance of oil at every place. It is open near one half.

# %%
places = np.column_stack([east, north])
few = rng.permutation(150)[:25]
model = b.LineClassifier(p=0.9).fit(places[few], is_oil[few])
x, z = np.linspace(0, 900, 181), np.linspace(0, 500, 101)
grid = np.stack(np.meshgrid(x, z), axis=-1).reshape(-1, 2)
chance = model.predict_proba(grid)[:, 1].reshape(len(z), len(x))

figure, axes = plt.subplots(layout="constrained")
picture = axes.pcolormesh(x, z, chance, cmap="RdBu_r", vmin=0, vmax=1, shading="nearest", rasterized=True)
axes.contour(x, z, chance, levels=[0.25, 0.5, 0.75], colors=INK, linewidths=[0.7, 1.5, 0.7])
for label, colour in ((True, WET), (False, DRY)):
    chosen = few[is_oil[few] == label]
    axes.scatter(*places[chosen].T, color=colour, edgecolor="white", label="oil" if label else "no oil")
figure.colorbar(picture, label="chance that a reading says oil", shrink=0.7)
axes.set(aspect="equal", xlabel="east, metres", ylabel="north, metres", title="After 25 of the labels", ylim=(0, 500))
axes.legend(loc="lower left", bbox_to_anchor=(0, 1.08), ncols=2, frameon=False)
plt.show()

# %% [markdown]
# ## A made-up world
#
# A boat knows nothing. It seeks the spill, goes along its edge, and maps it with a width that holds nine times in ten.
# One reading in twenty is wrong.

# %%
mission = b.Mission(
    algorithm="track",
    area={"x": [0, 400], "z": [0, 300]},
    vehicle={"kind": "boat", "reach": 12, "step": 0.5, "sharpest": 0.6},
    start={"x": 30, "z": 30},
    oracle=[],
    noise={"p": 0.95},
    steps=400,
    truth={"circle": [220, 160, 80]},
)
flight = mission.run()
flight

# %%
figure, axes = plt.subplots(layout="constrained")
axes.plot(*flight.track[:, :2].T, color="#888888", linewidth=0.8, label="track")
read, labels = flight.samples
for label, colour in ((1, WET), (-1, DRY)):
    axes.scatter(*read[labels == label].T, s=9, color=colour, label=f"label {label:+}")
turn = np.linspace(0, 2 * np.pi, 200)
axes.plot(220 + 80 * np.cos(turn), 160 + 80 * np.sin(turn), "--", color=INK, linewidth=1, label="true edge")
for piece in np.unique(flight.front[:, 3]):
    x, z, half, _ = flight.front[flight.front[:, 3] == piece].T
    left = -np.gradient(z), np.gradient(x)
    left = half * left / np.hypot(*left)
    axes.fill(*np.hstack([[x, z] + left, ([x, z] - left)[:, ::-1]]), color=WET, alpha=0.3, linewidth=0)
    axes.plot(x, z, color=WET, linewidth=1.5, label="map and its width" if piece == 1 else None)
metres = flight.end["front"]["metres"]
axes.set(aspect="equal", xlabel="x, metres", ylabel="z, metres")
axes.set_title(f"{metres:.0f} m of edge, mapped with {len(labels)} labels")
axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))
plt.show()

# %% [markdown]
# ## Beside libraries for active learning
#
# On the same made-up lines, four points of which are known: the planner, and two libraries that ask where the
# estimator is least certain. They jump anywhere in the field, and their metres are those between the places. Both ask by
# the same rule here, so their curves are one.

# %%
def asks_by_modal(known, labels, pool):
    from modAL.models import ActiveLearner
    from modAL.uncertainty import uncertainty_sampling

    warnings.simplefilter("ignore", FutureWarning)  # modAL calls scikit-learn in an older way
    learner = ActiveLearner(b.LineClassifier(p=0.99), uncertainty_sampling, known, labels)
    while True:
        asked = learner.query(pool)[0][0]
        label = yield asked, learner.estimator.coef_[0]
        learner.teach(pool[[asked]], [label])


def asks_by_activeml(known, labels, pool):
    from skactiveml.classifier import SklearnClassifier
    from skactiveml.pool import UncertaintySampling

    classifier = SklearnClassifier(b.LineClassifier(p=0.99), classes=[-1, 1])
    while True:
        sampling = UncertaintySampling(method="margin_sampling", random_state=1)
        asked = sampling.query(known, labels, classifier, candidates=pool)[0]
        label = yield asked, classifier.fit(known, labels).estimator_.coef_[0]
        known, labels = np.vstack([known, pool[asked]]), np.append(labels, label)


def by_library(asks, field, count, pool):
    """The error of the slope in degrees, and metres, after each label."""
    known = np.array([[field[f"x{k}"], field[f"z{k}"]] for k in range(1, 5)])
    truth = np.array([field["a"], field["b"]])
    learner = asks(known, np.array([field[f"label{k}"] for k in range(1, 5)]), pool)
    at, metres, found = known[0], 0.0, []
    asked, normal = next(learner)
    for _ in range(count):
        metres, at = metres + np.hypot(*(pool[asked] - at)), pool[asked]
        asked, normal = learner.send(1 if at @ truth + field["c"] > 0 else -1)
        cross, dot = normal[0] * truth[1] - normal[1] * truth[0], normal @ truth
        found.append((np.degrees(np.arctan2(abs(cross), abs(dot))), metres))
    return found


# %%
FIELDS, LABELS = 20, 16
b.command("campaign", "--fields", FIELDS, "--steps", 1, "--fields-csv", "fields.csv")
with open("fields.csv", newline="") as file:
    fields = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
pool = np.stack(np.meshgrid(np.linspace(0, 20, 41), np.linspace(0, 20, 41)), axis=-1).reshape(-1, 2)

rows = b.campaign(FIELDS, algorithm="lookahead", steps=LABELS, every=True, progress=False)
ours = np.array([(row["centre_deg"], row["metres"]) for row in rows])
results = {"look-ahead": ours.reshape(FIELDS, LABELS, 2)}
for name, asks in (("modAL", asks_by_modal), ("scikit-activeml", asks_by_activeml)):
    try:
        results[name] = np.array([by_library(asks, field, LABELS, pool) for field in fields])
    except ImportError:
        print(f"{name} is not installed: left out")

figure, (by_labels, by_metres) = plt.subplots(1, 2, figsize=(9, 4), sharey=True, layout="constrained")
for (name, found), style in zip(results.items(), ("o-", "s--", "^:")):
    error, metres = np.median(found, axis=0).T
    by_labels.semilogy(range(1, LABELS + 1), error, style, markersize=4, label=name)
    by_metres.semilogy(metres, error, style, markersize=4, label=name)
by_labels.set(xlabel="labels", ylabel="error of the slope, degrees (median)")
by_metres.set(xlabel="metres driven")
for axes in (by_labels, by_metres):
    axes.grid(alpha=0.3)
by_labels.legend()
plt.show()
