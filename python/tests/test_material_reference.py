"""Material models against 80-digit arithmetic: material_points_*.json and closed_forms.json of tests/reference."""

# ruff: noqa: N803, N806 - F, P, A and J are the letters of the field

import functools
import json
import pathlib

import numpy as np
import pytest

import resilin

EPSILON = np.finfo(np.float64).eps
REFERENCE = pathlib.Path(__file__).resolve().parents[2] / "tests" / "reference"

LAME = {"mu": "shear_modulus", "lam": "lame_lambda"}
BULK = {"mu": "shear_modulus", "kappa": "bulk_modulus"}
LAWS = {  # laws of the files: our name, and our names of its constants; those of a list are numbered
    "nh_log": ("neo_hookean", LAME),
    "nh_j1_log": ("neo_hookean_quadratic", LAME),
    "snh": ("stable_neo_hookean", LAME),
    "snh_log": ("stable_neo_hookean_log", LAME),
    "nh_iso_j1": ("neo_hookean_isochoric", BULK),
    "nh_iso_simo": ("neo_hookean_simo", BULK),
    "stvk": ("saint_venant_kirchhoff", LAME),
    "linear": ("linear_elastic", LAME),
    "corot_linear": ("corotated_linear", LAME),
    "corot_fixed": ("corotated", LAME),
    "mooney_rivlin": ("mooney_rivlin", BULK),
    "yeoh": ("yeoh", BULK),
    "ogden": ("ogden", {**BULK, "mu": "mu_{}", "alpha": "alpha_{}"}),
    "arruda_boyce": ("arruda_boyce", {**BULK, "mu": "chain_modulus", "N": "chain_segments"}),
    "hgo": ("holzapfel_gasser_ogden", {**BULK, "k1": "fibre_modulus", "k2": "fibre_stiffening", "kd": "dispersion"}),
}


@functools.cache
def case(name):
    return json.loads((REFERENCE / f"{name}.json").read_text(encoding="utf-8"))


def material_of(file, key):
    law, names = LAWS[key]
    constants, fibres = {}, []
    for name, value in case(file)["laws"][key]["parameters"].items():
        if name in ("a1", "a2"):
            fibres.append(value)
        elif isinstance(value, list):
            constants.update((names[name].format(place), one) for place, one in enumerate(value, 1))
        else:
            constants[names.get(name, name)] = value
    return resilin.Material(law, **constants, fibres=fibres or None)


def energy_at_rest(file, key):
    """Our energies are zero at rest; two formulas of the files are not."""
    parameters = case(file)["laws"][key]["parameters"]
    mu, lam = parameters.get("mu"), parameters.get("lam")
    if key == "snh":
        return mu**2 / (2 * lam)
    if key == "snh_log":
        return 9 * mu**2 / (32 * lam) - mu / 2 * np.log(4.0)
    return 0.0


def size_of_terms(material, F, P, A):
    """Terms that P sums: itself, the rounding of each entry of F, and that of J, a sum of products of entries."""
    dim = F.shape[-1]
    norm = np.linalg.norm(F, axis=(-2, -1))
    cofactors = np.prod(np.linalg.svd(F, compute_uv=False)[..., : dim - 1], axis=-1)
    sensitivity = np.linalg.norm(A, axis=(1, 2)) * (norm + 1)
    if material.info.needs_positive_J:  # the slope with respect to J is steep near J = 0; A knows how steep
        return np.linalg.norm(P, axis=(1, 2)) + sensitivity * norm ** (dim - 1) / cofactors
    modulus = sum(abs(value) for value in material.constants.values())
    return np.linalg.norm(P, axis=(1, 2)) + sensitivity + modulus * cofactors * (norm**dim + 1)


def is_defined(value):
    return value.get("defined", True) and not value.get("overflow", False)


class Truth:
    """The points of one law that are defined, as arrays, and F of those that are not, or beyond double."""

    def __init__(self, dim, key):
        points = case(f"material_points_{dim}d")["points"]
        defined = [point for point in points if is_defined(point["laws"][key])]
        undefined = [point["F"] for point in points if not is_defined(point["laws"][key])]
        self.kinds = [point["kind"] for point in defined]
        self.F = np.array([point["F"] for point in defined])
        self.undefined_F = np.array(undefined).reshape(-1, dim, dim)
        values = [point["laws"][key] for point in defined]
        self.psi = np.array([value["psi"] for value in values]) - energy_at_rest(f"material_points_{dim}d", key)
        self.P = np.array([value["P"] for value in values]).reshape(-1, dim, dim)
        # Where fibres begin to bear load the law has but one derivative.
        self.has_tangent = np.array([value["H"] is not None for value in values])
        nothing = np.full((dim * dim, dim * dim), np.nan)
        self.A = np.array([nothing if value["H"] is None else value["H"] for value in values])
        self.eigenvalues = np.array([value.get("H_eigenvalues") or nothing[0] for value in values])
        assert len(self.F) + len(self.undefined_F) == 94

    def is_within(self, tolerance, errors):
        outside = ~(errors <= tolerance)
        assert not outside.any(), [(kind, errors[i], tolerance[i]) for i, kind in enumerate(self.kinds) if outside[i]]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("key", LAWS)
