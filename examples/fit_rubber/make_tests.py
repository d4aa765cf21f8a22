"""Writes the three tests of fit_rubber.toml: synthetic, of Ogden's rubber of 1972 with noise (NumPy, seed 1944).

Stresses are those of the incompressible law with mu = 0.63, 0.0012, -0.01 MPa and alpha = 1.3, 5, -2, each off by a
normal error of 1.5 % and 2 kPa, and rounded as a laboratory writes them. The uniaxial test is in kgf/cm2, the others in
MPa.
"""

import pathlib

import numpy as np

TERMS = ((0.63, 1.3), (0.0012, 5.0), (-0.01, -2.0))  # mu_p [MPa], alpha_p
KGF_PER_CM2 = 0.0980665  # [MPa]
LATERAL = {"uniaxial": -0.5, "equibiaxial": -2.0, "planar": -1.0}  # the free stretch is this power of the other
END = {"uniaxial": 7.4, "equibiaxial": 4.4, "planar": 5.0}
POINTS = {"uniaxial": 24, "equibiaxial": 16, "planar": 14}


def nominal_stress(mode, stretch):
    """[MPa]; P = sum mu (l^(alpha - 1) - l^(e alpha - 1)) with e the power of the free stretch."""
    return sum(mu * (stretch ** (alpha - 1) - stretch ** (LATERAL[mode] * alpha - 1)) for mu, alpha in TERMS)


def main():
    random = np.random.default_rng(1944)
    for mode in LATERAL:
        part = np.linspace(0, 1, POINTS[mode] + 1)[1:]
        stretch = np.round(1 + (END[mode] - 1) * part**1.3, 2)
        exact = nominal_stress(mode, stretch)
        stress = exact * (1 + 0.015 * random.standard_normal(stretch.size)) + 0.002 * random.standard_normal(
            stretch.size
        )
        unit, digits = "MPa", 3
        if mode == "uniaxial":
            stress, unit, digits = stress / KGF_PER_CM2, "kgf/cm2", 2
        rows = [f"{a:.2f},{b:.{digits}f}" for a, b in zip(stretch, stress, strict=True)]
        text = "\n".join([f"stretch,nominal_stress [{unit}]", *rows]) + "\n"
        (pathlib.Path(__file__).parent / f"{mode}.csv").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
