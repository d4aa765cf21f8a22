/** The ground: a disk that fades out, with the soft shade of what is close above it. */

import * as THREE from "three";
import type { SceneUniforms } from "./body_shader";

const SIZE = 128; // pixels of the shade
const REACH = 1.5; // half side of the square that is shaded, in extents of the scene

/** How near each place is above the ground, seen from below. */
const heightMaterial = (shared: SceneUniforms) =>
  new THREE.ShaderMaterial({
    vertexShader: /* glsl */ `
      varying vec3 place;
      void main() { place = position; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0); }`,
    fragmentShader: /* glsl */ `
      uniform vec4 cut;
      uniform bool cutOn;
      uniform vec4 plane;  // up, height
      uniform float reach;
      varying vec3 place;
      void main() {
        if (cutOn && dot(cut.xyz, place) > cut.w) discard;
        float above = max(dot(plane.xyz, place) - plane.w, 0.0) / reach;
        gl_FragColor = vec4(exp(-3.2 * above));
      }`,
    uniforms: { ...shared, plane: { value: new THREE.Vector4() }, reach: { value: 1 } },
    side: THREE.DoubleSide,
  });

const blurMaterial = () =>
  new THREE.ShaderMaterial({
    vertexShader: `varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }`,
    fragmentShader: /* glsl */ `
      uniform sampler2D shade;
      uniform vec2 along;
      varying vec2 at;
      void main() {
        float sum = 0.0, weights = 0.0;
        for (int i = -4; i <= 4; ++i) {
          float w = exp(-float(i * i) / 6.0);
          sum += w * texture2D(shade, at + float(i) * along).r;
          weights += w;
        }
        gl_FragColor = vec4(sum / weights);
      }`,
    uniforms: { shade: { value: null as THREE.Texture | null }, along: { value: new THREE.Vector2() } },
    depthTest: false,
    depthWrite: false,
  });

