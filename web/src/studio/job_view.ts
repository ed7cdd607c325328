// A job: how far it is, or what came of it.
import { make } from '../dom';
import { raised } from '../figures';
import { advised } from './advice';
import { button, copyButton, download, trouble } from './pieces';
import { isEnded, type Session } from './session';
import type { Slot } from './slot';
import type { Job } from './told';
import { bytesIn, secondsIn, sentence, stageIn } from './words';

interface Part {
  readonly element: HTMLElement;
  readonly show: (job: Job, isHeard: boolean) => void;
}

// While it waits or runs. Stages that were heard of stay in the list.
function progress(session: Session, id: string): Part {
  const title = make('h2');
  const bar = make('progress', { max: '1', 'aria-label': 'Progress of this stage' });
  const stages = make('ol', { class: 'stages' });
  const said = make('p', { class: 'note', role: 'status' });
  const stop = button('Stop', () => session.stop(id));
  const element = make('div', { class: 'progress' }, title, bar, said, stages, stop);
  const seen: string[] = [];
  const show = (job: Job, isHeard: boolean): void => {
    const before = job.waitingBefore ?? 0;
    const isRunning = job.state === 'running';
    title.textContent = isRunning ? 'Hollowing …' : 'Waiting';
    const stage = job.stage ?? '';
    if (isRunning && stage && seen.at(-1) !== stage) {
      seen.push(stage);
      stages.append(make('li', {}, stageIn(stage)));
    }
    const share = job.progress ?? null;
    if (share === null) bar.removeAttribute('value');
    else bar.value = share;
    // Nobody knows how far it is while the program is not heard, and nobody can stop it.
    bar.hidden = !isHeard;
    stop.hidden = !isHeard;
    const known = isRunning ? (stage ? stageIn(stage) : 'Beginning') : before > 0 ? `${before} before this one` : 'It is next';
    const told = isHeard ? known : 'The program does not answer: how far this is is not known';
    if (said.textContent !== told) said.textContent = told;
    stages.hidden = !isRunning;
  };
  return { element, show };
}

function notices(job: Job): HTMLElement[] {
  const told = [...new Set(job.notices ?? [])];
  if (told.length === 0) return [];
  return [make('ul', { class: 'notices', 'aria-label': 'Notices' }, ...told.map((notice) => make('li', {}, raised(sentence(notice)))))];
}

function downloads(session: Session, job: Job): HTMLElement {
  const stem = job.files?.[0]?.name.replace(/\.[^.]*$/, '') ?? 'result';
  const get = (path: string, name: string) => () => download(session.api.bytes(`jobs/${job.id}/${path}`), name);
  const files = (job.files ?? []).map(({ form, name, bytes }) => {
    const element = button('', get(`file/${form}`, name), `Download ${name}, ${bytesIn(bytes)}`);
    element.append(`${form.toUpperCase()} `, make('span', { class: 'bytes' }, bytesIn(bytes)));
    element.classList.add('file');
    element.dataset.form = form;
    return element;
  });
  return make(
    'div',
    { class: 'downloads', role: 'group', 'aria-label': 'Download' },
    ...files,
    button('Report', get('report.txt', `${stem}.txt`), 'Download the report as text'),
    button('Report, JSON', get('report', `${stem}.json`), 'Download the report as JSON'),
    copyButton('Copy command', () => job.command),
  );
}

function ended(session: Session, job: Job): HTMLElement {
  const again = button('Use its options', () => session.store.set({ options: job.options }));
  const remove = button('Remove', () => session.removeJob(job.id));
  if (job.state === 'done') {
    const took = job.seconds === undefined ? 'Done' : `Done in ${secondsIn(job.seconds)}`;
    const head = make('div', { class: 'head' }, make('p', { class: 'done' }, took), downloads(session, job), make('div', { class: 'aside' }, again, remove));
    return make('div', { class: 'ended' }, head, ...notices(job));
  }
  const words = job.state === 'stopped' ? make('p', {}, 'Stopped. Nothing was written.') : trouble(advised(job.error ?? { what: 'the job failed' }));
  return make('div', { class: 'ended nothing' }, make('h2', {}, job.state === 'stopped' ? 'Stopped' : 'Nothing was made'), words, ...notices(job), make('div', { class: 'aside' }, again, remove));
}

export class JobView {
  readonly element = make('div', { class: 'job' });
  private last: Job | null = null;
  private wasHeard = true;
  private running: Part | null = null;

  constructor(
    private readonly session: Session,
    private readonly slot: Slot,
  ) {}

  show(job: Job, isHeard: boolean): void {
    if (job === this.last && isHeard === this.wasHeard) return;
    this.wasHeard = isHeard;
    const isOther = job.id !== this.last?.id;
    const wasEnded = !isOther && this.last !== null && isEnded(this.last);
    this.last = job;
    this.element.dataset.state = job.state;
    this.element.dataset.seconds = String(job.seconds ?? '');
    if (isEnded(job)) {
      if (wasEnded) return;
      this.running = null;
      this.element.replaceChildren(ended(this.session, job));
      if (job.state !== 'done') return this.slot.clear();
      this.element.append(this.slot.element);
      this.slot.show(`jobs/${job.id}/scene`);
    } else {
      if (isOther || !this.running) {
        this.slot.clear();
        this.running = progress(this.session, job.id);
        this.element.replaceChildren(this.running.element);
      }
      this.running.show(job, isHeard);
    }
  }

  hide(): void {
    this.last = null;
    this.running = null;
  }
}
