/** A chart as a table and as a picture. */

import { download, fileName } from "./download";
import { styleValue } from "./theme";

/** Rows of comma-separated values under one line of names; what is no number stays empty. */
export function tableText(names: string[], columns: ArrayLike<number | null | undefined>[]): string {
  const quoted = (name: string) => (/[",\n]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);
  const lines = [names.map(quoted).join(",")];
  for (let i = 0; i < (columns[0]?.length ?? 0); ++i)
    lines.push(columns.map((column) => (Number.isFinite(column[i]) ? String(column[i]) : "")).join(","));
  return `${lines.join("\n")}\n`;
}

export function saveTable(title: string, names: string[], columns: ArrayLike<number | null | undefined>[]): void {
  download(new Blob([tableText(names, columns)], { type: "text/csv" }), `${fileName(title)}.csv`);
}

interface Entry {
  label: string;
  color: string;
  dash: number[];
}

/** The drawing of a chart on the colour of its card, with its title and what its lines are. */
export function savePicture(title: string, plot: HTMLCanvasElement, entries: Entry[]): void {
  const scale = plot.width / Math.max(plot.clientWidth, 1);
  const [margin, head, foot] = [12 * scale, 26 * scale, 22 * scale];
  const canvas = document.createElement("canvas");
  canvas.width = plot.width + 2 * margin;
  canvas.height = plot.height + head + foot + margin;
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = styleValue("--solid");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.fillStyle = styleValue("--text");
  pen.textBaseline = "middle";
  pen.font = `600 ${12 * scale}px system-ui, sans-serif`;
  pen.fillText(title, margin, head / 2 + 4 * scale);
  pen.drawImage(plot, margin, head);
  pen.font = `${11 * scale}px system-ui, sans-serif`;
  let x = margin;
  for (const { label, color, dash } of entries) {
    const y = head + plot.height + foot / 2 + 2 * scale;
    pen.strokeStyle = color;
    pen.lineWidth = 2 * scale;
    pen.setLineDash(dash.map((length) => length * scale));
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + 18 * scale, y);
    pen.stroke();
    pen.fillText(label, x + 23 * scale, y);
    x += 38 * scale + pen.measureText(label).width;
  }
  canvas.toBlob((image) => image && download(image, `${fileName(title)}.png`));
}
