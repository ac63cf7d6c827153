"""Random mechanisms of every sort: five formulations, one answer."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_mechanisms import Features, random_model
from random_states import state_in_motion
from scipy.sparse.csgraph import connected_components

from maggi.analyses.compare_formulations import compare_at
from maggi.model import GROUND, Coupler, Driver, Pfaffian, PfaffianFunction, RigidBody
from maggi.projection.maggi import project
from maggi.system.build import build_system
from maggi.system.dense import dense_rows, velocity_scale

T = 0.1
NO_ENDS = (Driver, Coupler, Pfaffian, PfaffianFunction)
FEATURES = st.builds(Features, *(st.booleans() for _ in range(5)))
SEEDS = st.integers(0, 2**32 - 1)


def loops(model):
    """Independent closed loops of bodies; two joints between the same two bodies are none."""
    joined = (joint for joint in model.joints.values() if not isinstance(joint, NO_ENDS))
    pairs = {frozenset((joint.first.body, joint.second.body)) for joint in joined}
    bodies = sorted({GROUND, *model.bodies})
    graph = np.zeros((len(bodies), len(bodies)))
    for first, second in pairs:
        graph[bodies.index(first), bodies.index(second)] = 1.0
    parts, _ = connected_components(graph, directed=False)
    return len(pairs) - len(bodies) + parts


def sorts(system, motion):
    """What a mechanism turned out to be."""
    rows = dense_rows(system, motion, T)
    yield "any"
    if loops(system.model):
        yield "closed"
    if not system.holonomic.all():
        yield "nonholonomic"
    if len(project(rows.A, velocity_scale(system)).redundant):
        yield "redundant"
    if any(not isinstance(body, RigidBody) for body in system.model.bodies.values()):
        yield "elastic"
    if np.abs(motion.v).max() > 0.01:
        yield "in motion"


def compare_many(count):
    """Compare `count` random mechanisms; what share of them is of which sort."""
    counts = Counter()

    @settings(max_examples=count, suppress_health_check=list(HealthCheck), database=None)
    @given(SEEDS, FEATURES)
    def one(seed, features):
        rng = np.random.default_rng(seed)
        system = build_system(random_model(rng, features), dense=True)
        motion = state_in_motion(system, rng, T)
        if motion is None:
            counts["no state"] += 1
            return
        counts.update(sorts(system, motion))
        found = compare_at(system, motion, T)
        assert found.agree, found

    one()
    return counts


def test_a_few():
    assert compare_many(8)["any"] > 0


@pytest.mark.slow
def test_two_hundred():
    counts = compare_many(300)
    assert counts["any"] >= 200
    for sort in ("closed", "nonholonomic", "redundant", "elastic", "in motion"):
        assert counts[sort] >= 0.25 * counts["any"], counts
