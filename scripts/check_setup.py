"""The functions of setup.sh that decide what to install and how long things take, without installing anything."""

import pathlib
import shutil
import subprocess
import tempfile

from files import ROOT

ABSENT = "resilin-no-such-package"
OF_EVERY_DEBIAN = ("awk", "bash", "dpkg-query", "head", "sed", "sort")  # tools that the functions call


def run_setup(commands):
    """Runs shell commands with setup.sh loaded, as strictly as ./run and ./test do."""
    script = f"set -euo pipefail\nroot={ROOT}\nsource {ROOT}/scripts/setup.sh\n{commands}"
    return subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=False)


def find_problems():
    cases = [  # commands, expected standard output
        (f"missing_packages {ABSENT} bash coreutils", f"{ABSENT}\n"),
        ("missing_packages bash coreutils", ""),
        ('missing_packages "${build_packages[@]}"', ""),
        ("install_packages bash coreutils && echo installed", "installed\n"),
        ("timed nothing true; echo ${#spent[@]}", "0\n"),
        ("timed wrong false || echo failed", "failed\n"),
        ("slow() { SECONDS=$((SECONDS + 9)); }; timed it slow; echo ${spent[0]%=*}", "--spent=it\n"),
    ]
    with tempfile.TemporaryDirectory() as folder:
        for tool in OF_EVERY_DEBIAN:
            pathlib.Path(folder, tool).symlink_to(shutil.which(tool))
        bare = f"PATH={folder}; hash -r; "  # no compiler, no cmake
        cases += [
            (f"{bare}missing_packages {ABSENT} bash coreutils", f"{ABSENT}\n"),
            (f"{bare}mapfile -t found < <(missing_packages bash {ABSENT}); echo ${{found[@]}}", f"{ABSENT}\n"),
            (f"{bare}packages_replaced_by_tools; echo none", "none\n"),
            ("missing_packages() { return 3; }; (install_packages bash) 2>/dev/null || echo told", "told\n"),
        ]
        return problems_of(cases)


def problems_of(cases):
    problems = []
    for commands, expected in cases:
        run = run_setup(commands)
        if run.returncode != 0 or run.stdout != expected:
            problems.append(f"setup.sh: {commands}: expected {expected!r}, got {run.stdout + run.stderr!r}")
    return problems
