import { expect, it, vi } from 'vitest';
import type { Api } from '../../src/studio/api';
import type { ServerEvent } from '../../src/studio/event_stream';
import { Session } from '../../src/studio/session';
import { shownIn, Store } from '../../src/studio/store';
import type { Job, Model, Told } from '../../src/studio/told';

const model = (id: string): Model => ({
  id,
  name: `${id}.stl`,
  bytes: 84,
  report: { input: { format: 'STL', triangles: 12, filled_volume_mm3: 1, box: { lower_mm: [0, 0, 0], upper_mm: [1, 1, 1] } } },
  usable: true,
  use: '',
});
const job = (id: string, of: string, state: Job['state'] = 'done'): Job => ({ id, model: of, options: {}, state, command: '' });

function told(models: readonly Model[], jobs: readonly Job[]): Told {
  return { version: '', limits: { bodyBytes: 1, models: 1, jobs: 1, formats: [] }, options: [], processes: [], models, jobs };
}

// A page whose stream of events is open; `states` are what the program answers one after the other.
async function opened(...states: readonly Told[]) {
  let tell: (event: ServerEvent) => void = () => {};
  const answers = [...states];
  const removed: string[] = [];
  const api = {
    state: () => Promise.resolve(answers.length > 1 ? answers.shift()! : answers[0]),
    listen: (onEvent: typeof tell, onOpen: () => void) => {
      tell = onEvent;
      onOpen();
      return new Promise<void>(() => {});
    },
    remove: (kind: string, id: string) => {
      removed.push(`${kind}/${id}`);
      return Promise.resolve({});
    },
  };
  const store = new Store();
  const session = new Session(api as unknown as Api, store);
  void session.run();
  await vi.waitFor(() => expect(store.now.connection).toBe('open'));
  await new Promise((done) => setTimeout(done));
  return { session, store, removed, tell: (name: string, data: unknown) => tell({ name, data: JSON.stringify(data) }) };
}

const ids = (all: readonly { readonly id: string }[]): readonly string[] => all.map(({ id }) => id);

it('goes back to the model when another tab removes all that is compared', async () => {
  const { store, tell } = await opened(told([model('m1')], [job('j1', 'm1'), job('j2', 'm1', 'failed')]));
  store.set({ shown: { kind: 'comparison' } });
  tell('removed', { id: 'j2' });
  expect(store.now.shown).toEqual({ kind: 'comparison' });
  tell('removed', { id: 'j1' });
  expect(store.now.shown).toEqual({ kind: 'model' });
});

it('shows the model in the place of what is not there', async () => {
  const { store } = await opened(told([model('m1'), model('m2')], [job('j1', 'm1')]));
  expect(shownIn({ ...store.now, shown: { kind: 'job', id: 'j1' } })).toEqual({ kind: 'job', id: 'j1' });
  expect(shownIn({ ...store.now, shown: { kind: 'job', id: 'j9' } })).toEqual({ kind: 'model' });
  expect(shownIn({ ...store.now, chosen: 'm2', shown: { kind: 'comparison' } })).toEqual({ kind: 'model' });
});

it('forgets what was removed before the events began, and keeps what came since', async () => {
  const before = told([model('m1'), model('m2')], [job('j1', 'm1'), job('j2', 'm2'), job('j3', 'm1')]);
  const { store, tell } = await opened(before, told([model('m1')], [job('j1', 'm1')]));
  expect(ids(store.now.models)).toEqual(['m1']);
  expect(ids(store.now.jobs)).toEqual(['j1']);
  tell('job', job('j4', 'm1', 'running'));
  expect(ids(store.now.jobs)).toEqual(['j1', 'j4']);
});

it('keeps a job that is told of while it asks once more what is there', async () => {
  const all = told([model('m1')], [job('j1', 'm1')]);
  let answer: (state: Told) => void = () => {};
  let asked = 0;
  const api = {
    state: () => (++asked === 1 ? Promise.resolve(all) : new Promise<Told>((done) => (answer = done))),
    listen: (onEvent: (event: ServerEvent) => void, onOpen: () => void) => {
      onOpen();
      onEvent({ name: 'job', data: JSON.stringify(job('j2', 'm1', 'waiting')) });
      return new Promise<void>(() => {});
    },
  };
  const store = new Store();
  void new Session(api as unknown as Api, store).run();
  await vi.waitFor(() => expect(asked).toBe(2));
  answer({ ...all, jobs: [] });
  await vi.waitFor(() => expect(ids(store.now.jobs)).toEqual(['j2']));
});

it('removes a model by one request, and forgets what was made of it', async () => {
  const { session, store, removed } = await opened(told([model('m1'), model('m2')], [job('j1', 'm1'), job('j2', 'm2')]));
  store.set({ chosen: 'm1' });
  await session.removeModel('m1');
  expect(removed).toEqual(['models/m1']);
  expect(ids(store.now.jobs)).toEqual(['j2']);
  expect(store.now.chosen).toBe('m2');
});
