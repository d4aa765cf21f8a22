"""Installs the library into an empty folder and builds and runs examples/cpp against it, outside the tree."""

import pathlib
import re
import shutil
import subprocess
import tempfile

from files import ROOT

EXAMPLE = ROOT / "examples" / "cpp"
TIP = re.compile(r"tip: *(-?[0-9.eE+-]+) m")
TIME_LIMIT = 1200  # [s] for a step that hangs; they take seconds
# Text that the program prints about itself, where shells and man look for it: the beginning of each.
PRINTED = {
    "bash-completion/completions/resilin": "# Completion for bash",
    "zsh/site-functions/_resilin": "#compdef resilin",
    "fish/vendor_completions.d/resilin.fish": "# Completion for fish",
    "man/man1/resilin.1": ".TH RESILIN 1",
}
SAG = -0.569481  # [m], by two finite-element codes that are not ours on the same mesh


def find_problems():
    with tempfile.TemporaryDirectory() as folder:
        return problems_in(pathlib.Path(folder))


def problems_in(folder):
    prefix, source, build = folder / "prefix", folder / "source", folder / "build"
    shutil.copytree(EXAMPLE, source)
    steps = (
        ["cmake", "--install", ROOT / "build" / "release", "--prefix", prefix],
        ["cmake", "-S", source, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}"],
        ["cmake", "--build", build],
        [build / "cantilever"],
    )
    for step in steps:
        run = subprocess.run(step, capture_output=True, text=True, check=False, timeout=TIME_LIMIT)
        if run.returncode != 0:
            command = " ".join(map(str, step))
            return [f"{command}: exit code {run.returncode}", *(run.stdout + run.stderr).splitlines()[-30:]]
    problems = [
        f"{file.relative_to(prefix)}: names this checkout, so the package cannot move to another machine"
        for file in prefix.rglob("*.cmake")
        if str(ROOT) in file.read_text()
    ]
    for file, beginning in PRINTED.items():
        path = prefix / "share" / file
        if not path.exists() or not path.read_text(encoding="utf-8").startswith(beginning):
            problems.append(f"share/{file}: expected a file that begins with {beginning!r}")
    return problems + problems_of_output(run.stdout)


def problems_of_output(output):
    match = TIP.search(output)
    if match is None:
        return [f"examples/cpp: expected a line `tip: NUMBER m`, got {output!r}"]
    if abs(float(match.group(1)) - SAG) > 2e-6:  # the program prints six digits
        return [f"examples/cpp: expected a tip at {SAG} m, got {match.group(1)}"]
    return []
