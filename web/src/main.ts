import licence from '../node_modules/three/LICENSE?raw';
import './style.css';
import { colourVertices, kKindColours } from './colours';
import { bestCut, layersOf, planeOfCut, planeOfLayer, type Plane } from './cut';
import { byId } from './dom';
import { showFigures } from './figures';
import { decode, type Part } from './geometry';
import { vertexNormals } from './normals';
import { unpack } from './payload';
import { kCutSteps, makePanel, nextVoid, type State } from './panel';
import { pick } from './pick';
import { kKinds, type Kind, type Mark, type Scene, type Vec3 } from './scene';
import { Stage, type Theme } from './stage';

const kLight: Theme = {
  cut: [0.93, 0.78, 0.5],
  hatch: [0.55, 0.38, 0.14],
  other: [0.55, 0.74, 0.92],
  chosen: [0.86, 0.15, 0.42],
  mark: [0.78, 0.09, 0.16],
};
const kDark: Theme = {
  cut: [0.62, 0.47, 0.24],
  hatch: [0.9, 0.76, 0.48],
  other: [0.2, 0.4, 0.6],
  chosen: [1, 0.36, 0.58],
  mark: [0.85, 0.1, 0.18],
};

// For tests, and for who puts the page into another one.
declare global {
  interface Window {
    aerate?: {
      readonly scene: Scene;
      readonly centre: Vec3; // of the model, mm
      readonly size: Vec3;
      state: () => State;
      set: (change: Partial<State>) => void;
      project: (place: Vec3) => readonly [number, number];
    };
  }
}

function say(text: string, isError = false): void {
  const state = byId('state', HTMLParagraphElement);
  state.textContent = text;
  state.hidden = text === '';
  state.classList.toggle('error', isError);
}

function sayWhatItIs(scene: Scene): void {
  document.title = `${scene.title}, ${scene.is}`;
  byId('title', HTMLHeadingElement).textContent = scene.title;
  byId('is', HTMLParagraphElement).textContent = scene.is;
  byId('made', HTMLParagraphElement).textContent =
    `Made by ${scene.program}. What is shown is within ${scene.grid.step.toPrecision(2)} mm of the file.`;
  byId('licence', HTMLPreElement).textContent = licence.trim();
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

async function main(): Promise<void> {
  const { scene, streams } = await unpack(byId('data', HTMLScriptElement).textContent ?? '');
  byId('data', HTMLScriptElement).remove();
  sayWhatItIs(scene);
  let stage: Stage | null = null;
  let set: ((change: Partial<State>) => void) | null = null;
  showFigures(scene, byId('figures', HTMLDivElement), (mark: Mark) => {
    set?.({ marks: true });
    stage?.lookAt(mark.place);
  });

  const geometry = decode(scene, streams);
  const normals = vertexNormals(geometry);
  const tints = new Uint8Array((4 * geometry.positions.length) / 3);
  const canvas = byId('canvas', HTMLCanvasElement);
  canvas.setAttribute('aria-label', `${scene.title}, ${scene.is}`);
  try {
    stage = new Stage(canvas, scene, geometry, normals, tints);
  } catch {
    throw new Error('this browser draws nothing in three dimensions (WebGL 2 is missing or switched off)');
  }
  const shownStage = stage;
  const layers = layersOf(scene, geometry);
  const kinds = kKinds.filter(
    (kind) => kind !== 'outer' && kind !== 'remnant' && geometry.parts.some((part) => part.kind === kind),
  );
  const isCut = scene.voids.radius.length > 0 && shownStage.closesCuts;
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
    shownStage.tinted();
  };
  const apply = (change: Partial<State>): void => {
    const old = state;
    state = { ...state, ...change };
    // Without a cut there is no face of it.
    if (!state.cut.axis && state.printed >= layers.count) state = { ...state, cutAlone: false };
    if (state.by !== old.by || state.chosen !== old.chosen) colour();
    shownStage.show({ ...state, planes: planes() });
    const plane = planeOfCut(geometry, state.cut);
    const turned = state.cut.axis !== old.cut.axis || state.cut.flipped !== old.cut.flipped;
    if (plane && turned && !shownStage.faces(plane)) shownStage.lookFrom(firstWay(scene, plane));
    update(state);
  };
  set = apply;
  const home = (): void => {
    apply({ cut: first.cut, printed: first.printed });
    shownStage.lookFrom(firstWay(scene, planeOfCut(geometry, first.cut)));
  };
  const update = makePanel(scene, geometry, layers, shownStage.closesCuts, kinds, kKindColours, apply, () => state, () => window.print());

  listenToKeys(canvas, shownStage, layers.count, scene.voids.radius.length, () => state, apply, home);
  listenToClicks(canvas, (x, y) => {
    const { from, way } = shownStage.ray(x, y);
    const isShown = (part: Part): boolean =>
      part.kind === 'outer' || part.kind === 'remnant' ? state.outer === 'solid' : state.kinds.has(part.kind);
    const part = pick(geometry, from, way, planes(), isShown, state.outer !== 'solid' || !scene.closed);
    const voids = geometry.parts.filter((one) => one.kind === 'void');
    apply({ chosen: part?.kind === 'void' ? voids.indexOf(part) : null });
  });
  listenToTheme(shownStage);
  listenToPrint(canvas, shownStage);
  window.aerate = {
    scene,
    centre: geometry.centre,
    size: geometry.size,
    state: () => state,
    set: apply,
    project: (place) => shownStage.project(place),
  };

  colour();
  home();
  shownStage.onDrawn = () => {
    shownStage.onDrawn = null;
    performance.mark('first-frame');
    document.documentElement.dataset.ready = 'true';
  };
  say('');
}

