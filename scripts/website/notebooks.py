"""Notebooks as pages: their text, their code and, where they can be run here, what comes of it."""

import base64
import json
import os
import re
import subprocess
import sys
import tempfile

from files import ROOT
from website.pages import code_block

INTERPRETER = ROOT / "build" / "python" / "venv" / "bin" / "python"
PACKAGE = ROOT / "build" / "release" / "python"
WARNING = re.compile(r"\S+:\d+: UserWarning: (.*)")
PROGRESS = re.compile(r"\s*\d+ %  ")
WIDGET = "application/vnd.jupyter.widget-view+json"  # it lives with its kernel, which a page has not
RUN = """
import sys, nbformat, nbclient
book = nbformat.read(sys.argv[1], 4)
nbclient.NotebookClient(book, timeout=600, resources={"metadata": {"path": sys.argv[2]}}).execute()
nbformat.write(book, sys.stdout)
"""


def executed(path):
    """The notebook with outputs, as nbclient leaves it; as it stands where it cannot be run."""
    if not INTERPRETER.is_file() or not (PACKAGE / "resilin").is_dir():
        print(f"{path.name}: shown without outputs: ./test python makes what runs it", file=sys.stderr)
        return json.loads(path.read_text(encoding="utf-8"))
    command = [INTERPRETER, "-c", RUN, path, path.parent]
    with tempfile.TemporaryDirectory(prefix="resilin-site-") as home:  # for files that Jupyter leaves behind
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "HOME": home, "IPYTHONDIR": home}
        run = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if run.returncode != 0:
        raise RuntimeError(f"{path.name}: {run.stderr.strip()[-800:]}")
    return json.loads(run.stdout)


def joined(value):
    return value if isinstance(value, str) else "".join(value)


def worth_reading(text):
    """Output of a cell, without the line of progress and without the places in sources where warnings arise."""
    lines = [line.rsplit("\r", 1)[-1] for line in text.splitlines()]
    kept = []
    for line in lines:
        if match := WARNING.match(line):
            kept.append("warning: " + match[1])
        elif line.strip() and not line.startswith("  return ") and not PROGRESS.match(line):
            kept.append(line)
    return "\n".join(kept)


def output_parts(output, name, files):
    """Markdown of an output; what is a picture or a page becomes a file under files/notebooks."""
    data = output.get("data", {})
    folder = files / "notebooks"
    if "text" in output:
        if text := worth_reading(joined(output["text"])):
            yield code_block(text, "text")
    elif "image/png" in data:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.png").write_bytes(base64.b64decode(joined(data["image/png"])))
        yield f'<img src="UP/notebooks/{name}.png" alt="what the code above draws">\n'
    elif "<iframe" in joined(data.get("text/html", "")):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.html").write_text(joined(data["text/html"]), encoding="utf-8")
        yield f'<iframe class="result" src="UP/notebooks/{name}.html" loading="lazy" title="the result"></iframe>\n'
    elif "text/plain" in data and WIDGET not in data:
        yield code_block(joined(data["text/plain"]), "text")


def page(path, files, runs):
    """Text of the page; "UP" in it stands for the way to the root of the site."""
    book = executed(path) if runs else json.loads(path.read_text(encoding="utf-8"))
    parts = []
    for number, cell in enumerate(book["cells"]):
        source = joined(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source + "\n")
            continue
        parts.append(code_block(source, "python"))
        for i, output in enumerate(cell.get("outputs", [])):
            parts += output_parts(output, f"{path.stem}-{number}-{i}", files)
    return "\n".join(parts)
