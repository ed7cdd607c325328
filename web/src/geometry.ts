// Reads the walk by which src/view/page_geometry.cpp writes triangles; each step there has its counterpart here.
import { kKinds, type Kind, type Scene } from './scene';

const kNew = 0;
const kForward = 1;
const kBackward = 2;
const kNothing = 3;
const kLink = 4;
const kStart = 8;

export interface Part {
  readonly kind: Kind;
  readonly firstTriangle: number;
  readonly triangles: number;
  readonly firstVertex: number;
  readonly vertices: number;
}

export interface Geometry {
  readonly positions: Float32Array; // mm from `centre`, three for each vertex
  readonly triangles: Uint32Array; // three vertices each, counter-clockwise seen from outside of what is solid
  readonly parts: readonly Part[];
  readonly centre: readonly [number, number, number]; // of the grid's box, mm
  readonly size: readonly [number, number, number];
}

class Numbers {
  private at = 0;
  constructor(private readonly bytes: Uint8Array) {}

  next(): number {
    let number = 0;
    for (let shift = 0; ; shift += 7) {
      const byte = this.bytes[this.at++];
      if (byte === undefined) throw new Error('the data ends early');
      number |= (byte & 0x7f) << shift;
      if (byte < 0x80) return number >>> 0;
    }
  }

  nextSigned(): number {
    const number = this.next();
    return (number >>> 1) ^ -(number & 1);
  }
}

class Walk {
  // Of each gate: its ends, the corner behind it, its neighbours.
  private readonly from: Int32Array;
  private readonly to: Int32Array;
  private readonly behind: Int32Array;
  private readonly before: Int32Array;
  private readonly after: Int32Array;
  private gates = 0;
  private here = -1;
  private met = 0; // vertices of all parts so far
  private done = 0; // triangles

  constructor(
    private readonly places: Int32Array,
    private readonly triangles: Uint32Array,
    private readonly steps: Uint8Array,
    private readonly links: Numbers,
    private readonly offsets: readonly [Numbers, Numbers, Numbers],
  ) {
    // A gate is made with each vertex or link, and three with each start.
    let most = 0;
    for (const step of steps) most += step >= kStart ? 3 : step === kNew || step === kLink ? 1 : 0;
    this.from = new Int32Array(most);
    this.to = new Int32Array(most);
    this.behind = new Int32Array(most);
    this.before = new Int32Array(most);
    this.after = new Int32Array(most);
  }

  private step = 0;

  // Returns how many vertices the part has.
  readPart(count: number): number {
    const first = this.met;
    const end = this.done + count;
    const last: [number, number, number] = [0, 0, 0];
    this.here = -1;
    while (this.done < end || this.here >= 0) {
      const step = this.steps[this.step++];
      if (step === undefined) throw new Error('the data ends early');
      if (step >= kStart) this.start(step, last);
      else this.goOn(step);
    }
    return this.met - first;
  }

  private place(x: number, y: number, z: number): number {
    const at = 3 * this.met;
    this.places[at] = x + this.offsets[0].nextSigned();
    this.places[at + 1] = y + this.offsets[1].nextSigned();
    this.places[at + 2] = z + this.offsets[2].nextSigned();
    return this.met++;
  }

  private link(): number {
    return this.met - 1 - this.links.next();
  }

  private add(a: number, b: number, c: number): void {
    const at = 3 * this.done++;
    this.triangles[at] = a;
    this.triangles[at + 1] = b;
    this.triangles[at + 2] = c;
  }

