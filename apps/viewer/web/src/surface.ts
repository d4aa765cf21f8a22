/** One part of the scene as three.js draws it. */

import * as THREE from "three";
import { lineMaterial, surfaceMaterial, type SceneUniforms } from "./body_shader";
import { sharpEdges, splitAtCreases, uniqueEdges, vertexNormals, type Corners, type SharpEdges } from "./creases";
import type { Frame, Part } from "./protocol";

/** The layer of lines: they cast no shade. */
export const LINES = 1;

/** From where a surface has its normals: its frames bring them, or they are formed here, with or without creases. */
export type Normals = "given" | "smooth" | "creased";

const CREASE = (48 * Math.PI) / 180;
const EDGE = (40 * Math.PI) / 180; // smallest angle of an edge that is drawn
/** Edges that make more of a surface than this are the roughness of a scan, not those of a part. */
const MOST_EDGES = 0.3;
const LEAST_EDGES = 0.006;
const MOST_SPLIT = 200_000; // triangles of a skin whose normals are formed here

/** Whether a skin is that of a part with edges, which stay sharp; scans and animals are smooth. */
export function hasSharpEdges(triangles: Uint32Array, places: Float32Array): boolean {
  if (triangles.length > 3 * MOST_SPLIT) return false;
  const { creased } = sharpEdges(triangles, places, CREASE);
  return creased >= LEAST_EDGES && creased <= MOST_EDGES;
}

export class Surface {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
  private readonly corners: Corners | null; // null: drawn vertex i is vertex first_vertex + i
  private readonly positions: THREE.BufferAttribute;
  private readonly normals: THREE.BufferAttribute;
  private readonly field: THREE.BufferAttribute;
  private readonly drawnTriangles: Uint32Array;
  private readonly isCreased: boolean;
  private lines: THREE.LineSegments[] = [];
  private creases: THREE.LineSegments | null = null;
  private sharp: SharpEdges | null = null; // found when they are first drawn
  private veil: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null; // its depth, without colour

