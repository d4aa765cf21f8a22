"""clang-tidy over the library and the programs, or over the files named on the command line.

A file whose text, headers of this project and settings have not changed since it last came out clean is not looked
at again (build/tools/tidy holds the memory), so that a second run takes a second.
"""

import concurrent.futures
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

from files import ROOT, relative, repository_files

BUILD = ROOT / "build" / "release"
MEMORY = ROOT / "build" / "tools" / "tidy"
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def with_headers(path, seen):
    """Adds `path` and all headers of this project that it sees to `seen`."""
    if path in seen:
        return
    seen.add(path)
    for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
        for candidate in (ROOT / "src" / name, path.parent / name):
            if candidate.is_file():
                with_headers(candidate, seen)
                break


def fingerprint(path):
    seen = set()
    with_headers(path, seen)
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    digest.update((ROOT / ".pre-commit-config.yaml").read_bytes())
    for file in sorted(seen):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def problems_of_file(path):
    memory = MEMORY / relative(path).replace("/", "-")
    print_of_now = fingerprint(path)
    if memory.exists() and memory.read_text() == print_of_now:
        return []
    command = ["clang-tidy", "--quiet", "-p", BUILD, "--warnings-as-errors=*", path]
    run = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    if run.returncode == 0:
        MEMORY.mkdir(parents=True, exist_ok=True)
        memory.write_text(print_of_now)
        return []
    return [
        line.replace(f"{ROOT}/", "") for line in run.stdout.splitlines() if ": error:" in line or ": warning:" in line
    ] or [f"{relative(path)}: clang-tidy failed: {run.stderr.strip()[-300:]}"]


def find_problems(files=None):
    if shutil.which("clang-tidy") is None or not (BUILD / "compile_commands.json").exists():
        return None
    built = (BUILD / "compile_commands.json").read_text()
    files = files or [p for p in repository_files(".cpp") if relative(p).startswith(("src/", "apps/"))]
    files = [path for path in files if str(path) in built]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return sorted({line for lines in pool.map(problems_of_file, files) for line in lines})


if __name__ == "__main__":
    found = find_problems([pathlib.Path(name).resolve() for name in sys.argv[1:]])
    if found is None:
        sys.exit("clang-tidy or build/release/compile_commands.json is not there: run ./test once")
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))
