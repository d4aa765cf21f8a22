"""Writes the standard scenes of contact, by name."""

from contact_scenes import few_cells, many_cells, shapes
from toml_text import toml


def write(name, folder, **arguments):
    """Writes the scene of this name and its meshes into a folder; the scene's file."""
    scene, meshes = getattr(few_cells if hasattr(few_cells, name) else many_cells, name)(**arguments)
    folder.mkdir(parents=True, exist_ok=True)
    for file, shape in meshes.items():
        (shapes.write_solid if file.endswith(".mesh") else shapes.write_surface)(folder / file, shape)
    lines = []
    for key, tables in scene.items():
        for table in tables if isinstance(tables, list) else [tables]:
            lines.append(f"[[{key}]]" if isinstance(tables, list) else f"[{key}]")
            lines += [f"{name} = {toml(value)}" for name, value in table.items()] + [""]
    (folder / "scene.toml").write_text("\n".join(lines), encoding="utf-8")
    return folder / "scene.toml"