function listenToKeys(
  canvas: HTMLCanvasElement,
  stage: Stage,
  layers: number,
  voids: number,
  state: () => State,
  apply: (change: Partial<State>) => void,
  home: () => void,
): void {
  const kTurn = Math.PI / 24;
  const moveCut = (by: number): void => {
    const { cut } = state();
    apply({ cut: { ...cut, share: Math.min(Math.max(cut.share + by / kCutSteps, 0), 1) } });
  };
  const print = (by: number): void => apply({ printed: Math.min(Math.max(state().printed + by, 1), layers) });
  const keys: Readonly<Record<string, () => void>> = {
    ArrowLeft: () => stage.turn(-kTurn, 0),
    ArrowRight: () => stage.turn(kTurn, 0),
    ArrowUp: () => stage.turn(0, kTurn),
    ArrowDown: () => stage.turn(0, -kTurn),
    '+': () => stage.zoom(1.2),
    '=': () => stage.zoom(1.2),
    '-': () => stage.zoom(1 / 1.2),
    PageUp: () => moveCut(kCutSteps / 100),
    PageDown: () => moveCut(-kCutSteps / 100),
    '[': () => print(-1),
    ']': () => print(1),
    n: () => apply({ chosen: nextVoid(voids, state().chosen, 1) }),
    p: () => apply({ chosen: nextVoid(voids, state().chosen, -1) }),
    Escape: () => apply({ chosen: null }),
    Home: home,
  };
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}

// Where a pointer goes up near where it went down: what is dragged turns.
function listenToClicks(canvas: HTMLCanvasElement, onClick: (x: number, y: number) => void): void {
  const kNear = 5; // CSS pixels
  let down: { readonly x: number; readonly y: number } | null = null;
  canvas.addEventListener('pointerdown', (event) => (down = event.isPrimary && event.button === 0 ? event : null));
  canvas.addEventListener('pointerup', (event) => {
    if (!down || !event.isPrimary || Math.hypot(event.x - down.x, event.y - down.y) > kNear) return;
    const box = canvas.getBoundingClientRect();
    onClick(event.x - box.x, event.y - box.y);
  });
}

function listenToTheme(stage: Stage): void {
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const paint = (): void => stage.paint(dark.matches ? kDark : kLight);
  dark.addEventListener('change', paint);
  paint();
}

// What is printed is a picture of what is seen, in the colours of paper.
function listenToPrint(canvas: HTMLCanvasElement, stage: Stage): void {
  const picture = byId('printed', HTMLImageElement);
  window.addEventListener('beforeprint', () => {
    stage.paint(kLight);
    stage.drawNow();
    picture.src = trimmed(canvas);
    picture.alt = canvas.getAttribute('aria-label') ?? '';
    picture.hidden = false;
  });
  window.addEventListener('afterprint', () => {
    picture.hidden = true;
    stage.paint(window.matchMedia('(prefers-color-scheme: dark)').matches ? kDark : kLight);
  });
}

// Without the margins on which nothing is drawn.
function trimmed(canvas: HTMLCanvasElement): string {
  const copy = document.createElement('canvas');
  const { width, height } = canvas;
  copy.width = width;
  copy.height = height;
  const context = copy.getContext('2d', { willReadFrequently: true });
  if (!context) return canvas.toDataURL();
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  let [left, right, top, bottom] = [width, 0, height, 0];
  for (let y = 0, at = 3; y < height; ++y) {
    for (let x = 0; x < width; ++x, at += 4) {
      if (data[at] === 0) continue;
      left = Math.min(left, x);
      right = Math.max(right, x + 1);
      top = Math.min(top, y);
      bottom = Math.max(bottom, y + 1);
    }
  }
  if (left >= right) return canvas.toDataURL();
  copy.width = right - left;
  copy.height = bottom - top;
  context.drawImage(canvas, -left, -top);
  return copy.toDataURL();
}

main().catch((error: unknown) => {
  say(`The model cannot be shown: ${error instanceof Error ? error.message : String(error)}.`, true);
  document.documentElement.dataset.ready = 'failed';
});
