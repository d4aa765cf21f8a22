# ruff: noqa: N802, N803, N806 - F, P, A and J are the letters of the field
import numpy as np
import pytest

import resilin

MU, LAMBDA = 4e4, 1.6e5  # [Pa]


def body(dim, **constants):
    mesh = resilin.Mesh.box((1, 1, 1), (2, 2, 2)) if dim == 3 else resilin.Mesh.rectangle((1, 1), (3, 3))
    constants = constants or {"shear_modulus": MU, "lame_lambda": LAMBDA}
    return resilin.Elastic(mesh, resilin.Material("neo_hookean", **constants))


def deformed(elastic, size=0.03, seed=1):
    """Rest positions and a random motion, small enough that no cell is inverted."""
    X = elastic.rest_positions
    return X + size * np.random.default_rng(seed).standard_normal(X.shape)


class ByHand:
    """Psi = mu/2 (I_C - d) - mu ln J + lambda/2 (ln J)^2 on linear cells, straight from the formula."""

    def __init__(self, elastic):
        X, cells = elastic.rest_positions, elastic.cells
        self.cells, self.dim = cells, X.shape[1]
        edges = np.swapaxes(X[cells[:, 1:]] - X[cells[:, :1]], 1, 2)
        self.volumes = np.linalg.det(edges) / (2 if self.dim == 2 else 6)
        inner = np.linalg.inv(edges)  # rows: gradients of corners 1, 2, ...
        self.gradients = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)

    def F(self, x):
        return np.einsum("mai,maj->mij", x[self.cells], self.gradients)

    def value(self, x):
        F = self.F(x)
        ln_J = np.log(np.linalg.det(F))
        psi = MU / 2 * (np.sum(F * F, axis=(1, 2)) - self.dim) - MU * ln_J + LAMBDA / 2 * ln_J**2
        return self.volumes @ psi

    def gradient(self, x):
        F = self.F(x)
        inverse = np.swapaxes(np.linalg.inv(F), 1, 2)
        P = MU * (F - inverse) + LAMBDA * np.log(np.linalg.det(F))[:, None, None] * inverse
        forces = np.einsum("m,mij,maj->mai", self.volumes, P, self.gradients)
        gradient = np.zeros_like(x)
        np.add.at(gradient, self.cells, forces)
        return gradient

    def hessian(self, x, is_clamped):
        F, d = self.F(x), self.dim
        inverse = np.swapaxes(np.linalg.inv(F), 1, 2)
        ln_J = np.log(np.linalg.det(F))[:, None, None, None, None]
        A = MU * np.einsum("ik,jl->ijkl", np.eye(d), np.eye(d)) + LAMBDA * np.einsum("mij,mkl->mijkl", inverse, inverse)
        A = A + (MU - LAMBDA * ln_J) * np.einsum("mil,mkj->mijkl", inverse, inverse)
        if is_clamped:
            values, vectors = np.linalg.eigh(A.reshape(-1, d * d, d * d))
            A = np.einsum("mik,mk,mjk->mij", vectors, np.maximum(values, 0), vectors).reshape(-1, d, d, d, d)
        blocks = np.einsum("m,mijkl,maj,mbl->maibk", self.volumes, A, self.gradients, self.gradients)
        H = np.zeros((x.size, x.size))
        unknowns = (d * self.cells[:, :, None] + np.arange(d)).reshape(len(self.cells), -1)
        np.add.at(H, (unknowns[:, :, None], unknowns[:, None, :]), blocks.reshape(len(blocks), *[d * (d + 1)] * 2))
        return H


def assert_equal_to_round_off(ours, theirs, factor=1e-12):
    """Relative to the largest entry: sums of a few dozen terms of that size."""
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=factor * np.abs(theirs).max())


@pytest.mark.parametrize("dim", [2, 3])
def test_value_and_gradient_are_those_of_the_formula(dim):
    elastic = body(dim)
    x = deformed(elastic)
    assert elastic.value(x) == pytest.approx(ByHand(elastic).value(x), rel=1e-12)
    assert_equal_to_round_off(elastic.gradient(x), ByHand(elastic).gradient(x))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("projection", [None, "clamp"])
