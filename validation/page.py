"""The page docs/validation.md: every row of validation with what was expected, what came and how far off it is."""

import math
import pathlib
import re
import subprocess
import textwrap

from case import cases

HEAD = """# Validation

Resilin's results beside those of other codes, published benchmarks and closed forms.
"""
HOW = """## How to read and repeat it
- A relative error is the largest difference of a component, divided by the largest expected component.
- "Newton" counts the iterations of the whole run, over all its load increments or time steps.
- Scenes, meshes and expected numbers lie in [validation](../validation), one folder per case.
- `./test validation` runs the quick rows on your machine.
- `validation/run.py build/release/apps/cli/resilin` runs all rows; `--report docs/validation.md` writes this page.
"""
# Their order on the page; a case of another topic comes after them.
TOPICS = (
    "Static elasticity",
    "Nearly incompressible solids",
    "Patch tests and convergence",
    "Constitutive models",
    "Buckling",
    "Dynamics and modal analysis",
    "Rigid bodies, joints and cables",
    "Contact and friction",
)
SUMMARY = (
    "| topic | compared with | cases | rows | numbers | to 1e-6 or closer | largest error of these | rows that fail |\n"
    f"{'| --- ' * 8}|\n"
)
TABLE = """| row | quantity | expected | got | relative error | tolerance | Newton | |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""
COLUMNS = 8


def write(file, program, results, folders):
    """Writes the page, and beside it one picture for each case that has a folder of results in `folders`."""
    pictures = {}
    for name, case in cases().items():
        if "picture" in case:
            folder = folders[name, case["picture"]["row"]]
            target = file.parent / "images" / "validation" / f"{name}.png"
            pictures[name] = draw(target, program, folder, case["picture"]["options"])
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    file.write_text(text_of(version, results, pictures), encoding="utf-8")


def text_of(version, results, pictures):
    """The page; `pictures` {name of a case: file}."""
    by_topic = {}
    for name, case in sorted(cases().items(), key=lambda item: place_of(item[1])):
        of_case = [result for case_name, result in results if case_name == name]
        by_topic.setdefault(case["topic"], []).append((name, case, of_case))
    sections = [topic_section(topic, entries, pictures) for topic, entries in by_topic.items()]
    return "\n".join([HEAD, summary(version, results, by_topic), HOW, *sections])


def place_of(case):
    """Where a case stands on the page."""
    topic = case["topic"]
    return (TOPICS.index(topic) if topic in TOPICS else len(TOPICS), topic, case["title"])


def anchor(title):
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def summary(version, results, by_topic):
    """A line for each topic, and one for all."""
    numbers = [found for _, result in results for found in result.comparisons]
    errors = close_errors(results)
    failed = sum(not result.passed for _, result in results)
    text = SUMMARY
    for topic, entries in by_topic.items():
        of_topic = [(name, result) for name, _, of_case in entries for result in of_case]
        against = ", ".join(dict.fromkeys(one for _, case, _ in entries for one in case["compared_with"].split(", ")))
        text += summary_line(f"[{topic}](#{anchor(topic)})", against, len(entries), of_topic)
    text += summary_line("**all**", "", sum(len(entries) for entries in by_topic.values()), results)
    half = f"{errors[len(errors) // 2]:.0e}"
    return f"""Version {version}: {len(results)} rows with {len(numbers)} numbers; {failed} rows fail.
Each topic ends with the rows that fail, and why.

{len(errors)} numbers are compared to 1e-6 or closer, on the same mesh with the same element.
Their largest relative error is {errors[-1]:.1e}, and half of them are below {half}.

