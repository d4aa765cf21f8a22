"""Reads the frames that a run leaves: appended raw VTU, as Resilin writes it."""

import array
import dataclasses
import re

DTYPES = {b"Float64": "d", b"Int64": "q"}


@dataclasses.dataclass
class Frame:
    rest: list  # positions of the nodes at rest, three numbers each [m]
    displacements: list  # displacements of the nodes, three numbers each [m]
    positions: list  # positions of the nodes, three numbers each, to the last bit [m]
    cells: list  # node numbers of each cell, in VTK's order
    bodies: list  # number of the body that each cell is of

    def nodes_of(self, body):
        """Node numbers of a body."""
        return {i for cell, number in zip(self.cells, self.bodies, strict=True) if number == body for i in cell}


def read_frame(folder, step):
    data = (folder / "frames" / f"{step:04d}.vtu").read_bytes()
    head, _, appended = data.partition(b'<AppendedData encoding="raw">\n_')

    def numbers(name):
        found = re.search(rb'type="(\w+)" Name="%s" [^>]*offset="(\d+)"' % name, head)
        start = int(found[2]) + 8
        size = int.from_bytes(appended[start - 8 : start], "little")
        return array.array(DTYPES[found[1]], appended[start : start + size])

    def vectors(name):
        flat = numbers(name)
        return [flat[i : i + 3] for i in range(0, len(flat), 3)]

    displacements, positions = vectors(b"displacement"), vectors(b"Points")
    rest = [[x - u for x, u in zip(*pair, strict=True)] for pair in zip(positions, displacements, strict=True)]
    connectivity = numbers(b"connectivity")
    ends = numbers(b"offsets")
    cells = [connectivity[begin:end] for begin, end in zip([0, *ends], ends, strict=False)]
    return Frame(rest, displacements, positions, cells, numbers(b"body"))
