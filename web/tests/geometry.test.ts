import { describe, expect, it } from 'vitest';
import { decode, type Geometry, type Part } from '../src/geometry';
import { vertexNormals } from '../src/normals';
import { unpack } from '../src/payload';
import { fixture, kData } from './fixture';

function volumeOf({ positions: p, triangles }: Geometry, part: Part): number {
  let sum = 0;
  for (let t = 3 * part.firstTriangle; t < 3 * (part.firstTriangle + part.triangles); t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[t + k]);
    sum +=
      p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]) +
      p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]) +
      p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
  }
  return sum / 6;
}

describe('what the program wrote', () => {
  it('has its parts', async () => {
    const { geometry } = await fixture();
    expect(geometry.parts.map(({ kind, triangles }) => [kind, triangles])).toEqual([
      ['outer', 12],
      ['void', 168],
    ]);
    expect(geometry.size.map((size) => Math.round(1e3 * size))).toEqual([20000, 20000, 20000]);
    expect(geometry.centre.map((at) => Math.round(1e3 * at))).toEqual([10000, 10000, 10000]);
  });

  it('is closed: each edge has a triangle on either side', async () => {
    const { geometry } = await fixture();
    const edges = new Map<string, number>();
    for (let i = 0; i < geometry.triangles.length; i += 3) {
      for (let k = 0; k < 3; ++k) {
        const from = geometry.triangles[i + k];
        const to = geometry.triangles[i + ((k + 1) % 3)];
        edges.set(`${from} ${to}`, (edges.get(`${from} ${to}`) ?? 0) + 1);
      }
    }
    for (const [edge, count] of edges) {
      expect(count).toBe(1);
      expect(edges.get(edge.split(' ').reverse().join(' '))).toBe(1);
    }
  });

  it('faces outward, and into voids', async () => {
    const { geometry } = await fixture();
    expect(volumeOf(geometry, geometry.parts[0])).toBeCloseTo(8000, 0);
    const hollow = volumeOf(geometry, geometry.parts[1]);
    expect(hollow).toBeLessThan(-400);
    expect(hollow).toBeGreaterThan((-4 / 3) * Math.PI * 125);
  });

  it('has normals that face into the void', async () => {
    const { geometry } = await fixture();
    const normals = vertexNormals(geometry);
    const { firstVertex, vertices } = geometry.parts[1];
    for (let v = firstVertex; v < firstVertex + vertices; ++v) {
      // The void's centre is 2 mm below the middle of all.
      const [x, y, z] = [0, 1, 2].map((k) => geometry.positions[3 * v + k]);
      const inward = -(normals[4 * v] * x + normals[4 * v + 1] * y + normals[4 * v + 2] * (z + 2));
      expect(inward / 127 / 5).toBeGreaterThan(0.95);
      expect(normals[4 * v + 3]).toBe(127);
    }
    expect(normals[3]).toBe(0); // a corner of the box
  });
});

describe('data that is damaged', () => {
  it('is said to be', async () => {
    const { scene, streams } = await unpack(kData);
    const [steps, links, ...places] = streams;
    expect(() => decode(scene, [steps.subarray(0, 20), links, ...places])).toThrow('ends early');
    expect(() => decode({ ...scene, vertices: 3 }, streams)).toThrow('vertices');
    const odd = steps.map((step, i) => (i === 5 ? 7 : step));
    expect(() => decode(scene, [odd, links, ...places])).toThrow('a step 7');
    await expect(unpack(kData.trim().slice(0, 200))).rejects.toThrow();
  });
});
