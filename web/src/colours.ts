// What colour each vertex has: by part, or of voids by a figure of theirs.
import type { Geometry, Part } from './geometry';
import type { Kind, Scene, Vec3 } from './scene';

export type Rgb = readonly [number, number, number]; // 0 to 255
export type ColourBy = 'kind' | 'radius' | 'wall' | 'ceiling';

export const kKindColours: Readonly<Record<Kind, Rgb>> = {
  outer: [176, 186, 200],
  remnant: [176, 186, 200],
  void: [86, 156, 214],
  channel: [64, 178, 142],
  hole: [226, 150, 52],
};

// Dark to light, in steps that are even to the eye, colour-blind ones too (after cividis).
const kEven: readonly Rgb[] = [
  [0, 48, 112],
  [57, 80, 110],
  [99, 110, 118],
  [138, 139, 120],
  [184, 170, 106],
  [229, 203, 76],
  [254, 232, 100],
];

// Calm to alarming.
const kAlarm: readonly Rgb[] = [
  [108, 150, 190],
  [170, 190, 206],
  [236, 214, 160],
  [232, 138, 74],
  [190, 44, 44],
];

function along(scale: readonly Rgb[], share: number): Rgb {
  const at = Math.min(Math.max(share, 0), 1) * (scale.length - 1);
  const low = Math.min(Math.floor(at), scale.length - 2);
  const mix = at - low;
  const part = (k: number): number => Math.round(scale[low][k] * (1 - mix) + scale[low + 1][k] * mix);
  return [part(0), part(1), part(2)];
}

export interface Legend {
  readonly title: string;
  readonly low: string;
  readonly high: string;
  readonly stops: readonly Rgb[];
}

export const format = (value: number, digits = 2): string =>
  value.toLocaleString('en', { maximumFractionDigits: digits, useGrouping: true });

interface Range {
  readonly low: number;
  readonly high: number;
}

function rangeOf(values: readonly (number | null)[]): Range | null {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value === null) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? { low, high } : null;
}

const shareOf = (value: number, { low, high }: Range): number => (high > low ? (value - low) / (high - low) : 0.5);

// Which figures there are to colour by.
export function choicesOf(scene: Scene): readonly ColourBy[] {
  const choices: ColourBy[] = ['kind'];
  if (scene.voids.radius.length > 0) choices.push('radius', 'ceiling');
  if (rangeOf(scene.voids.wall)) choices.splice(2, 0, 'wall');
  return choices;
}

export function legendOf(scene: Scene, by: ColourBy): Legend | null {
  if (by === 'ceiling') return { title: 'Overhang', low: 'steep', high: 'flat ceiling', stops: kAlarm };
  if (by === 'kind') return null;
  const range = rangeOf(by === 'radius' ? scene.voids.radius : scene.voids.wall);
  if (!range) return null;
  const thin = by === 'wall';
  return {
    title: thin ? 'Wall to the surface' : 'Radius',
    low: `${format(range.low)} mm`,
    high: `${format(range.high)} mm`,
    stops: thin ? [...kAlarm].reverse() : kEven,
  };
}

// Of a ceiling that is flat 1, of one steeper than 30 degrees from a wall 0. Voids' normals face into them.
function flatness(normals: Int8Array, vertex: number, up: Vec3): number {
  const at = 4 * vertex;
  const down = -(normals[at] * up[0] + normals[at + 1] * up[1] + normals[at + 2] * up[2]) / 127;
  return (down - 0.5) / 0.5;
}

// Four bytes for each vertex; the last says whether it is of the chosen void.
export function colourVertices(
  scene: Scene,
  geometry: Geometry,
  normals: Int8Array,
  by: ColourBy,
  chosen: number | null,
  into: Uint8Array,
): void {
  const values = by === 'radius' ? scene.voids.radius : by === 'wall' ? scene.voids.wall : [];
  const range = rangeOf(values);
  const scale = by === 'wall' ? [...kAlarm].reverse() : kEven;
  let index = 0;
  for (const part of geometry.parts) {
    const isVoid = part.kind === 'void';
    const value = isVoid ? values[index] : undefined;
    const mark = isVoid && index === chosen ? 255 : 0;
    if (isVoid) ++index;
    const sloped = by === 'ceiling' && part.kind !== 'outer' && part.kind !== 'remnant';
    const colour =
      range && value !== undefined && value !== null ? along(scale, shareOf(value, range)) : kKindColours[part.kind];
    paint(part, into, mark, (vertex) => (sloped ? along(kAlarm, flatness(normals, vertex, scene.up)) : colour));
  }
}

function paint(part: Part, into: Uint8Array, mark: number, colourOf: (vertex: number) => Rgb): void {
  for (let vertex = part.firstVertex; vertex < part.firstVertex + part.vertices; ++vertex) {
    const colour = colourOf(vertex);
    into[4 * vertex] = colour[0];
    into[4 * vertex + 1] = colour[1];
    into[4 * vertex + 2] = colour[2];
    into[4 * vertex + 3] = mark;
  }
}
