/** The field along a straight line through the bodies, between two places that were clicked. */

import type { Frame } from "./protocol";

export type Place3 = [number, number, number];

export interface LineValues {
  distances: number[]; // from the first place [m]; where the line leaves a body the value there is NaN
  values: number[];
}

interface Piece {
  from: number; // shares of the line
  to: number;
  first: number; // values at both
  last: number;
}

/**
 * Pieces of the line in cells: in each the field is linear. `width`: 4 for tetrahedra, 3 for the triangles of a scene
 * in 2D.
 */
function piecesOf(
  cells: Uint32Array,
  width: 3 | 4,
  { positions, fieldValues, least, greatest }: Frame,
  start: Place3,
  end: Place3,
): Piece[] {
  const pieces: Piece[] = [];
  const n = width - 1;
  const low = start.map((x, k) => Math.min(x, end[k]));
  const high = start.map((x, k) => Math.max(x, end[k]));
  for (let cell = 0; cell < cells.length; cell += width) {
    let isFar = false;
    for (let k = 0; k < n && !isFar; ++k) {
      let [cellLow, cellHigh] = [Infinity, -Infinity];
      for (let c = 0; c < width; ++c) {
        const x = positions[3 * cells[cell + c] + k];
        cellLow = Math.min(cellLow, x);
        cellHigh = Math.max(cellHigh, x);
      }
      isFar = cellLow > high[k] || cellHigh < low[k];
    }
    if (isFar) continue;
    const atStart = sharesIn(cells, cell, n, positions, start);
    const atEnd = sharesIn(cells, cell, n, positions, end);
    if (!atStart || !atEnd) continue;
    let [from, to] = [0, 1];
    for (let c = 0; c < width; ++c) {
      const [a, b] = [atStart[c], atEnd[c]];
      if (a < 0 && b < 0) [from, to] = [1, 0];
      else if (a < 0) from = Math.max(from, a / (a - b));
      else if (b < 0) to = Math.min(to, a / (a - b));
    }
    if (!(to > from)) continue;
    const valueAt = (t: number) => {
      let sum = 0;
      for (let c = 0; c < width; ++c) {
        const code = fieldValues![cells[cell + c]];
        if (code === 0) return NaN;
        sum += (atStart[c] + t * (atEnd[c] - atStart[c])) * (least + ((code - 1) / 65534) * (greatest - least));
      }
      return sum;
    };
    pieces.push({ from, to, first: valueAt(from), last: valueAt(to) });
  }
  return pieces;
}

/** Barycentric coordinates of a place in a cell; null: the cell is flat. */
function sharesIn(cells: Uint32Array, cell: number, n: number, x: Float32Array, place: Place3): number[] | null {
  const at = (c: number, k: number) => x[3 * cells[cell + c] + k];
  const column = (c: number) => Array.from({ length: n }, (_, k) => at(c, k) - at(0, k));
  const right = Array.from({ length: n }, (_, k) => place[k] - at(0, k));
  const columns = Array.from({ length: n }, (_, c) => column(c + 1));
  const whole = determinant(columns);
  if (whole === 0) return null;
  const shares = columns.map((_, c) => determinant(columns.map((own, i) => (i === c ? right : own))) / whole);
  return [1 - shares.reduce((sum, share) => sum + share, 0), ...shares];
}

function determinant(columns: number[][]): number {
  const [a, b, c] = columns;
  if (columns.length === 2) return a[0] * b[1] - a[1] * b[0];
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) + c[0] * (a[1] * b[2] - a[2] * b[1]);
}

/** Plot of a frame's field between two places; empty where the line meets no cell. */
export function valuesAlong(cells: Uint32Array, width: 3 | 4, frame: Frame, start: Place3, end: Place3): LineValues {
  const found: LineValues = { distances: [], values: [] };
  if (!frame.fieldValues) return found;
  const length = Math.hypot(...end.map((x, k) => x - start[k]));
  const pieces = piecesOf(cells, width, frame, start, end).sort((a, b) => a.from - b.from);
  let reached = -1;
  for (const { from, to, first, last } of pieces) {
    if (to <= reached + 1e-9) continue; // two cells share a face that the line lies in
    if (reached >= 0 && from > reached + 1e-6) {
      found.distances.push(0.5 * (reached + from) * length);
      found.values.push(NaN);
    }
    const begin = Math.max(from, reached);
    const value = begin > from ? first + ((begin - from) / (to - from)) * (last - first) : first;
    found.distances.push(begin * length, to * length);
    found.values.push(value, last);
    reached = to;
  }
  return found;
}
