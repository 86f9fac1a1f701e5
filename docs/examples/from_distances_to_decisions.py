# %% [markdown]
# # From distances to decisions
#
# An arm is made up, measured with three reflectors, identified, predicted, compensated, and its next measurement is
# designed. Everything stands in this file; lengths are mm and angles rad. Run it as a script, or cell by cell in an
# editor that knows `# %%`. Each `assert` states what the text says.

# %%
import numpy as np

from catseye.calibration import (
    BidirectionalMap,
    Budget,
    Commands,
    Contributor,
    Criterion,
    Points,
    Pool,
    Problem,
    Rules,
    Study,
    Way,
    compare,
    compensate,
    contributions,
    coverage_factor,
    draw_estimates,
    exchange,
    forward,
    greedy_start,
    identify,
    inverse,
    predict,
    reject,
    robust_fit,
    shortest_interval,
    sight_of,
    systematic_of_map,
)

MDEG = np.deg2rad(1e-3)
NOMINAL = (325.0, 225.0)
NODES1, NODES2 = np.deg2rad(np.arange(-140.0, 61.0, 20.0)), np.deg2rad(np.arange(0.0, 141.0, 20.0))

# %% [markdown]
# ## An arm and its measurement
#
# Each joint has a map for either direction of approach; between the nodes it is linear. The J1 map has a mean of
# zero: distances cannot see a rotation of everything about J1, so the result is given in this gauge.

# %%
wave1, wave2 = 14.0 * np.sin(1.4 * NODES1 + 0.6), -6.0 + 11.0 * np.sin(1.8 * NODES2)
wave1 -= wave1.mean()
true_map1 = BidirectionalMap(NODES1, MDEG * (wave1 - 4.5), MDEG * (wave1 + 4.5))
true_map2 = BidirectionalMap(NODES2, MDEG * (wave2 - 6.0), MDEG * (wave2 + 6.0))
TRUE_LINKS = (324.964, 224.998)
REFLECTORS = np.array([[651.2, -401.6], [680.4, 1.8], [639.1, 380.7]])


def stands(commands: Commands) -> np.ndarray:
    """Return where the true arm stands, mm, shape (n, 2)."""
    theta1 = commands.theta1_rad + true_map1.deviation(commands.theta1_rad, commands.direction1)
    theta2 = commands.theta2_rad + true_map2.deviation(commands.theta2_rad, commands.direction2)
    return forward(theta1, theta2, *TRUE_LINKS)


# %% [markdown]
# Every pair of nodes is visited from every pair of directions: 352 commands, each seen by three reflectors. The beam
# to a reflector is never broken here, so each reflector has one dead path.

# %%
first = np.concatenate([NODES1, NODES1[::-1]]), np.repeat([1, -1], NODES1.size)
second = np.concatenate([NODES2, NODES2[::-1]]), np.repeat([1, -1], NODES2.size)
once = Commands(
    np.repeat(first[0], second[0].size),
    np.tile(second[0], first[0].size),
    np.repeat(first[1], second[0].size),
    np.tile(second[1], first[0].size),
)
rng = np.random.default_rng(7)
rows = np.tile(np.arange(len(once)), 3)
reflector = np.repeat(np.arange(3), len(once))
length = np.linalg.norm(stands(once.select(rows)) - REFLECTORS[reflector], axis=1)
counted = length - length.reshape(3, -1)[reflector, 0] + rng.normal(0.0, 0.010, length.size)
points = Points(
    commands=once.select(rows),
    reflector=reflector,
    dead_path=reflector,
    displacement_mm=counted,
    sigma_mm=None,
    reflector_names=("P1", "P2", "P3"),
    dead_paths=(("P1", 0), ("P2", 0), ("P3", 0)),
)

# %% [markdown]
# ## Identification with both models
#
# The budget says what a distance is good for and what errors have in common. Here the repeatability of the arm
# differs from reading to reading, and an unknown scale is common to all.

# %%
budget = Budget(
    (
        Contributor("repeatability", "length", 0.010),
        Contributor("wavelength", "scale", 0.3e-6, "common"),
    )
)
rough = np.round(REFLECTORS, -1)
asked = (NODES1, NODES2, *NOMINAL, rough, budget)
conventional = identify(points, "conventional", *asked)
error_map = identify(points, "error-map", *asked)

