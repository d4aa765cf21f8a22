"""Norms of FEBio's test suite: one fast problem for each feature that its translation knows."""

import json
import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(os.environ.get("RESILIN_SHARED") or ROOT.parent / "shared") / "febio"
sys.path.insert(0, str(ROOT / "validation" / "febio"))

# Relative differences: FEBio stops early, and its contact has a penalty.
PROBLEMS = {
    "di01": 1e-7,  # a spring that starts without length
    "ma63": 1e-10,  # toe_linear_fibre in a sum
    "mi05": 1e-6,  # prescribed displacements
    "ri01": 1e-6,  # a force on a rigid body that is bonded to a soft one
    "ri05": 1e-5,  # two rigid bodies in a soft one, with a ball joint
    "rj01": 1e-9,  # a slanted slider
    "rj05": 1e-6,  # two turns of a slider-crank
    "rj06": 1e-9,  # a body that is turned and shifted along an axis
    "te01": 1e-7,  # linear tetrahedra
    "co01": 1e-2,  # contact of two blocks
}


@pytest.mark.skipif(not FOLDER.is_dir(), reason="needs the files of FEBio's suite, in RESILIN_SHARED")
@pytest.mark.parametrize("name", PROBLEMS)
def test_problem_has_the_norm_that_febio_gets(name):
    from translate import norm_of

    known = json.loads((FOLDER / "norms.json").read_text())[name]["norm"]
    assert norm_of(FOLDER / f"{name}.feb") == pytest.approx(known, rel=PROBLEMS[name])
