// How the cut face is closed: of all that is not cut away, a first pass counts along each pixel's ray how many surfaces it
// leaves by and how many it enters by. Their difference is in how many solids the ray is where it comes through the plane.
// The second pass draws the plane itself where that is not none.

const kPlanes = /* glsl */ `
uniform vec4 planes[2]; // away is what has dot(xyz, p) > w
bool isAway(int plane, vec3 place) { return dot(planes[plane].xyz, place) > planes[plane].w; }
`;

export const kCountVertex = /* glsl */ `
centroid out vec3 vPlace; // within the triangle, also where its edge crosses a pixel
void main() {
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const kCountFragment = /* glsl */ `
precision highp float;
${kPlanes}
uniform bool fillsVoids; // what this surface bounds is solid, of another kind
centroid in vec3 vPlace;
out vec4 counts;
void main() {
  float one = gl_FrontFacing ? -1.0 : 1.0;
  vec2 both = vec2(isAway(0, vPlace) ? 0.0 : one, isAway(1, vPlace) ? 0.0 : one);
  counts = fillsVoids ? vec4(0.0, 0.0, -both) : vec4(both, 0.0, 0.0);
}`;

export const kCapVertex = /* glsl */ `
out vec3 vPlace;
void main() {
  vPlace = (modelMatrix * vec4(position, 1.0)).xyz;
  gl_Position = projectionMatrix * viewMatrix * vec4(vPlace, 1.0);
}`;

export const kCapFragment = /* glsl */ `
precision highp float;
${kPlanes}
uniform int plane;       // that is closed
uniform sampler2D counts;
uniform float hatch;     // mm from line to line
uniform float opacity;
uniform vec3 cutColour, hatchColour, otherColour;
in vec3 vPlace;
out vec4 colour;
void main() {
  vec4 counted = texelFetch(counts, ivec2(gl_FragCoord.xy), 0);
  float solid = clamp(plane == 0 ? counted.x : counted.y, 0.0, 1.0);
  float other = clamp(plane == 0 ? counted.z : counted.w, 0.0, 1.0);
  vec3 across = abs(planes[plane].xyz);
  vec3 along = across.x > 0.5 ? vec3(0.0, 1.0, 1.0) : across.y > 0.5 ? vec3(1.0, 0.0, 1.0) : vec3(1.0, 1.0, 0.0);
  vec3 against = across.x > 0.5 ? vec3(0.0, 1.0, -1.0) : across.y > 0.5 ? vec3(1.0, 0.0, -1.0) : vec3(1.0, -1.0, 0.0);
  float line = dot(other > 0.5 ? against : along, vPlace) / hatch;
  float blur = max(fwidth(line), 1e-4);
  if (isAway(1 - plane, vPlace) || max(solid, other) < 0.02) discard;
  float stroke = 1.0 - smoothstep(0.12 - blur, 0.12 + blur, abs(fract(line) - 0.5));
  stroke = mix(stroke, 0.24, smoothstep(0.35, 0.8, blur)); // finer than pixels
  colour = vec4(mix(mix(cutColour, otherColour, other), hatchColour, stroke), opacity * max(solid, other));
}`;

export const kSurfaceVertex = /* glsl */ `
in vec4 slope; // normal, and whether it is that of a round surface
in vec4 tint;
centroid out vec3 vPlace;
out vec3 vSlope;
out vec4 vNormal;
out vec4 vTint;
void main() {
  vPlace = position;
  vSlope = position;
  vNormal = slope;
  vTint = tint;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const kSurfaceFragment = /* glsl */ `
precision highp float;
${kPlanes}
uniform bool isGlass;
uniform vec3 chosenColour;
centroid in vec3 vPlace;
in vec3 vSlope;
in vec4 vNormal;
in vec4 vTint;
out vec4 colour;
void main() {
  vec3 flatNormal = normalize(cross(dFdx(vSlope), dFdy(vSlope)));
  if (isAway(0, vPlace) || isAway(1, vPlace)) discard;
  vec3 eye = normalize(cameraPosition - vPlace);
  if (dot(flatNormal, eye) < 0.0) flatNormal = -flatNormal;
  // Triangles at an edge are flat.
  vec3 n = vNormal.w > 0.999 ? normalize(vNormal.xyz) : flatNormal;
  if (dot(n, flatNormal) < 0.0) n = -n;
  // Light over the left shoulder of who looks, and some from above.
  vec3 side = vec3(viewMatrix[0][0], viewMatrix[1][0], viewMatrix[2][0]);
  vec3 top = vec3(viewMatrix[0][1], viewMatrix[1][1], viewMatrix[2][1]);
  vec3 light = normalize(eye - 0.45 * side + 0.6 * top);
  float lit = 0.5 + 0.48 * max(dot(n, light), 0.0) + 0.10 * max(dot(n, eye), 0.0);
  vec3 base = mix(vTint.rgb, chosenColour, vTint.a * 0.85);
  float rim = 1.0 - abs(dot(n, eye));
  if (isGlass) { colour = vec4(base * lit, 0.07 + 0.4 * rim * rim * rim); return; }
  colour = vec4(base * lit + 0.10 * pow(max(dot(reflect(-light, n), eye), 0.0), 24.0), 1.0);
}`;
