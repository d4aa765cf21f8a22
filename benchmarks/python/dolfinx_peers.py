"""A bar to its full load on one and two processes: Resilin with PETSc, Resilin's own solver, and dolfinx.

    apt-get install --no-install-recommends python3-dolfinx-real openmpi-bin
    python3 benchmarks/python/dolfinx_peers.py RESILIN [--n 15] [--repetitions 3]

RESILIN is the program, built with PETSc (cmake --preset petsc). The bar of `resilin bench bar`: 4 x 1 x 1 m, n boxes
for each metre, each cut into six linear tetrahedra, neo-Hookean, clamped at one end, bent by a body force, until the
forces are out of balance by 1e-8 of the load. dolfinx takes conjugate gradients with GAMG and the rigid motions, and as
many load steps as plain Newton needs; its best linear tolerance is to be found by --linear-tolerance. All take turns.

Resilin's times are those of the whole command with reading and output. dolfinx's begin after its modules have been
imported and its forms compiled (the run before the first that counts does that). Processor time is that of all
processes together, waiting for each other included, as MPI waits by asking again and again.
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

YOUNG, POISSON, FORCE = 1e6, 0.4, (0.0, 0.0, -3000.0)  # Pa, 1, N/m^3
TOLERANCE = 1e-8  # tolerance of the load
PLACES = [[4, 0, 0], [4, 1, 0], [4, 0, 1], [4, 1, 1], [2, 0, 0], [2, 1, 1]]  # nodes whose displacements are compared
AGREEMENT = 1e-6  # agreement of the largest; what TOLERANCE leaves
DOLFINX_PYTHON = "/usr/bin/python3"
DOLFINX_MODULES = "/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages"

SCENE = f"""
[simulation]
kind = "static"
[newton]
tolerance = {TOLERANCE}
[output]
fields = ["displacement"]
[[body]]
name = "bar"
element = "P1"
mesh = {{ box = {{ size = [4, 1, 1], cells = [CELLS] }} }}
material = {{ law = "neo_hookean", youngs_modulus = {YOUNG}, poissons_ratio = {POISSON}, density = 1000 }}
[[fix]]
name = "wall"
where = {{ plane = {{ axis = "x", at = 0 }} }}
[[load]]
name = "weight"
kind = "body_force"
value = {list(FORCE)}
"""


def scene_text(n):
    probes = [f'[[probe]]\nname = "{i}"\nat = {place}\n' for i, place in enumerate(PLACES)]
    return SCENE.replace("CELLS", f"{4 * n}, {n}, {n}") + "".join(probes)


def launch(command, ranks, folder):
    """Seconds on the wall clock, processor seconds of all processes, and what was printed."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}
    if command[0] == DOLFINX_PYTHON:
        environment["PYTHONPATH"] = DOLFINX_MODULES
    if ranks > 1:
        command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), *command]
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    seconds, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return seconds, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def run_resilin(program, solver, ranks, folder):
    command = [program, "run", "bar.toml", "--out", "out", "--threads", "1", "--formats", "vtu"]
    if solver:
        command += ["--set", f'solver.kind="{solver}"']
    wall, cpu, _ = launch(command, ranks, folder)
    frame = json.loads((folder / "out" / "report.json").read_text())["frames"][-1]
    moved = [frame["probes"][str(i)]["displacement"] for i in range(len(PLACES))]
    return {"wall": wall, "cpu": cpu, "newton": frame["newton_iterations"], "displacements": moved}


def run_dolfinx(options, ranks, folder):
    me = pathlib.Path(__file__).resolve()
    command = [DOLFINX_PYTHON, me, "--as-dolfinx", "--n", str(options.n), "--load-steps", str(options.load_steps)]
    _, _, printed = launch([*command, "--linear-tolerance", str(options.linear_tolerance)], ranks, folder)
    return json.loads(printed.splitlines()[-1])


