/** Marks of the user's actions: the hand and its line, pins, the ball that pokes, the probed place. */

import * as THREE from "three";
import type { Orbit } from "./orbit";

const HAND = 0x1f6feb;
const PIN = 0xd29922;
const PROBE = 0x8250df;

export class Marks {
  readonly group = new THREE.Group();
  private readonly hand = ball(HAND, 0.95);
  private readonly held = ball(HAND, 0.95);
  private readonly poke = ball(HAND, 0.35, 48);
  private readonly line: THREE.Line;
  private readonly groundLine: THREE.Line;
  private readonly pins: THREE.Mesh[] = [];
  private readonly probes: THREE.Mesh[] = [];

  constructor(
    private readonly extent: number,
    flat: boolean,
  ) {
    const line = (color: number) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(6), 3));
      const material = new THREE.LineBasicMaterial({ color, depthTest: false, transparent: true });
      const made = new THREE.Line(geometry, material);
      made.frustumCulled = false;
      made.renderOrder = 4;
      made.visible = false;
      this.group.add(made);
      return made;
    };
    this.line = line(HAND);
    this.groundLine = line(0x808790);
    for (const mark of [this.hand, this.held]) {
      (mark.material as THREE.Material).depthTest = false;
      this.group.add(mark);
    }
    if (flat) (this.poke.material as THREE.Material).depthTest = false;
    this.group.add(this.poke);
  }

  /** The hand at `target` holds `grabbed`; null: it is empty. */
  setHand(target: THREE.Vector3 | null, grabbed: THREE.Vector3 | null): void {
    this.hand.visible = target !== null;
    this.held.visible = this.line.visible = target !== null && grabbed !== null;
    if (target) this.hand.position.copy(target);
    if (target && grabbed) {
      this.held.position.copy(grabbed);
      this.setLine(this.line, target, grabbed);
    }
  }

  setPoke(center: THREE.Vector3 | null, radius: number): void {
    this.poke.visible = center !== null;
    if (!center) return;
    this.poke.position.copy(center);
    this.poke.scale.setScalar(radius);
  }

  setPins(places: THREE.Vector3[]): void {
    setBalls(this.group, this.pins, places, PIN);
  }

  setProbes(places: THREE.Vector3[]): void {
    setBalls(this.group, this.probes, places, PROBE);
  }

  /** In 2D the ground is a line. */
  setGroundLine(height: number | null, up: [number, number, number]): void {
    this.groundLine.visible = height !== null;
    if (height === null) return;
    const along = new THREE.Vector3(up[1], -up[0], 0).multiplyScalar(50 * this.extent);
    const middle = new THREE.Vector3(...up).multiplyScalar(height);
    this.setLine(this.groundLine, middle.clone().sub(along), middle.clone().add(along));
  }

  /** Marks keep their size in the window. */
  follow(orbit: Orbit): void {
    const pixel = orbit.pixelSize();
    this.hand.scale.setScalar(6.5 * pixel);
    this.held.scale.setScalar(4 * pixel);
    for (const mark of [...this.pins, ...this.probes]) mark.scale.setScalar(5 * pixel);
  }

  private setLine(line: THREE.Line, from: THREE.Vector3, to: THREE.Vector3): void {
    const places = line.geometry.getAttribute("position") as THREE.BufferAttribute;
    places.setXYZ(0, from.x, from.y, from.z);
    places.setXYZ(1, to.x, to.y, to.z);
    places.needsUpdate = true;
  }
}

function ball(color: number, opacity: number, segments = 20): THREE.Mesh {
  const geometry = new THREE.SphereGeometry(1, segments, segments / 2);
  const material = new THREE.ShaderMaterial({
    vertexShader: `varying vec3 n; void main() { n = normalMatrix * normal;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      uniform float opacity;
      varying vec3 n;
      void main() {
        float facing = max(normalize(n).z, 0.0);
        float a = mix(min(1.0, opacity + 0.45), opacity, facing);
        gl_FragColor = vec4(color * (0.75 + 0.35 * facing), a);
        #include <colorspace_fragment>
        gl_FragColor.rgb *= a;
      }`,
    uniforms: { color: { value: new THREE.Color(color) }, opacity: { value: opacity } },
    transparent: true,
    blending: THREE.CustomBlending,
    blendSrc: THREE.OneFactor,
    blendDst: THREE.OneMinusSrcAlphaFactor,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.renderOrder = 3;
  mesh.visible = false;
  return mesh;
}

function setBalls(group: THREE.Group, balls: THREE.Mesh[], places: THREE.Vector3[], color: number): void {
  while (balls.length < places.length) {
    const mark = ball(color, 0.95);
    (mark.material as THREE.Material).depthTest = false;
    group.add(mark);
    balls.push(mark);
  }
  balls.forEach((mark, i) => {
    mark.visible = i < places.length;
    if (mark.visible) mark.position.copy(places[i]);
  });
}
