// Keys and clicks on the model.
import { kCutSteps, nextVoid, type State } from './panel';
import type { Stage } from './stage';

export interface Steered {
  readonly layers: number;
  readonly voids: number;
  readonly state: () => State;
  readonly apply: (change: Partial<State>) => void;
  readonly home: () => void;
}

export function listenToKeys(stage: Stage, { layers, voids, state, apply, home }: Steered): void {
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
  stage.canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}

// Where a pointer goes up near where it went down: what is dragged turns.
export function listenToClicks(canvas: HTMLCanvasElement, onClick: (x: number, y: number) => void): void {
  const kNear = 5; // CSS pixels
  let down: { readonly x: number; readonly y: number } | null = null;
  canvas.addEventListener('pointerdown', (event) => (down = event.isPrimary && event.button === 0 ? event : null));
  canvas.addEventListener('pointerup', (event) => {
    if (!down || !event.isPrimary || Math.hypot(event.x - down.x, event.y - down.y) > kNear) return;
    const box = canvas.getBoundingClientRect();
    onClick(event.x - box.x, event.y - box.y);
  });
}
