"""Runs scenes on two and three processes with the program of build/petsc and compares them with one process."""

import contextlib
import json
import math
import os
import pathlib
import random
import re
import signal
import struct
import subprocess
import tempfile
import time

import shared_run_scenes
from files import ROOT

PROGRAM = ROOT / "build" / "petsc" / "apps" / "cli" / "resilin"
PLAIN_PROGRAM = ROOT / "build" / "release" / "apps" / "cli" / "resilin"
TIME_LIMIT = 300  # [s] for one run that hangs; they take seconds
TOLERANCE = 1e-9  # relative: what sums in another order and another linear solver leave of Newton's 1e-12
PRINTED = re.compile(r"^resilin: ", re.MULTILINE)


def start(folder, arguments, ranks=0, program=PROGRAM):
    """The program in a folder; on several processes where `ranks` is more than 0."""
    launch = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)] if ranks else []
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([*launch, program, *arguments], cwd=folder, env=environment, **pipes)


def finish(process):
    try:
        output, errors = process.communicate(timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        for rank in children_of(process.pid):
            os.kill(rank, signal.SIGKILL)
        process.kill()
        process.communicate()
        raise
    return subprocess.CompletedProcess(process.args, process.returncode, output, errors)


def run(folder, arguments, ranks=0, program=PROGRAM):
    return finish(start(folder, arguments, ranks, program))


def children_of(process):
    """In the order in which they were started; none of a process that has ended."""
    try:
        return sorted(map(int, pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()))
    except OSError:
        return []


def catches(process, number):
    """Whether the process has a handler for a signal."""
    try:
        status = pathlib.Path(f"/proc/{process}/status").read_text()
    except OSError:
        return False
    return bool(int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) >> (number - 1) & 1)


def read_arrays(file):
    """{name: (components, numbers)} of the arrays of doubles in a .vtu file that we wrote."""
    data = file.read_bytes()
    begin = data.index(b"_", data.index(b"<AppendedData")) + 1
    header = data[:begin].decode("latin-1")
    arrays = {}
    for tag in re.findall(r"<DataArray ([^>]*)>", header):
        facts = dict(re.findall(r'(\w+)="([^"]*)"', tag))
        if facts["type"] != "Float64":
            continue
        at = begin + int(facts["offset"])
        (size,) = struct.unpack_from("<Q", data, at)
        components = int(facts.get("NumberOfComponents", 1))
        arrays[facts["Name"]] = components, struct.unpack_from(f"<{size // 8}d", data, at + 8)
    return arrays


def nodes_of(files):
    """{rest position, rounded: displacement} of all nodes of some .vtu files."""
    nodes = {}
    for file in files:
        arrays = read_arrays(file)
        places, moved = arrays["Points"][1], arrays["displacement"][1]
        for i in range(0, len(places), 3):
            shift = moved[i : i + 3]
            key = tuple(round(x - u, 7) + 0.0 for x, u in zip(places[i : i + 3], shift, strict=True))
            nodes.setdefault(key, []).append(shift)
    return nodes


def differences_of_nodes(one, several, slack):
    """In words, between the last frames of two results."""
    ours, theirs = nodes_of([one]), nodes_of(several)
    if ours.keys() != theirs.keys():
        return [f"nodes: expected {len(ours)}, got {len(theirs)}"]
    size = max(math.hypot(*copies[0]) for copies in ours.values())
    worst = max(math.dist(ours[key][0], other) for key, copies in theirs.items() for other in copies)
    apart = max(math.dist(copies[0], other) for copies in theirs.values() for other in copies)
    problems = []
    if not worst <= slack * TOLERANCE * size:
        problems.append(f"displacements: {worst / size:.1e} of the largest apart")
    if apart > 0:
        problems.append(f"copies of a node differ by {apart:.1e} m")
    return problems


