"""Runs the tests of the Python package: on the build folder, and on a wheel in an environment of its own."""

import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

from files import ROOT

FOLDER = ROOT / "build" / "python"
TESTS = ROOT / "python" / "tests"
INTERPRETER = FOLDER / "venv" / "bin" / "python"  # made by setup.sh
EXTRAS = ("plot", "parquet", "sweep", "notebook")  # extras of the package, which its tests use
TIME_LIMIT = 1800  # [s] for all tests when one hangs; they take a minute on quiet cores


def run_in_build_folder():
    """All tests on the package as ./test has just built it."""
    package = ROOT / "build" / "release" / "python"
    return run_pytest(INTERPRETER, "build.xml", environment={"PYTHONPATH": str(package)})


def run_what_the_wheel_leaves_out():
    """The files of tests that name torch, on that package: after run_in_empty_environment all others would be the same
    again."""
    package = ROOT / "build" / "release" / "python"
    files = [file for file in sorted(TESTS.glob("test_*.py")) if "torch" in file.read_text(encoding="utf-8")]
    return run_pytest(INTERPRETER, "torch.xml", *files, environment={"PYTHONPATH": str(package)})


def run_in_empty_environment():
    """All tests but those of torch, whose wheel is a gigabyte, on a wheel that carries what it needs."""
    wheels = FOLDER / "wheels"
    shutil.rmtree(wheels, ignore_errors=True)
    statistics = FOLDER / "ccache.log"
    statistics.unlink(missing_ok=True)
    environment = {"RESILIN_COMPILER_LAUNCHER": os.environ.get("RESILIN_COMPILER_LAUNCHER", default_launcher())}
    # The same warnings as in the release build, so that ccache finds its objects again.
    environment |= {"RESILIN_WARNINGS_AS_ERRORS": "ON", "CCACHE_STATSLOG": str(statistics)}
    problems = problems_of([ROOT / "scripts" / "build_wheel.sh", wheels], environment)
    if statistics.exists():
        print(f"    wheel: {compiled_objects(statistics.read_text())}", file=sys.stderr, flush=True)
    if problems:
        return None, problems
    venv = FOLDER / "empty"
    python = venv / "bin" / "python"
    (wheel,) = wheels.glob("*.whl")
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    for command in (
        [INTERPRETER, "-m", "venv", "--clear", venv],
        [*install, f"{wheel}[{','.join(EXTRAS)}]", *pinned()],
    ):
        problems = problems_of(command)
        if problems:
            return None, problems
    return run_on_wheel(python, "wheel.xml")


def pinned():
    """Requirements of the tests, with their versions."""
    text = (ROOT / "python" / "requirements-dev.txt").read_text(encoding="utf-8")
    return [line for line in text.partition("# To test")[2].splitlines()[1:] if not line.startswith("#")]


def run_on_wheel(python, results_name):
    """All tests but those of torch in an environment that has a wheel."""
    # Nothing of the system's libraries but those of every machine: the wheel must bring the rest.
    return run_pytest(python, results_name, "--ignore-glob=*test_torch*", environment={"PYTHONPATH": ""})


def default_launcher():
    """As scripts/setup.sh has it."""
    return "ccache" if shutil.which("ccache") else ""


def compiled_objects(log):
    """Statistics in ccache's log, one line of words for each object."""
    words = log.split("\n")
    hits = sum(word in ("direct_cache_hit", "preprocessed_cache_hit") for word in words)
    misses = words.count("cache_miss")
    return f"{hits + misses} objects, {misses} of them compiled, the others from ccache"


def problems_of(command, environment=None):
    """The end of what a command that failed said."""
    run = subprocess.run(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        env={**os.environ, **(environment or {})},
    )
    lines = run.stdout.splitlines()[-30:]
    return [f"{' '.join(map(str, command))}: exit code {run.returncode}", *lines] if run.returncode else []


def run_pytest(python, results_name, *options, environment):
    """(JUnit file, problems): one of them is empty."""
    results = FOLDER / results_name
    results.unlink(missing_ok=True)
    command = [python, "-m", "pytest", "-p", "no:cacheprovider", "--quiet", f"--junit-xml={results}", *options]
    try:
        run = subprocess.run(
            command,
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=TIME_LIMIT,
            env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **environment},
        )
    except subprocess.TimeoutExpired:
        return None, [f"{' '.join(map(str, command))}: took more than {TIME_LIMIT} s"]
    if run.returncode not in (0, 1) or not results.exists():
        return None, [f"pytest: exit code {run.returncode}", *run.stdout.splitlines()[-30:]]
    return results, []


def outcomes_in(results):
    """[(name, status, detail)] of the JUnit file that pytest wrote."""
    outcomes = []
    for case in ElementTree.parse(results).getroot().iter("testcase"):
        faults = [child for child in case if child.tag in ("failure", "error")]
        skipped = case.find("skipped")
        status = "failed" if faults else "skipped" if skipped is not None else "passed"
        detail = faults[0].text if faults else (skipped.get("message") if skipped is not None else "")
        outcomes.append((f"{case.get('classname')}.{case.get('name')}", status, (detail or "").strip()))
    return outcomes
