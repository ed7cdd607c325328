// A place for one viewer, and what was read for it.
import { make } from '../dom';
import { unpackBytes, type Payload } from '../payload';
import { mountViewer, type Viewer } from '../viewer';
import type { Api } from './api';

// Scenes that were shown last, so that going back to them is quick.
export class Scenes {
  private readonly kept = new Map<string, Promise<Payload>>();

  constructor(private readonly api: Api) {}

  get(path: string): Promise<Payload> {
    const kMost = 6;
    const scene = this.kept.get(path) ?? this.api.bytes(path).then(unpackBytes);
    this.kept.delete(path);
    this.kept.set(path, scene);
    scene.catch(() => this.kept.delete(path)); // to be asked for again
    for (const old of this.kept.keys()) if (this.kept.size > kMost) this.kept.delete(old);
    return scene;
  }
}

// For tests: what is shown in each slot.
declare global {
  interface Window {
    aerateStudio?: Record<string, Viewer | undefined>;
  }
}

export class Slot {
  readonly element = make('div', { class: 'slot' });
  private path = '';
  private end: AbortController | null = null;
  viewer: Viewer | null = null;
  onViewer: ((viewer: Viewer) => void) | null = null;

  constructor(
    private readonly scenes: Scenes,
    private readonly ids: string,
  ) {}

  show(path: string): void {
    if (path === this.path) return;
    this.clear();
    this.path = path;
    this.end = new AbortController();
    void this.mount(path, this.end.signal);
  }

  clear(): void {
    this.end?.abort();
    this.end = null;
    this.path = '';
    this.viewer = null;
    delete this.element.dataset.ready;
    if (window.aerateStudio) delete window.aerateStudio[this.ids];
    this.element.replaceChildren();
  }

  private async mount(path: string, signal: AbortSignal): Promise<void> {
    const root = make('div');
    this.element.replaceChildren(root);
    try {
      const viewer = await mountViewer(root, this.scenes.get(path), { ids: this.ids, level: 2, signal });
      if (signal.aborted) return;
      this.viewer = viewer;
      window.aerateStudio = { ...window.aerateStudio, [this.ids]: viewer };
      await viewer.drawn;
      if (signal.aborted) return;
      this.element.dataset.ready = path;
      this.onViewer?.(viewer);
    } catch {
      if (!signal.aborted) this.element.dataset.ready = 'failed'; // the viewer says why
    }
  }
}