def test_the_hessian_is_that_of_the_formula(dim, projection):
    elastic = body(dim)
    x = 0.7 * deformed(elastic, size=0.05)  # compressed, so that there is something to project
    by_hand = ByHand(elastic)
    assert np.linalg.det(by_hand.F(x)).min() > 0
    plain, clamped = by_hand.hessian(x, False), by_hand.hessian(x, True)
    assert np.abs(plain - clamped).max() > 1e-3 * np.abs(plain).max()
    assert_equal_to_round_off(elastic.hessian(x, projection).toarray(), clamped if projection else plain, 1e-11)


def test_projected_hessians_have_no_negative_eigenvalues():
    elastic = body(3)
    x = 0.7 * deformed(elastic, size=0.05)
    largest = np.linalg.eigvalsh(elastic.hessian(x, "absolute").toarray())[-1]
    for projection in ("clamp", "absolute"):
        assert np.linalg.eigvalsh(elastic.hessian(x, projection).toarray())[0] > -1e-12 * largest
    assert np.linalg.eigvalsh(elastic.hessian(x).toarray())[0] < -1e-3 * largest


def test_the_hessian_is_a_canonical_csr_matrix_and_equals_its_triplets():
    from scipy.sparse import coo_matrix, csr_matrix

    elastic = body(3)
    x = deformed(elastic)
    H = elastic.hessian(x)
    assert isinstance(H, csr_matrix)
    assert H.shape == (x.size, x.size)
    fresh = csr_matrix((H.data, H.indices, H.indptr), shape=H.shape)
    assert fresh.has_canonical_format  # looked up anew: columns ascend, none twice
    i, j, v = elastic.hessian(x, as_triplets=True)
    assert abs(coo_matrix((v, (i, j)), shape=H.shape) - H).max() == 0
    assert abs(H - H.T).max() == 0


def test_matrices_do_not_share_memory():
    elastic = body(2)
    x = deformed(elastic)
    first, second = elastic.hessian(x), elastic.hessian(x)
    first.data[:] = 0
    first.eliminate_zeros()
    assert second.nnz > first.nnz == 0
    assert abs(second - elastic.hessian(x)).max() == 0


def test_constants_may_differ_from_cell_to_cell():
    """The energy is linear in mu and lambda: two halves with their own constants add up."""
    M = len(body(3).cells)
    stiff = np.arange(M) % 2 == 0
    x = deformed(body(3))
    mixed = body(3, shear_modulus=np.where(stiff, 3 * MU, MU), lame_lambda=np.where(stiff, 3 * LAMBDA, LAMBDA))
    densities = body(3).energy_densities(x)
    np.testing.assert_allclose(mixed.energy_densities(x), np.where(stiff, 3, 1) * densities, rtol=1e-12)
    assert mixed.value(x) == pytest.approx(body(3).rest_volumes @ (np.where(stiff, 3, 1) * densities), rel=1e-12)


def test_youngs_modulus_may_differ_from_cell_to_cell():
    elastic = body(2, youngs_modulus=np.linspace(1e5, 2e5, 18), poissons_ratio=0.3)
    x = deformed(elastic)
    g, h = elastic.gradient(x), 1e-6
    p = np.random.default_rng(0).standard_normal(x.shape)
    slope = (elastic.value(x + h * p) - elastic.value(x - h * p)) / (2 * h)
    assert slope == pytest.approx(np.sum(g * p), rel=1e-6)  # central differences: error h^2 and round-off / h


