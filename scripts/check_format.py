"""Formatters and linters that only look: C++, Python and shell."""

import shutil
import subprocess

from files import ROOT, repository_files

CPP = (".cpp", ".hpp", ".inl")


def lines_of(command, files):
    """The complaints of `command` about `files`; None when the command is not there."""
    if shutil.which(command[0]) is None:
        return None
    if not files:
        return []
    run = subprocess.run([*command, *files], capture_output=True, text=True, check=False, cwd=ROOT)
    return (run.stdout + run.stderr).splitlines() if run.returncode != 0 else []


def find_cpp_problems():
    complaints = lines_of(["clang-format", "--dry-run", "-Werror"], repository_files(*CPP))
    if complaints is None:
        return None
    names = sorted({line.split(":")[0].removeprefix(f"{ROOT}/") for line in complaints if ": error:" in line})
    return [f"{name}: not formatted; clang-format -i {name}" for name in names]


def find_python_problems():
    files = repository_files(".py")
    problems = lines_of(["ruff", "check", "--quiet", "--output-format=concise"], files)
    return problems if problems is None else problems + lines_of(["ruff", "format", "--check", "--quiet"], files)


def find_shell_problems():
    scripts = [ROOT / "run", ROOT / "test", ROOT / ".ci" / "run", *repository_files(".sh")]
    return [line for script in scripts for line in lines_of(["bash", "-n"], [script])]
