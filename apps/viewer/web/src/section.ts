/** The plane of a cut through the cells: their field, drawn into an image that the shader of bodies reads. */

import * as THREE from "three";
import type { SceneUniforms } from "./body_shader";
import type { Frame } from "./protocol";

/** Corners of what a plane leaves of tetrahedra, three for each triangle. */
export interface SectionTriangles {
  places: Float32Array; // 3 per corner [m]
  values: Float32Array; // 1 per corner, 0 to 1 from the least to the greatest value; -1: not a number
  count: number; // count of corners
}

/** A plane as dot(xyz, place) = w. */
export type Plane = { x: number; y: number; z: number; w: number };

/** Cuts all tetrahedra; values are linear in each. */
export function cutTetrahedra(
  tetrahedra: Uint32Array,
  { positions, fieldValues }: Pick<Frame, "positions" | "fieldValues">,
  { x, y, z, w }: Plane,
): SectionTriangles {
  const places: number[] = [];
  const values: number[] = [];
  const side = [0, 0, 0, 0];
  const corner = (tetrahedron: number, above: number, below: number) => {
    const [a, b] = [tetrahedra[tetrahedron + above], tetrahedra[tetrahedron + below]];
    const t = side[above] / (side[above] - side[below]);
    for (let k = 0; k < 3; ++k) places.push(positions[3 * a + k] + t * (positions[3 * b + k] - positions[3 * a + k]));
    const [first, second] = fieldValues ? [fieldValues[a], fieldValues[b]] : [0, 0];
    const known = first > 0 && second > 0;
    values.push(known ? (first - 1 + t * (second - first)) / 65534 : -1);
  };
  for (let i = 0; i < tetrahedra.length; i += 4) {
    const above: number[] = [];
    const below: number[] = [];
    for (let c = 0; c < 4; ++c) {
      const p = 3 * tetrahedra[i + c];
      side[c] = x * positions[p] + y * positions[p + 1] + z * positions[p + 2] - w;
      (side[c] > 0 ? above : below).push(c);
    }
    if (above.length === 0 || below.length === 0) continue;
    if (above.length === 2) {
      const ring: [number, number][] = [
        [above[0], below[0]],
        [above[0], below[1]],
        [above[1], below[1]],
        [above[1], below[0]],
      ];
      for (const k of [0, 1, 2, 0, 2, 3]) corner(i, ...ring[k]);
    } else if (above.length === 1) for (const b of below) corner(i, above[0], b);
    else for (const a of above) corner(i, a, below[0]);
  }
  return { places: Float32Array.from(places), values: Float32Array.from(values), count: values.length };
}

const material = () =>
  new THREE.ShaderMaterial({
    vertexShader: /* glsl */ `
      attribute float value;
      varying float shown;
      void main() { shown = value; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0); }`,
    fragmentShader: /* glsl */ `
      varying float shown;
      void main() {
        float v = clamp(shown, 0.0, 1.0) * 255.0;
        gl_FragColor = vec4(floor(v) / 255.0, fract(v), step(0.0, shown), 1.0);
      }`,
    side: THREE.DoubleSide,
    blending: THREE.NoBlending,
    depthTest: false,
    depthWrite: false,
  });

export class Section {
  private readonly target = new THREE.WebGLRenderTarget(1, 1, {
    minFilter: THREE.NearestFilter,
    magFilter: THREE.NearestFilter,
    depthBuffer: false,
  });
  private readonly scene = new THREE.Scene();
  private readonly mesh = new THREE.Mesh(new THREE.BufferGeometry(), material());
  private readonly size = new THREE.Vector2();
  triangles: SectionTriangles | null = null; // triangles of the last cut

  constructor(
    private readonly tetrahedra: Uint32Array,
    private readonly shared: SceneUniforms,
  ) {
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh);
  }

  /** Cuts this frame by the plane; null: there is no cut. */
  update(frame: Frame | null, plane: Plane): void {
    const isWanted = frame !== null && frame.fieldValues !== null && this.tetrahedra.length > 0;
    this.shared.sectionOn.value = isWanted;
    this.triangles = isWanted ? cutTetrahedra(this.tetrahedra, frame, plane) : null;
    if (!this.triangles) return;
    this.mesh.geometry.dispose();
    this.mesh.geometry = new THREE.BufferGeometry();
    this.mesh.geometry.setAttribute("position", new THREE.BufferAttribute(this.triangles.places, 3));
    this.mesh.geometry.setAttribute("value", new THREE.BufferAttribute(this.triangles.values, 1));
  }

  /** Draws it as `camera` sees it. */
  render(renderer: THREE.WebGLRenderer, camera: THREE.Camera): void {
    if (!this.shared.sectionOn.value) return;
    renderer.getDrawingBufferSize(this.size);
    if (this.target.width !== this.size.x || this.target.height !== this.size.y)
      this.target.setSize(this.size.x, this.size.y);
    renderer.setRenderTarget(this.target);
    renderer.clear();
    renderer.render(this.scene, camera);
    renderer.setRenderTarget(null);
    this.shared.section.value = this.target.texture;
    this.shared.windowSize.value.copy(this.size);
  }

  dispose(): void {
    this.target.dispose();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.shared.sectionOn.value = false;
  }
}
