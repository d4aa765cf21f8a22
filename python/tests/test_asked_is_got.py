"""Young's modulus and Poisson's ratio mean the small-strain solid, whatever the law."""

import numpy as np
import pytest
from every_law import LAWS, beside_young_and_poisson, poissons_ratio_of

import resilin

YOUNG, POISSON = 2e6, 0.37  # [Pa]
STRAIN = 1e-5  # the answer of a law differs from Hooke's by a few times the strain


def pulled_bar(law):
    """A bar of 2 x 1 x 1 m, pulled along x between planes that let it slide."""

    def slide(group, axis, **more):
        return {"name": group, "where": {"group": group}, "components": axis, **more}

    # E and nu of a law with fibres are those of the solid between them, which are as good as not there.
    has_fibres = resilin.laws()[law].max_fibres > 0
    beside = beside_young_and_poisson(law, 1e-8 * YOUNG if has_fibres else YOUNG)

    return {
        "simulation": {"kind": "static"},
        "body": [
            {
                "mesh": {"box": {"size": [2, 1, 1], "cells": [3, 2, 2]}},
                "material": {
                    "law": law,
                    "youngs_modulus": YOUNG,
                    "poissons_ratio": poissons_ratio_of(law, POISSON),
                    **beside,
                },
            }
        ],
        "fix": [
            slide("x_min", "x"),
            slide("y_min", "y"),
            slide("z_min", "z"),
            slide("x_max", "x", displacement=[2 * STRAIN, 0, 0]),
        ],
        "probe": [{"name": "corner", "at": [2, 1, 1]}],
        "newton": {"tolerance": 1e-10},
    }


@pytest.mark.parametrize("law", LAWS)
def test_a_pulled_bar_shows_the_constants_that_were_asked_for(law):
    frame = resilin.run(pulled_bar(law)).report["frames"][-1]
    force = frame["reactions"]["x_max"][0]
    across = frame["probes"]["corner"]["displacement"][1:]
    assert force / (1 * 1) / STRAIN == pytest.approx(YOUNG, rel=1e-4)
    np.testing.assert_allclose(-np.array(across) / STRAIN, poissons_ratio_of(law, POISSON), rtol=0, atol=1e-4 * POISSON)
