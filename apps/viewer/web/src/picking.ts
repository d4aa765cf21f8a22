/** Where a line of sight meets the drawn surface: all triangles are tried, 200,000 of them in a few milliseconds. */

import * as THREE from "three";

export interface Hit {
  part: number; // place in the header's list
  vertex: number; // nearest corner of the triangle met
  corners: [number, number, number];
  weights: [number, number, number]; // weights of the corners, at the place met
  point: THREE.Vector3;
  distance: number;
}

export interface Pickable {
  part: number;
  triangles: Uint32Array;
}

/** The first triangle along `ray` from `origin`; places for which `cutAway` holds are passed through. */
export function pick(
  ray: THREE.Ray,
  surfaces: Pickable[],
  places: Float32Array,
  cutAway: ((x: number, y: number, z: number) => boolean) | null,
): Hit | null {
  const { x: ox, y: oy, z: oz } = ray.origin;
  const { x: dx, y: dy, z: dz } = ray.direction;
  let best: Hit | null = null;
  for (const { part, triangles } of surfaces) {
    for (let t = 0; t < triangles.length; t += 3) {
      // Source: Moeller & Trumbore 1997, "Fast, minimum storage ray/triangle intersection".
      const a = 3 * triangles[t];
      const b = 3 * triangles[t + 1];
      const c = 3 * triangles[t + 2];
      const ux = places[b] - places[a];
      const uy = places[b + 1] - places[a + 1];
      const uz = places[b + 2] - places[a + 2];
      const vx = places[c] - places[a];
      const vy = places[c + 1] - places[a + 1];
      const vz = places[c + 2] - places[a + 2];
      const px = dy * vz - dz * vy;
      const py = dz * vx - dx * vz;
      const pz = dx * vy - dy * vx;
      const determinant = ux * px + uy * py + uz * pz;
      if (determinant === 0) continue;
      const sx = ox - places[a];
      const sy = oy - places[a + 1];
      const sz = oz - places[a + 2];
      const u = (sx * px + sy * py + sz * pz) / determinant;
      if (u < 0 || u > 1) continue;
      const qx = sy * uz - sz * uy;
      const qy = sz * ux - sx * uz;
      const qz = sx * uy - sy * ux;
      const v = (dx * qx + dy * qy + dz * qz) / determinant;
      if (v < 0 || u + v > 1) continue;
      const distance = (vx * qx + vy * qy + vz * qz) / determinant;
      if (distance < 0 || (best && distance >= best.distance)) continue;
      const point = new THREE.Vector3(ox + distance * dx, oy + distance * dy, oz + distance * dz);
      if (cutAway?.(point.x, point.y, point.z)) continue;
      const weights: [number, number, number] = [1 - u - v, u, v];
      const corners: [number, number, number] = [triangles[t], triangles[t + 1], triangles[t + 2]];
      const nearest = weights.indexOf(Math.max(...weights));
      best = { part, vertex: corners[nearest], corners, weights, point, distance };
    }
  }
  return best;
}

/** The place of a hit on the surface as it has moved since. */
export function placeOf(hit: Hit, places: Float32Array, out: THREE.Vector3): THREE.Vector3 {
  out.set(0, 0, 0);
  hit.corners.forEach((vertex, i) => {
    const weight = hit.weights[i];
    out.x += weight * places[3 * vertex];
    out.y += weight * places[3 * vertex + 1];
    out.z += weight * places[3 * vertex + 2];
  });
  return out;
}
