import type { Plane } from './cut';
import type { Geometry, Part } from './geometry';
import type { Vec3 } from './scene';

// The part whose surface a ray meets first of what is not cut away; none if it comes through a closed cut face first, which
// is so where it meets a surface from behind.
//   shown: parts that are looked at
//   seesThrough: there is no cut face that hides anything
export function pick(
  geometry: Geometry,
  from: Vec3,
  way: Vec3,
  planes: readonly Plane[],
  shown: (part: Part) => boolean,
  seesThrough: boolean,
): Part | null {
  let start = 0;
  let end = Infinity;
  let enters = false;
  for (const { normal, offset } of planes) {
    const toward = dot(normal, way);
    const off = offset - dot(normal, from);
    if (toward < 0 && off < 0) {
      start = Math.max(start, off / toward);
      enters = true;
    } else if (toward > 0) {
      end = Math.min(end, off / toward);
    } else if (off < 0) {
      return null;
    }
  }
  let nearest = end;
  let found: Part | null = null;
  let isBack = false;
  for (const part of geometry.parts) {
    if (!shown(part)) continue;
    for (let t = part.firstTriangle; t < part.firstTriangle + part.triangles; ++t) {
      const hit = crossing(geometry, t, from, way);
      if (hit === null) continue;
      const distance = Math.abs(hit);
      if (distance < start || distance >= nearest) continue;
      nearest = distance;
      found = part;
      isBack = hit < 0;
    }
  }
  return found && enters && isBack && !seesThrough ? null : found;
}

function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// How far a triangle is along the ray, negative if it is met from behind (after Moeller and Trumbore).
function crossing({ positions: p, triangles }: Geometry, t: number, from: Vec3, way: Vec3): number | null {
  const a = 3 * triangles[3 * t];
  const b = 3 * triangles[3 * t + 1];
  const c = 3 * triangles[3 * t + 2];
  const ux = p[b] - p[a];
  const uy = p[b + 1] - p[a + 1];
  const uz = p[b + 2] - p[a + 2];
  const vx = p[c] - p[a];
  const vy = p[c + 1] - p[a + 1];
  const vz = p[c + 2] - p[a + 2];
  const hx = way[1] * vz - way[2] * vy;
  const hy = way[2] * vx - way[0] * vz;
  const hz = way[0] * vy - way[1] * vx;
  const det = ux * hx + uy * hy + uz * hz;
  if (det === 0) return null;
  const sx = from[0] - p[a];
  const sy = from[1] - p[a + 1];
  const sz = from[2] - p[a + 2];
  const along = (sx * hx + sy * hy + sz * hz) / det;
  if (along < 0 || along > 1) return null;
  const qx = sy * uz - sz * uy;
  const qy = sz * ux - sx * uz;
  const qz = sx * uy - sy * ux;
  const across = (way[0] * qx + way[1] * qy + way[2] * qz) / det;
  if (across < 0 || along + across > 1) return null;
  const distance = (vx * qx + vy * qy + vz * qz) / det;
  if (distance <= 0) return null;
  return det > 0 ? distance : -distance;
}
