"""The command line, `resilin` or `python -m resilin`: the program in the package takes this process's place."""

from __future__ import annotations

import os
import pathlib
import sys
from typing import NoReturn

PROGRAM = pathlib.Path(__file__).parent / "bin" / "resilin"


def main() -> NoReturn:
    if not PROGRAM.exists():
        sys.exit(
            f"resilin: {PROGRAM}: expected the program there, got nothing; install the package again: pip install ."
        )
    os.execv(PROGRAM, ["resilin", *sys.argv[1:]])


if __name__ == "__main__":
    main()
