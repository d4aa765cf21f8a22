/** How a body looks: soft studio light, colours of a field, and the cut. */

import * as THREE from "three";
import { colorTexture } from "./color_map";

/** Shared by all surfaces and lines of the scene, so that one change reaches everything. */
export function sceneUniforms() {
  return {
    colorMap: { value: colorTexture() },
    fieldRange: { value: new THREE.Vector2(0, 1) }, // values that 1 and 65535 stand for
    barRange: { value: new THREE.Vector2(0, 1) }, // values at the ends of the colours
    cut: { value: new THREE.Vector4(0, 0, 0, 1e30) }, // points with dot(xyz, place) > w are cut away
    cutOn: { value: false },
    up: { value: new THREE.Vector3(0, 1, 0) }, // in the eye's frame
    dark: { value: false },
    lit: { value: true }, // false in 2D
    hatch: { value: 0.02 }, // distance of the lines on a cut [m]
    section: { value: null as THREE.Texture | null }, // the field on the plane of the cut: section.ts
    sectionOn: { value: false },
    windowSize: { value: new THREE.Vector2(1, 1) }, // size of that image [pixels]
    pixels: { value: 1 }, // drawn for each of the window's, along each side
  };
}

export type SceneUniforms = ReturnType<typeof sceneUniforms>;

const bodyVertex = /* glsl */ `
#ifdef OCTAHEDRAL
attribute vec2 octahedral;
#endif
attribute float field;
uniform float fieldOn;
varying vec3 eyeNormal, eyePlace, place;
varying float value, known;

#ifdef OCTAHEDRAL
vec3 unfolded(vec2 e) {
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float t = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -t : t;
  n.y += n.y >= 0.0 ? -t : t;
  return normalize(n);
}
#else
#define unfolded(e) normal
#endif

void main() {
  place = position;
  vec4 seen = viewMatrix * vec4(position, 1.0);
  eyePlace = seen.xyz;
  eyeNormal = mat3(viewMatrix) * unfolded(octahedral);
  float code = field * 65535.0;
  known = fieldOn * step(0.5, code);
  value = (code - 1.0) / 65534.0;
  gl_Position = projectionMatrix * seen;
}`;