  constructor(
    readonly part: Part,
    readonly triangles: Uint32Array, // vertices numbered over all parts
    private readonly edges: Uint32Array,
    private readonly restPositions: Float32Array,
    private readonly shared: SceneUniforms,
    color: THREE.Color,
    normals: Normals,
    private readonly lineColor: THREE.Color,
  ) {
    this.isCreased = normals === "creased";
    const given = normals === "given";
    this.corners = given ? null : splitAtCreases(triangles, restPositions, normals === "smooth" ? Math.PI : CREASE);
    const count = this.corners?.source.length ?? part.num_vertices;
    const dynamic = <T extends THREE.BufferAttribute>(attribute: T) => {
      attribute.setUsage(THREE.DynamicDrawUsage);
      return attribute;
    };
    this.positions = dynamic(new THREE.BufferAttribute(new Float32Array(3 * count), 3));
    this.normals = dynamic(
      given
        ? new THREE.BufferAttribute(new Int8Array(2 * count), 2, true)
        : new THREE.BufferAttribute(new Float32Array(3 * count), 3),
    );
    this.field = dynamic(new THREE.BufferAttribute(new Uint16Array(count), 1, true));
    this.drawnTriangles = this.corners?.triangles ?? triangles.map((vertex) => vertex - part.first_vertex);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.positions);
    geometry.setAttribute(given ? "octahedral" : "normal", this.normals);
    geometry.setAttribute("field", this.field);
    geometry.setIndex(new THREE.BufferAttribute(this.drawnTriangles, 1));
    this.mesh = new THREE.Mesh(geometry, surfaceMaterial(shared, color, given));
    this.mesh.frustumCulled = false; // its places change with each frame
  }

  update(frame: Pick<Frame, "positions" | "normals" | "fieldValues">): void {
    const places = this.positions.array as Float32Array;
    const fields = this.field.array as Uint16Array;
    const { first_vertex: first, num_vertices: count } = this.part;
    if (this.corners) {
      const { source } = this.corners;
      for (let i = 0; i < source.length; ++i) {
        const from = 3 * source[i];
        places[3 * i] = frame.positions[from];
        places[3 * i + 1] = frame.positions[from + 1];
        places[3 * i + 2] = frame.positions[from + 2];
      }
      if (frame.fieldValues) for (let i = 0; i < source.length; ++i) fields[i] = frame.fieldValues[source[i]];
      vertexNormals(this.drawnTriangles, places, this.normals.array as Float32Array);
      this.normals.needsUpdate = true;
    } else {
      places.set(frame.positions.subarray(3 * first, 3 * (first + count)));
      if (frame.normals) {
        (this.normals.array as Int8Array).set(frame.normals.subarray(2 * first, 2 * (first + count)));
        this.normals.needsUpdate = true;
      }
      if (frame.fieldValues) fields.set(frame.fieldValues.subarray(first, first + count));
    }
    this.positions.needsUpdate = true;
    this.field.needsUpdate = frame.fieldValues !== null;
    this.mesh.material.uniforms.fieldOn.value = frame.fieldValues && this.hasValues(frame.fieldValues) ? 1 : 0;
  }

  /** Whether the field has a value anywhere here: a rigid body, which has no stress, keeps its own colour. */
  private hasValues(values: Uint16Array): boolean {
    const { first_vertex: first, num_vertices: count } = this.part;
    for (let v = first; v < first + count; ++v) if (values[v] !== 0) return true;
    return false;
  }

  /** Transparent surfaces draw only their nearest layer, in any order of the triangles. */
  setOpacity(opacity: number, nearestAlone = false): void {
    const { material } = this.mesh;
    material.uniforms.opacity.value = opacity;
    material.transparent = opacity < 1;
    this.veil?.removeFromParent();
    if (!nearestAlone || opacity >= 1) return;
    if (!this.veil) {
      const depthOnly = material.clone();
      depthOnly.uniforms = material.uniforms;
      depthOnly.colorWrite = false;
      this.veil = new THREE.Mesh(this.mesh.geometry, depthOnly);
      this.veil.frustumCulled = false;
      this.veil.renderOrder = -1;
    }
    this.veil.material.transparent = true; // drawn behind the opaque ones, as the mesh is
    this.mesh.parent?.add(this.veil);
  }

  /** Lines along the edges; `through`: seen faintly through surfaces, too. */
  showLines(visible: boolean, through: boolean, opacity: number): void {
    for (const line of this.lines) {
      this.mesh.parent?.remove(line);
      line.material instanceof THREE.Material && line.material.dispose();
    }
    this.lines = [];
    if (!visible) return;
    const geometry = this.lineGeometry();
    const add = (hidden: boolean, strength: number) => {
      const line = new THREE.LineSegments(geometry, lineMaterial(this.shared, this.lineColor, strength, hidden));
      line.frustumCulled = false;
      line.renderOrder = 2;
      line.layers.set(LINES);
      this.lines.push(line);
      this.mesh.parent?.add(line);
    };
    add(false, opacity);
    if (through) add(true, 0.45 * opacity);
  }

  /** Lines along edges of the body, which the colours of a field would hide. */
  showCreases(visible: boolean): void {
    if (visible && this.isCreased && !this.creases) {
      this.sharp ??= sharpEdges(this.triangles, this.restPositions, EDGE);
      if (this.sharp.edges.length === 0 || this.sharp.share > MOST_EDGES) return;
      const geometry = this.geometryAlong(this.sharp.edges);
      this.creases = new THREE.LineSegments(geometry, lineMaterial(this.shared, new THREE.Color(0x15181d), 0.55));
      this.creases.frustumCulled = false;
      this.creases.renderOrder = 2;
      this.creases.layers.set(LINES);
    }
    if (!this.creases) return;
    if (visible) this.mesh.parent?.add(this.creases);
    else this.creases.removeFromParent();
  }

  /** How many edges are drawn as such, for tests. */
  get numCreases(): number {
    return this.creases?.parent ? (this.sharp?.edges.length ?? 0) / 2 : 0;
  }

  private edgeGeometry: THREE.BufferGeometry | null = null;

  private lineGeometry(): THREE.BufferGeometry {
    if (this.edgeGeometry) return this.edgeGeometry;
    return (this.edgeGeometry = this.geometryAlong(this.edges.length > 0 ? this.edges : uniqueEdges(this.triangles)));
  }

  private geometryAlong(wanted: Uint32Array): THREE.BufferGeometry {
    const drawn = new Uint32Array(this.part.num_vertices);
    if (this.corners) this.corners.source.forEach((vertex, i) => (drawn[vertex - this.part.first_vertex] = i));
    else drawn.forEach((_, i) => (drawn[i] = i));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.positions);
    geometry.setIndex(
      new THREE.BufferAttribute(
        wanted.map((vertex) => drawn[vertex - this.part.first_vertex]),
        1,
      ),
    );
    return geometry;
  }

  dispose(): void {
    this.showLines(false, false, 0);
    this.showCreases(false);
    (this.creases?.material as THREE.Material | undefined)?.dispose();
    this.veil?.removeFromParent();
    this.veil?.material.dispose();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.mesh.removeFromParent();
  }
}
