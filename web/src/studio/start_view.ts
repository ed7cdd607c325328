// The estimate, the command line that does the same, and the button.
import { make } from '../dom';
import { raised } from '../figures';
import { advised, optionOf, titled } from './advice';
import { troubleOf, type Api } from './api';
import { titleOf } from './fields';
import { attempt, copyButton, trouble } from './pieces';
import { kRefused } from './form_view';
import type { Session } from './session';
import { modelChosen, type Page } from './store';
import type { Estimate, Trouble } from './told';

// Those that were asked for while others were waited for do not matter any more.
class Estimates {
  private asked: AbortController | null = null;
  private timer = 0;

  constructor(
    private readonly api: Api,
    private readonly onAnswer: (estimate: Estimate | null, refused: Trouble | null) => void,
  ) {}

  // After a moment in which nothing else is asked.
  want({ options, connection, ...page }: Page): void {
    const kMoment = 200; // ms
    window.clearTimeout(this.timer);
    this.asked?.abort();
    const model = page.models.find(({ id }) => id === page.chosen);
    if (!model || connection !== 'open') return this.onAnswer(null, null);
    this.timer = window.setTimeout(async () => {
      const asked = new AbortController();
      this.asked = asked;
      try {
        const estimate = await this.api.estimate(model.id, options, asked.signal);
        if (!asked.signal.aborted) this.onAnswer(estimate, null);
      } catch (error) {
        if (!asked.signal.aborted) this.onAnswer(null, troubleOf(error));
      }
    }, kMoment);
  }
}

// How much of the window the bar hides, so that what has the focus is scrolled clear of it. One that would hide half of the
// window does not stay.
function keepClearOf(bar: HTMLElement, form: HTMLElement): void {
  const clear = (): void => {
    const focused = document.activeElement;
    if (!focused || bar.contains(focused) || !form.contains(focused)) return;
    // What a pointer has pressed must not move away from it.
    if (focused.matches(':focus-visible')) focused.scrollIntoView({ block: 'nearest' });
  };
  const tell = (): void => {
    const height = Math.ceil(bar.getBoundingClientRect().height);
    const stays = height <= window.innerHeight / 2;
    bar.classList.toggle('stays', stays);
    document.documentElement.style.setProperty('--hidden-below', `${stays ? height : 0}px`);
    clear(); // what it says may grow over the field that it is about
  };
  new ResizeObserver(tell).observe(bar);
  window.addEventListener('resize', tell);
  form.addEventListener('focusin', clear); // browsers scroll to the first line of a field of several
}

export function showStart(into: HTMLElement, form: HTMLFormElement, session: Session): void {
  const { store, api } = session;
  const rows = make('dl', { id: 'estimate', 'aria-live': 'polite' });
  const command = make('code', { id: 'command', tabindex: '0', 'aria-label': 'Command line' });
  const line = make('details', { class: 'command' }, make('summary', {}, 'The same on the command line'), command, copyButton('Copy', () => command.textContent ?? ''));
  const words = make('div', { id: kRefused });
  const go = make('button', { type: 'submit', id: 'go', class: 'go' }, 'Hollow it');
  const press = make('div', { class: 'press' }, go);
  into.append(rows, words, line, press);
  keepClearOf(into, form);

  const inFields = (refused: Trouble): Trouble => {
    const option = optionOf(refused);
    const isField = store.now.told?.options.some(({ name }) => name === option) ?? false;
    return option && isField ? titled(refused, titleOf(option)) : advised(refused, modelChosen(store.now));
  };
  const estimates = new Estimates(api, (estimate, refused) => {
    into.removeAttribute('aria-busy');
    rows.replaceChildren(
      ...(estimate?.rows ?? []).map(({ label, value }) => make('div', {}, make('dt', {}, label), make('dd', {}, raised(value)))),
    );
    command.textContent = estimate?.command ?? '';
    line.hidden = !estimate;
    const model = modelChosen(store.now);
    words.replaceChildren(...(refused ? [trouble(inFields(refused))] : []));
    store.set({ refused: refused && optionOf(refused) });
    if (!model) words.replaceChildren(make('p', { class: 'note' }, 'Add a model, and what can be saved is estimated here.'));
    // Other refusals are not the job's own.
    go.disabled = !model || store.now.connection !== 'open' || refused?.exit !== undefined;
  });
  let last: readonly unknown[] = [];
  store.listen((page) => {
    const now = [page.chosen, page.options, page.connection, modelChosen(page)];
    if (now.every((one, i) => one === last[i])) return;
    last = now;
    go.disabled = page.connection !== 'open' || !modelChosen(page);
    into.setAttribute('aria-busy', 'true');
    estimates.want(page);
  });
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    if (go.disabled) return;
    go.disabled = true;
    const hollow = async (): Promise<void> => {
      await session.hollow();
      // On a narrow window it is further down.
      document.getElementById('show')?.scrollIntoView({ block: 'start' });
    };
    void attempt(hollow, go).finally(() => (go.disabled = false));
  });
}
