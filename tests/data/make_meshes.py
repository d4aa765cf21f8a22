"""Makes the small meshes in meshes/ with programs that are not ours: pip install gmsh meshio vtk trimesh numpy.

cube*: the unit cube with the physical groups "body" (volume), "left" (the side x = 0), "rim" (two of its edges) and
"corner" (the origin), saved by Gmsh in every version of its format; second order in cube_p2*.
"""

import base64
import json
import struct
from pathlib import Path

import gmsh
import meshio
import numpy as np
import trimesh
import vtk

folder = Path(__file__).parent / "meshes"
folder.mkdir(exist_ok=True)

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMin", 1)
gmsh.option.setNumber("Mesh.MeshSizeMax", 1)
gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
gmsh.model.occ.synchronize()


def at_zero(dim, axes):
    """Entities of `dim` whose coordinates along all of `axes` are zero."""
    found = []
    for _, tag in gmsh.model.getEntities(dim):
        box = gmsh.model.getBoundingBox(dim, tag)
        if all(abs(box[a]) < 1e-6 and abs(box[a + 3]) < 1e-6 for a in axes):
            found.append(tag)
    return found


gmsh.model.addPhysicalGroup(3, [1], 7, "body")
gmsh.model.addPhysicalGroup(2, at_zero(2, [0]), 8, "left")
gmsh.model.addPhysicalGroup(1, at_zero(1, [0, 1]) + at_zero(1, [0, 2]), 9, "rim")
gmsh.model.addPhysicalGroup(0, at_zero(0, [0, 1, 2]), 10, "corner")
gmsh.model.mesh.generate(3)
for order, stem in ((1, "cube"), (2, "cube_p2")):
    gmsh.model.mesh.setOrder(order)
    for version in (2.2, 4.0, 4.1) if order == 1 else (4.1,):
        for binary in (0,) if version == 4.0 else (0, 1):  # Gmsh no longer writes 4.0 in binary
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            name = f"{stem}_{str(version).replace('.', '')}_{'binary' if binary else 'ascii'}.msh"
            gmsh.write(str(folder / name))
    gmsh.option.setNumber("Mesh.Binary", 0)
    if order == 1:
        gmsh.write(str(folder / "cube.mesh"))
gmsh.finalize()

# Formats of VTK, by VTK itself, with a field on the cells and a vector on the points.
msh = meshio.read(folder / "cube_p2_41_ascii.msh")
for stem, kind, vtk_type in (("cube", "tetra", vtk.VTK_TETRA), ("cube_p2", "tetra10", vtk.VTK_QUADRATIC_TETRA)):
    source = msh if kind == "tetra10" else meshio.read(folder / "cube_41_ascii.msh")
    cells = source.cells_dict[kind].copy()
    if kind == "tetra10":  # meshio keeps VTK's order of the last two edges inside
        assert np.allclose(source.points[cells[:, 8]], source.points[cells[:, [1, 3]]].mean(axis=1))
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for p in source.points:
        points.InsertNextPoint(p)
    grid.SetPoints(points)
    for cell in cells:
        grid.InsertNextCell(vtk_type, len(cell), [int(i) for i in cell])
    young = vtk.vtkDoubleArray()
    young.SetName("young")
    for i in range(len(cells)):
        young.InsertNextValue(1000.0 + i)
    grid.GetCellData().AddArray(young)
    velocity = vtk.vtkFloatArray()
    velocity.SetName("velocity")
    velocity.SetNumberOfComponents(3)
    for p in source.points:
        velocity.InsertNextTuple3(*(2 * p))
    grid.GetPointData().AddArray(velocity)

    for mode in ("ascii", "binary") if kind == "tetra" else ("binary",):
        for version in (42, 51):
            writer = vtk.vtkUnstructuredGridWriter()
            writer.SetInputData(grid)
            writer.SetFileVersion(version)
            writer.SetFileTypeToASCII() if mode == "ascii" else writer.SetFileTypeToBinary()
            writer.SetFileName(str(folder / f"{stem}_{version}_{mode}.vtk"))
            writer.Write()
    for mode in ("ascii", "inline", "raw", "base64") if kind == "tetra" else ("raw",):
        writer = vtk.vtkXMLUnstructuredGridWriter()
        writer.SetInputData(grid)
        writer.SetCompressorTypeToNone()
        if mode == "ascii":
            writer.SetDataModeToAscii()
        elif mode == "inline":
            writer.SetDataModeToBinary()
        else:
            writer.SetDataModeToAppended()
            writer.SetEncodeAppendedData(mode == "base64")
        writer.SetHeaderTypeToUInt32() if mode == "inline" else writer.SetHeaderTypeToUInt64()
        writer.SetFileName(str(folder / f"{stem}_{mode}.vtu"))
        writer.Write()
