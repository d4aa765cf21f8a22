"""The files of the repository, for the checks beside this one."""

import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def repository_files(*suffixes):
    """Tracked and new files that git does not ignore; in an unpacked archive all but build products."""
    command = ["git", "-C", ROOT, "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    try:
        listing = subprocess.run(command, capture_output=True, check=True, text=True).stdout
        paths = [ROOT / name for name in listing.split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        paths = [p for p in ROOT.rglob("*") if not {"build", "out", "node_modules"} & set(p.relative_to(ROOT).parts)]
    chosen = {p for p in paths if p.is_file() and (not suffixes or p.name.endswith(suffixes))}
    return sorted(chosen)


def relative(path):
    return path.relative_to(ROOT).as_posix()


def project_version():
    return re.search(r"project\(resilin VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
