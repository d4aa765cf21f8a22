"""Times a batched material written in torch beside resilin.Material, on the same tensors.

    python benchmarks/python/torch_comparison.py [--counts 1000 100000 1000000] [--threads 1 2] [--json FILE]

Both take tensors (M, 3, 3) in float64 and give tensors back. Calls alternate, so that both meet the same moments of a
busy machine; times are medians of calls, in nanoseconds per element: of processor time on one thread, of a clock on the
wall on several.
"""

# ruff: noqa: N803, N806 - F, P, H and J are the letters of the field

import argparse
import json
import platform
import statistics
import sys
import time

import numpy as np
import torch

import resilin
from resilin.torch import StableNeoHookean

YOUNGS_MODULUS, POISSONS_RATIO = 1e6, 0.45
BYTES = {"energy": 80, "stress": 144, "forces": 248}  # read and written per element
SECONDS_PER_CASE = 3.0


class TorchMaterial:
    """The operations of the class that StableNeoHookean replaces, clamps included."""

    def __init__(self):
        self.mu = YOUNGS_MODULUS / (2 * (1 + POISSONS_RATIO))
        self.lam = YOUNGS_MODULUS * POISSONS_RATIO / ((1 + POISSONS_RATIO) * (1 - 2 * POISSONS_RATIO))

    def energy_density(self, F):
        first_invariant = torch.sum(F * F, dim=(1, 2))
        J = torch.clamp(torch.det(F), min=1e-6)
        return self.mu / 2 * (first_invariant - 3) - self.mu * torch.log(J) + self.lam / 2 * (J - 1) ** 2

    def first_piola_kirchhoff_stress(self, F):
        leaf = F.detach().requires_grad_(True)
        return torch.autograd.grad(self.energy_density(leaf).sum(), leaf, create_graph=True)[0]

    def first_piola_kirchhoff_stress_analytic(self, F):
        J = torch.det(F)
        J = torch.clamp(J, min=0.1, max=5.0) if (J < 0.01).any() else torch.clamp(J, min=0.3, max=3.0)
        U, sigma, Vh = torch.linalg.svd(F)
        inverse_sigma = 1 / torch.clamp(sigma, min=0.2, max=5.0)
        inverse = torch.bmm(Vh.transpose(1, 2), torch.bmm(torch.diag_embed(inverse_sigma), U.transpose(1, 2)))
        slope = (J - 1).unsqueeze(-1).unsqueeze(-1) * J.unsqueeze(-1).unsqueeze(-1)
        P = self.mu * F - self.mu * inverse.transpose(1, 2) + self.lam * slope * inverse.transpose(1, 2)
        return P * torch.clamp(1e6 / (torch.norm(P, dim=(1, 2), keepdim=True) + 1e-8), max=1.0)

    def compute_elastic_forces(self, F, Dm_inv, volume):
        P = self.first_piola_kirchhoff_stress_analytic(F)
        H = -volume.unsqueeze(-1).unsqueeze(-1) * torch.bmm(P, Dm_inv.transpose(1, 2))
        f1, f2, f3 = H[:, :, 0], H[:, :, 1], H[:, :, 2]
        return torch.stack([-(f1 + f2 + f3), f1, f2, f3], dim=1)


def cells(count):
    """F with J around 1, Dm_inv and volume of `count` tetrahedra."""
    generator = torch.Generator().manual_seed(0)
    noise = torch.rand(2, count, 3, 3, dtype=torch.float64, generator=generator) - 0.5
    F, Dm_inv = torch.eye(3, dtype=torch.float64) + 0.2 * noise
    return F.contiguous(), Dm_inv.contiguous(), torch.rand(count, dtype=torch.float64, generator=generator) + 0.5


def methods(theirs, ours, F, Dm_inv, volume):
    """Name -> (call in torch, call here, the same call into an array that exists)."""
    law = resilin.Material("neo_hookean_quadratic", youngs_modulus=YOUNGS_MODULUS, poissons_ratio=POISSONS_RATIO)
    psi, P, f = torch.empty(len(F)).double(), torch.empty_like(F), torch.empty(len(F), 4, 3).double()
    return {
        "energy": (
            lambda: theirs.energy_density(F),
            lambda: ours.energy_density(F),
            lambda: law.energy_density(F, out=psi),
        ),
        "stress": (
            lambda: theirs.first_piola_kirchhoff_stress(F),
            lambda: ours.first_piola_kirchhoff_stress(F),
            lambda: law.first_piola_kirchhoff_stress(F, out=P),
        ),
        "forces": (
            lambda: theirs.compute_elastic_forces(F, Dm_inv, volume),
            lambda: ours.compute_elastic_forces(F, Dm_inv, volume),
            lambda: law.elastic_forces(F, Dm_inv, volume, out=f),
        ),
    }


def seconds_of(call, repeats):
    clock = time.thread_time if resilin.num_threads() == 1 else time.perf_counter
    begin = clock()
    for _ in range(repeats):
        call()
    return (clock() - begin) / repeats


