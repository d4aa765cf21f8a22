"""Laws fitted to three tests of a rubber: `resilin.fit` beside FElupe's `optimize`, on the same data.

    pip install felupe tensortrax        # beside the resilin package
    python benchmarks/python/fit_peers.py

FElupe fits uniaxial and equibiaxial tests; the planar one, whose number of points differs, is left out for both. It
has no Gent law: its Extended Tube takes that place. Seconds are the least of three calls of the process, without the
import.
"""

import pathlib
import time
import tomllib

import numpy as np

import resilin

EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / "examples" / "fit_rubber.toml"
KGF_PER_CM2 = 0.0980665  # [MPa]


def least_seconds(action):
    times = []
    for _ in range(3):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return min(times)


def example_tests():
    """{mode: (stretch, stress [MPa])} of the tests that both fit."""
    tests = {}
    for test in tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))["test"]:
        path = EXAMPLE.parent / test["file"]
        stretch, stress = np.loadtxt(path, delimiter=",", skiprows=1).T
        in_kgf = "kgf" in path.read_text(encoding="utf-8").splitlines()[0]
        tests[test["mode"]] = (stretch, stress * (KGF_PER_CM2 if in_kgf else 1))
    del tests["planar"]
    return tests


def felupe_fits(tests):
    import felupe
    from felupe.constitution import tensortrax as laws

    models = {
        "neo_hookean": (laws.models.hyperelastic.neo_hooke, {"mu": 0.4}),
        "mooney_rivlin": (laws.models.hyperelastic.mooney_rivlin, {"C10": 0.2, "C01": 0.1}),
        "yeoh": (laws.models.hyperelastic.yeoh, {"C10": 0.2, "C20": 0.0, "C30": 0.0}),
        "ogden3": (laws.models.hyperelastic.ogden, {"mu": [0.5, 0.1, 0.1], "alpha": [1.3, 5.0, -2.0]}),
        "arruda_boyce": (laws.models.hyperelastic.arruda_boyce, {"C1": 0.2, "limit": 5.0}),
        "extended tube": (
            laws.models.hyperelastic.extended_tube,
            {"Gc": 0.2, "delta": 0.1, "Ge": 0.2, "beta": 0.2},
        ),
    }
    for name, (model, constants) in models.items():

        def fit(model=model, constants=constants):
            umat = laws.Hyperelastic(model, **constants)
            return umat.optimize(ux=np.array(tests["uniaxial"]), bx=np.array(tests["equibiaxial"]), incompressible=True)

        try:
            yield name, least_seconds(fit)
        except (TypeError, ValueError, RuntimeError) as error:
            yield name, f"{type(error).__name__}: {error}"
    del felupe


def main():
    tests = example_tests()
    data = {
        "test": [
            {"mode": mode, "stretch": stretch, "nominal_stress": stress, "unit": "MPa"}
            for mode, (stretch, stress) in tests.items()
        ]
    }
    for name in ("neo_hookean", "mooney_rivlin", "yeoh", "ogden3", "arruda_boyce", "gent"):
        print(f"resilin {name:16s} {least_seconds(lambda name=name: resilin.fit(data, laws=[name])):.4f} s")
    print(f"resilin {'all six':16s} {least_seconds(lambda: resilin.fit(data)):.4f} s")
    for name, seconds in felupe_fits(tests):
        print(f"felupe  {name:16s} {seconds if isinstance(seconds, str) else f'{seconds:.4f} s'}")


if __name__ == "__main__":
    main()
