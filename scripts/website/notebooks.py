"""Notebooks as pages: their text, their code and, where they can be run here, what comes of it."""

import base64
import json
import subprocess
import sys

from files import ROOT
from website.pages import code_block

INTERPRETER = ROOT / "build" / "python" / "venv" / "bin" / "python"
PACKAGE = ROOT / "build" / "release" / "python"
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
    environment = {"PYTHONPATH": str(PACKAGE), "PATH": "/usr/bin:/bin", "HOME": str(path.parent)}
    command = [INTERPRETER, "-c", RUN, path, path.parent]
    run = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if run.returncode != 0:
        raise RuntimeError(f"{path.name}: {run.stderr.strip()[-800:]}")
    return json.loads(run.stdout)


def joined(value):
    return value if isinstance(value, str) else "".join(value)


def output_parts(output, name, files):
    """Markdown of an output; what is a picture or a page becomes a file under files/notebooks."""
    data = output.get("data", {})
    folder = files / "notebooks"
    if "text" in output:
        yield code_block(joined(output["text"]), "text")
    elif "image/png" in data:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.png").write_bytes(base64.b64decode(joined(data["image/png"])))
        yield f'<img src="UP/notebooks/{name}.png" alt="what the code above draws">\n'
    elif "<iframe" in joined(data.get("text/html", "")):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.html").write_text(joined(data["text/html"]), encoding="utf-8")
        yield f'<iframe class="result" src="UP/notebooks/{name}.html" loading="lazy" title="the result"></iframe>\n'
    elif "text/plain" in data:
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
