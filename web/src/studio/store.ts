// What all parts of the page show. Whoever changes it calls `set`; whoever shows it is told, once for many changes.
import type { Job, Model, Options, Told, Trouble } from './told';

export type Connection = 'opening' | 'open' | 'lost' | 'refused';

export interface Upload {
  readonly id: number;
  readonly name: string;
  readonly bytes: number;
  readonly share: number | null; // sent; null while it waits
  readonly trouble: Trouble | null;
}

// What is looked at: a model, a job, or all that was made of a model beside each other.
export type Shown = { readonly kind: 'model' } | { readonly kind: 'job'; readonly id: string } | { readonly kind: 'comparison' };

export interface Page {
  readonly connection: Connection;
  readonly told: Told | null; // but for what changes:
  readonly models: readonly Model[];
  readonly jobs: readonly Job[];
  readonly uploads: readonly Upload[];
  readonly chosen: string | null; // model
  readonly shown: Shown;
  readonly options: Options;
  readonly refused: string | null; // option whose value the program refuses
}

export const kFirst: Page = {
  connection: 'opening',
  told: null,
  models: [],
  jobs: [],
  uploads: [],
  chosen: null,
  shown: { kind: 'model' },
  options: {},
  refused: null,
};

export class Store {
  private page = kFirst;
  private isTold = true;
  private readonly listeners: ((page: Page) => void)[] = [];

  get now(): Page {
    return this.page;
  }

  set(change: Partial<Page>): void {
    this.page = { ...this.page, ...change };
    if (!this.isTold) return;
    this.isTold = false;
    queueMicrotask(() => {
      this.isTold = true;
      for (const listener of this.listeners) listener(this.page);
    });
  }

  listen(listener: (page: Page) => void): void {
    this.listeners.push(listener);
  }
}

export const modelChosen = ({ models, chosen }: Page): Model | null => models.find(({ id }) => id === chosen) ?? null;

export const jobsOf = ({ jobs, chosen }: Page): readonly Job[] => jobs.filter(({ model }) => model === chosen);

// What is looked at, or the model where that is there no more.
export function shownIn(page: Page): Shown {
  const { shown } = page;
  const jobs = jobsOf(page);
  const isThere = shown.kind === 'job' ? jobs.some(({ id }) => id === shown.id) : shown.kind === 'model' || jobs.some(({ state }) => state === 'done');
  return isThere ? shown : { kind: 'model' };
}

export const jobShown = (page: Page): Job | null => {
  const { shown } = page;
  return shown.kind === 'job' ? (jobsOf(page).find(({ id }) => id === shown.id) ?? null) : null;
};

// A listener that acts only when what it looks at has changed.
export function onChange<T>(key: (page: Page) => T, act: (page: Page) => void): (page: Page) => void {
  let last: T | undefined;
  return (page) => {
    const now = key(page);
    if (now === last) return;
    last = now;
    act(page);
  };
}
