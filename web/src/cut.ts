// Where the model is cut: a plane across an axis, and the layer up to which it is printed.
import type { Geometry } from './geometry';
import type { Scene, Vec3 } from './scene';

export type Axis = 'x' | 'y' | 'z';
export const kAxes: readonly Axis[] = ['x', 'y', 'z'];

export interface Cut {
  readonly axis: Axis | null;
  readonly share: number; // of the model's extent, 0 to 1
  readonly flipped: boolean; // the other half is taken away than is usual: before (y), right (x) or above (z)
}

// What lies where normal * p > offset is taken away; mm from the geometry's centre.
export interface Plane {
  readonly normal: Vec3;
  readonly offset: number;
}

const kAssumedLayer = 0.2; // mm

export interface Layers {
  readonly height: number;
  readonly assumed: boolean;
  readonly count: number;
}

// How far the model's box reaches along a direction from its centre, either way.
function reach(geometry: Geometry, direction: Vec3): number {
  return direction.reduce((sum, value, k) => sum + (Math.abs(value) * geometry.size[k]) / 2, 0);
}

export function layersOf(scene: Scene, geometry: Geometry): Layers {
  const height = scene.layerHeight ?? kAssumedLayer;
  const count = Math.max(1, Math.ceil((2 * reach(geometry, scene.up)) / height - 1e-6));
  return { height, assumed: scene.layerHeight === null, count };
}

export function planeOfCut(geometry: Geometry, cut: Cut): Plane | null {
  if (!cut.axis) return null;
  const k = kAxes.indexOf(cut.axis);
  // Never in the faces of the box themselves, which would leave slivers.
  const offset = (Math.min(Math.max(cut.share, 0.001), 0.999) - 0.5) * geometry.size[k];
  const sign = (cut.axis === 'y') === cut.flipped ? 1 : -1;
  const normal: [number, number, number] = [0, 0, 0];
  normal[k] = sign;
  return { normal, offset: sign * offset };
}

// Through the middle of the last layer, where a slicer cuts too. All layers: no plane.
export function planeOfLayer(scene: Scene, geometry: Geometry, layers: Layers, printed: number): Plane | null {
  if (printed >= layers.count) return null;
  return { normal: scene.up, offset: (printed - 0.5) * layers.height - reach(geometry, scene.up) };
}

// The cut across which most of the voids lies, by their spheres.
export function bestCut(scene: Scene, geometry: Geometry): Cut {
  const { place, radius } = scene.voids;
  let best: Cut = { axis: 'y', share: 0.5, flipped: false };
  let most = 0;
  kAxes.forEach((axis, k) => {
    // An upright cut is what most want to see first.
    const weight = Math.abs(scene.up[k]) > 0.9 ? 0.7 : 1;
    const low = geometry.centre[k] - geometry.size[k] / 2;
    for (let step = 6; step <= 34; ++step) {
      const share = step / 40;
      const at = low + share * geometry.size[k];
      let area = 0;
      for (let i = 0; i < radius.length; ++i) {
        const off = place[3 * i + k] - at;
        area += Math.max(0, radius[i] ** 2 - off ** 2);
      }
      if (weight * area > most * 1.0001) {
        most = weight * area;
        best = { axis, share, flipped: false };
      }
    }
  });
  return best;
}
