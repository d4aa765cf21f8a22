"""Scenes fitted to markers; the numbers themselves are checked in C++ (tests/fit)."""

import pathlib

import numpy as np
import pytest
from toml_reader import tomllib

import resilin

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
EXAMPLE = EXAMPLES / "fit_bar.toml"


def test_the_example_finds_the_two_moduli_of_its_bar():
    lines = []
    fit = resilin.fit_scenes(EXAMPLE, on_solve=lines.append)
    assert fit.is_converged
    assert fit.solves == len(lines) <= 6
    assert lines[0].startswith("solve 1: sum of squares")
    for name, truth in (("E root", 8e5), ("E tip", 3e5)):
        low, high = fit[name].interval
        assert low < truth < high
        assert fit[name].value == pytest.approx(truth, rel=0.05)
    assert fit.warnings == ()
    assert fit.correlation.shape == (2, 2)
    assert fit.tables[0].measured.shape == fit.tables[0].model.shape == (33,)
    residuals = (fit.tables[0].model - fit.tables[0].measured) / 1e-3
    assert np.sum(residuals**2) == pytest.approx(fit.sum_of_squares)
    assert "E tip" in fit.text
    assert tomllib.loads(fit.material_toml)["material"]["law"] == "neo_hookean"


def test_a_dict_is_fitted_as_the_file_is():
    with EXAMPLE.open("rb") as file:
        data = tomllib.load(file)
    experiment = data["experiment"][0]
    experiment["scene"] = str(EXAMPLES / experiment["scene"])
    experiment["markers"]["file"] = str(EXAMPLES / experiment["markers"]["file"])
    fit = resilin.fit_scenes(data, overrides={"fit.max_solves": 20})
    assert fit["E root"].value == resilin.fit_scenes(EXAMPLE)["E root"].value


def test_what_is_wrong_is_said_in_one_line():
    with pytest.raises(resilin.InputError, match="resilin.fit"):
        resilin.fit_scenes(EXAMPLES / "fit_rubber.toml")
    with pytest.raises(resilin.InputError, match="fit_scenes"):
        resilin.fit(EXAMPLE)
    with pytest.raises(resilin.InputError, match="a path or a dict"):
        resilin.fit_scenes(3)
    with pytest.raises(resilin.InputError, match="one of E root, E tip"):
        resilin.fit_scenes(EXAMPLE)["E"]


def test_an_exception_of_the_callback_ends_the_fit():
    def stop(line):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        resilin.fit_scenes(EXAMPLE, on_solve=stop)


def test_a_field_of_cells_is_found_and_saved(tmp_path):
    mesh = resilin.Mesh.rectangle(size=(1, 0.5), cells=(8, 4))
    stiff = mesh.positions[mesh.cells].mean(axis=1)[:, 0] > 0.5
    scene = {
        "simulation": {"kind": "static", "dimension": 2},
        "body": [{"name": "sheet", "mesh": mesh, "element": "P1"}],
        "fix": [{"name": "grip", "where": {"group": "x_min"}}],
        "load": [{"name": "pull", "kind": "traction", "value": [1e4, 0], "where": {"group": "x_max"}}],
    }

    def with_moduli(moduli):
        material = {"law": "neo_hookean", "youngs_modulus": moduli, "poissons_ratio": 0.3}
        return scene | {"body": [scene["body"][0] | {"material": material}]}

    at = mesh.positions[mesh.positions[:, 0] > 0]
    truth = np.where(stiff, 3e5, 1e5)
    key = "body.sheet.material.youngs_modulus"
    run = resilin.value_and_gradient(with_moduli(truth), {"displacement": {"at": at, "target": 0 * at}}, [key])
    noise = 1e-4 * np.random.default_rng(3).standard_normal(at.shape)
    markers = {"at": at, "displacement": run.residuals.reshape(at.shape) + noise, "sigma": 1e-4}
    fit = resilin.fit_scenes(
        {
            "experiment": [{"scene": with_moduli(2e5), "markers": markers}],
            "parameter": [{"key": key, "per": "cell"}],
        }
    )
    assert fit.is_converged
    assert fit.parameters == {}
    field = fit.fields[key]
    assert field.values.shape == field.interval[0].shape == field.resolution.shape == (64,)
    assert np.sqrt(np.mean(np.log(field.values / truth) ** 2)) < 0.2  # a third of what the truth varies by
    assert fit.regularisation.l_curve.shape[1] == 3
    assert fit.regularisation.freedom < 64
    fit.save(tmp_path / "out")
    assert np.loadtxt(tmp_path / "out" / "sheet_youngs_modulus.csv") == pytest.approx(field.values, rel=1e-15)
    assert "the L-curve" in (tmp_path / "out" / "fit.html").read_text()
    saved = resilin.Mesh.read(tmp_path / "out" / "sheet_youngs_modulus.vtu")
    assert len(saved.cells) == 64
