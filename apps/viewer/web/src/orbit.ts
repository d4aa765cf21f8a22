/** The camera: turns about a target, moves in the view plane, comes nearer; in 2D it looks straight down the z axis. */

import * as THREE from "three";

export interface Pose {
  azimuth: number; // [rad] about `up`
  elevation: number; // [rad]
  distance: number; // [m]; in 2D the height of the window
  target: [number, number, number];
}

const FIELD_OF_VIEW = 32; // [degrees], a portrait lens
const LARGEST_ELEVATION = Math.PI / 2 - 1e-5; // straight down, up to rounding
const MARGIN = 1.1; // around what is to be seen

export class Orbit {
  camera: THREE.PerspectiveCamera | THREE.OrthographicCamera;
  pose: Pose = { azimuth: 0.6, elevation: 0.3, distance: 3, target: [0, 0, 0] };
  private readonly east = new THREE.Vector3();
  private readonly north = new THREE.Vector3();
  private readonly up: THREE.Vector3;
  private width = 1;
  private height = 1;
  private extent = 1;
  private covered = { left: 0, right: 0, top: 0, bottom: 0 }; // pixels of the window that something lies over

  constructor(
    readonly flat: boolean,
    up: [number, number, number],
  ) {
    this.camera = flat ? new THREE.OrthographicCamera() : new THREE.PerspectiveCamera(FIELD_OF_VIEW);
    this.up = flat ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(...up).normalize();
    // Azimuth 0 looks along +y when z is up, and along +z when y is up: most animals of graphics face -z.
    if (Math.abs(this.up.z) > 0.9) this.north.set(0, -1, 0);
    else if (Math.abs(this.up.y) > 0.9) this.north.set(0, 0, -1);
    else this.north.set(0, 1, 0);
    this.north.addScaledVector(this.up, -this.north.dot(this.up)).normalize();
    this.east.crossVectors(this.up, this.north);
  }

