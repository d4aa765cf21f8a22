"""The functions of setup.sh that decide what to install and how long things take, without installing anything."""

import subprocess

from files import ROOT

ABSENT = "resilin-no-such-package"


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
    problems = []
    for commands, expected in cases:
        run = run_setup(commands)
        if run.returncode != 0 or run.stdout != expected:
            problems.append(f"setup.sh: {commands}: expected {expected!r}, got {run.stdout + run.stderr!r}")
    return problems