def bar(n):
    """Nodes and tetrahedra: each box along the six paths from corner to corner (Kuhn)."""
    import itertools

    import numpy as np

    counts = np.array([4 * n, n, n])
    places = np.stack(np.meshgrid(*(np.arange(c + 1) for c in counts), indexing="ij"), axis=-1).reshape(-1, 3) / n
    corners = np.stack(np.meshgrid(*(np.arange(c) for c in counts), indexing="ij"), axis=-1).reshape(-1, 3)
    strides = np.array([(n + 1) * (n + 1), n + 1, 1])
    cells = []
    for path in itertools.permutations(range(3)):
        steps = np.cumsum([0, *(strides[axis] for axis in path)])
        cells.append((corners @ strides)[:, None] + steps)
    return places, np.stack(cells, axis=1).reshape(-1, 4)


def solve_by_dolfinx(options):
    """On each of the processes that mpirun has started; the first prints the result."""
    import dolfinx.fem.petsc
    import numpy as np
    import ufl
    from mpi4py import MPI
    from petsc4py import PETSc

    comm = MPI.COMM_WORLD
    fem = dolfinx.fem
    nodes, cells = bar(options.n) if comm.rank == 0 else (np.zeros((0, 3)), np.zeros((0, 4), np.int64))
    comm.barrier()
    start_wall, start_cpu = time.perf_counter(), time.process_time()
    shape = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1))
    mesh = dolfinx.mesh.create_mesh(comm, cells, nodes, shape)
    space = fem.VectorFunctionSpace(mesh, ("Lagrange", 1))
    wall = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x: np.isclose(x[0], 0.0))
    clamp = fem.dirichletbc(np.zeros(3), fem.locate_dofs_topological(space, 2, wall), space)
    u, v, w = fem.Function(space), ufl.TestFunction(space), ufl.TrialFunction(space)
    share, force = fem.Constant(mesh, PETSc.ScalarType(0)), fem.Constant(mesh, np.array(FORCE))
    mu, lame = YOUNG / (2 * (1 + POISSON)), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    gradient = ufl.Identity(3) + ufl.grad(u)
    log_volume = ufl.ln(ufl.det(gradient))
    dx = ufl.dx(metadata={"quadrature_degree": 0})
    energy = (mu / 2 * (ufl.inner(gradient, gradient) - 3) - mu * log_volume + lame / 2 * log_volume**2) * dx
    balance = ufl.derivative(energy, u, v) - share * ufl.inner(force, v) * ufl.dx(metadata={"quadrature_degree": 1})
    jit = {"cffi_extra_compile_args": ["-O3", "-march=native", "-ffast-math"], "cffi_libraries": ["m"]}
    forces = fem.form(balance, jit_params=jit)
    stiffness = fem.form(ufl.derivative(ufl.derivative(energy, u, v), u, w), jit_params=jit)
    matrix, b = fem.petsc.create_matrix(stiffness), fem.petsc.create_vector(forces)
    step, places = matrix.createVecRight(), matrix.createVecRight()
    places.array[:] = space.tabulate_dof_coordinates()[: space.dofmap.index_map.size_local].ravel()
    matrix.setNearNullSpace(PETSc.NullSpace().createRigidBody(places))
    solver = PETSc.KSP().create(comm)
    solver.setOperators(matrix)
    solver.setType("cg")
    solver.setTolerances(rtol=options.linear_tolerance, max_it=3000)
    solver.getPC().setType("gamg")
    solver.setFromOptions()

    def residual():
        with b.localForm() as local:
            local.set(0)
        fem.petsc.assemble_vector(b, forces)
        b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        fem.petsc.set_bc(b, [clamp], None, 0.0)
        return b.norm()

    share.value = 1
    load = residual()
    solves = iterations = 0
    for k in range(options.load_steps):
        share.value = (k + 1) / options.load_steps
        while not residual() <= TOLERANCE * load:
            matrix.zeroEntries()
            fem.petsc.assemble_matrix(matrix, stiffness, bcs=[clamp])
            matrix.assemble()
            solver.setOperators(matrix)
            solver.solve(b, step)
            fem.petsc.set_bc(step, [clamp], None, 0.0)  # the rigid motions move them a little
            u.vector.axpy(-1, step)
            u.x.scatter_forward()
            solves += 1
            iterations += solver.getIterationNumber()
            if solves > 100 or not np.isfinite(b.norm()):
                raise SystemExit("Newton's method does not converge; take more --load-steps")
    comm.barrier()
    cpu = comm.allreduce(time.process_time() - start_cpu)
    seconds = time.perf_counter() - start_wall
    own = space.tabulate_dof_coordinates()[: space.dofmap.index_map.size_local]
    moved = u.x.array.reshape(-1, 3)
    found = {}
    for i, place in enumerate(PLACES):
        for node in np.flatnonzero(np.linalg.norm(own - place, axis=1) < 1e-9):
            found[i] = moved[node].tolist()
    found = comm.gather(found)
    if comm.rank == 0:
        all_found = {i: shift for part in found for i, shift in part.items()}
        facts = {"wall": seconds, "cpu": cpu, "newton": solves, "iterations": iterations}
        print(json.dumps(facts | {"displacements": [all_found[i] for i in range(len(PLACES))]}))


