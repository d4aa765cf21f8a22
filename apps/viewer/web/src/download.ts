/** Files that the page hands to the user. */

import { element } from "./dom";

/** A title as the name of a file, without an ending. */
export function fileName(title: string): string {
  const name = title
    .replace(/\.(stl|ply|obj|msh|mesh|vtk|vtu|vtp|gltf|glb|toml)$/i, "")
    .replace(/[^\p{L}\p{N}._-]+/gu, "_")
    .replace(/^[._-]+|_+$/g, "")
    .slice(0, 60);
  return name || "resilin";
}

export function download(bytes: Blob, name: string): void {
  const address = URL.createObjectURL(bytes);
  const link = element("a", { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000); // the browser may ask the user first
}
