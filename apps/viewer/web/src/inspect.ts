/** window.resilin: what the page shows, for tests and the curious. */

export interface Inspected {
  kind: string;
  errors: string[]; // scripts that failed
  framesDrawn: number; // with the bodies: a scene without its first frame yet is not counted
  [name: string]: unknown;
}

declare global {
  interface Window {
    resilin: Inspected;
  }
}

export function startInspection(kind: string): Inspected {
  const inspected: Inspected = { kind, errors: [], framesDrawn: 0 };
  window.addEventListener("error", (event) => inspected.errors.push(event.message));
  window.addEventListener("unhandledrejection", (event) => inspected.errors.push(String(event.reason)));
  window.resilin = inspected;
  return inspected;
}