{text}"""


def close_errors(results):
    """Relative errors of the numbers that are compared to 1e-6 or closer, from the smallest on."""
    return sorted(found.error for _, result in results for found in result.comparisons if found.tolerance <= 1e-6)


def summary_line(topic, against, number_of_cases, results):
    errors = close_errors(results)
    numbers = sum(len(result.comparisons) for _, result in results)
    failed = sum(not result.passed for _, result in results)
    largest = f"{errors[-1]:.1e}" if errors else ""
    cells = (topic, against, number_of_cases, len(results), numbers, len(errors), largest, failed or "none")
    return "| " + " | ".join(str(cell) for cell in cells) + " |\n"


def why(result):
    return result.problem or ", ".join(found.what for found in result.comparisons if not found.passed)


def topic_section(topic, entries, pictures):
    parts = [f"## {topic}\n"]
    parts += [section(name, case, results, pictures.get(name)) for name, case, results in entries]
    failed = [(case, result) for _, case, results in entries for result in results if not result.passed]
    if failed:
        points = "".join(explanation(case, result) for case, result in failed)
        parts.append(f"### Rows that fail: {topic.lower()}\n{points}")
    return "\n".join(parts)


def explanation(case, result):
    """A point of a list: what is off, and what is known about it."""
    remark = result.row.get("remark")
    known = f" {remark[0].upper()}{remark[1:]}." if remark else ""
    return wrapped(f"**{case['title']}, {result.row['name']}**. Off: {why(result)}.{known}", "- ")


def wrapped(text, bullet=""):
    """Text in lines; none begins with a minus or plus that Markdown would take for a point of a list."""
    whole = re.sub(r" ([-+]) ", r" \1\0", text)
    lines = textwrap.wrap(
        whole,
        118,
        initial_indent=bullet,
        subsequent_indent=" " * len(bullet),
        break_long_words=False,
        break_on_hyphens=False,
    )
    return "\n".join(lines).replace("\0", " ") + "\n"


def section(name, case, results, picture):
    lines = [f"### {case['title']}", f"[validation/{name}](../validation/{name})", "", wrapped(case["measured"])]
    lines += [wrapped(f"**Source**: {case['source']}"), wrapped(f"**Tolerances**: {case['tolerances']}")]
    if picture:
        lines += [f"![{case['title']}](images/validation/{picture.name})", ""]
    if "units" in case:
        lines += [f"**Units**: {case['units']}.", ""]
    return "\n".join(lines) + "\n" + TABLE + "".join(rows_of(result) for result in results)


def rows_of(result):
    """The lines of the table for a row; its name and its iterations stand in the first."""
    newton = "" if result.newton_iterations is None else result.newton_iterations
    if result.problem:
        return table_line(result.row["name"], result.problem, "", "", "", "", newton, "**failed**")
    text = ""
    for number, found in enumerate(result.comparisons):
        what = found.what + (f" ({found.note})" if found.note else "")
        is_bound = math.isnan(found.tolerance)
        error = "" if is_bound and found.passed else f"{found.error:.1e}"
        tolerance = "" if is_bound else f"{found.tolerance:.1e}".replace(".0e", "e")
        verdict = "passed" if found.passed else "**failed**"
        first = (result.row["name"], newton) if number == 0 else ("", "")
        text += table_line(first[0], what, found.expected, found.got, error, tolerance, first[1], verdict)
    return text


def table_line(*columns):
    return "| " + " | ".join(str(column).replace("|", "\\|").replace("\n", " ") for column in columns) + " |\n"


def folders_of_pictures(parent):
    """{(name of the case, name of the row): folder below `parent` for the results that will be drawn}."""
    pictured = [(name, case["picture"]["row"]) for name, case in cases().items() if "picture" in case]
    return {key: pathlib.Path(parent) / key[0] for key in pictured}


def draw(file, program, results, options):
    """Lets `resilin picture` draw the folder `results`."""
    file.parent.mkdir(parents=True, exist_ok=True)
    command = [program, "picture", results, "--out", file, "--size", "640", "480", *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return file


def rows_named_in(text):
    """{(name of the case, name of the row)} that the tables of a page hold."""
    named = set()
    case_name = None
    for line in text.splitlines():
        heading = re.match(r"\[validation/(\w+)\]", line)
        if heading:
            case_name = heading[1]
        columns = [column.strip() for column in re.split(r"(?<!\\)\|", line)[1:-1]]
        if case_name and len(columns) == COLUMNS and columns[0] not in ("", "row", "---"):
            named.add((case_name, columns[0]))
    return named


def problems_of_page(file):
    """A line for each row that the page lacks or that exists no more."""
    named = rows_named_in(pathlib.Path(file).read_text(encoding="utf-8"))
    exist = {(name, row["name"]) for name, case in cases().items() for row in case["rows"]}
    cure = "write the page again (validation/run.py)"
    return [f"{file}: the row {name}/{row} is not in it; {cure}" for name, row in sorted(exist - named)] + [
        f"{file}: there is no row {name}/{row} any more; {cure}" for name, row in sorted(named - exist)
    ]
