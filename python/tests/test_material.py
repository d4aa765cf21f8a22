"""Material at numpy arrays: every law of the catalogue, every kind of array."""

# ruff: noqa: N802, N803, N806 - F, H, P and A are the letters of the field

import pickle
import subprocess
import sys

import numpy as np
import pytest
from every_law import LAWS, material_of

import resilin

EPSILON = np.finfo(np.float64).eps


def states(dim, count=7, strain=0.3, seed=0):
    """Deformation gradients around the identity with J well above 0."""
    noise = np.random.default_rng(seed).uniform(-1, 1, (count, dim, dim))
    return np.eye(dim) + strain * noise / dim


def slope(function, x, step):
    """Central differences of `function` along each entry of the last two axes of x, appended as two axes."""
    columns = []
    for i, j in np.ndindex(x.shape[-2:]):
        change = np.zeros_like(x)
        change[..., i, j] = step
        columns.append((function(x + change) - function(x - change)) / (2 * step))
    shape = columns[0].shape
    return np.stack(columns, axis=-1).reshape(*shape, *x.shape[-2:])


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("law", LAWS)
class TestEveryLaw:
    def test_stress_is_the_slope_of_the_energy(self, law, dim):
        material, F = material_of(law), states(dim)
        P = material.first_piola_kirchhoff_stress(F)
        # Central differences of step h: h^2 from the third derivative, eps / h from rounding.
        assert np.abs(slope(material.energy_density, F, 1e-5) - P).max() < 1e-8 * np.abs(P).max()

    def test_tangent_is_the_slope_of_the_stress(self, law, dim):
        material, F = material_of(law), states(dim)
        A = material.stress_tangent(F)
        assert A.shape == (7, dim, dim, dim, dim)
        assert np.abs(slope(material.first_piola_kirchhoff_stress, F, 1e-5) - A).max() < 1e-7 * np.abs(A).max()
        assert np.abs(A - A.transpose(0, 3, 4, 1, 2)).max() <= 64 * EPSILON * np.abs(A).max()

    @pytest.mark.parametrize("projection", ["clamp", "absolute"])
    def test_projection_changes_the_negative_eigenvalues_only(self, law, dim, projection):
        material, F = material_of(law), states(dim, strain=1.2)
        exact, projected = (
            material.stress_tangent(F, kind).reshape(-1, dim * dim, dim * dim) for kind in (None, projection)
        )
        inside = np.isfinite(exact).all((1, 2))
        assert inside.any()
        values, vectors = np.linalg.eigh(exact[inside])
        treated = np.maximum(values, 0) if projection == "clamp" else np.abs(values)
        expected = vectors * treated[:, None, :] @ vectors.transpose(0, 2, 1)
        scale = np.abs(exact[inside]).max((1, 2), keepdims=True)
        assert (np.abs(projected[inside] - expected) <= 1e-10 * scale).all()  # projected Hessians, as in the references

    def test_forces_are_the_slope_of_the_energy_of_a_cell(self, law, dim):
        material = material_of(law)
        rng = np.random.default_rng(1)
        rest = np.eye(dim) + 0.2 * rng.uniform(-1, 1, (5, dim, dim))
        Dm_inv, volume = np.linalg.inv(rest), np.abs(np.linalg.det(rest)) / (2 if dim == 2 else 6)
        corners = np.concatenate([np.zeros((5, 1, dim)), rest.swapaxes(1, 2)], axis=1)
        corners = corners + 0.1 * rng.uniform(-1, 1, corners.shape)

        def gradients(x):
            return (x[:, 1:] - x[:, :1]).swapaxes(1, 2) @ Dm_inv

        def energy(x):
            return volume * material.energy_density(gradients(x))

        forces = material.elastic_forces(gradients(corners), Dm_inv, volume)
        assert forces.shape == (5, dim + 1, dim)
        assert np.abs(slope(energy, corners, 1e-6) + forces).max() < 1e-8 * np.abs(forces).max()
        assert np.abs(forces.sum(1)).max() <= 64 * EPSILON * np.abs(forces).max()

    def test_constant_derivatives_are_slopes_with_respect_to_the_constants(self, law, dim):
        material, F = material_of(law), states(dim)
        nonzero = {name: value or 0.1 for name, value in material.constants.items()}
        material = resilin.Material(law, **nonzero, fibres=material.fibres)
        derivatives = material.constant_derivatives(F)
        assert list(derivatives) == list(material.constants) == [c.name for c in material.info.constants]
        for name, value in material.constants.items():
            step = 1e-4 * abs(value)
            low, high = (
                resilin.Material(law, **{**material.constants, name: value + change}, fibres=material.fibres)
                for change in (-step, step)
            )
            dpsi, dP = derivatives[name]
            slopes = [
                (getattr(high, method)(F) - getattr(low, method)(F)) / (2 * step)
                for method in ("energy_density", "first_piola_kirchhoff_stress")
            ]
            psi_scale = np.abs(material.energy_density(F)).max() / abs(value)
            P_scale = np.abs(material.first_piola_kirchhoff_stress(F)).max() / abs(value)
            assert np.abs(dpsi - slopes[0]).max() < 1e-7 * psi_scale + 1e-7 * np.abs(dpsi).max(), name
            assert np.abs(dP - slopes[1]).max() < 1e-7 * P_scale + 1e-7 * np.abs(dP).max(), name

    def test_rest_is_free_of_energy_and_stress(self, law, dim):
        material, F = material_of(law), np.eye(dim)
        assert material.energy_density(F) == 0
        assert not material.first_piola_kirchhoff_stress(F).any()

    def test_displacement_gradients_give_the_same_with_all_digits(self, law, dim):
        material, F = material_of(law), states(dim)
        H = F - np.eye(dim)  # exact: the entries of F lie between 1/2 and 2, or H is F itself
        for method in ("energy_density", "first_piola_kirchhoff_stress", "stress_tangent", "cauchy_stress"):
            expected = getattr(material, method)(F)
            got = getattr(material, method)(H, displacement_gradient=True)
            assert np.abs(got - expected).max() <= 256 * EPSILON * np.abs(expected).max(), method
        tiny = 1e-9 * (F - np.eye(dim))
        psi = [material.energy_density(scale * tiny, displacement_gradient=True) for scale in (1, 2)]
        np.testing.assert_allclose(psi[1], 4 * psi[0], rtol=1e-7)  # quadratic, up to the strain itself

    def test_single_precision_is_right_at_ordinary_and_at_tiny_strain(self, law, dim):
        material = material_of(law)
        for strain in (0.3, 1e-6):
            F = states(dim, strain=strain).astype(np.float32)
            for method in ("energy_density", "first_piola_kirchhoff_stress"):
                got = getattr(material, method)(F)
                truth = getattr(material, method)(F.astype(np.float64))
                assert got.dtype == np.float32
                scale = (
                    np.abs(truth) if method == "energy_density" else np.linalg.norm(truth, axis=(1, 2))[:, None, None]
                )
                assert (np.abs(got - truth) <= 1e-5 * scale).all(), (method, strain)

    def test_cauchy_stress_is_P_turned_to_the_deformed_area(self, law, dim):
        material, F = material_of(law), states(dim)
        sigma = material.cauchy_stress(F)
        assert sigma.shape == (7, 3, 3)
        P = material.first_piola_kirchhoff_stress(F)
        expected = P if material.info.is_small_strain else P @ F.swapaxes(1, 2) / np.linalg.det(F)[:, None, None]
        assert np.abs(sigma[:, :dim, :dim] - expected).max() <= 64 * EPSILON * np.abs(expected).max()
        if dim == 2:  # out of the plane: what a constrained third direction bears
            embedded = np.zeros((7, 3, 3))
            embedded[:, :2, :2], embedded[:, 2, 2] = F, 1
            np.testing.assert_array_equal(sigma, material.cauchy_stress(embedded))

    def test_a_broken_state_disturbs_no_other(self, law, dim):
        material, F = material_of(law), states(dim)
        broken = F.copy()
        broken[2, 0, 0], broken[4, 0, 0] = np.nan, np.inf
        others = [0, 1, 3, 5, 6]
        for method in ("energy_density", "first_piola_kirchhoff_stress", "stress_tangent", "cauchy_stress"):
            got, expected = getattr(material, method)(broken), getattr(material, method)(F)
            np.testing.assert_array_equal(got[others], expected[others])
            assert not np.isfinite(got[2]).all(), method
            assert not np.isfinite(got[4]).all(), method

    def test_inversion_is_undefined_exactly_where_the_law_says_so(self, law, dim):
        material = material_of(law)
        F = np.stack([np.diag([-0.5] + [1.0] * (dim - 1)), np.diag([0.0] + [1.0] * (dim - 1))])
        psi, P = material.energy_density(F), material.first_piola_kirchhoff_stress(F)
        if material.info.needs_positive_J:
            assert np.isposinf(psi).all()
            assert np.isnan(P).any((1, 2)).all()
        else:
            assert np.isfinite(psi).all()
            assert np.isfinite(P).all()


