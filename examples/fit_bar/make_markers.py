"""The measurements of fit_bar.toml, made: eleven markers on a bar of 800 and 300 kPa, with noise of 1 mm."""

from pathlib import Path

import numpy as np

import resilin

HERE = Path(__file__).parent
AT = np.array([[x, 0.1, 0.1] for x in np.linspace(0.05, 1, 11)])  # [m]
ROOT, TIP = 8e5, 3e5  # [Pa]
NOISE = 1e-3  # [m], standard deviation

guess = np.loadtxt(HERE / "youngs_modulus.csv")  # 600 kPa in cells of the half at the wall, 400 kPa in the others
run = resilin.value_and_gradient(
    HERE / "bar.toml",
    {"displacement": {"at": AT.tolist(), "target": np.zeros_like(AT).tolist(), "sigma": 1}},
    wrt=["body.bar.material.youngs_modulus"],
    overrides={"body.bar.material.youngs_modulus": np.where(guess == guess[0], ROOT, TIP).tolist()},
)
measured = run.residuals.reshape(AT.shape) + np.random.default_rng(11).normal(0, NOISE, AT.shape)
np.savetxt(
    HERE / "markers.csv", np.hstack([AT, measured]), fmt="%.6g", delimiter=",", header="X,Y,Z,ux,uy,uz", comments=""
)
