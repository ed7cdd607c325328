// What the program tells about a job: the header of a page's data (docs/view.md, "The format"). Millimetres.

export const kKinds = ['outer', 'remnant', 'void', 'channel', 'hole'] as const;
export type Kind = (typeof kKinds)[number];

export type VoidUse = 'removed' | 'modifiers' | 'packed' | 'found';

export type Vec3 = readonly [number, number, number];

export interface Mark {
  readonly kind: string;
  readonly place: Vec3;
  readonly text: string;
  readonly lines: readonly number[]; // six numbers for each
}

export interface Change {
  readonly name: string;
  readonly unit: string;
  readonly before: number;
  readonly after: number;
}

export interface Scene {
  readonly format: 1;
  readonly program: string;
  readonly title: string;
  readonly is: string;
  readonly closed: boolean;
  readonly use: VoidUse;
  readonly grid: { readonly origin: Vec3; readonly step: number };
  readonly vertices: number;
  readonly streams: readonly [number, number, number, number, number]; // bytes of steps, links, x, y, z
  // Of each part its kind, as an index of kKinds, and its triangles.
  readonly parts: { readonly kind: readonly number[]; readonly triangles: readonly number[] };
  // Of each part that is a void, in their order.
  readonly voids: {
    readonly number: readonly number[];
    readonly place: readonly number[]; // three each
    readonly radius: readonly number[];
    readonly volume: readonly number[];
    readonly wall: readonly (number | null)[];
  };
  readonly marks: readonly Mark[];
  readonly figures: readonly (readonly [string, string])[];
  readonly changes: readonly Change[];
  readonly up: Vec3;
  readonly layerHeight: number | null;
  readonly tolerance: number;
  readonly bridge: number | null;
}

// What a void is called where it is shown.
export function nameOfVoids(use: VoidUse): { readonly one: string; readonly many: string } {
  if (use === 'modifiers') return { one: 'Modifier', many: 'Modifiers' };
  if (use === 'packed') return { one: 'Sphere', many: 'Spheres' };
  if (use === 'found') return { one: 'Hollow', many: 'Hollows' };
  return { one: 'Void', many: 'Voids' };
}
