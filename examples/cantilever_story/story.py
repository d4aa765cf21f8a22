"""A cantilever of gel sags: linear elasticity beside a Neo-Hookean law, and the load at which the first breaks down.

python story.py [PICTURE.png]
"""

import pathlib
import sys

import resilin

SCENE = pathlib.Path(__file__).with_name("beam.toml")
results = {
    law: resilin.run(SCENE, overrides={"body.beam.material.law": law}) for law in ("linear_elastic", "neo_hookean")
}


def tip(result):
    """Displacement of the tip in each frame: (down, towards the wall) [m]."""
    places = [frame["probes"]["tip"]["displacement"] for frame in result.report["frames"]]
    return [-z for _, _, z in places], [-x for x, _, _ in places]


def table():
    """The sag of both beams by load factor."""
    yield "load   linear: down, to the wall   neo-hookean: down, to the wall [m]"
    columns = [column for result in results.values() for column in tip(result)]
    for load, *row in zip(results["neo_hookean"].loads, *columns, strict=True):
        yield "{:4.1f}       {:7.3f}   {:7.3f}              {:7.3f}   {:7.3f}".format(load, *row)


inversion_load = results["linear_elastic"].report["frames"][-1]["inversion_load"]


def draw(path):
    """Sag against load, with the load at which linear elasticity inverts an element."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for law, result in results.items():
        axes.plot(result.loads, tip(result)[0], "o-", label=law)
    axes.axvline(inversion_load, color="grey", linestyle="--", label="linear: an element inverts")
    axes.set(xlabel="load factor", ylabel="sag of the tip [m]", title="A 1 m beam of gel under its weight")
    axes.legend()
    figure.savefig(path, dpi=120)
    return figure


if __name__ == "__main__":
    print("\n".join(table()))
    print(f"linear elasticity inverts an element at load factor {inversion_load:.3f}")
    smallest = results["neo_hookean"].fields["volume_ratio"][-1].min()
    print(f"neo_hookean at full load: the smallest volume ratio is {smallest:.3f}")
    if len(sys.argv) > 1:
        draw(sys.argv[1])