print(f"conventional {conventional.fit.rms_um:.1f} µm rms, error map {error_map.fit.rms_um:.1f} µm rms")
assert error_map.fit.rms_um < 0.3 * conventional.fit.rms_um
assert error_map.fit.lack_of_fit is not None
assert not error_map.fit.lack_of_fit.significant

# %% [markdown]
# The estimates lie about their standard uncertainty from the truth: the rms of the normalised errors is near 1.

# %%
layout = error_map.layout
truth = np.concatenate(
    [
        TRUE_LINKS,
        true_map1.positive_rad,
        true_map1.negative_rad,
        true_map2.positive_rad,
        true_map2.negative_rad,
    ]
)
known = slice(0, layout.arm_size)
normalised = (error_map.parameters[known] - truth) / error_map.standard_uncertainty[known]
print(f"normalised errors {np.sqrt(np.mean(normalised**2)):.2f} rms")
assert 0.6 < np.sqrt(np.mean(normalised**2)) < 1.4

# %% [markdown]
# ## Uncertainty: Jacobian and Monte Carlo
#
# The law of propagation gives the covariance with the result. A Monte Carlo draws from the same budget and identifies
# every draw anew. Both agree, as they should for a problem that is so nearly linear. `contributions` shows which line
# of the budget makes how much of a result.

# %%
draws = draw_estimates(error_map, 2000, seed=1)
ratio = draws.std(axis=0, ddof=1) / error_map.standard_uncertainty
print(f"Monte Carlo over Jacobian: {ratio.min():.3f} to {ratio.max():.3f}")
# 2000 draws know a standard deviation to 1.6 %.
assert np.all(np.abs(ratio - 1.0) < 0.07)

drawn = shortest_interval(draws[:, 0], 0.95)
half_mm = float(coverage_factor(0.95, np.inf)) * error_map.standard_uncertainty[0]
print(f"L1 = {error_map.parameters[0]:.4f} mm, 95 %: ± {1e3 * half_mm:.1f} µm")
assert abs((drawn.high - drawn.low) / (2.0 * half_mm) - 1.0) < 0.1

parts = contributions(error_map)
share = parts.variances[:, 0] / parts.variances[:, 0].sum()
for name, one in zip(parts.names, share, strict=True):
    print(f"of the variance of L1: {name} {100 * one:.2f} %")
assert share[parts.names.index("repeatability")] > 0.95

# %% [markdown]
# The map of J2 in the terms of ISO 230-2: the mean reversal error (upwards minus downwards) is −12 mdeg here.

# %%
j2 = systematic_of_map(error_map.parameters[layout.map2], error_map.covariance[layout.map2, layout.map2])
reversal = next(one for one in j2 if one.symbol == "B̄")
print(f"mean reversal error of J2: {reversal.value / MDEG:.2f} mdeg, u = {reversal.u / MDEG:.2f} mdeg")
assert abs(abs(reversal.value) / MDEG - 12.0) < 3.0 * reversal.u / MDEG

# %% [markdown]
# ## A distance that cannot be right
#
# One distance is off by 0.4 mm. It pulls the estimate; leaving it out by its studentised residual, or a loss that
# trusts far-off distances less, brings it back.

# %%
spoiled = points.displacement_mm.copy()
spoiled[500] += 0.4
bad = Points(points.commands, reflector, reflector, spoiled, None, points.reflector_names, points.dead_paths)
cleaned = reject(Problem(bad, "error-map", *asked), limit=4.0)
print(cleaned.identified.rejected)
assert [one.row for one in cleaned.rejected] == [501]

pulled = identify(bad, "error-map", *asked)
robust = robust_fit(pulled, "huber").identified
off = [np.abs(one.parameters - error_map.parameters).max() for one in (pulled, robust, cleaned.identified)]
assert off[2] < off[1] < off[0]

# %% [markdown]
# ## Prediction against an independent measurement
#
# Along X = 200 mm an instrument with a frame of its own locates the arm to 5 µm. Its frame is unknown, so both models
# are compared after a rigid alignment, over the rows that both predict: a map is never extrapolated.

# %%
way = np.column_stack([np.full(101, 200.0), np.linspace(-500.0, 500.0, 101)])
theta1, theta2 = inverse(way, *NOMINAL)
path = Commands(
    theta1,
    theta2,
    np.where(np.gradient(theta1) >= 0.0, 1, -1),
    np.where(np.gradient(theta2) >= 0.0, 1, -1),
)
predicted = [predict(one.arm, path, *NOMINAL) for one in (conventional, error_map)]
inside = predicted[1].inside
print(f"{inside.sum()} of {inside.size} rows lie inside of the nodes")
assert 0 < inside.sum() < inside.size

