/** The colours of fields: the same as in the pictures of `resilin picture` (src/resilin/picture/color_map.cpp). */

import * as THREE from "three";

/** Every eighth entry of viridis by van der Walt, Smith and Firing (CC0). */
// prettier-ignore
export const viridis = [
  [68, 1, 84],    [71, 13, 96],   [72, 24, 106],  [72, 35, 116],  [71, 45, 123],  [69, 55, 129],
  [66, 64, 134],  [62, 73, 137],  [59, 82, 139],  [55, 91, 141],  [51, 99, 141],  [47, 107, 142],
  [44, 114, 142], [41, 122, 142], [38, 130, 142], [35, 137, 142], [33, 145, 140], [31, 152, 139],
  [31, 160, 136], [34, 167, 133], [40, 174, 128], [50, 182, 122], [63, 188, 115], [78, 195, 107],
  [94, 201, 98],  [112, 207, 87], [132, 212, 75], [152, 216, 62], [173, 220, 48], [194, 223, 35],
  [216, 226, 25], [236, 229, 27], [253, 231, 37],
];

/** 256 colours, sRGB, as a texture of one row. */
export function colorTexture(): THREE.DataTexture {
  const data = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i) data.set([...color(i / 255), 255], 4 * i);
  const texture = new THREE.DataTexture(data, 256, 1, THREE.RGBAFormat);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** The colour at `t` in [0, 1], 0 to 255. */
export function color(t: number): number[] {
  const place = Math.min(Math.max(t, 0), 1) * (viridis.length - 1);
  const i = Math.min(Math.floor(place), viridis.length - 2);
  return viridis[i].map((low, k) => Math.round(low + (place - i) * (viridis[i + 1][k] - low)));
}

/** A CSS gradient from the least to the greatest value. */
export function cssGradient(direction: string): string {
  return `linear-gradient(${direction}, ${viridis.map((c) => `rgb(${c})`).join(", ")})`;
}