const bodyFragment = /* glsl */ `
uniform sampler2D colorMap, section;
uniform vec2 fieldRange, barRange, windowSize;
uniform vec4 cut;
uniform bool cutOn, dark, lit, sectionOn;
uniform vec3 up, color, cutColor;
uniform float fieldOn, opacity, hatch;
varying vec3 eyeNormal, eyePlace, place;
varying float value, known;

vec3 fieldColor(float share, float isNumber) {
  if (isNumber < 0.999) return vec3(0.9, 0.25, 0.55);  // not a number, as in resilin picture
  float v = mix(fieldRange.x, fieldRange.y, share);
  float t = (v - barRange.x) / max(barRange.y - barRange.x, 1e-37);
  return texture2D(colorMap, vec2(clamp(t, 0.0, 1.0) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
}

vec3 albedo() { return fieldOn < 0.5 ? color : fieldColor(value, known); }

vec3 studio(vec3 base, vec3 n, vec3 eye, float own) {
  vec3 key = normalize(vec3(-0.45, 0.75, 0.55));
  vec3 fill = normalize(vec3(0.85, 0.15, 0.5));
  vec3 rim = normalize(vec3(0.35, 0.55, -0.75));
  float sky = 0.5 + 0.5 * dot(n, up);
  vec3 ambient = mix(vec3(0.27, 0.22, 0.20), vec3(0.40, 0.42, 0.46), sky);
  // Light goes a little way into soft matter: the terminator is wide and reddish.
  float wrapped = (dot(n, key) + 0.35) / 1.35;
  vec3 through = mix(vec3(1.0), vec3(1.0, 0.72, 0.62), own * (1.0 - smoothstep(0.0, 0.55, wrapped)));
  vec3 light = ambient + max(wrapped, 0.0) * through * vec3(0.61, 0.585, 0.55);
  light += max(dot(n, fill), 0.0) * vec3(0.13, 0.15, 0.18);
  float grazing = pow(1.0 - max(dot(n, eye), 0.0), 3.0);
  float mirrored = max(dot(n, normalize(key + eye)), 0.0);
  // Where colours are to be read, there is little gloss to hide them.
  float shine = (0.03 + 0.07 * own) * pow(mirrored, 26.0) + (0.02 + 0.06 * own) * pow(mirrored, 140.0);
  vec3 glow = vec3(0.9, 0.93, 1.0) * (grazing * (0.06 + 0.40 * max(dot(n, rim) * 0.6 + 0.4, 0.0)));
  // The colours of a field stay those of the bar; what is left of the light shows the shape.
  if (own < 0.5) return base * mix(0.74, 1.0, smoothstep(0.25, 1.0, dot(light, vec3(0.34)))) + 0.3 * shine;
  return base * light + shine + glow * mix(vec3(0.25), base, 0.5) * (dark ? 1.25 : 0.8);
}

/** How far along the line of sight the cut is, from the eye; negative: not before this place, which is an inside seen elsewhere. */
float wayToCut(vec3 origin, vec3 ray) {
  float along = dot(cut.xyz, ray);
  float way = (cut.w - dot(cut.xyz, origin)) / (abs(along) < 1e-6 ? 1e-6 : along);
  return way <= 1.0001 * distance(place, origin) ? way : -1.0;
}

/** The field on the plane at this pixel, or at one beside it. */
vec4 sectionHere() {
  vec2 at = gl_FragCoord.xy / windowSize;
  vec4 found = texture2D(section, at);
  for (int i = 0; i < 8 && found.a < 0.5; ++i) {
    float turn = 0.785398 * float(i);
    found = texture2D(section, at + 2.0 * vec2(cos(turn), sin(turn)) / windowSize);
  }
  return found;
}

/** The face of the cut, shaded where the line of sight meets the plane. */
vec3 face(vec3 eye, vec3 hit) {
  vec3 n = mat3(viewMatrix) * cut.xyz;
  vec3 a = normalize(abs(cut.y) < 0.9 ? cross(cut.xyz, vec3(0, 1, 0)) : cross(cut.xyz, vec3(1, 0, 0)));
  float stripe = (dot(hit, a) + dot(hit, cross(cut.xyz, a))) / hatch;
  float wide = fwidth(stripe) * 1.2;
  float line = 1.0 - smoothstep(0.12, 0.12 + wide, abs(fract(stripe) - 0.5));
  vec4 inside = sectionOn && fieldOn > 0.5 ? sectionHere() : vec4(0.0);
  if (inside.a > 0.5) return fieldColor(inside.r + inside.g / 255.0, inside.b) * (1.0 - 0.05 * line);
  return cutColor * (0.72 + 0.28 * abs(dot(n, eye))) * (1.0 - 0.16 * line * step(wide, 0.8));
}

void main() {
  if (cutOn && dot(cut.xyz, place) > cut.w) discard;
  vec3 eye = isOrthographic ? vec3(0, 0, 1) : normalize(-eyePlace);
  vec3 ray = isOrthographic ? -vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2]) : normalize(place - cameraPosition);
  vec3 origin = isOrthographic ? place - dot(place - cameraPosition, ray) * ray : cameraPosition;
  float way = cutOn && !gl_FrontFacing ? wayToCut(origin, ray) : -1.0;
  vec3 rgb;
  if (!lit) rgb = albedo();
  else if (way > 0.0) rgb = face(eye, origin + way * ray);
  else {
    vec3 n = normalize(eyeNormal) * (gl_FrontFacing ? 1.0 : -1.0);
    rgb = studio(albedo(), n, eye, 1.0 - fieldOn);
  }
  gl_FragColor = vec4(rgb, opacity);
  #include <colorspace_fragment>
  gl_FragColor.rgb *= gl_FragColor.a;
}`;

export interface SurfaceUniforms {
  color: { value: THREE.Color };
  cutColor: { value: THREE.Color };
  fieldOn: { value: number };
  opacity: { value: number };
}

export function surfaceMaterial(shared: SceneUniforms, color: THREE.Color, octahedral: boolean): THREE.ShaderMaterial {
  const own: SurfaceUniforms = {
    color: { value: color },
    cutColor: { value: color.clone().lerp(new THREE.Color(0xffffff), 0.35) },
    fieldOn: { value: 0 },
    opacity: { value: 1 },
  };
  return new THREE.ShaderMaterial({
    vertexShader: bodyVertex,
    fragmentShader: bodyFragment,
    uniforms: { ...shared, ...own },
    defines: octahedral ? { OCTAHEDRAL: 1 } : {},
    side: THREE.DoubleSide,
    blending: THREE.CustomBlending,
    blendSrc: THREE.OneFactor,
    blendDst: THREE.OneMinusSrcAlphaFactor,
    polygonOffset: true, // lines of the same surface lie in front of it
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}

/** Lines of one colour that end at the cut. `hidden`: those behind a surface, fainter. */
export function lineMaterial(shared: SceneUniforms, color: THREE.Color, opacity: number, hidden = false) {
  return new THREE.ShaderMaterial({
    vertexShader: /* glsl */ `
      varying vec3 place;
      void main() { place = position; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0); }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      uniform float opacity;
      uniform vec4 cut;
      uniform bool cutOn;
      varying vec3 place;
      void main() {
        if (cutOn && dot(cut.xyz, place) > cut.w) discard;
        gl_FragColor = vec4(color, opacity);
        #include <colorspace_fragment>
        gl_FragColor.rgb *= opacity;
      }`,
    uniforms: { ...shared, color: { value: color }, opacity: { value: opacity } },
    transparent: true,
    depthWrite: false,
    depthFunc: hidden ? THREE.GreaterDepth : THREE.LessEqualDepth,
    blending: THREE.CustomBlending,
    blendSrc: THREE.OneFactor,
    blendDst: THREE.OneMinusSrcAlphaFactor,
  });
}
