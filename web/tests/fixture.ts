import { readFileSync } from 'node:fs';
import { decode, type Geometry } from '../src/geometry';
import { unpack } from '../src/payload';
import type { Scene } from '../src/scene';

// What the program makes of a box of 20 mm with a round void (tests/view/test_page.cpp).
export const kData = readFileSync(new URL('../../tests/data/page-data.txt', import.meta.url), 'utf8');

export async function fixture(): Promise<{ readonly scene: Scene; readonly geometry: Geometry }> {
  const { scene, streams } = await unpack(kData);
  return { scene, geometry: decode(scene, streams) };
}
