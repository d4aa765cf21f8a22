"""Writes the type stub of resilin._core into its folder: nanobind's, with no parameter of a type left open."""

import pathlib
import re
import sys

from nanobind import stubgen

folder = pathlib.Path(sys.argv[1])
stub = folder / "_core.pyi"
stubgen.main(["-q", "-i", str(folder), "-m", "_core", "-o", str(stub)])
text = stub.read_text(encoding="utf-8")
text = re.sub(r"\bos\.PathLike\b(?!\[)", "os.PathLike[str]", text)
text = re.sub(r"\bNDArray(?=,)", "NDArray[numpy.generic]", text)
stub.write_text(text, encoding="utf-8")
