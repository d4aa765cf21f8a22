/** Drawn vertices of a surface with creases: a vertex on an edge of a box becomes one for each side. */

export interface Corners {
  source: Uint32Array; // for each drawn vertex, the vertex of the frame
  triangles: Uint32Array; // in drawn vertices
}

/** Neighbouring triangles share a drawn vertex where they meet at less than `angle` [rad] in `places`. */
export function splitAtCreases(triangles: Uint32Array, places: Float32Array, angle: number): Corners {
  const parent = Uint32Array.from(triangles, (_, corner) => corner);
  const root = (i: number): number => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const normals = faceNormals(triangles, places);
  const leastCosine = Math.cos(angle);
  for (const [first, second] of sharedEdges(triangles)) {
    const a = 3 * Math.floor(first / 3);
    const b = 3 * Math.floor(second / 3);
    const cosine = normals[a] * normals[b] + normals[a + 1] * normals[b + 1] + normals[a + 2] * normals[b + 2];
    if (cosine < leastCosine) continue;
    // The edge starts at corner `first` of one triangle and ends at corner `second` of the other.
    parent[root(first)] = root(next(second));
    parent[root(next(first))] = root(second);
  }
  const drawn = new Map<number, number>();
  const source: number[] = [];
  const corners = triangles.map((vertex, corner) => {
    const key = root(corner);
    let place = drawn.get(key);
    if (place === undefined) {
      drawn.set(key, (place = source.length));
      source.push(vertex);
    }
    return place;
  });
  return { source: Uint32Array.from(source), triangles: corners };
}

const next = (corner: number) => (corner % 3 === 2 ? corner - 2 : corner + 1);

/** Pairs of corners at which the two triangles of an edge begin it, each in its own sense. */
function sharedEdges(triangles: Uint32Array): [number, number][] {
  const begun = new Map<number, number>();
  const pairs: [number, number][] = [];
  for (let corner = 0; corner < triangles.length; ++corner) {
    const a = triangles[corner];
    const b = triangles[next(corner)];
    const other = begun.get(b * 2 ** 26 + a);
    if (other === undefined) begun.set(a * 2 ** 26 + b, corner);
    else pairs.push([other, corner]);
  }
  return pairs;
}

function faceNormals(triangles: Uint32Array, places: Float32Array): Float32Array {
  const normals = new Float32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [ux, uy, uz] = [places[b] - places[a], places[b + 1] - places[a + 1], places[b + 2] - places[a + 2]];
    const [vx, vy, vz] = [places[c] - places[a], places[c + 1] - places[a + 1], places[c + 2] - places[a + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const length = Math.hypot(x, y, z) || 1;
    normals.set([x / length, y / length, z / length], t);
  }
  return normals;
}

/** Adds up area-weighted normals of the triangles around each vertex; their length does not matter to the shader. */
export function vertexNormals(triangles: Uint32Array, places: Float32Array, normals: Float32Array): void {
  normals.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ux = places[b] - places[a];
    const uy = places[b + 1] - places[a + 1];
    const uz = places[b + 2] - places[a + 2];
    const vx = places[c] - places[a];
    const vy = places[c + 1] - places[a + 1];
    const vz = places[c + 2] - places[a + 2];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    normals[a] += x;
    normals[a + 1] += y;
    normals[a + 2] += z;
    normals[b] += x;
    normals[b + 1] += y;
    normals[b + 2] += z;
    normals[c] += x;
    normals[c + 1] += y;
    normals[c + 2] += z;
  }
}

/** Each edge of the triangles once. */
export function uniqueEdges(triangles: Uint32Array): Uint32Array {
  const keys = new Float64Array(triangles.length);
  for (let corner = 0; corner < triangles.length; ++corner) {
    const a = triangles[corner];
    const b = triangles[next(corner)];
    keys[corner] = a < b ? a * 2 ** 26 + b : b * 2 ** 26 + a;
  }
  keys.sort();
  const edges: number[] = [];
  for (let i = 0; i < keys.length; ++i) {
    if (i > 0 && keys[i] === keys[i - 1]) continue;
    edges.push(Math.floor(keys[i] / 2 ** 26), keys[i] % 2 ** 26);
  }
  return Uint32Array.from(edges);
}

/** Edges of a surface that are seen as edges: borders, and where triangles meet at more than `angle` [rad]. */
export interface SharpEdges {
  edges: Uint32Array; // pairs of vertices
  share: number; // share of the length of all edges
  creased: number; // the same without the borders
}

export function sharpEdges(triangles: Uint32Array, places: Float32Array, angle: number): SharpEdges {
  const normals = faceNormals(triangles, places);
  const leastCosine = Math.cos(angle);
  const length = (corner: number) => {
    const [a, b] = [3 * triangles[corner], 3 * triangles[next(corner)]];
    return Math.hypot(places[b] - places[a], places[b + 1] - places[a + 1], places[b + 2] - places[a + 2]);
  };
  const isInside = new Uint8Array(triangles.length); // by corner: another triangle has this edge
  const sharp: number[] = [];
  let [all, found, creased] = [0, 0, 0];
  for (const [first, second] of sharedEdges(triangles)) {
    isInside[first] = isInside[second] = 1;
    all += length(first);
    const a = 3 * Math.floor(first / 3);
    const b = 3 * Math.floor(second / 3);
    const cosine = normals[a] * normals[b] + normals[a + 1] * normals[b + 1] + normals[a + 2] * normals[b + 2];
    if (cosine >= leastCosine) continue;
    found += length(first);
    creased += length(first);
    sharp.push(triangles[first], triangles[next(first)]);
  }
  for (let corner = 0; corner < triangles.length; ++corner) {
    if (isInside[corner]) continue;
    all += length(corner);
    found += length(corner);
    sharp.push(triangles[corner], triangles[next(corner)]);
  }
  return { edges: Uint32Array.from(sharp), share: found / (all || 1), creased: creased / (all || 1) };
}
