/** The colours of curves, as people with and without all cones see them. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { webFolder } from "./harness";

/** Linear RGB. */
function linear(hex: string): number[] {
  return [1, 3, 5].map((i) => {
    const x = parseInt(hex.slice(i, i + 2), 16) / 255;
    return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
  });
}

/** Coordinates of a colour in Oklab (Ottosson 2020). */
function oklab([r, g, b]: number[]): number[] {
  const cones = [
    [0.4122214708, 0.5363325363, 0.0514459929],
    [0.2119034982, 0.6806995451, 0.1073969566],
    [0.0883024619, 0.2817188376, 0.6299787005],
  ].map(([x, y, z]) => Math.cbrt(x * Math.max(r, 0) + y * Math.max(g, 0) + z * Math.max(b, 0)));
  return [
    [0.2104542553, 0.793617785, -0.0040720468],
    [1.9779984951, -2.428592205, 0.4505937099],
    [0.0259040371, 0.7827717662, -0.808675766],
  ].map((row) => row.reduce((sum, share, i) => sum + share * cones[i], 0));
}

/** Colours as seen without one kind of cones. Source: Machado, Oliveira & Fernandes 2009, severity 1. */
const BLINDNESS: Record<string, number[][]> = {
  none: [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  protanopia: [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
  ],
  deuteranopia: [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ],
  tritanopia: [
    [1.255528, -0.076749, -0.178779],
    [-0.078411, 0.930809, 0.147602],
    [0.004733, 0.691367, 0.3039],
  ],
};

test("colours of curves stay apart for the colour blind", () => {
  const style = readFileSync(path.join(webFolder, "src/style.css"), "utf8");
  const colors = [...style.matchAll(/--series-\d: (#[0-9a-f]{6});/g)].map((match) => match[1]);
  assert.equal(colors.length, 12);
  for (const theme of [colors.slice(0, 6), colors.slice(6)])
    for (const [kind, matrix] of Object.entries(BLINDNESS)) {
      const seen = theme.map((hex) =>
        oklab(matrix.map((row) => row.reduce((sum, x, i) => sum + x * linear(hex)[i], 0))),
      );
      seen.forEach((a, i) =>
        seen.slice(i + 1).forEach((b, j) => {
          const apart = Math.hypot(...a.map((x, k) => x - b[k]));
          assert.ok(apart > 0.07, `${kind}: ${theme[i]} and ${theme[i + 1 + j]} are ${apart.toFixed(3)} apart`);
        }),
      );
    }
});
