"""The audit of random mechanisms with every kind of liaison and body: numbers that must fit each other."""

from __future__ import annotations

import json

import numpy as np
import pytest
from random_mechanisms import Features, random_model

from maggi.analyses.audit import audit


@pytest.mark.parametrize("seed", range(10))
def test_numbers_fit_each_other(seed):
    rng = np.random.default_rng(seed)
    model = random_model(rng, Features(*(bool(x) for x in rng.random(5) < 0.5)))
    found = audit(model)
    counts = found.mobility
    assert found.problems == ()
    assert counts.freedoms == counts.velocities - counts.rank
    assert counts.freedoms <= counts.position_freedoms
    assert len(counts.redundant) == counts.rows - counts.rank
    assert counts.gruebler <= counts.rigid_mobility
    # a random pose is a general one
    assert counts.generic_freedoms in (None, counts.freedoms)
    assert counts.generic_rigid_mobility in (None, counts.rigid_mobility)
    free = [one for one in found.motions if one.driver is None]
    driven = [one for one in found.motions if one.driver is not None]
    assert len(driven) <= counts.drivers
    # couplers may take part in what a driver moves, so that its motion is named after another joint
    assert len(free) + len(driven) - counts.drivers <= counts.rigid_mobility <= len(found.motions)
    elastic = sum(body.freedoms for body in found.elastic)
    assert counts.rigid_mobility + elastic - (counts.rank - counts.rigid_rank) == counts.freedoms
    for remedy in found.remedies:
        assert sum(one.rows for one in remedy.replacements) in (0, remedy.redundant)
        assert {one.joint for one in remedy.replacements} <= set(remedy.joints)
    without = {name for part in found.integrability for one in part.liaisons for name in one.liaisons}
    for part in found.integrability:
        for one in (*part.liaisons, part.together):
            assert one.tested > 0
            assert one.velocities <= one.reachable <= one.positions
            assert one.rows == one.positions - one.velocities
        assert part.together.velocities <= min(one.velocities for one in part.liaisons)
    kinds = {one.name: one.kind for one in found.liaisons}
    always = {"rolling-disc", "rolling-sphere", "knife-edge", "pfaffian"}
    assert {name for name, kind in kinds.items() if kind in always} <= without
    assert json.loads(json.dumps(found.data()))["mobility"]["rank"] == counts.rank
    assert found.text()