writer = vtk.vtkXMLUnstructuredGridWriter()
writer.SetInputData(grid)
writer.SetFileName(str(folder / "cube_compressed.vtu"))
writer.Write()

first_order = meshio.read(folder / "cube_41_ascii.msh")
meshio.Mesh(first_order.points, [("tetra", first_order.cells_dict["tetra"])]).write(folder / "cube.node")

# Formats, or uses of them, that no program at hand writes.
(folder / "two_tets.veg").write_text("""# two tetrahedra
*VERTICES
5 3 0 0
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 1 1

*ELEMENTS
TET
2 4 0
1 1 2 3 4
2 2 3 4 5

*MATERIAL BODY
ENU, 1000, 10000000, 0.45

*REGION
allElements, BODY

*SET second
2
""")
(folder / "pyramid.obj").write_text("""# a pyramid with a square base
o pyramid
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0.5 0.5 1
vt 0 0
vn 0 0 -1
g base
f 1/1/1 4/1/1 3/1/1 2/1/1
g sides
f -5 -4 -1
f 2 3 5
f 3 4 5
f 4 1 5
""")
(folder / "square.mesh").write_text("""MeshVersionFormatted 2
Dimension 2
Vertices
4
0 0 0
1 0 0
1 1 7
0 1 0
Triangles
2
1 2 3 1
1 3 4 2
Corners
1
1
End
""")

# Surfaces: the 12 triangles of the unit cube, by meshio; PLY of the other byte order, with quadrilaterals, properties
# and an element that are passed over, by hand.
corners = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)], dtype=float)
quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
surface = meshio.Mesh(corners, [("triangle", np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32))])
for name, binary in (("ascii", False), ("binary", True)):
    meshio.write(folder / f"cube_{name}.stl", surface, binary=binary)
    meshio.write(folder / f"cube_{name}.ply", surface, binary=binary)
header = """ply
format binary_big_endian 1.0
comment the unit cube
element vertex 8
property double x
property uchar red
property double y
property list uchar short used_by
property double z
element note 2
property float value
element face 6
property int flags
property list uchar uint vertex_indices
end_header
"""
body = b"".join(struct.pack(">dBdBhhd", x, 200, y, 2, 1, -1, z) for x, y, z in corners)
body += struct.pack(">ff", 1, 2)
body += b"".join(struct.pack(">iB4I", i, 4, *quad) for i, quad in enumerate(quads))
(folder / "cube_big_endian.ply").write_bytes(header.encode() + body)

# The same by VTK, in each of its encodings.
reader = vtk.vtkPLYReader()
reader.SetFileName(str(folder / "cube_binary.ply"))
reader.Update()
for name, mode, is_compressed, is_encoded in (
    ("ascii", "Ascii", False, False),
    ("base64", "Appended", False, True),
    ("inline", "Binary", True, False),
    ("raw", "Appended", False, False),
    ("compressed", "Appended", True, True),
):
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(str(folder / f"cube_{name}.vtp"))
    writer.SetInputData(reader.GetOutput())
    getattr(writer, f"SetDataModeTo{mode}")()
    writer.SetEncodeAppendedData(is_encoded)
    if not is_compressed:
        writer.SetCompressorTypeToNone()
    writer.Write()

# And by trimesh: a cube around the origin that its node turns and moves.
cube = trimesh.creation.box((1, 1, 1))
cube.visual = trimesh.visual.ColorVisuals()
scene = trimesh.Scene()
turn = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 0, 1))
place = trimesh.transformations.translation_matrix((0.5, 0.5, 0.5)) @ turn
scene.add_geometry(cube, node_name="cube", geom_name="cube", transform=place)
(folder / "cube_binary.glb").write_bytes(scene.export(file_type="glb"))
parts = trimesh.exchange.gltf.export_gltf(scene, merge_buffers=True)
gltf = json.loads(parts["model.gltf"])
for buffer in gltf["buffers"]:
    data = base64.b64encode(parts[buffer["uri"]]).decode()
    buffer["uri"] = "data:application/octet-stream;base64," + data
(folder / "cube_inline.gltf").write_text(json.dumps(gltf) + "\n")
