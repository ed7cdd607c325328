import { expect, it } from 'vitest';
import { bestCut, layersOf, planeOfCut, planeOfLayer } from '../src/cut';
import { fixture } from './fixture';

it('goes through the void, where it is widest', async () => {
  const { scene, geometry } = await fixture();
  const cut = bestCut(scene, geometry);
  expect(cut.axis).toBe('x');
  expect(cut.share).toBeCloseTo(0.5);
});

it('takes away what is right, before or above', async () => {
  const { geometry } = await fixture();
  const at = (axis: 'x' | 'y' | 'z', flipped = false) => planeOfCut(geometry, { axis, share: 0.75, flipped });
  expect(at('x')).toEqual({ normal: [1, 0, 0], offset: expect.closeTo(5) as number });
  expect(at('y')?.normal[1]).toBe(-1);
  expect(at('y')?.offset).toBeCloseTo(-5);
  expect(at('z')?.normal[2]).toBe(1);
  expect(at('z', true)?.normal[2]).toBe(-1);
  expect(planeOfCut(geometry, { axis: null, share: 0.5, flipped: false })).toBeNull();
});

it('counts layers from the plate, of the height that the print has', async () => {
  const { scene, geometry } = await fixture();
  const layers = layersOf(scene, geometry);
  expect(layers).toEqual({ height: 0.25, assumed: false, count: 80 });
  expect(planeOfLayer(scene, geometry, layers, 1)?.offset).toBeCloseTo(-9.875);
  expect(planeOfLayer(scene, geometry, layers, 40)?.offset).toBeCloseTo(-0.125);
  expect(planeOfLayer(scene, geometry, layers, 80)).toBeNull();
  expect(layersOf({ ...scene, layerHeight: null }, geometry)).toEqual({ height: 0.2, assumed: true, count: 100 });
});