def numbers_in(value, path=""):
    """(place, number) of everything in a tree of JSON."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from numbers_in(entry, f"{path}.{key}")
    elif isinstance(value, list):
        for i, entry in enumerate(value):
            yield from numbers_in(entry, f"{path}[{i}]")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, float(value)


COMPARED = ("probes", "reactions", "reaction_moments", "energy", "momentum")


def scales_of(frames):
    """{kind of number: its largest in any frame}: what a difference is measured by."""
    scales = {}
    for frame in frames:
        for key in COMPARED:
            for path, number in numbers_in(frame[key]):
                kind = f"{key} {path.rsplit('.', 1)[-1].split('[')[0]}" if key == "probes" else key
                scales[kind] = max(scales.get(kind, 0), abs(number))
    return scales


def differences_of_reports(one, several, scene):
    """In words, between two reports of a scene."""
    problems = []
    for key in ("status", "title", "bodies", "solver"):
        if key == "bodies":
            of_whole_bodies = ("discretisation_error", "discretisation_error_by", "mesh_volume_ratio")
            left = [{k: v for k, v in body.items() if k not in of_whole_bodies} for body in one[key]]
            right = [{k: v for k, v in body.items() if k not in of_whole_bodies} for body in several[key]]
            if left != right:
                problems.append(f"bodies: expected {left}, got {right}")
        elif key == "solver":
            if several[key] != "petsc_gamg":
                problems.append(f"solver: expected petsc_gamg, got {several[key]}")
        elif one[key] != several[key]:
            problems.append(f"{key}: expected {one[key]}, got {several[key]}: {several['reason']}")
    if len(one["frames"]) != len(several["frames"]):
        return [*problems, f"expected {len(one['frames'])} frames, got {len(several['frames'])}"]
    scales = scales_of(one["frames"])
    for left, right in zip(one["frames"], several["frames"], strict=True):
        where = f"step {left['step']}"
        if abs(left["newton_iterations"] - right["newton_iterations"]) > 1:
            problems.append(f"{where}: {left['newton_iterations']} Newton iterations, now {right['newton_iterations']}")
        if [left["worst_cell"], left["worst_body"]] != [right["worst_cell"], right["worst_body"]] and not scene.ties:
            problems.append(f"{where}: worst cell {left['worst_cell']}, now {right['worst_cell']}")
        if not abs(left["min_volume_ratio"] - right["min_volume_ratio"]) <= scene.slack * TOLERANCE:
            problems.append(f"{where}: volume ratio {left['min_volume_ratio']}, now {right['min_volume_ratio']}")
        for key in COMPARED:
            ours, theirs = dict(numbers_in(left[key])), dict(numbers_in(right[key]))
            if ours.keys() != theirs.keys():
                problems.append(f"{where}: {key}: expected {sorted(ours)}, got {sorted(theirs)}")
                continue
            for path, number in ours.items():
                kind = f"{key} {path.rsplit('.', 1)[-1].split('[')[0]}" if key == "probes" else key
                if not abs(number - theirs[path]) <= scene.slack * TOLERANCE * scales[kind]:
                    problems.append(f"{where}: {key}{path}: {number}, now {theirs[path]}")
        if left["extremes"].keys() != right["extremes"].keys():
            problems.append(f"{where}: extremes: {sorted(left['extremes'])}, now {sorted(right['extremes'])}")
        for field, ends in left["extremes"].items():
            for end, entry in ends.items():
                other, size = right["extremes"][field][end], max(abs(ends["max"]["value"]), abs(ends["min"]["value"]))
                if not abs(entry["value"] - other["value"]) <= 10 * scene.slack * TOLERANCE * size:
                    problems.append(f"{where}: {end} of {field}: {entry['value']}, now {other['value']}")
    return problems


def last_frame(folder):
    """The files of a result's last frame: one, or the pieces."""
    frames = json.loads((folder / "report.json").read_text())["frames"]
    stem = f"{len(frames) - 1:04}"
    plain = folder / "frames" / f"{stem}.vtu"
    if plain.exists():
        return [plain]
    joined = (folder / "frames" / f"{stem}.pvtu").read_text()
    return [folder / "frames" / name for name in re.findall(r'Source="([^"]*)"', joined)]