seen = np.full(way.shape, np.nan)
seen[inside] = stands(path.select(inside))
turn = np.deg2rad(0.8)
frame = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
measured = seen @ frame + [130.0, -15.0] + rng.normal(0.0, 0.005, way.shape)
left = [compare(way, one.position_mm, measured, inside) for one in predicted]
print(f"2-D rms left: conventional {left[0].rms_2d_um:.1f} µm, error map {left[1].rms_2d_um:.1f} µm")
assert left[1].rms_2d_um < 0.25 * left[0].rms_2d_um

# %% [markdown]
# Each prediction carries its standard uncertainty, so the error bars of a figure are `prediction.u_mm`.

# %%
u_um = 1e3 * predicted[1].u_mm[inside]
print(f"standard uncertainty of the prediction: {u_um.min():.1f} to {u_um.max():.1f} µm")
assert u_um.max() < 20.0

# %% [markdown]
# ## Compensation
#
# The model turned round gives the commands at which the identified arm stands where it shall. What is left is what
# the identification does not know: a few µm, not the 145 µm of before.

# %%
corrected = compensate(error_map.arm, path.select(inside), way[inside])
assert corrected.solved.all()
before_um = 1e3 * np.linalg.norm(stands(path.select(inside)) - way[inside], axis=1)
after_um = 1e3 * np.linalg.norm(stands(corrected.commands) - way[inside], axis=1)
print(f"error of the true arm: {before_um.max():.0f} µm before, {after_um.max():.0f} µm after")
assert np.sqrt(np.mean(after_um**2)) < 0.25 * np.sqrt(np.mean(before_um**2))
# According to the model nothing is left.
again = predict(error_map.arm, corrected.commands, *NOMINAL).position_mm
assert np.abs(again - way[inside]).max() < 1e-9

# %% [markdown]
# ## Design of the next measurement
#
# Where should three reflectors stand? Each place brings information about the arm; a place that does not see enough
# is left out, and the best three of the others are found by exchanges. Smaller is better: criterion A is the rms
# standard uncertainty of maps and links. (The way of the arm is looked at where it measures only; `catseye design`
# looks in between as well.)

# %%
study = Study(layout.of_arm(), *NOMINAL, once, budget)
rules = Rules(
    column_radius_mm=115.0,
    field_half_angle_rad=np.deg2rad(80.0),
    beam_range_mm=(50.0, 5000.0),
    j4_limits_rad=(-2.0 * np.pi, 2.0 * np.pi),
    theta40_rad=0.0,
    keep_out_mm=600.0,
    apart_mm=100.0,
    fewest_seen=0.8,
    most_breaks=3,
)
seen_from = Way(
    np.column_stack([once.theta1_rad, once.theta2_rad]),
    forward(once.theta1_rad, once.theta2_rad, *NOMINAL),
    np.arange(len(once)),
)
ticks = np.arange(-900.0, 901.0, 150.0)
grid = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
looks = [look for xy in grid if not (look := sight_of(xy, seen_from, rules)).reason]
places = np.array([look.xy_mm for look in looks])
apart = np.linalg.norm(places[:, None] - places[None, :], axis=2) >= rules.apart_mm
pool = Pool.of([study.rows(look).information() for look in looks], apart, systematic=False)
criterion = Criterion("A", layout.arm_size, np.zeros((0, study.basis.shape[1])))
start = greedy_start(pool, 3, criterion)
assert start is not None
chosen = exchange(pool, start, criterion)
print(f"{len(looks)} places; the best three: {places[chosen.places].tolist()}")
print(f"rms standard uncertainty: {criterion.shown(chosen.value):.2f} mdeg")

# %% [markdown]
# The layout of the measurement above, by the same criterion:

# %%
present = [study.rows(sight_of(xy, seen_from, rules)).information() for xy in REFLECTORS]
value = criterion.value(np.linalg.inv(np.sum([one.matrix for one in present], axis=0)))
print(f"with the reflectors as they stood: {criterion.shown(float(value)):.2f} mdeg")
assert chosen.value < float(value)
