"""Who holds how much memory when a benchmark holds most, per unknown: the heap at its peak, by heaptrack.

    apt-get install --no-install-recommends heaptrack
    python benchmarks/python/memory_holders.py build/release/apps/cli/resilin-bench bar --n 25

What follows the program goes to it; one thread unless it says otherwise. Sizes are those that were asked for, in bytes
for each unknown; `process` is the peak of the whole process in a run without heaptrack, program and libraries included.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

# The first line whose pattern is in the stack of an allocation says whose it is.
HOLDERS = [
    ("multigrid: blocks, their inverse diagonals, vectors of a cycle", r"MultigridLevel::allocate"),
    ("multigrid: prolongation and its tentative one", r"MultigridLevel::(connect;?$|set_tentative)"),
    (
        "multigrid: maps of the Galerkin product, pattern",
        r"MultigridLevel::|(Lower|Permuted)Pattern|::(build_levels|analyze_pattern)",
    ),
    ("matrix", r"BlockMatrix::BlockMatrix"),
    ("places of the cells in the matrix", r"ElasticEnergy::(bind|find_places)"),
    ("pattern of the matrix, plan of its product", r"BlockPattern"),
    ("geometry of the cells", r"make_element_blocks|ElasticEnergy::ElasticEnergy|give_material"),
    ("masses", r"MassMatrix|add_masses|add_cell_masses"),
    ("mesh of the scene", r"make_box|Mesh"),
    ("cells and groups of the world", r"Builder::|World::|select_|supports_of"),
    ("conjugate gradients", r"ConjugateGradients|SmoothedAggregation|MatrixSample|SolverChain"),
    ("Newton's method", r"Newton::|Potential|LoadControl|solve_stage|Simulation"),
]


def peak_stacks(command, folder):
    """(stack, bytes) of the allocations that were alive at the peak."""
    trace = folder / "trace"
    subprocess.run(["heaptrack", "-o", trace, *command], check=True, stdout=subprocess.DEVNULL)
    [recorded] = folder.glob("trace*")
    stacks = folder / "stacks.txt"
    options = ["-p0", "-l0", "-a0", "-T0", "--flamegraph-cost-type", "peak", "-F", stacks]
    subprocess.run(["heaptrack_print", "-f", recorded, *options], check=True, capture_output=True)
    for line in stacks.read_text(encoding="utf-8").splitlines():
        stack, size = line.rsplit(" ", 1)
        yield re.sub(r"\([^()]*\)", "", stack.replace("(anonymous namespace)", "")), int(size)


def holder_of(stack):
    return next((name for name, pattern in HOLDERS if re.search(pattern, stack)), "everything else")


def run_and_measure(command):
    """Returns the output of the benchmark and the peak memory of its process [bytes]."""
    with subprocess.Popen([*command, "--json"], stdout=subprocess.PIPE) as process:
        report = json.load(process.stdout)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(process.returncode)
    return report, 1024 * usage.ru_maxrss


def main():
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    command = sys.argv[1:]
    if "--threads" not in command:
        command += ["--threads", "1"]
    report, process = run_and_measure(command)
    held = {}
    with tempfile.TemporaryDirectory() as folder:
        for stack, size in peak_stacks(command, pathlib.Path(folder)):
            held[holder_of(stack)] = held.get(holder_of(stack), 0) + size
    unknowns = report["unknowns"]
    print(f"{unknowns:.0f} unknowns")
    for name, size in sorted(held.items(), key=lambda item: -item[1]):
        print(f"{size / unknowns:8.1f}  {name}")
    print(f"{sum(held.values()) / unknowns:8.1f}  heap\n{process / unknowns:8.1f}  process")


if __name__ == "__main__":
    main()