def test_energy_and_stress_of_the_material_points(key, dim):
    file = f"material_points_{dim}d"
    material, truth = material_of(file, key), Truth(dim, key)
    A = np.where(truth.has_tangent[:, None, None], truth.A, material.stress_tangent(truth.F).reshape(truth.A.shape))
    terms = size_of_terms(material, truth.F, truth.P, A)
    P = material.first_piola_kirchhoff_stress(truth.F)
    truth.is_within(64 * EPSILON * terms, np.abs(P - truth.P).max((1, 2)))
    size_F = np.linalg.norm(truth.F, axis=(1, 2)) + 1
    rest = abs(energy_at_rest(file, key))
    psi = material.energy_density(truth.F)
    truth.is_within(64 * EPSILON * (terms * size_F + rest), np.abs(psi - truth.psi))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("key", LAWS)
def test_tangents_of_the_material_points(key, dim):
    material, truth = material_of(f"material_points_{dim}d", key), Truth(dim, key)
    size_F = np.linalg.norm(truth.F, axis=(1, 2)) + 1
    J = np.abs(np.linalg.det(truth.F))
    # Near J = 0 the tangent is as sensitive to the rounding of J as P is, once more.
    steep = 1 + 64 * EPSILON / (J * 1e-10) if material.info.needs_positive_J else 1
    tolerance = 1e-10 * steep * size_F * np.linalg.norm(truth.A, axis=(1, 2))
    tolerance[~truth.has_tangent] = np.inf
    exact = np.where(truth.has_tangent[:, None, None], truth.A, 0)
    A = material.stress_tangent(truth.F).reshape(exact.shape)
    truth.is_within(tolerance, np.linalg.norm(A - exact, axis=(1, 2)))
    for projection, treat in (("clamp", lambda values: np.maximum(values, 0)), ("absolute", np.abs)):
        projected = material.stress_tangent(truth.F, projection).reshape(exact.shape)
        expected = np.sort(treat(np.where(truth.has_tangent[:, None], truth.eigenvalues, 0)), axis=1)
        truth.is_within(tolerance, np.abs(np.linalg.eigvalsh(projected) - expected).max(1))
        values, vectors = np.linalg.eigh(exact)
        rebuilt = vectors * treat(values)[:, None, :] @ vectors.transpose(0, 2, 1)
        truth.is_within(tolerance, np.linalg.norm(projected - rebuilt, axis=(1, 2)))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("key", LAWS)
def test_undefined_points_are_never_finite(key, dim):
    material, F = material_of(f"material_points_{dim}d", key), Truth(dim, key).undefined_F
    assert not np.isfinite(material.energy_density(F)).any()
    assert not np.isfinite(material.first_piola_kirchhoff_stress(F)).all((1, 2)).any()
    points = case(f"material_points_{dim}d")["points"]
    F = [point["F"] for point in points if not point["laws"][key].get("defined", True)]
    F = np.array(F).reshape(-1, dim, dim)
    for projection in (None, "clamp", "absolute"):
        assert not np.isfinite(material.stress_tangent(F, projection)).all((1, 2, 3, 4)).any()


def laws_without_energy_at_rest():
    """(law, dimension) of the files; an energy at rest would swallow the digits of that of a tiny strain."""
    pairs = [(key, dim) for key in LAWS for dim in (2, 3)]
    return [(key, dim) for key, dim in pairs if energy_at_rest(f"material_points_{dim}d", key) == 0]


@pytest.mark.parametrize(("key", "dim"), laws_without_energy_at_rest())
def test_energy_at_a_strain_of_1e_8_keeps_its_digits(key, dim):
    file = f"material_points_{dim}d"
    truth = Truth(dim, key)
    tiny = [place for place, kind in enumerate(truth.kinds) if kind == "tiny strain 1e-8"]
    assert tiny
    psi = material_of(file, key).energy_density(truth.F[tiny])
    np.testing.assert_allclose(psi, truth.psi[tiny], rtol=1e-8)


@pytest.mark.parametrize("key", LAWS)
def test_closed_forms(key):
    material = material_of("closed_forms", key)
    rows = [row for kind in case("closed_forms")["results"][key].values() for row in kind if "no_state" not in row]
    F, P, sigma = (np.array([row[name] for row in rows]) for name in ("F", "P", "cauchy"))
    psi = np.array([row["psi"] for row in rows]) - energy_at_rest("closed_forms", key)
    A = material.stress_tangent(F).reshape(-1, 9, 9)
    size_F = np.linalg.norm(F, axis=(1, 2)) + 1
    terms = size_of_terms(material, F, P, A)
    assert (np.abs(material.first_piola_kirchhoff_stress(F) - P).max((1, 2)) <= 64 * EPSILON * terms).all()
    rest = abs(energy_at_rest("closed_forms", key))
    assert (np.abs(material.energy_density(F) - psi) <= 64 * EPSILON * (terms * size_F + rest)).all()
    if not material.info.is_small_strain:
        bound = 64 * EPSILON * terms * size_F / np.linalg.det(F)
        assert (np.abs(material.cauchy_stress(F) - sigma).max((1, 2)) <= bound).all()


@pytest.mark.parametrize("file", ["material_points_2d", "material_points_3d", "closed_forms"])
def test_every_law_of_the_files_is_here(file):
    assert set(case(file)["laws"]) == set(LAWS)
    assert {law for law, _ in LAWS.values()} <= set(resilin.laws())