@pytest.mark.parametrize("dim", [2, 3])
def test_both_masses_weigh_what_the_body_weighs(dim):
    elastic = body(dim)
    volume = elastic.rest_volumes.sum()
    for kind in ("lumped", "consistent"):
        M = elastic.mass(density=500, kind=kind)
        ones = np.ones(M.shape[0])
        assert ones @ (M @ ones) == pytest.approx(500 * volume * dim, rel=1e-12)
        assert np.linalg.eigvalsh(M.toarray())[0] > 0
    assert elastic.mass(kind="lumped").nnz == elastic.rest_positions.size
    # The kinetic energy of v = X along x: rho/2 int x^2 dV = rho/6 on the unit square or cube, exactly.
    v = np.zeros_like(elastic.rest_positions)
    v[:, 0] = elastic.rest_positions[:, 0]
    M = elastic.mass(density=500, kind="consistent")
    assert 0.5 * v.ravel() @ (M @ v.ravel()) == pytest.approx(500 / 6, rel=1e-12)


def test_max_step_ends_before_the_first_inversion():
    elastic = body(2)
    x = elastic.rest_positions
    p = -2 * x  # x + t p = (1 - 2 t) x: area ratio (1 - 2 t)^2, a tenth of it left at t = (1 - sqrt(0.1)) / 2
    assert elastic.max_step(x, p) == pytest.approx((1 - np.sqrt(0.1)) / 2, rel=1e-9)
    assert elastic.max_step(x, 0.1 * x) == 1


def test_fields_of_a_uniform_stretch():
    elastic = body(3)
    stretch = np.array([1.2, 0.9, 1.1])
    x = elastic.rest_positions * stretch
    J = stretch.prod()
    principal = (MU * (stretch**2 - 1) + LAMBDA * np.log(J)) / J
    np.testing.assert_allclose(elastic.volume_ratios(x), J, rtol=1e-12)
    np.testing.assert_allclose(
        elastic.deformation_gradients(x), np.broadcast_to(np.diag(stretch), (48, 3, 3)), atol=1e-14
    )
    expected = np.broadcast_to(np.diag(principal), (48, 3, 3))
    np.testing.assert_allclose(elastic.cauchy_stresses(x), expected, atol=1e-11 * LAMBDA)
    differences = principal - np.roll(principal, 1)
    np.testing.assert_allclose(elastic.von_mises(x), np.sqrt(differences @ differences / 2), rtol=1e-11)


def test_outside_the_domain_the_energy_is_infinite():
    elastic = body(3)
    x = elastic.rest_positions * [-1, 1, 1]
    assert elastic.value(x) == np.inf
    assert np.isnan(elastic.gradient(x)).all()


def test_inverted_cells_are_turned_around():
    mesh = resilin.Mesh([[0, 0], [1, 0], [0, 1]], [[0, 2, 1]])
    law = resilin.Material("neo_hookean", shear_modulus=MU, lame_lambda=LAMBDA)
    with pytest.warns(UserWarning, match="inverted"):
        elastic = resilin.Elastic(mesh, law)
    assert elastic.rest_volumes == pytest.approx([0.5])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda mesh, law: resilin.Elastic(mesh.positions, law), "mesh: expected a resilin.Mesh, got ndarray"),
        (lambda mesh, law: resilin.Elastic(mesh, "neo_hookean"), "material: expected a resilin.Material, got str"),
        (lambda mesh, law: resilin.embed(None, mesh.positions), "mesh: expected a resilin.Mesh, got NoneType"),
    ],
)
def test_what_is_no_mesh_and_no_material_is_refused(call, message):
    law = resilin.Material("neo_hookean", shear_modulus=MU, lame_lambda=LAMBDA)
    with pytest.raises(resilin.InputError) as caught:
        call(resilin.Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]), law)
    assert str(caught.value) == message


@pytest.mark.parametrize("x", [np.zeros((16, 3)), np.zeros(32), np.zeros((16, 2), dtype=complex), "x"])
def test_wrong_positions_are_refused_in_one_line(x):
    with pytest.raises(resilin.InputError) as caught:
        body(2).gradient(x)
    assert str(caught.value).startswith("x: expected")
    assert "\n" not in str(caught.value)


