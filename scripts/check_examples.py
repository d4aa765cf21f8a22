"""Runs every scene in examples/ and the one in README.md, and looks at the report that each leaves."""

import json
import math
import pathlib
import re
import subprocess
import tempfile
import tomllib

from files import ROOT

PROGRAM = ROOT / "build" / "release" / "apps" / "cli" / "resilin"
TIME_LIMIT = 1200  # [s] for one that hangs; an example takes seconds to a minute on two quiet cores
COMMENT_LINES = re.compile(r"\A# \S.*\n")


def all_checks():
    """Name -> function that returns a list of problems."""
    checks = {
        path.name: lambda path=path: problems_of_scene(path) for path in sorted((ROOT / "examples").glob("*.toml"))
    }
    checks["in README.md"] = problems_of_readme
    return checks


def problems_of_fit(path):
    """Tests of a material, `resilin fit`: every law is fitted, and the page and the material are there. Experiments
    with a scene: the search converges, and nothing is odd about it."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        command = [PROGRAM, "fit", path, "--out", out, "--quiet"]
        run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=TIME_LIMIT)
        if run.returncode != 0:
            return [f"{path.name}: exit code {run.returncode}: {run.stderr.strip()}"]
        report = json.loads((out / "fit.json").read_text(encoding="utf-8"))
        tomllib.loads((out / "material.toml").read_text(encoding="utf-8"))
        if "parameters" in report:
            return [f"{path.name}: warning: {warning}" for warning in report["warnings"]]
        problems = [f"{path.name}: {law['name']} was not fitted" for law in report["not_fitted"]]
        if not report["laws"] or not all(test["r_squared"] > 0.95 for test in report["laws"][0]["tests"]):
            problems.append(f"{path.name}: no law meets the tests")
        if "<svg" not in (out / "fit.html").read_text(encoding="utf-8"):
            problems.append(f"{path.name}: fit.html shows no curves")
        return problems


def problems_of_readme():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"```toml\n(.*?)```", text, re.DOTALL)
    if block is None:
        return ["README.md: expected a scene in a block marked `toml`"]
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "readme.toml"
        scene.write_text(block.group(1), encoding="utf-8")
        return problems_of_run(scene)


def problems_of_scene(path):
    problems = problems_of_fit(path) if path.name.startswith("fit_") else problems_of_run(path)
    if not COMMENT_LINES.match(path.read_text(encoding="utf-8")):
        problems.append(f"{path.name}: expected a first line that says what to see")
    return problems


def problems_of_run(scene):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        command = [PROGRAM, "run", scene, "--out", out, "--quiet"]
        try:
            run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=TIME_LIMIT)
        except subprocess.TimeoutExpired:
            return [f"{scene.name}: took more than {TIME_LIMIT} s"]
        if run.returncode != 0:
            return [f"{scene.name}: exit code {run.returncode}: {run.stderr.strip()}"]
        problems = [f"{scene.name}: --quiet printed {run.stdout!r}"] if run.stdout else []
        report = json.loads((out / "report.json").read_text(encoding="utf-8"))
        return problems + problems_of_report(scene, tomllib.loads(scene.read_text(encoding="utf-8")), report, out)


def problems_of_report(scene, description, report, out):
    """The run is complete, its numbers are numbers and nothing is inverted."""
    problems = []
    frames = report["frames"]
    if report["status"] != "done":
        problems.append(f"{scene.name}: {report['status']}: {report['reason']}")
    probes = {probe["name"] for probe in description.get("probe", [])}
    for frame in frames:
        numbers = [frame["energy"]["total"], frame["min_volume_ratio"]]
        for probe in probes:
            numbers += frame["probes"][probe]["displacement"]
        if not all(math.isfinite(number) for number in numbers):
            problems.append(f"{scene.name}: frame {frame['step']} holds a number that is not finite")
    if len(frames) < 2 or not any((out / "frames").glob("*.vtu")) or not (out / "frames.pvd").exists():
        problems.append(f"{scene.name}: expected at least two frames and their pictures, got {len(frames)}")
    if probes and all(not any(frames[-1]["probes"][probe]["displacement"]) for probe in probes):
        problems.append(f"{scene.name}: nothing has moved")
    return problems
