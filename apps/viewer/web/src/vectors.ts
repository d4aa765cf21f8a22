/** Arrows of a field of vectors, at places spread over the surfaces that are shown. */

import * as THREE from "three";
import { arrowGeometry } from "./scene_marks";
import type { Arrows, Field, Frame, Part } from "./protocol";

const MOST = 400; // arrows
const LONGEST = 0.14; // length relative to the extent
const COLOR = 0x20262e;
const COLOR_IN_THE_DARK = 0xe8ecf2;
const SHORTEST = 0.12; // relative to the longest, so that it is seen
const ROUNDING = 1e-6; // round-off, relative to the scale of the field
const FALL = 0.15; // share of the way down to the present largest length, for each frame

/** The fields of which arrows can be drawn: those with components. Displacements are known from the places. */
export function vectorFields(fields: Field[]): Field[] {
  const names = new Set(fields.map(({ name }) => name));
  return fields.filter(({ name }) => names.has(`${name}.x`));
}

export class Vectors {
  readonly mesh: THREE.InstancedMesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
  /** Value of the longest arrow, in the unit of the field. */
  longest = 0;
  private name = ""; // name of the field
  private eased = 0;

  constructor(
    private readonly rest: Float32Array,
    private readonly extent: number,
    private readonly fields: Field[],
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

  /** Chooses the field; "": none. */
  choose(name: string): void {
    if (name !== this.name) this.eased = this.longest = this.mesh.count = 0;
    this.name = name;
    this.mesh.visible = name !== "";
    // Bodies that touch hide what they exchange.
    this.mesh.material.depthTest = !this.pushes;
  }

  /** The longest arrow is always as long; where next to nothing happens there is none. */
  update({ positions, arrows }: Pick<Frame, "positions" | "arrows">, parts: Part[]): void {
    if (!this.mesh.visible) return;
    const given = this.given(positions, arrows ?? null);
    if (!given) return;
    const { vectors, greatest } = given;
    const u = new THREE.Vector3();
    const found: { at: number; length: number }[] = [];
    for (const { first_vertex: first, num_vertices } of parts)
      for (let at = first; at < first + num_vertices; ++at) {
        const length = u.fromArray(vectors, 3 * at).length();
        if (length > 0 && Number.isFinite(length)) found.push({ at, length });
      }
    const largest = found.reduce((most, { length }) => Math.max(most, length), 0);
    this.eased = Math.max(largest, this.eased + FALL * (largest - this.eased));
    this.longest = greatest ?? this.eased;
    const least = ROUNDING * (this.fields.find(({ name }) => name === this.name)?.scale ?? 0);
    const strong = found.filter(({ length }) => length > Math.max(0.01 * this.longest, least));
    const stride = Math.max(1, Math.ceil(strong.length / MOST));
    const shown = strong.filter((_, i) => i % stride === 0);
    const [matrix, turn, size] = [new THREE.Matrix4(), new THREE.Quaternion(), new THREE.Vector3()];
    shown.forEach(({ at, length }, i) => {
      turn.setFromUnitVectors(new THREE.Vector3(0, 1, 0), u.fromArray(vectors, 3 * at).normalize());
      const place = new THREE.Vector3().fromArray(positions, 3 * at);
      const drawn = LONGEST * this.extent * Math.min(Math.max(length / this.longest, SHORTEST), 1);
      if (this.pushes) place.addScaledVector(u, -drawn);
      this.mesh.setMatrixAt(i, matrix.compose(place, turn, size.setScalar(drawn)));
    });
    this.mesh.count = shown.length;
    this.mesh.instanceMatrix.needsUpdate = true;
  }

  /** Whether the vectors push into the body: the tip is then at the vertex. */
  private get pushes(): boolean {
    return this.name.startsWith("contact");
  }

  /** How many arrows are drawn, for tests. */
  get count(): number {
    return this.mesh.visible ? this.mesh.count : 0;
  }

  private given(positions: Float32Array, arrows: Arrows | null): Pick<Arrows, "vectors" | "greatest"> | null {
    if (arrows) return this.fields[arrows.field]?.name === this.name ? arrows : null;
    if (this.name !== "displacement") return null;
    return { vectors: positions.map((x, i) => x - this.rest[i]), greatest: null };
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
