import type { Geometry } from './geometry';

// Of each vertex the mean of its triangles' normals by their area, as four signed bytes (the fourth is 0).
export function vertexNormals({ positions, triangles }: Geometry): Int8Array {
  const sums = new Float32Array(positions.length);
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i];
    const b = 3 * triangles[i + 1];
    const c = 3 * triangles[i + 2];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    sums[a] += nx;
    sums[a + 1] += ny;
    sums[a + 2] += nz;
    sums[b] += nx;
    sums[b + 1] += ny;
    sums[b + 2] += nz;
    sums[c] += nx;
    sums[c + 1] += ny;
    sums[c + 2] += nz;
  }
  const normals = new Int8Array((positions.length / 3) * 4);
  for (let i = 0, at = 0; i < sums.length; i += 3, at += 4) {
    const length = Math.sqrt(sums[i] ** 2 + sums[i + 1] ** 2 + sums[i + 2] ** 2);
    const scale = length > 0 ? 127 / length : 0;
    for (let k = 0; k < 3; ++k) normals[at + k] = Math.round(sums[i + k] * scale);
  }
  return normals;
}