const diskMaterial = (shared: SceneUniforms) =>
  new THREE.ShaderMaterial({
    vertexShader: /* glsl */ `
      varying vec2 flat_;
      void main() {
        flat_ = position.xy;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: /* glsl */ `
      uniform sampler2D shade;
      uniform bool dark;
      uniform float spacing, radius, reach;
      varying vec2 flat_;
      float grid(vec2 p) {
        vec2 wide = fwidth(p);
        vec2 d = abs(fract(p - 0.5) - 0.5) / max(wide, 1e-6);
        float line = 1.0 - min(min(d.x, d.y) / 1.1, 1.0);
        return line * (1.0 - smoothstep(0.15, 0.5, max(wide.x, wide.y)));
      }
      void main() {
        float r = length(flat_) / radius;
        float fade = 1.0 - smoothstep(0.25, 1.0, r);
        float lines = 0.5 * grid(flat_ / spacing) + 0.5 * grid(flat_ / (5.0 * spacing));
        float near = gl_FrontFacing ? 1.0 : 0.35;  // from below the ground hides nothing
        vec2 at = vec2(flat_.x, -flat_.y) / (2.0 * reach) + 0.5;  // the shade is seen from below
        vec2 inside = step(vec2(0.0), at) * step(at, vec2(1.0));
        float shadow = texture2D(shade, at).r * inside.x * inside.y;
        vec4 own = dark ? vec4(0.030, 0.035, 0.045, 0.55) : vec4(0.84, 0.85, 0.87, 0.55);
        vec4 ink = dark ? vec4(0.17, 0.19, 0.23, 1.0) : vec4(0.45, 0.48, 0.53, 1.0);
        vec4 c = vec4(own.rgb, 1.0) * own.a * near;
        c = mix(c, vec4(ink.rgb, 1.0), (dark ? 0.34 : 0.36) * lines * near);
        float strength = (dark ? 0.85 : 0.62) * shadow * near;
        vec3 tone = dark ? vec3(0.004) : vec3(0.045, 0.04, 0.05);
        c = vec4(tone, 1.0) * strength + c * (1.0 - strength);
        gl_FragColor = vec4(c.rgb / max(c.a, 1e-4), c.a * fade);
        #include <colorspace_fragment>
        gl_FragColor.rgb *= gl_FragColor.a;
      }`,
    uniforms: {
      ...shared,
      shade: { value: null as THREE.Texture | null },
      spacing: { value: 0.1 },
      radius: { value: 1 },
      reach: { value: 1 },
    },
    side: THREE.DoubleSide,
    transparent: true,
    depthWrite: false,
    blending: THREE.CustomBlending,
    blendSrc: THREE.OneFactor,
    blendDst: THREE.OneMinusSrcAlphaFactor,
  });

export class Ground {
  readonly disk: THREE.Mesh<THREE.CircleGeometry, THREE.ShaderMaterial>;
  private readonly targets: THREE.WebGLRenderTarget[];
  private readonly below = new THREE.OrthographicCamera();
  private readonly heights: THREE.ShaderMaterial;
  private readonly blur = blurMaterial();
  private readonly page = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.blur);
  private readonly up: THREE.Vector3;
  private readonly turn = new THREE.Quaternion();
  private readonly center = new THREE.Vector3();
  private reach = 1;

  constructor(shared: SceneUniforms, up: [number, number, number]) {
    this.up = new THREE.Vector3(...up).normalize();
    this.targets = [0, 1].map(
      () => new THREE.WebGLRenderTarget(SIZE, SIZE, { type: THREE.UnsignedByteType, depthBuffer: true }),
    );
    this.heights = heightMaterial(shared);
    this.disk = new THREE.Mesh(new THREE.CircleGeometry(1, 96), diskMaterial(shared));
    this.disk.renderOrder = 1;
    this.turn.setFromUnitVectors(new THREE.Vector3(0, 0, 1), this.up);
    this.disk.quaternion.copy(this.turn);
    this.disk.frustumCulled = false;
  }

  /** `center`: below the middle of the scene; `height` along up [m]. */
  place(center: THREE.Vector3, height: number, extent: number): void {
    this.center.copy(center).addScaledVector(this.up, height - center.dot(this.up));
    this.reach = REACH * extent;
    const radius = 3.2 * extent;
    this.disk.position.copy(this.center);
    const { uniforms } = this.disk.material;
    // The disk is unscaled so that its own coordinates are metres.
    this.disk.geometry.dispose();
    this.disk.geometry = new THREE.CircleGeometry(radius, 96);
    uniforms.radius.value = radius;
    uniforms.reach.value = this.reach;
    uniforms.spacing.value = 10 ** Math.round(Math.log10(extent) - 0.9);
    this.heights.uniforms.plane.value.set(...this.up.toArray(), height);
    this.heights.uniforms.reach.value = 0.5 * extent;
    // Looks up from the ground; the image's axes are those of the disk, seen from below.
    Object.assign(this.below, { left: -this.reach, right: this.reach, top: this.reach, bottom: -this.reach });
    Object.assign(this.below, { near: 0, far: 2 * this.reach });
    this.below.position.copy(this.center);
    const xAxis = new THREE.Vector3(1, 0, 0).applyQuaternion(this.turn);
    const yAxis = new THREE.Vector3(0, 1, 0).applyQuaternion(this.turn);
    // A camera looks along its -z axis, which is `up`; x and z fix y as the mirror of the disk's.
    const basis = new THREE.Matrix4().makeBasis(xAxis, yAxis.clone().negate(), this.up.clone().negate());
    this.below.quaternion.setFromRotationMatrix(basis);
    this.below.updateProjectionMatrix();
    this.below.updateMatrixWorld();
  }

  /** Draws the shade of `bodies`, the children of a scene of their own. */
  shade(renderer: THREE.WebGLRenderer, bodies: THREE.Scene): void {
    const [first, second] = this.targets;
    bodies.overrideMaterial = this.heights;
    renderer.setRenderTarget(first);
    renderer.clear();
    renderer.render(bodies, this.below);
    bodies.overrideMaterial = null;
    const pass = (from: THREE.WebGLRenderTarget, to: THREE.WebGLRenderTarget, x: number, y: number) => {
      this.blur.uniforms.shade.value = from.texture;
      this.blur.uniforms.along.value.set(x / SIZE, y / SIZE);
      renderer.setRenderTarget(to);
      renderer.render(this.page, this.below);
    };
    pass(first, second, 1, 0);
    pass(second, first, 0, 1);
    renderer.setRenderTarget(null);
    this.disk.material.uniforms.shade.value = first.texture;
  }
}
