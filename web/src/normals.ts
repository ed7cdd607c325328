import type { Geometry } from './geometry';

// Of each vertex the mean of its triangles' normals by their area, as four signed bytes; the fourth is 0 where they differ so
// much that there is an edge, else 127.
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
  for (let i = 0; i < sums.length; i += 3) {
    const length = Math.sqrt(sums[i] ** 2 + sums[i + 1] ** 2 + sums[i + 2] ** 2);
    for (let k = 0; k < 3; ++k) sums[i + k] /= length > 0 ? length : 1;
  }
  const isRound = roundVertices(positions, triangles, sums);
  const normals = new Int8Array((positions.length / 3) * 4);
  for (let i = 0, at = 0; i < sums.length; i += 3, at += 4) {
    for (let k = 0; k < 3; ++k) normals[at + k] = Math.round(127 * sums[i + k]);
    normals[at + 3] = isRound[i / 3] ? 127 : 0;
  }
  return normals;
}

const kEdge = Math.cos((45 * Math.PI) / 180);

// Where all triangles face as the vertex does, nearly.
function roundVertices(positions: Float32Array, triangles: Uint32Array, normals: Float32Array): Uint8Array {
  const isRound = new Uint8Array(positions.length / 3).fill(1);
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
    const least = kEdge * Math.sqrt(nx * nx + ny * ny + nz * nz);
    if (normals[a] * nx + normals[a + 1] * ny + normals[a + 2] * nz < least) isRound[a / 3] = 0;
    if (normals[b] * nx + normals[b + 1] * ny + normals[b + 2] * nz < least) isRound[b / 3] = 0;
    if (normals[c] * nx + normals[c + 1] * ny + normals[c + 2] * nz < least) isRound[c / 3] = 0;
  }
  return isRound;
}
