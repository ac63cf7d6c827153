"""Elastic constants per cell."""

import numpy as np

from maggi.elements.materials import CellMaterials
from maggi.model.materials import Material

STEEL, RUBBER = Material(7850.0, 2.1e11, 0.3), Material(1100.0, 1e7, 0.49)


def test_constants_of_chosen_materials():
    law = CellMaterials.chosen([STEEL, RUBBER], np.array([1, 0, 1]))
    assert law.density.tolist() == [1100.0, 7850.0, 1100.0]
    assert law.young.tolist() == [1e7, 2.1e11, 1e7]
    assert law.poisson.tolist() == [0.49, 0.3, 0.49]


def test_lame_constants_give_back_young_and_poisson():
    law = CellMaterials.uniform(STEEL, 2)
    np.testing.assert_allclose(law.shear * (3 * law.lame + 2 * law.shear) / (law.lame + law.shear), 2.1e11)
    np.testing.assert_allclose(law.lame / (2 * (law.lame + law.shear)), 0.3)
