// What the page does with the program: asks for all there is, hears what changes, sends models, starts and stops jobs.
import { Refusal, troubleOf, type Api } from './api';
import type { ServerEvent } from './event_stream';
import { modelChosen, shownIn, type Page, type Store, type Upload } from './store';
import type { Job, Model, Told, Trouble } from './told';
import { bytesIn } from './words';

export const isEnded = ({ state }: Job): boolean => state === 'done' || state === 'failed' || state === 'stopped';

const pause = (ms: number): Promise<void> => new Promise((done) => window.setTimeout(done, ms));

export class Session {
  private uploads = 0;
  private readonly stops = new Map<number, AbortController>();
  private readonly queue: { readonly id: number; readonly file: File }[] = [];
  private isSending = false;

  constructor(
    readonly api: Api,
    readonly store: Store,
  ) {}

  // As long as the page is open.
  async run(): Promise<void> {
    for (let wait = 500; ; wait = Math.min(2 * wait, 5000)) {
      try {
        await this.refresh();
        await this.api.listen(
          (event) => this.hear(event),
          () => {
            wait = 500;
            this.store.set({ connection: 'open' });
            void this.forgetLost();
          },
        );
      } catch (error) {
        if (error instanceof Refusal && error.status === 401) {
          this.store.set({ connection: 'refused' });
          return;
        }
      }
      this.store.set({ connection: 'lost' });
      await pause(wait);
    }
  }

  private async refresh(): Promise<void> {
    const told: Told = await this.api.state();
    const isFirst = this.store.now.told === null;
    const { chosen } = this.store.now;
    const { models, jobs } = told;
    const isThere = models.some(({ id }) => id === chosen);
    this.settle({ told, models, jobs, ...(isThere ? {} : { chosen: models.at(-1)?.id ?? null, shown: { kind: 'model' } }) });
    if (isFirst) this.goOn(jobs);
  }

  // What is looked at may be gone.
  private settle(change: Partial<Page>): void {
    this.store.set({ ...change, shown: shownIn({ ...this.store.now, ...change }) });
  }

  // What was removed between the answer of what is there and the beginning of the events is told by neither.
  private async forgetLost(): Promise<void> {
    const { models, jobs } = this.store.now;
    try {
      const told = await this.api.state();
      const there = new Set([...told.models, ...told.jobs].map(({ id }) => id));
      for (const { id } of [...models, ...jobs]) if (!there.has(id)) this.forget(id);
    } catch {
      // The stream of events ends, too, and all is asked for again.
    }
  }

  // A page that is loaded again shows what was done last.
  private goOn(jobs: readonly Job[]): void {
    const last = jobs.filter(({ model }) => this.store.now.models.some(({ id }) => id === model)).at(-1);
    if (last) this.store.set({ chosen: last.model, shown: { kind: 'job', id: last.id }, options: last.options });
  }

  private hear({ name, data }: ServerEvent): void {
    if (name === 'job') {
      this.takeJob(JSON.parse(data) as Job);
    } else if (name === 'model') {
      this.takeModel(JSON.parse(data) as Model);
    } else if (name === 'removed') {
      this.forget((JSON.parse(data) as { readonly id: string }).id);
    }
  }

  private takeJob(job: Job): void {
    const { jobs } = this.store.now;
    const isNew = !jobs.some(({ id }) => id === job.id);
    this.store.set({ jobs: isNew ? [...jobs, job] : jobs.map((old) => (old.id === job.id ? job : old)) });
  }

  private takeModel(model: Model): void {
    const { models, chosen } = this.store.now;
    if (models.some(({ id }) => id === model.id)) return;
    this.store.set({ models: [...models, model], ...(chosen === null ? { chosen: model.id } : {}) });
  }

  // A model with all that was made of it, or a job.
  private forget(gone: string): void {
    const { models, jobs, chosen } = this.store.now;
    const left = models.filter(({ id }) => id !== gone);
    this.settle({
      models: left,
      jobs: jobs.filter(({ id, model }) => id !== gone && model !== gone),
      ...(gone === chosen ? { chosen: left.at(-1)?.id ?? null, shown: { kind: 'model' } } : {}),
    });
  }

  private change(id: number, change: Partial<Upload>): void {
    this.store.set({ uploads: this.store.now.uploads.map((upload) => (upload.id === id ? { ...upload, ...change } : upload)) });
  }

  private drop(id: number): void {
    this.store.set({ uploads: this.store.now.uploads.filter((upload) => upload.id !== id) });
  }

  // What cannot be taken anyway is not sent.
  private refusalBefore(file: File): Trouble | null {
    const limits = this.store.now.told?.limits;
    if (limits && file.size > limits.bodyBytes)
      return {
        what: `${file.name} has ${bytesIn(file.size)}, and the studio takes ${bytesIn(limits.bodyBytes)} at most`,
        hint: "'aerate hollow' reads files of any size that memory holds",
      };
    if (limits && !limits.formats.some((ending) => file.name.toLowerCase().endsWith(ending)))
      return { what: `${file.name} is not of a format that can be read`, hint: `these are ${limits.formats.join(', ')}` };
    return null;
  }

  send(files: Iterable<File>): void {
    for (const file of files) {
      const id = ++this.uploads;
      const trouble = this.refusalBefore(file);
      const upload: Upload = { id, name: file.name, bytes: file.size, share: null, trouble };
      this.store.set({ uploads: [...this.store.now.uploads, upload] });
      if (!trouble) this.queue.push({ id, file });
    }
    void this.sendNext();
  }

  // One after the other.
  private async sendNext(): Promise<void> {
    if (this.isSending) return;
    this.isSending = true;
    for (let next = this.queue.shift(); next; next = this.queue.shift()) {
      const { id, file } = next;
      const stop = new AbortController();
      this.stops.set(id, stop);
      try {
        this.change(id, { share: 0 });
        const model = await this.api.upload(file, (share) => this.change(id, { share }), stop.signal);
        this.takeModel(model);
        this.store.set({ chosen: model.id, shown: { kind: 'model' } });
        this.drop(id);
      } catch (error) {
        if (stop.signal.aborted) this.drop(id);
        else this.change(id, { share: null, trouble: troubleOf(error) });
      }
      this.stops.delete(id);
    }
    this.isSending = false;
  }

  // Stops sending, or takes what was said away.
  cancel(id: number): void {
    const at = this.queue.findIndex((one) => one.id === id);
    if (at >= 0) this.queue.splice(at, 1);
    const stop = this.stops.get(id);
    if (stop) stop.abort();
    else this.drop(id);
  }

  choose(model: string): void {
    this.store.set({ chosen: model, shown: { kind: 'model' } });
  }

  async hollow(options = this.store.now.options): Promise<void> {
    const model = modelChosen(this.store.now);
    if (!model) return;
    const job = await this.api.start(model.id, options);
    if (!this.store.now.jobs.some(({ id }) => id === job.id)) this.takeJob(job);
    this.store.set({ shown: { kind: 'job', id: job.id } });
  }

  async stop(id: string): Promise<void> {
    this.takeJob(await this.api.stop(id));
  }

  async removeJob(id: string): Promise<void> {
    await this.api.remove('jobs', id);
    this.forget(id);
  }

  // The program removes what was made of it, too.
  async removeModel(id: string): Promise<void> {
    await this.api.remove('models', id); // refused while a job needs it
    this.forget(id);
  }
}
