#!/usr/bin/env python3
"""Translates problems of FEBio's test suite, runs them and compares a norm of the solution.

RESILIN_SHARED=FOLDER validation/febio/run.py              every problem of FOLDER/febio that can be expressed
RESILIN_SHARED=FOLDER validation/febio/run.py --only ma    problems whose name contains the text
RESILIN_SHARED=FOLDER validation/febio/run.py --json FILE  writes a line for each problem, too

The norm is the l2 norm of all free displacements and of the unknowns of rigid bodies at the end of the last step.
FEBio stops early by default, so that some of its norms hold to 1e-6 or 1e-4 only. The files are read where they are.
"""

import argparse
import collections
import json
import os
import pathlib
import time

from materials import InexpressibleError
from translate import norm_of


def compare(folder, only):
    """[{name, difference or problem}] of all problems, in their order."""
    rows = []
    for name, known in json.loads((folder / "norms.json").read_text()).items():
        if not any(text in name for text in only.split(",")):
            continue
        row = {"name": name, "norm": known["norm"], "outcome": known["outcome"]}
        start = time.monotonic()
        try:
            row["ours"] = norm_of(folder / f"{name}.feb")
            row["difference"] = abs(row["ours"] - known["norm"]) / max(abs(known["norm"]), 1e-9)
        except InexpressibleError as problem:
            row["cannot"] = str(problem)
        except Exception as problem:  # noqa: BLE001 - a problem that fails is a row like the others
            row["problem"] = str(problem).splitlines()[0]
        row["seconds"] = round(time.monotonic() - start, 2)
        rows.append(row)
        outcome = row.get("difference", row.get("problem") or "cannot: " + row.get("cannot", ""))
        print(name, outcome, f"{row['seconds']} s", flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="TEXT", help="problems whose name contains one of these, a,b,c")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write the rows")
    arguments = parser.parse_args()
    if not os.environ.get("RESILIN_SHARED"):
        parser.error("RESILIN_SHARED: expected the folder that holds febio/, got nothing")
    rows = compare(pathlib.Path(os.environ["RESILIN_SHARED"]) / "febio", arguments.only)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1))
    run = [row for row in rows if "cannot" not in row]
    print(f"{len(rows)} problems, {len(run)} expressible")
    for limit in (1e-6, 1e-4, 1e-2):
        print(f"to {limit:g}: {sum(row.get('difference', 1) <= limit for row in run)}")
    reasons = collections.Counter(row["cannot"] for row in rows if "cannot" in row)
    for reason, count in reasons.most_common():
        print(f"{count:4}  {reason}")


if __name__ == "__main__":
    main()
