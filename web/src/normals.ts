import type { Geometry } from './geometry';

// Of each triangle the cross product of two edges: along its normal, as long as twice its area.
function faceNormals({ positions, triangles }: Geometry): Float64Array {
  const normals = new Float64Array(triangles.length);
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
    normals[i] = uy * vz - uz * vy;
    normals[i + 1] = uz * vx - ux * vz;
    normals[i + 2] = ux * vy - uy * vx;
  }
  return normals;
}

// Of each vertex the mean of its triangles' normals by their area, as four signed bytes; the fourth is 0 where they differ so
// much that there is an edge, else 127.
export function vertexNormals(geometry: Geometry): Int8Array {
  const { positions, triangles } = geometry;
  const faces = faceNormals(geometry);
  const sums = new Float32Array(positions.length);
  for (let i = 0; i < triangles.length; i += 3)
    for (let corner = 0; corner < 3; ++corner) {
      const at = 3 * triangles[i + corner];
      sums[at] += faces[i];
      sums[at + 1] += faces[i + 1];
      sums[at + 2] += faces[i + 2];
    }
  for (let i = 0; i < sums.length; i += 3) {
    const length = Math.sqrt(sums[i] ** 2 + sums[i + 1] ** 2 + sums[i + 2] ** 2);
    for (let k = 0; k < 3; ++k) sums[i + k] /= length > 0 ? length : 1;
  }
  const isRound = roundVertices(triangles, faces, sums);
  const normals = new Int8Array((positions.length / 3) * 4);
  for (let i = 0, at = 0; i < sums.length; i += 3, at += 4) {
    for (let k = 0; k < 3; ++k) normals[at + k] = Math.round(127 * sums[i + k]);
    normals[at + 3] = isRound[i / 3] ? 127 : 0;
  }
  return normals;
}

const kEdge = Math.cos((45 * Math.PI) / 180);

// Where all triangles face as the vertex does, nearly.
function roundVertices(triangles: Uint32Array, faces: Float64Array, normals: Float32Array): Uint8Array {
  const isRound = new Uint8Array(normals.length / 3).fill(1);
  for (let i = 0; i < triangles.length; i += 3) {
    const [nx, ny, nz] = [faces[i], faces[i + 1], faces[i + 2]];
    const least = kEdge * Math.sqrt(nx * nx + ny * ny + nz * nz);
    for (let corner = 0; corner < 3; ++corner) {
      const at = 3 * triangles[i + corner];
      if (normals[at] * nx + normals[at + 1] * ny + normals[at + 2] * nz < least) isRound[at / 3] = 0;
    }
  }
  return isRound;
}
