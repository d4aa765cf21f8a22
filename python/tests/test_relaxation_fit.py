import json

import numpy as np
import pytest

import resilin

TIME = np.geomspace(0.01, 100, 41)
MODULUS = 1.1 + 0.5 * np.exp(-TIME / 0.1) + 0.4 * np.exp(-TIME / 5)


def test_arrays_give_the_series_back(tmp_path):
    fit = resilin.fit_relaxation({"title": "R", "relaxation": {"time": TIME, "modulus": MODULUS, "tau": [0.1, 5]}})
    assert fit.g == pytest.approx((0.25, 0.2))
    assert fit.tau == (0.1, 5)
    assert fit.instantaneous_modulus == pytest.approx(2)
    assert fit.long_term_modulus == pytest.approx(1.1)
    assert fit.largest_error < 1e-9
    assert fit.viscoelastic == {"g": list(fit.g), "tau": [0.1, 5]}
    assert "41 times" in fit.text
    fit.save(tmp_path / "out")
    page = (tmp_path / "out" / "fit.html").read_text()
    assert page.count("<circle") == 41
    assert "viscoelastic = {" in (tmp_path / "out" / "material.toml").read_text()
    assert json.loads((tmp_path / "out" / "fit.json").read_text())["g"] == list(fit.g)


def test_a_file_of_a_dynamic_test_gives_two_pictures(tmp_path):
    w = 2 * np.pi * np.geomspace(0.01, 10, 13)
    rows = zip(w / (2 * np.pi), 1 + 0.5 * w**2 / (1 + w**2), 0.5 * w / (1 + w**2), strict=True)
    lines = "".join(f"{f:.17g},{storage:.17g},{loss:.17g}\n" for f, storage, loss in rows)
    (tmp_path / "dma.csv").write_text("frequency [Hz],storage,loss\n" + lines)
    (tmp_path / "dma.toml").write_text('[relaxation]\nfile = "dma.csv"\ntau = [1]\n')
    fit = resilin.fit_relaxation(tmp_path / "dma.toml")
    assert fit.g == pytest.approx((1 / 3,))
    fit.save(tmp_path)
    assert (tmp_path / "fit.html").read_text().count("<svg") == 2
    assert resilin.fit_relaxation(tmp_path / "dma.toml", {"relaxation.tau": [0.5, 1]}).g == pytest.approx((1 / 3,))


@pytest.mark.parametrize(
    ("data", "text"),
    [
        ({"relaxation": {"time": [0, 1], "modulus": [2, 1, 1]}}, r"relaxation\.modulus: expected 2 numbers, got 3"),
        (
            {"test": [{"mode": "uniaxial", "stretch": [1.1, 2], "nominal_stress": [1e5, 1e6]}]},
            r"expected \[relaxation\]",
        ),
    ],
)
def test_wrong_data_are_refused_in_one_line(data, text):
    with pytest.raises(resilin.InputError, match=text) as error:
        resilin.fit_relaxation(data)
    assert "\n" not in str(error.value)


def test_other_fits_name_this_one():
    with pytest.raises(resilin.InputError, match=r"resilin\.fit_relaxation"):
        resilin.fit({"relaxation": {"time": TIME, "modulus": MODULUS}})
