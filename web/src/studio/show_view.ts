// What is looked at, and tabs to choose it by.
import { make } from '../dom';
import { nameOfJob } from './comparison';
import { ComparisonView } from './comparison_view';
import { JobView } from './job_view';
import { isEnded, type Session } from './session';
import { Scenes, Slot } from './slot';
import { jobShown, jobsOf, modelChosen, shownIn, type Page, type Shown } from './store';
import type { Job } from './told';

interface Tab {
  readonly key: string;
  readonly title: string;
  readonly about: string;
  readonly shown: Shown;
}

const kAbout: Readonly<Record<Job['state'], string>> = { waiting: 'waits', running: 'running', done: '', failed: 'failed', stopped: 'stopped' };

export const keyOf = (shown: Shown): string => (shown.kind === 'job' ? `job-${shown.id}` : shown.kind);

function tabsOf(page: Page): readonly Tab[] {
  if (!modelChosen(page)) return [];
  const jobs = jobsOf(page);
  const tabs: { title: string; about: string; shown: Shown }[] = [{ title: 'Model', about: '', shown: { kind: 'model' } }];
  for (const job of jobs) tabs.push({ title: nameOfJob(job), about: kAbout[job.state], shown: { kind: 'job', id: job.id } });
  if (jobs.some(({ state }) => state === 'done')) tabs.push({ title: 'Compare', about: '', shown: { kind: 'comparison' } });
  return tabs.map((tab) => ({ ...tab, key: keyOf(tab.shown) }));
}

function welcome(): HTMLElement {
  return make(
    'div',
    { class: 'welcome' },
    make('h2', {}, 'Use less material'),
    make(
      'ol',
      {},
      make('li', {}, 'Drop a model: STL, 3MF, OBJ, PLY and more.'),
      make('li', {}, 'Choose what prints it. Walls and gaps follow from that.'),
      make('li', {}, 'Press ', make('em', {}, 'Hollow it'), ', look inside, and take the file to your slicer.'),
    ),
    make('p', { class: 'note' }, 'All of it happens on this computer. Nothing is kept when the program ends.'),
  );
}

export function showTabs(bar: HTMLElement, view: HTMLElement, session: Session): void {
  const { store } = session;
  let last = '';
  const go = (tabs: readonly Tab[], at: number): void => {
    const tab = tabs[(at + tabs.length) % tabs.length];
    store.set({ shown: tab.shown });
    queueMicrotask(() => document.getElementById(`tab-${tab.key}`)?.focus());
  };
  store.listen((page) => {
    const tabs = tabsOf(page);
    const chosen = keyOf(shownIn(page));
    const now = JSON.stringify([tabs, chosen]);
    if (now === last) return;
    last = now;
    const hadFocus = bar.contains(document.activeElement);
    bar.replaceChildren(
      ...tabs.map(({ key, title, about, shown }, i) => {
        const isChosen = key === chosen;
        const tab = make('button', { type: 'button', role: 'tab', id: `tab-${key}`, 'aria-selected': String(isChosen), 'aria-controls': view.id, tabindex: isChosen ? '0' : '-1' }, title);
        if (about) tab.append(make('span', { class: 'about' }, about));
        tab.addEventListener('click', () => store.set({ shown }));
        tab.addEventListener('keydown', ({ key: pressed }) => {
          if (pressed === 'ArrowRight') go(tabs, i + 1);
          else if (pressed === 'ArrowLeft') go(tabs, i - 1);
        });
        return tab;
      }),
    );
    bar.hidden = tabs.length < 2;
    view.setAttribute('aria-labelledby', `tab-${chosen}`);
    if (hadFocus) document.getElementById(`tab-${chosen}`)?.focus();
  });
}

export function showView(view: HTMLElement, session: Session): void {
  const scenes = new Scenes(session.api);
  const slot = new Slot(scenes, 'shown-');
  const jobView = new JobView(session, slot);
  const comparison = new ComparisonView(session, scenes);
  const put = (element: HTMLElement): void => {
    if (view.firstElementChild !== element || view.childElementCount > 1) view.replaceChildren(element);
  };
  let first: HTMLElement | null = null;
  session.store.listen((page) => {
    const model = modelChosen(page);
    const job = jobShown(page);
    const isCompared = shownIn(page).kind === 'comparison' && model !== null;
    if (!isCompared) comparison.hide();
    if (!job) jobView.hide();
    if (isCompared) {
      slot.clear();
      put(comparison.element);
      comparison.show(page);
    } else if (job) {
      put(jobView.element);
      jobView.show(job, page.connection !== 'lost');
    } else if (model) {
      put(slot.element);
      slot.show(`models/${model.id}/scene`);
    } else if (page.told) {
      slot.clear();
      put((first ??= welcome()));
    }
    view.classList.toggle('waits', job !== null && !isEnded(job));
  });
}