def test_whole_float32_and_strided_positions_are_read_as_numbers():
    elastic = body(2)
    x = np.round(4 * elastic.rest_positions)
    as_numbers = elastic.gradient(x)
    for other in (x.astype(int), x.astype(np.float32), np.asfortranarray(x), np.repeat(x, 2, axis=0)[::2]):
        np.testing.assert_array_equal(elastic.gradient(other), as_numbers)


def test_wrong_choices_are_refused():
    elastic = body(2)
    x = elastic.rest_positions
    for call in (
        lambda: elastic.hessian(x, "clip"),
        lambda: elastic.mass(kind="heavy"),
        lambda: elastic.mass(density=0),
        lambda: body(2, shear_modulus=np.ones(3), lame_lambda=1.0),
        lambda: resilin.Elastic(resilin.Mesh.rectangle((1, 1), (1, 1)), elastic.material, element="P7"),
        lambda: resilin.Elastic(resilin.Mesh.rectangle((1, 1), (1, 1)), elastic.material, dimension=3),
    ):
        with pytest.raises(resilin.InputError):
            call()


def test_results_do_not_depend_on_the_number_of_threads():
    before = resilin.num_threads()
    mesh = resilin.Mesh.box((1, 1, 1), (12, 12, 12))
    elastic = resilin.Elastic(mesh, resilin.Material("neo_hookean", shear_modulus=MU, lame_lambda=LAMBDA))
    x = deformed(elastic, 0.005)
    results = []
    try:
        for count in (1, 2, 5):
            resilin.set_num_threads(count)
            results.append(
                (elastic.value(x), elastic.gradient(x).tobytes(), elastic.hessian(x, "clamp").data.tobytes())
            )
    finally:
        resilin.set_num_threads(before)
    assert results[0] == results[1] == results[2]


class TestElements:
    """Elements of degree 2 and of hexahedra through Python; what they compute is tested in C++."""

    @pytest.mark.parametrize("element", ["P1", "P2", "P2P0", "Q1", "Q1P0"])
    @pytest.mark.parametrize("dimension", [2, 3])
    def test_every_element_holds_a_uniform_stretch(self, element, dimension):
        pattern = "hexahedra" if element[0] == "Q" else "kuhn6"
        mesh = resilin.Mesh.box((1, 1, 1), (2, 1, 1), pattern=pattern)
        if dimension == 2:
            pattern = "quadrilaterals" if element[0] == "Q" else "uniform"
            mesh = resilin.Mesh.rectangle((1, 1), (2, 1), pattern=pattern)
        body = resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.3), element)
        x = body.rest_positions * np.array([1.1, 0.9, 1.05])[:dimension]
        assert body.element == element
        points = 1 if element == "P1" else body.point_volumes.shape[1]
        assert body.volume_ratios(x).shape == ((len(body.cells),) if points == 1 else (len(body.cells), points))
        np.testing.assert_allclose(body.volume_ratios(x), np.prod([1.1, 0.9, 1.05][:dimension]), rtol=1e-13)
        assert body.deformation_gradients(x).shape[-2:] == (dimension, dimension)
        assert body.point_volumes.sum() == pytest.approx(1)
        assert body.mass(3.0).sum() == pytest.approx(3 * dimension)
        assert body.mass(3.0, kind="consistent").sum() == pytest.approx(3 * dimension)

    def test_quadratic_elements_add_nodes_after_the_vertices(self):
        mesh = resilin.Mesh.box((1, 1, 1), (1, 1, 1))
        body = resilin.Elastic(
            mesh, resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.3), "P2", quadrature="exact"
        )
        np.testing.assert_array_equal(body.rest_positions[: len(mesh.positions)], mesh.positions)
        assert len(body.rest_positions) == 27
        assert body.quadrature == "exact"

    def test_an_element_that_does_not_fit_is_refused(self):
        mesh = resilin.Mesh.box((1, 1, 1), (1, 1, 1))
        with pytest.raises(resilin.InputError, match="Q1 on tetrahedron"):
            resilin.Elastic(mesh, resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.3), "Q1")