def differences(runs):
    """In words, of everybody's displacements to the first's."""
    reference = next(iter(runs.values()))[0]["displacements"]
    size = max(abs(value) for shift in reference for value in shift)
    problems = []
    for name, results in runs.items():
        for result in results:
            pairs = zip(sum(reference, []), sum(result["displacements"], []), strict=True)
            worst = max(abs(a - b) for a, b in pairs) / size
            if not worst <= AGREEMENT:
                problems.append(f"{name}: displacements differ by {worst:.1e} of the largest")
    return problems


def compare(options):
    program = pathlib.Path(options.resilin).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "bar.toml").write_text(scene_text(options.n))
        cases = {
            "resilin, petsc_gamg, 1 process": lambda: run_resilin(program, "petsc_gamg", 1, folder),
            "resilin, petsc_gamg, 2 processes": lambda: run_resilin(program, "", 2, folder),
            "resilin, cg_amg, 1 process": lambda: run_resilin(program, "cg_amg", 1, folder),
            "dolfinx, GAMG, 1 process": lambda: run_dolfinx(options, 1, folder),
            "dolfinx, GAMG, 2 processes": lambda: run_dolfinx(options, 2, folder),
        }
        run_dolfinx(options, 1, folder)  # compiles its forms
        runs = {case: [] for case in cases}
        for _ in range(options.repetitions):
            for case, run in cases.items():
                runs[case].append(run())
    medians = {
        case: {key: statistics.median(result[key] for result in results) for key in ("wall", "cpu")}
        for case, results in runs.items()
    }
    print(f"{'':34} {'wall s':>8} {'cpu s':>8} {'Newton':>7}   dolfinx on as many, wall, cpu")
    for case, times in medians.items():
        peer = medians[f"dolfinx, GAMG, {case.split(', ')[-1]}"]
        ratios = f"{peer['wall'] / times['wall']:8.2f} {peer['cpu'] / times['cpu']:8.2f}"
        newton = runs[case][0]["newton"]
        print(f"{case:34} {times['wall']:8.2f} {times['cpu']:8.2f} {newton:7} {ratios}")
    if problems := differences(runs):
        sys.exit("\n".join(problems))
    print(f"displacements of {len(PLACES)} nodes agree within {AGREEMENT:g} of the largest")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("resilin", nargs="?", help="the program, built with PETSc")
    parser.add_argument("--n", type=int, default=15, help="boxes for each metre")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--load-steps", type=int, default=4, help="of dolfinx")
    parser.add_argument("--linear-tolerance", type=float, default=1e-5, help="of dolfinx")
    parser.add_argument("--as-dolfinx", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.as_dolfinx:
        solve_by_dolfinx(options)
    elif options.resilin is None:
        parser.error("the program is missing")
    else:
        compare(options)


if __name__ == "__main__":
    main()
