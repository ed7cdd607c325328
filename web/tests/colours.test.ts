import { expect, it } from 'vitest';
import { choicesOf, colourVertices, kKindColours, legendOf } from '../src/colours';
import { vertexNormals } from '../src/normals';
import { fixture } from './fixture';

async function painted(by: 'kind' | 'radius' | 'ceiling', chosen: number | null = null) {
  const { scene, geometry } = await fixture();
  const tints = new Uint8Array((4 * geometry.positions.length) / 3);
  colourVertices(scene, geometry, vertexNormals(geometry), by, chosen, tints);
  const at = (vertex: number) => [...tints.subarray(4 * vertex, 4 * vertex + 4)];
  return { geometry, at };
}

it('offers what there is to colour by', async () => {
  const { scene } = await fixture();
  expect(choicesOf(scene)).toEqual(['kind', 'radius', 'wall', 'ceiling']);
  expect(choicesOf({ ...scene, voids: { ...scene.voids, wall: [null] } })).toEqual(['kind', 'radius', 'ceiling']);
  expect(legendOf(scene, 'radius')).toMatchObject({ low: '5 mm', high: '5 mm' });
  expect(legendOf(scene, 'kind')).toBeNull();
});

it('gives each part its colour, and marks the void that is chosen', async () => {
  const { geometry, at } = await painted('kind', 0);
  expect(at(0)).toEqual([...kKindColours.outer, 0]);
  expect(at(geometry.parts[1].firstVertex)).toEqual([...kKindColours.void, 255]);
});

it('is more alarmed by the top of a void than by its bottom', async () => {
  const { geometry, at } = await painted('ceiling');
  const { firstVertex, vertices } = geometry.parts[1];
  const byHeight = Array.from({ length: vertices }, (_, i) => firstVertex + i).sort(
    (a, b) => geometry.positions[3 * a + 2] - geometry.positions[3 * b + 2],
  );
  const top = at(byHeight[vertices - 1]);
  const bottom = at(byHeight[0]);
  expect(top[0]).toBeGreaterThan(top[2]); // red
  expect(bottom[2]).toBeGreaterThan(bottom[0]); // blue
});