MATERIAL = material_of("neo_hookean")
METHODS = ("energy_density", "first_piola_kirchhoff_stress", "stress_tangent", "cauchy_stress")


@pytest.mark.parametrize("method", METHODS)
class TestEveryArray:
    def test_any_leading_shape(self, method):
        F = states(3, 12)
        expected = getattr(MATERIAL, method)(F)
        for batch in ((12,), (3, 4), (2, 1, 6)):
            got = getattr(MATERIAL, method)(F.reshape(*batch, 3, 3))
            assert got.shape == (*batch, *expected.shape[1:])
            np.testing.assert_array_equal(got.reshape(expected.shape), expected)
        single = getattr(MATERIAL, method)(F[0])
        assert single.shape == expected.shape[1:]
        np.testing.assert_array_equal(single, expected[0])

    @pytest.mark.parametrize("shape", [(0, 3, 3), (0, 2, 2), (4, 0, 3, 3)])
    def test_an_empty_batch_gives_an_empty_array(self, method, shape):
        got = getattr(MATERIAL, method)(np.empty(shape))
        assert got.size == 0
        assert got.shape[: len(shape) - 2] == shape[:-2]

    def test_layout_and_byte_order_do_not_matter(self, method):
        F = states(3)
        expected = getattr(MATERIAL, method)(F)
        apart = np.zeros((14, 3, 3))
        apart[::2] = F
        unaligned = np.zeros(F.nbytes + 1, np.uint8)[1:].view(np.float64).reshape(F.shape)
        unaligned[...] = F
        read_only = F.copy()
        read_only.flags.writeable = False
        same = {
            "strided": apart[::2],
            "reversed": F[::-1].copy()[::-1],
            "by columns": np.asfortranarray(F),
            "transposed": F.swapaxes(1, 2).copy().swapaxes(1, 2),
            "big-endian": F.astype(">f8"),
            "little-endian": F.astype("<f8"),
            "unaligned": unaligned,
            "read-only": read_only,
            "list": F.tolist(),
            "matrix of a subclass": F.view(type("Own", (np.ndarray,), {})),
        }
        for name, array in same.items():
            np.testing.assert_array_equal(getattr(MATERIAL, method)(array), expected, err_msg=name)

    def test_whole_numbers_are_read_exactly_and_answered_in_double(self, method):
        F = np.array([[2, 1, 0], [0, 1, 0], [0, 0, 3]])
        expected = getattr(MATERIAL, method)(F.astype(np.float64))
        for kind in (np.int64, np.int32, np.uint8):
            got = getattr(MATERIAL, method)(F.astype(kind))
            assert got.dtype == np.float64
            np.testing.assert_array_equal(got, expected)

    def test_the_input_stays_as_it_was(self, method):
        F = states(3)
        before = F.copy()
        getattr(MATERIAL, method)(F)
        np.testing.assert_array_equal(F, before)

    @pytest.mark.parametrize(
        ("F", "message"),
        [
            (np.eye(3, dtype=complex), "F: expected real numbers in float64 or float32, got complex128"),
            (np.eye(3, dtype=object), "F: expected real numbers in float64 or float32, got object"),
            (np.eye(3, dtype=bool), "F: expected real numbers in float64 or float32, got bool"),
            (np.eye(3, dtype=np.float16), "F: expected real numbers in float64 or float32, got float16"),
            (np.array([["a", "b"], ["c", "d"]]), "F: expected real numbers in float64 or float32, got str"),
            (np.zeros(3), "F: expected an array (..., 2, 2) or (..., 3, 3), got (3,)"),
            (np.zeros((5, 3, 2)), "F: expected an array (..., 2, 2) or (..., 3, 3), got (5, 3, 2)"),
            (np.zeros((5, 4, 4)), "F: expected an array (..., 2, 2) or (..., 3, 3), got (5, 4, 4)"),
            (np.zeros((1, 1)), "F: expected an array (..., 2, 2) or (..., 3, 3), got (1, 1)"),
            (1.0, "F: expected an array (..., 2, 2) or (..., 3, 3), got a single number"),
            ([[1.0, 0.0], [0.0]], "F: expected an array of real numbers, got rows of different lengths"),
            (np.ma.masked_array(np.eye(3)), "F: expected an array without a mask, got a masked array; use .filled()"),
            (None, "F: expected real numbers in float64 or float32, got object"),
        ],
    )
    def test_what_is_no_deformation_gradient_is_refused_in_one_line(self, method, F, message):
        with pytest.raises(resilin.InputError) as refusal:
            getattr(MATERIAL, method)(F)
        assert str(refusal.value).startswith(message)
        assert "\n" not in str(refusal.value)