def compare_results(one, several, scene):
    reports = [json.loads((folder / "report.json").read_text()) for folder in (one, several)]
    return differences_of_reports(*reports, scene) + differences_of_nodes(
        last_frame(one)[0], last_frame(several), scene.slack
    )


def problems_of_run(completed):
    if completed.returncode == 0:
        return []
    return [f"exit code {completed.returncode}", *(completed.stdout + completed.stderr).splitlines()[-8:]]


def check_scene(scene):
    """One process against each number of processes."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(scene.text)
        problems = problems_of_run(run(folder, ["run", "scene.toml", "--out", "one", "--formats", "vtu"]))
        for ranks in () if problems else scene.ranks:
            out = f"on_{ranks}"
            found = problems_of_run(run(folder, ["run", "scene.toml", "--out", out], ranks))
            found = found or compare_results(folder / "one", folder / out, scene)
            problems += [f"{ranks} processes: {problem}" for problem in found]
        return problems


def check_resume():
    """Broken off on two processes, gone on with on three and on one: the result of an unbroken run."""
    scene = shared_run_scenes.RESUMED
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(scene.text)
        problems = problems_of_run(run(folder, ["run", "scene.toml", "--out", "one", "--formats", "vtu"]))
        for ranks in (3, 0):
            out = f"on_{ranks}"
            broken = run(folder, ["run", "scene.toml", "--out", out, "--steps", "3"], 2)
            if "stopped after 3 steps" not in broken.stdout + broken.stderr:
                problems.append(f"expected a run of 3 steps, got {broken.stdout + broken.stderr}")
                continue
            rest = run(folder, ["run", "scene.toml", "--out", out, "--resume", "--formats", "vtu"], ranks)
            found = problems_of_run(rest)
            if not found and ranks:
                found = compare_results(folder / "one", folder / out, scene)
            elif not found:
                found = differences_of_nodes(last_frame(folder / "one")[0], last_frame(folder / out), scene.slack)
            problems += [f"gone on with on {ranks or 1}: {problem}" for problem in found]
        return problems


def runs_program(process):
    """Not mpirun's copy of itself that is about to become the program, in which signals get lost."""
    with contextlib.suppress(OSError):
        return pathlib.Path(f"/proc/{process}/exe").readlink() == PROGRAM
    return False


def end_by_signal(folder, out, ranks, is_time, targets, number):
    """Starts an endless motion and sends a signal when `is_time(processes)`; what it ended with."""
    launcher = start(folder, ["run", "scene.toml", "--out", out, "--quiet"], ranks)
    processes = []
    while launcher.poll() is None and not (
        len(processes) == ranks and all(map(runs_program, processes)) and is_time(processes)
    ):
        time.sleep(0.001)
        processes = children_of(launcher.pid)
    for process in [launcher.pid] if targets == "mpirun" else processes[targets]:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, number)
    return finish(launcher)


def after(seconds):
    """When a time has passed since it was asked first."""
    begin = []

    def is_time(_):
        begin.append(time.monotonic())
        return begin[-1] - begin[0] > seconds

    return is_time


def problems_of_end(folder, out, ended, number, was_launcher):
    """Problems of a run that was told to end: all its processes have, with one line, and its checkpoint serves."""
    lines = [line for line in ended.stderr.splitlines() if PRINTED.match(line)]
    said = f"exit code {ended.returncode}, {lines or ended.stderr.splitlines()[-4:]}"
    if ended.returncode == 128 + number or (was_launcher and ended.returncode != 0 and len(lines) <= 1):
        return []  # before the program listened; mpirun kills what has not ended in a second
    if ended.returncode != 2 or len(lines) != 1 or "stopped by" not in lines[0]:
        return [f"expected exit code 2 and one line, got {said}"]
    rest = run(folder, ["run", "scene.toml", "--out", out, "--quiet", "--resume", "--steps", "1"], 2)
    if "stopped after 1 steps as asked" not in rest.stderr:
        return [f"after {said}: it does not go on: {rest.stderr.splitlines()[-4:]}"]
    return []


