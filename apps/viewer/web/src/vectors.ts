/** Arrows along the displacement, at places spread over the surfaces that are shown. */

import * as THREE from "three";
import { arrowGeometry } from "./scene_marks";
import type { Frame, Part } from "./protocol";

const MOST = 400; // arrows
const LONGEST = 0.14; // length relative to the extent
const COLOR = 0x20262e;
const COLOR_IN_THE_DARK = 0xe8ecf2;

export class Vectors {
  readonly mesh: THREE.InstancedMesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;

  constructor(
    private readonly rest: Float32Array,
    private readonly extent: number,
  ) {
    this.mesh = new THREE.InstancedMesh(arrowGeometry(), new THREE.MeshBasicMaterial({ color: COLOR }), MOST);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 3;
    this.mesh.visible = false;
    this.mesh.count = 0;
  }

  setDark(dark: boolean): void {
    this.mesh.material.color.set(dark ? COLOR_IN_THE_DARK : COLOR);
  }

  /** The longest arrow is always as long; what has hardly moved has none. */
  update({ positions }: Frame, parts: Part[]): void {
    if (!this.mesh.visible) return;
    const count = parts.reduce((sum, part) => sum + part.num_vertices, 0);
    const stride = Math.max(1, Math.ceil(count / MOST));
    const moved: { at: number; length: number }[] = [];
    const u = new THREE.Vector3();
    const displacement = (vertex: number) =>
      u.fromArray(positions, 3 * vertex).sub(new THREE.Vector3().fromArray(this.rest, 3 * vertex));
    for (const { first_vertex: first, num_vertices } of parts)
      for (let at = first; at < first + num_vertices; at += stride)
        moved.push({ at, length: displacement(at).length() });
    const longest = Math.max(...moved.map(({ length }) => length), 1e-9 * this.extent);
    const [matrix, turn, size] = [new THREE.Matrix4(), new THREE.Quaternion(), new THREE.Vector3()];
    const shown = moved.filter(({ length }) => length > 0.01 * longest).slice(0, MOST);
    shown.forEach(({ at, length }, i) => {
      turn.setFromUnitVectors(new THREE.Vector3(0, 1, 0), displacement(at).normalize());
      const place = new THREE.Vector3().fromArray(positions, 3 * at);
      const drawn = (LONGEST * this.extent * length) / longest;
      this.mesh.setMatrixAt(i, matrix.compose(place, turn, size.setScalar(drawn)));
    });
    this.mesh.count = shown.length;
    this.mesh.instanceMatrix.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