class TestResultArrays:
    def test_out_takes_the_result(self):
        F, Dm_inv, volume = states(3), states(3, seed=1), np.full(7, 0.5)
        cases = [
            (MATERIAL.energy_density, (F,), (7,)),
            (MATERIAL.first_piola_kirchhoff_stress, (F,), (7, 3, 3)),
            (MATERIAL.stress_tangent, (F,), (7, 3, 3, 3, 3)),
            (MATERIAL.elastic_forces, (F, Dm_inv, volume), (7, 4, 3)),
        ]
        for method, arguments, shape in cases:
            out = np.full(shape, np.nan)
            assert method(*arguments, out=out) is out
            np.testing.assert_array_equal(out, method(*arguments))

    @pytest.mark.parametrize(
        ("out", "message"),
        [
            (np.empty(6), "out: expected a float64 array (7,), got float64 (6,)"),
            (np.empty(7, int), "out: expected a float64 array (7,), got int64 (7,)"),
            (np.empty(7, np.float32), "out: expected a float64 array (7,), got float32 (7,)"),
            (np.empty(14)[::2], "out: expected a writeable C-contiguous array, got"),
            ([0.0] * 7, "out: expected a float64 array (7,), got list"),
        ],
    )
    def test_an_unfit_out_is_refused(self, out, message):
        with pytest.raises(resilin.InputError) as refusal:
            MATERIAL.energy_density(states(3), out=out)
        assert str(refusal.value).startswith(message)

    def test_an_out_that_overlaps_an_input_is_refused(self):
        F = states(3)
        with pytest.raises(resilin.InputError, match="out: expected memory of its own"):
            MATERIAL.first_piola_kirchhoff_stress(F, out=F)


