// A model to turn and cut, with its controls and figures: all of a page of --view, and any number of them in the studio.
import { colourVertices, kKindColours } from './colours';
import { bestCut, layersOf, planeOfCut, planeOfLayer, type Plane } from './cut';
import { showFigures } from './figures';
import { makeFrame, say, type Frame, type FrameOptions } from './frame';
import { decode, type Geometry, type Part } from './geometry';
import { listenToClicks, listenToKeys } from './input';
import { vertexNormals } from './normals';
import { makePanel, type State } from './panel';
import type { Payload } from './payload';
import { pick } from './pick';
import { listenToPrint } from './print';
import { kKinds, type Kind, type Mark, type Scene, type Vec3 } from './scene';
import { Stage, type View } from './stage';
import { listenToTheme } from './themes';

export interface ViewerOptions extends FrameOptions {
  readonly signal?: AbortSignal; // ends it, and gives back what it drew with
}

export interface Viewer {
  readonly frame: Frame;
  readonly scene: Scene;
  readonly centre: Vec3; // of the model, mm
  readonly size: Vec3;
  readonly drawn: Promise<void>; // when the first frame is there
  readonly state: () => State;
  readonly set: (change: Partial<State>) => void;
  readonly project: (place: Vec3) => readonly [number, number];
  readonly view: () => View;
  readonly lookAs: (view: View) => void;
  // What is called when it is turned, zoomed, moved or cut by who looks.
  onMoved: (() => void) | null;
}

// The view of the beginning: at the cut face, from a little aside and above.
function firstWay(scene: Scene, plane: Plane | null): Vec3 {
  const up = scene.up;
  const front: Vec3 = Math.abs(up[1]) > 0.9 ? [0, 0, 1] : [0, -1, 0];
  const toward = plane?.normal ?? front;
  const aside: Vec3 = [toward[1] * up[2] - toward[2] * up[1], toward[2] * up[0] - toward[0] * up[2], toward[0] * up[1] - toward[1] * up[0]];
  const alongUp = Math.abs(toward[0] * up[0] + toward[1] * up[1] + toward[2] * up[2]) > 0.9;
  const mix = (k: number): number => (alongUp ? toward[k] + 0.6 * front[k] : toward[k] - 0.35 * aside[k] + 0.28 * up[k]);
  return [mix(0), mix(1), mix(2)];
}

function makeStage(frame: Frame, scene: Scene, geometry: Geometry, normals: Int8Array, tints: Uint8Array): Stage {
  try {
    return new Stage(frame.canvas, scene, geometry, normals, tints);
  } catch {
    throw new Error('this browser draws nothing in three dimensions (WebGL 2 is missing or switched off)');
  }
}

// Fills `root`. Where the model cannot be shown, says why there, and rejects.
export async function mountViewer(root: HTMLElement, payload: Payload | Promise<Payload>, options: ViewerOptions): Promise<Viewer> {
  const frame = makeFrame(root, options);
  try {
    return mount(frame, await payload, options.signal ?? new AbortController().signal);
  } catch (error) {
    say(frame, `The model cannot be shown: ${error instanceof Error ? error.message : String(error)}.`, true);
    throw error;
  }
}

function mount(frame: Frame, { scene, streams }: Payload, signal: AbortSignal): Viewer {
  signal.throwIfAborted();
  frame.title.textContent = scene.title;
  frame.is.textContent = scene.is;
  frame.made.textContent = `Made by ${scene.program}. What is shown is within ${scene.grid.step.toPrecision(2)} mm of the file.`;
  let shownStage: Stage | null = null;
  let set: ((change: Partial<State>) => void) | null = null;
  showFigures(scene, frame, (mark: Mark) => {
    set?.({ marks: true });
    shownStage?.lookAt(mark.place);
  });

  const geometry = decode(scene, streams);
  const normals = vertexNormals(geometry);
  const tints = new Uint8Array((4 * geometry.positions.length) / 3);
  frame.canvas.setAttribute('aria-label', `${scene.title}, ${scene.is}`);
  const stage = makeStage(frame, scene, geometry, normals, tints);
  shownStage = stage;
  signal.addEventListener('abort', () => stage.dispose());
  const layers = layersOf(scene, geometry);
  const kinds = kKinds.filter(
    (kind) => kind !== 'outer' && kind !== 'remnant' && geometry.parts.some((part) => part.kind === kind),
  );
  const isCut = scene.voids.radius.length > 0 && stage.closesCuts;
  const best = bestCut(scene, geometry);
  const first: State = {
    cut: isCut ? best : { ...best, axis: null },
    cutAlone: false,
    printed: layers.count,
    outer: 'solid',
    kinds: new Set<Kind>(kinds),
    marks: true,
    by: 'kind',
    chosen: null,
  };
  let state = first;

  const planes = (): readonly Plane[] =>
    [planeOfCut(geometry, state.cut), planeOfLayer(scene, geometry, layers, state.printed)].filter((plane) => plane !== null);
  const colour = (): void => {
    colourVertices(scene, geometry, normals, state.by, state.chosen, tints);
    stage.tinted();
  };
  const apply = (change: Partial<State>): void => {
    const old = state;
    state = { ...state, ...change };
    // Without a cut there is no face of it.
    if (!state.cut.axis && state.printed >= layers.count) state = { ...state, cutAlone: false };
    if (state.by !== old.by || state.chosen !== old.chosen) colour();
    stage.show({ ...state, planes: planes() });
    const plane = planeOfCut(geometry, state.cut);
    const turned = state.cut.axis !== old.cut.axis || state.cut.flipped !== old.cut.flipped;
    if (plane && turned && !stage.faces(plane)) stage.lookFrom(firstWay(scene, plane));
    update(state);
  };
  set = apply;
  const home = (): void => {
    apply({ cut: first.cut, printed: first.printed });
    stage.lookFrom(firstWay(scene, planeOfCut(geometry, first.cut)));
  };

  const viewer: Viewer = {
    frame,
    scene,
    centre: geometry.centre,
    size: geometry.size,
    drawn: new Promise((done) => {
      stage.onDrawn = () => {
        stage.onDrawn = null;
        done();
      };
    }),
    state: () => state,
    set: apply,
    project: (place) => stage.project(place),
    view: () => stage.view(),
    lookAs: (view) => stage.lookAs(view),
    onMoved: null,
  };
  // As who looks does it, not as `set` does.
  const steer = (change: Partial<State>): void => {
    apply(change);
    viewer.onMoved?.();
  };
  const update = makePanel(frame, scene, geometry, layers, stage.closesCuts, kinds, kKindColours, steer, () => state, () => window.print());

  const goHome = (): void => {
    home();
    viewer.onMoved?.();
  };
  stage.onMoved = () => viewer.onMoved?.();
  listenToKeys(stage, { layers: layers.count, voids: scene.voids.radius.length, state: () => state, apply: steer, home: goHome });
  listenToClicks(frame.canvas, (x, y) => {
    const { from, way } = stage.ray(x, y);
    const isShown = (part: Part): boolean =>
      part.kind === 'outer' || part.kind === 'remnant' ? state.outer === 'solid' : state.kinds.has(part.kind);
    const part = pick(geometry, from, way, planes(), isShown, state.outer !== 'solid' || !scene.closed);
    const voids = geometry.parts.filter((one) => one.kind === 'void');
    apply({ chosen: part?.kind === 'void' ? voids.indexOf(part) : null });
  });
  listenToTheme(stage, signal);
  listenToPrint(frame, stage, signal);

  colour();
  home();
  say(frame, '');
  return viewer;
}