def alternating_medians(calls):
    """Median seconds of one call of each, taken in turns for about SECONDS_PER_CASE."""
    repeats = [max(1, int(2e-3 / max(seconds_of(call, 2), 1e-7))) for call in calls]  # repeats of a few milliseconds
    samples = [[] for _ in calls]
    end = time.perf_counter() + SECONDS_PER_CASE
    while len(samples[0]) < 3 or (time.perf_counter() < end and len(samples[0]) < 200):
        for call, count, taken in zip(calls, repeats, samples, strict=True):
            taken.append(seconds_of(call, count))
    return [statistics.median(taken) for taken in samples]


def copy_bandwidth():
    """Bytes read and written per second by a copy between two arrays of 256 MiB, on one thread."""
    resilin.set_num_threads(1)
    source = np.ones(1 << 25)
    target = np.empty_like(source)
    np.copyto(target, source)
    return 2 * source.nbytes / statistics.median(seconds_of(lambda: np.copyto(target, source), 1) for _ in range(7))


def compare(counts, threads):
    """One row for each method, count and number of threads."""
    theirs, ours = TorchMaterial(), StableNeoHookean(YOUNGS_MODULUS, POISSONS_RATIO)
    rows = []
    for number in threads:
        torch.set_num_threads(number)
        resilin.set_num_threads(number)
        for count in counts:
            for name, calls in methods(theirs, ours, *cells(count)).items():
                in_torch, here, into = (1e9 / count * seconds for seconds in alternating_medians(calls))
                rows.append(
                    {
                        "method": name,
                        "count": count,
                        "threads": number,
                        "torch_ns": in_torch,
                        "resilin_ns": here,
                        "resilin_out_ns": into,
                        "ratio": in_torch / here,
                    }
                )
    return rows


def tangents(count=100_000):
    """Nanoseconds per element of stress_tangent on one thread, for each projection."""
    resilin.set_num_threads(1)
    law = resilin.Material("neo_hookean_quadratic", youngs_modulus=YOUNGS_MODULUS, poissons_ratio=POISSONS_RATIO)
    F = cells(count)[0]
    A = torch.empty(count, 3, 3, 3, 3, dtype=torch.float64)
    kinds = (None, "clamp", "absolute")
    medians = alternating_medians([lambda kind=kind: law.stress_tangent(F, kind, out=A) for kind in kinds])
    return {str(kind): 1e9 / count * seconds for kind, seconds in zip(kinds, medians, strict=True)}


def overheads():
    """Microseconds of a call with a single element."""
    resilin.set_num_threads(1)
    law = resilin.Material("neo_hookean_quadratic", youngs_modulus=YOUNGS_MODULUS, poissons_ratio=POISSONS_RATIO)
    tensors = cells(1)
    arrays = [tensor.numpy() for tensor in tensors]
    result = {}
    for kind, (F, Dm_inv, volume) in {"numpy": arrays, "torch": tensors}.items():
        calls = {
            "energy": lambda F=F: law.energy_density(F),
            "stress": lambda F=F: law.first_piola_kirchhoff_stress(F),
            "forces": lambda F=F, D=Dm_inv, V=volume: law.elastic_forces(F, D, V),
        }
        result[kind] = {name: 1e6 * min(seconds_of(call, 2000) for _ in range(9)) for name, call in calls.items()}
    return result


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()


def print_table(report):
    bandwidth = report["copy_bandwidth"]
    print(f"{report['processor']}, torch {report['torch']}, numpy {report['numpy']}, Python {report['python']}")
    print(f"copy: {bandwidth / 1e9:.1f} GB/s read and written; all times in ns per element")
    print(f"{'':8}{'M':>9}{'threads':>9}{'torch':>10}{'resilin':>10}{'out=':>8}{'ratio':>8}{'copy limit':>12}")
    for row in report["rows"]:
        limit = 1e9 * BYTES[row["method"]] / bandwidth
        print(
            f"{row['method']:8}{row['count']:>9}{row['threads']:>9}{row['torch_ns']:>10.1f}{row['resilin_ns']:>10.2f}"
            f"{row['resilin_out_ns']:>8.2f}{row['ratio']:>8.0f}{limit:>12.2f}"
        )
    print("stress_tangent, M = 1e5, one thread [ns/element]:", _numbers(report["stress_tangent_ns"]))
    for kind, times in report["overhead_us"].items():
        print(f"one element, {kind} [us/call]:", _numbers(times))


def _numbers(times):
    return ", ".join(f"{name} {value:.1f}" for name, value in times.items())


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--counts", type=int, nargs="+", default=[1000, 100_000, 1_000_000])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--json", metavar="FILE", help="write the report here as well")
    options = parser.parse_args(arguments)
    report = {
        "processor": processor(),
        "torch": torch.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "resilin": resilin.__version__,
        "copy_bandwidth": copy_bandwidth(),
        "overhead_us": overheads(),
        "stress_tangent_ns": tangents(),
        "rows": compare(options.counts, options.threads),
    }
    print_table(report)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(report, file, indent=1)


if __name__ == "__main__":
    main(sys.argv[1:])