class TestForces:
    def test_arguments_of_several_types_and_shapes_take_the_common_one(self):
        F, Dm_inv = states(3), states(3, seed=1)
        expected = MATERIAL.elastic_forces(
            F, np.ascontiguousarray(np.broadcast_to(Dm_inv[0], F.shape)), np.full(7, 2.0)
        )
        np.testing.assert_array_equal(MATERIAL.elastic_forces(F, Dm_inv[0], 2), expected)
        mixed = MATERIAL.elastic_forces(F, Dm_inv[0].astype(np.float32), np.float32(2))
        assert mixed.dtype == np.float64
        assert MATERIAL.elastic_forces(*(a.astype(np.float32) for a in (F, Dm_inv, np.ones(7)))).dtype == np.float32

    def test_arguments_that_do_not_go_together_are_refused(self):
        with pytest.raises(resilin.InputError, match=r"Dm_inv: expected matrices as large as those of F, \(3, 3\)"):
            MATERIAL.elastic_forces(states(3), states(2), np.ones(7))
        with pytest.raises(resilin.InputError, match=r"F: expected leading shapes that go together"):
            MATERIAL.elastic_forces(states(3), states(3), np.ones(6))
        with pytest.raises(resilin.InputError, match=r"volume: expected real numbers"):
            MATERIAL.elastic_forces(states(3), states(3), np.ones(7, complex))


def test_projection_of_another_name_is_refused():
    with pytest.raises(resilin.InputError, match='projection: expected None, "clamp" or "absolute", got \'clip\''):
        MATERIAL.stress_tangent(states(3), "clip")


def test_results_do_not_depend_on_the_number_of_threads():
    F = states(3, 50000)
    before = resilin.num_threads()
    try:
        results = []
        for count in (1, 2):
            resilin.set_num_threads(count)
            results.append(MATERIAL.first_piola_kirchhoff_stress(F))
    finally:
        resilin.set_num_threads(before)
    np.testing.assert_array_equal(*results)


def test_importing_resilin_does_not_import_torch():
    command = "import sys, resilin; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", command], check=False).returncode == 0


def test_a_pickled_material_is_the_same():
    material = resilin.Material("neo_hookean", youngs_modulus=np.linspace(1e5, 2e5, 7), poissons_ratio=0.3)
    copy = pickle.loads(pickle.dumps(material))
    np.testing.assert_array_equal(copy.energy_density(states(3)), material.energy_density(states(3)))