  /** Looks at the box so that all of it is seen in what panels leave free. */
  fit(box: THREE.Box3, azimuth = 0.55, elevation = 0.28): void {
    const center = box.getCenter(new THREE.Vector3());
    const size = box.getSize(new THREE.Vector3());
    this.extent = Math.max(size.length(), 2e-9);
    const free = {
      width: Math.max(this.width - this.covered.left - this.covered.right, 0.3 * this.width),
      height: Math.max(this.height - this.covered.top - this.covered.bottom, 0.3 * this.height),
    };
    if (this.flat) {
      const tallest = Math.max(size.x * (this.height / free.width), size.y * (this.height / free.height), 1e-9);
      this.pose = { azimuth, elevation, distance: MARGIN * tallest, target: center.toArray() };
      return this.apply();
    }
    this.pose = { azimuth, elevation, distance: this.extent, target: center.toArray() };
    this.apply(); // the axes of the camera
    const slope = Math.tan(THREE.MathUtils.degToRad(FIELD_OF_VIEW / 2));
    const [across, along] = [(slope * free.width) / this.height, (slope * free.height) / this.height];
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const out = new THREE.Vector3(
        (corner & 1 ? 0.5 : -0.5) * size.x,
        (corner & 2 ? 0.5 : -0.5) * size.y,
        (corner & 4 ? 0.5 : -0.5) * size.z,
      );
      const [x, y, z] = [out.dot(this.axis(0)), out.dot(this.axis(1)), out.dot(this.axis(2))];
      const near = this.isParallel ? 0 : z;
      distance = Math.max(distance, near + (MARGIN * Math.abs(x)) / across, near + (MARGIN * Math.abs(y)) / along);
    }
    this.pose.distance = Math.max(distance, 1e-9);
    this.apply();
  }

  /** Parallel lines of sight instead of those of an eye; what is at the target keeps its size. */
  setParallel(isParallel: boolean): void {
    if (this.flat || isParallel === this.isParallel) return;
    const { layers } = this.camera;
    this.camera = isParallel ? new THREE.OrthographicCamera() : new THREE.PerspectiveCamera(FIELD_OF_VIEW);
    this.camera.layers.mask = layers.mask;
    this.resize(this.width, this.height, this.covered);
  }

  get isParallel(): boolean {
    return this.camera instanceof THREE.OrthographicCamera;
  }

  /** `covered`: what panels take of the window; the scene is in the middle of the rest. */
  resize(width: number, height: number, covered = { left: 0, right: 0, top: 0, bottom: 0 }): void {
    [this.width, this.height] = [width, height];
    this.covered = covered;
    const [right, down] = [(covered.right - covered.left) / 2, (covered.bottom - covered.top) / 2];
    this.camera.setViewOffset(width, height, right, down, width, height);
    this.apply();
  }

  /** Looks from the direction `eye` of the target. */
  lookFrom(eye: [number, number, number]): void {
    const out = new THREE.Vector3(...eye).normalize();
    if (this.flat || out.lengthSq() === 0) return;
    this.pose.elevation = Math.asin(Math.min(Math.max(out.dot(this.up), -1), 1));
    this.pose.elevation = Math.min(Math.max(this.pose.elevation, -LARGEST_ELEVATION), LARGEST_ELEVATION);
    this.pose.azimuth = Math.atan2(out.dot(this.east), out.dot(this.north));
    this.apply();
  }

  turn(dx: number, dy: number): void {
    if (this.flat) return this.move(dx, dy);
    this.pose.azimuth -= (5 * dx) / this.height;
    const elevation = this.pose.elevation + (5 * dy) / this.height;
    this.pose.elevation = Math.min(Math.max(elevation, -LARGEST_ELEVATION), LARGEST_ELEVATION);
    this.apply();
  }

  move(dx: number, dy: number): void {
    const pixel = this.pixelSize();
    const target = new THREE.Vector3(...this.pose.target);
    target.addScaledVector(this.axis(0), -dx * pixel).addScaledVector(this.axis(1), dy * pixel);
    this.pose.target = target.toArray();
    this.apply();
  }

  zoom(factor: number): void {
    this.pose.distance = Math.min(Math.max(this.pose.distance * factor, 0.02 * this.extent), 40 * this.extent);
    this.apply();
  }

  setPose(pose: Pose): void {
    this.pose = pose;
    this.apply();
  }

  /** Size of a pixel at the target [m]. */
  pixelSize(): number {
    const height = this.flat
      ? this.pose.distance
      : 2 * this.pose.distance * Math.tan(THREE.MathUtils.degToRad(FIELD_OF_VIEW / 2));
    return height / this.height;
  }

  axis(i: 0 | 1 | 2): THREE.Vector3 {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, i);
  }

  /** The line of sight through a point of the window [pixels]. */
  ray(x: number, y: number): THREE.Ray {
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2((2 * x) / this.width - 1, 1 - (2 * y) / this.height), this.camera);
    return caster.ray;
  }

  /** Where a place is seen in the window [pixels]. */
  project(place: THREE.Vector3): { x: number; y: number } {
    const seen = place.clone().project(this.camera);
    return { x: ((seen.x + 1) / 2) * this.width, y: ((1 - seen.y) / 2) * this.height };
  }

  private apply(): void {
    const { azimuth, elevation, distance, target } = this.pose;
    const { camera } = this;
    const center = new THREE.Vector3(...target);
    const out = this.north
      .clone()
      .multiplyScalar(Math.cos(azimuth) * Math.cos(elevation))
      .addScaledVector(this.east, Math.sin(azimuth) * Math.cos(elevation))
      .addScaledVector(this.up, Math.sin(elevation));
    if (camera instanceof THREE.OrthographicCamera) {
      const halfHeight = (this.height * this.pixelSize()) / 2;
      const halfWidth = (halfHeight * this.width) / this.height;
      Object.assign(camera, { left: -halfWidth, right: halfWidth, top: halfHeight, bottom: -halfHeight });
      Object.assign(camera, { near: 0.1 * this.extent, far: 30 * this.extent });
      camera.position.copy(center).addScaledVector(this.flat ? new THREE.Vector3(0, 0, 1) : out, 10 * this.extent);
    } else {
      camera.aspect = this.width / this.height;
      camera.position.copy(center).addScaledVector(out, distance);
      camera.near = 0.02 * distance;
      camera.far = distance + 30 * this.extent;
    }
    camera.up.copy(this.up);
    camera.lookAt(center);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }
}