def check_signals():
    """Sent to any process at any time, also while METIS works, which has handlers of its own."""
    chance = random.Random(16)
    problems = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(shared_run_scenes.ENDLESS)

        def is_in_metis(processes):
            return catches(processes[0], signal.SIGTERM)

        ended = end_by_signal(folder, "metis", 2, is_in_metis, slice(0, 1), signal.SIGTERM)
        if ended.returncode != 2:
            problems.append("in METIS: not told to end")
        problems += problems_of_end(folder, "metis", ended, signal.SIGTERM, False)
        for i in range(6):
            delay = chance.uniform(0, 3)
            number = chance.choice([signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
            targets = chance.choice(["mpirun", slice(0, 1), slice(-1, None), slice(None)])
            ended = end_by_signal(folder, f"out{i}", chance.choice([2, 3]), after(delay), targets, number)
            found = problems_of_end(folder, f"out{i}", ended, number, targets == "mpirun")
            problems += [f"{number.name} to {targets} after {delay:.2f} s: {problem}" for problem in found]
    return problems


def check_refusal(text, ranks, words, program=PROGRAM):
    """One line, of one process, with these words."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(text)
        completed = run(folder, ["run", "scene.toml", "--out", "out"], ranks, program)
        lines = [line for line in completed.stderr.splitlines() if PRINTED.match(line)]
        if completed.returncode != 1:
            return [f"expected exit code 1, got {completed.returncode}", *completed.stderr.splitlines()[-8:]]
        if len(lines) != 1 or any(word not in lines[0] for word in words):
            return [f"expected one line with {' and '.join(words)}, got {lines or completed.stderr}"]
        return []


def check_solver_on_one_process():
    """solver.kind = "petsc_gamg" without mpirun: the same answer; in another build, one line."""
    scene = shared_run_scenes.SCENES[0]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(scene.text)
        by_petsc = ["--set", 'solver.kind="petsc_gamg"']
        for out, options in (("own", []), ("petsc", by_petsc)):
            problems = problems_of_run(run(folder, ["run", "scene.toml", "--out", out, "--formats", "vtu", *options]))
            if problems:
                return problems
        problems = compare_results(folder / "own", folder / "petsc", scene)
        if PLAIN_PROGRAM.exists():
            plain = run(folder, ["run", "scene.toml", "--out", "plain", *by_petsc], program=PLAIN_PROGRAM)
            lines = plain.stderr.splitlines()
            if plain.returncode != 1 or len(lines) != 1 or "petsc_gamg" not in lines[0]:
                problems.append(f"without PETSc: expected one line about petsc_gamg, got {plain.stderr!r}")
        return problems


def all_checks():
    """{name: function}; each gives a list of problems."""
    checks = {scene.name: lambda scene=scene: check_scene(scene) for scene in shared_run_scenes.SCENES}
    checks["a run is gone on with on another number of processes"] = check_resume
    checks["a run ends when one of its processes is told to"] = check_signals
    checks["petsc_gamg solves on one process"] = check_solver_on_one_process
    for name, (text, ranks, words) in shared_run_scenes.REFUSALS.items():
        checks[f"refused: {name}"] = lambda case=(text, ranks, words): check_refusal(*case)
    if PLAIN_PROGRAM.exists():
        text = shared_run_scenes.SCENES[0].text
        words = ["built without PETSc", "cmake --preset petsc"]
        checks["refused: mpirun without PETSc"] = lambda: check_refusal(text, 2, words, PLAIN_PROGRAM)
    return checks
