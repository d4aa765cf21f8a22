"""One rubber by seven laws: all have the same Young's modulus and Poisson's ratio, and part at large stretches."""

import sys
import warnings

import matplotlib.pyplot as plt
import numpy as np

import resilin

LAWS = (
    "neo_hookean",
    "neo_hookean_isochoric",
    "mooney_rivlin",
    "yeoh",
    "ogden",
    "arruda_boyce",
    "gent",
)
RANGES = {"uniaxial": np.linspace(0.5, 7, 131), "equibiaxial": np.linspace(0.7, 4.5, 96)}

warnings.simplefilter("ignore")  # where a law loses stability its curve is dashed
figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
for ax, (kind, stretches) in zip(axes, RANGES.items(), strict=True):
    for i, name in enumerate(LAWS):
        law = resilin.Material(name, youngs_modulus=1.25e6, poissons_ratio=0.49)
        law.curve(kind, stretches).plot(ax, color=plt.cm.tab10(i))
    ax.set_ylim(-2e6, 4e6)
    ax.yaxis.set_major_formatter(lambda stress, _: f"{stress / 1e6:g}")
    ax.set_ylabel("nominal stress [MPa]")
    ax.grid(alpha=0.3)
axes[0].legend(fontsize="small")

if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=90)
else:
    plt.show()