  private start(step: number, last: [number, number, number]): void {
    const corners: number[] = [];
    for (let i = 0; i < 3; ++i) {
      const corner = step & (1 << i) ? this.link() : this.place(last[0], last[1], last[2]);
      corners.push(corner);
      for (let k = 0; k < 3; ++k) last[k] = this.places[3 * corner + k];
    }
    this.add(corners[0], corners[1], corners[2]);
    const first = this.gates;
    for (let i = 0; i < 3; ++i)
      this.makeGate(corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3], first + ((i + 2) % 3), first + ((i + 1) % 3));
    this.here = first;
  }

  private makeGate(from: number, to: number, behind: number, before: number, after: number): number {
    const gate = this.gates++;
    this.from[gate] = from;
    this.to[gate] = to;
    this.behind[gate] = behind;
    this.before[gate] = before;
    this.after[gate] = after;
    return gate;
  }

  private goOn(step: number): void {
    const here = this.here;
    const from = this.from[here];
    const to = this.to[here];
    if (step === kNothing) {
      this.here = this.after[here];
      this.remove(here);
    } else if (step === kForward) {
      const closed = this.after[here];
      const tip = this.to[closed];
      this.add(to, from, tip);
      this.behind[here] = to;
      this.to[here] = tip;
      this.remove(closed);
      this.settle(here);
    } else if (step === kBackward) {
      const closed = this.before[here];
      const tip = this.from[closed];
      this.add(to, from, tip);
      this.behind[here] = from;
      this.from[here] = tip;
      this.remove(closed);
      this.settle(here);
    } else if (step === kNew || step === kLink) {
      const a = 3 * from;
      const b = 3 * to;
      const c = 3 * this.behind[here];
      const p = this.places;
      const tip =
        step === kLink
          ? this.link()
          : this.place(p[a] + p[b] - p[c], p[a + 1] + p[b + 1] - p[c + 1], p[a + 2] + p[b + 2] - p[c + 2]);
      this.add(to, from, tip);
      this.widen(here, tip);
    } else {
      throw new Error(`the data has a step ${step}`);
    }
  }

  private widen(here: number, tip: number): void {
    const from = this.from[here];
    const to = this.to[here];
    const after = this.after[here];
    const added = this.makeGate(tip, to, from, here, after);
    this.before[after] = added;
    this.to[here] = tip;
    this.behind[here] = to;
    this.after[here] = added;
    this.settle(added);
  }

  private remove(gate: number): void {
    this.after[this.before[gate]] = this.after[gate];
    this.before[this.after[gate]] = this.before[gate];
    if (this.here === gate) this.here = this.after[gate] === gate ? -1 : this.after[gate];
  }

  private isBack(a: number, b: number): boolean {
    return this.from[a] === this.to[b] && this.to[a] === this.from[b];
  }

  // Takes gates out that are two sides of one edge.
  private settle(gate: number): void {
    this.here = gate;
    for (;;) {
      const closed = this.here;
      const before = this.before[closed];
      const after = this.after[closed];
      if (after === closed) return;
      const other = this.isBack(closed, after) ? after : this.isBack(closed, before) ? before : -1;
      if (other < 0) return;
      const left = other === after ? before : this.before[other];
      this.remove(closed);
      const isLast = this.after[other] === other;
      this.remove(other);
      if (isLast) {
        this.here = -1;
        return;
      }
      this.here = left;
    }
  }
}

export function decode(scene: Scene, streams: readonly Uint8Array[]): Geometry {
  const total = scene.parts.triangles.reduce((sum, count) => sum + count, 0);
  const places = new Int32Array(3 * scene.vertices);
  const triangles = new Uint32Array(3 * total);
  const [steps, links, x, y, z] = streams;
  const walk = new Walk(places, triangles, steps, new Numbers(links), [new Numbers(x), new Numbers(y), new Numbers(z)]);
  const parts: Part[] = [];
  let firstTriangle = 0;
  let firstVertex = 0;
  for (let i = 0; i < scene.parts.kind.length; ++i) {
    const count = scene.parts.triangles[i];
    const vertices = walk.readPart(count);
    parts.push({ kind: kKinds[scene.parts.kind[i]], firstTriangle, triangles: count, firstVertex, vertices });
    firstTriangle += count;
    firstVertex += vertices;
  }
  if (firstVertex !== scene.vertices) throw new Error('the data has another number of vertices than it says');
  return { ...centred(places, scene), triangles, parts };
}

// In mm, from the middle of all, where fp32 resolves best.
function centred(places: Int32Array, scene: Scene): Pick<Geometry, 'positions' | 'centre' | 'size'> {
  const { origin, step } = scene.grid;
  const lower = [Infinity, Infinity, Infinity];
  const upper = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < places.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const at = places[i + k];
      if (at < lower[k]) lower[k] = at;
      if (at > upper[k]) upper[k] = at;
    }
  }
  const middle = lower.map((low, k) => (places.length > 0 ? (low + upper[k]) / 2 : 0));
  const positions = new Float32Array(places.length);
  for (let i = 0; i < places.length; i += 3)
    for (let k = 0; k < 3; ++k) positions[i + k] = (places[i + k] - middle[k]) * step;
  const vector = (of: (k: number) => number): [number, number, number] => [of(0), of(1), of(2)];
  return {
    positions,
    centre: vector((k) => origin[k] + middle[k] * step),
    size: vector((k) => (places.length > 0 ? (upper[k] - lower[k]) * step : 0)),
  };
}
