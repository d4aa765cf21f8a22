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

/** A fraction of 1 in linear light as a number of sRGB, 0 to 255. */
function srgb(linear: number): number {
  const inside = Math.min(Math.max(linear, 0), 1);
  return Math.round(255 * (inside <= 0.0031308 ? 12.92 * inside : 1.055 * inside ** (1 / 2.4) - 0.055));
}

/** Blue through light grey to red, as dark on both sides: in Oklab (Ottosson 2020), as resilin picture has it. */
function diverging(t: number): number[] {
  const s = Math.abs(2 * t - 1);
  const [lightness, chroma] = [0.94 - 0.49 * s, 0.165 * s ** 0.75 * (1 - 0.12 * s)];
  const hue = ((t < 0.5 ? 262 : 25) * Math.PI) / 180;
  const [a, b] = [chroma * Math.cos(hue), chroma * Math.sin(hue)];
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const n = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * n),
    srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * n),
    srgb(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * n),
  ];
}

const grey = (t: number): number[] => [0, 1, 2].map(() => Math.round(40 + 205 * t));

/** Viridis for what goes from less to more, diverging for what has two signs, grey for print. */
export const COLOR_MAPS = { viridis: color, diverging, grey } as const;
export type ColorMap = keyof typeof COLOR_MAPS;

/** The colour at `t` in [0, 1] of a map, 0 to 255. */
export const mapColor = (map: ColorMap, t: number): number[] => COLOR_MAPS[map](Math.min(Math.max(t, 0), 1));

/** 256 colours, sRGB, as a texture of one row. */
export function colorTexture(map: ColorMap = "viridis"): THREE.DataTexture {
  const data = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i) data.set([...mapColor(map, i / 255), 255], 4 * i);
  const texture = new THREE.DataTexture(data, 256, 1, THREE.RGBAFormat);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** The colour at `t` in [0, 1] of viridis, 0 to 255. */
export function color(t: number): number[] {
  const place = Math.min(Math.max(t, 0), 1) * (viridis.length - 1);
  const i = Math.min(Math.floor(place), viridis.length - 2);
  return viridis[i].map((low, k) => Math.round(low + (place - i) * (viridis[i + 1][k] - low)));
}

/** A CSS gradient from the least to the greatest value. */
export function cssGradient(direction: string, map: ColorMap = "viridis"): string {
  const stops = viridis.map((_, i) => mapColor(map, i / (viridis.length - 1)));
  return `linear-gradient(${direction}, ${stops.map((c) => `rgb(${c})`).join(", ")})`;
}
