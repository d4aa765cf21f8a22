"""Runs the quick rows of validation/ and looks whether the page about them is up to date."""

import sys

from files import ROOT

sys.path.insert(0, str(ROOT / "validation"))

import page  # noqa: E402  (lies in validation/)
import run  # noqa: E402

PROGRAM = ROOT / "build" / "release" / "apps" / "cli" / "resilin"


def quick_rows(jobs):
    """[(case/row, what is wrong or an empty text)]."""
    results = run.run_rows(PROGRAM, run.choose(quick=True), jobs)
    return [
        (f"{case_name}/{result.row['name']}", "" if result.passed else run.describe(case_name, result, 0))
        for case_name, result in results
    ]


def problems_of_page():
    return page.problems_of_page(ROOT / "docs" / "validation.md")
