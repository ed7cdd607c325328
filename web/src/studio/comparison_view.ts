// The solid, voids and modifiers: their figures in one table, two of them beside each other, seen from the same place and cut
// at the same place.
import { make } from '../dom';
import type { Vec3 } from '../scene';
import type { Viewer } from '../viewer';
import { compare, kSolid, type Comparison, type Done } from './comparison';
import { attempt, button, trouble } from './pieces';
import { troubleOf } from './api';
import { isEnded, type Session } from './session';
import { Slot, type Scenes } from './slot';
import { jobsOf, modelChosen, type Page } from './store';
import { withValue } from './fields';
import type { Job, Model, Report } from './told';

function tableOf({ columns, rows }: Comparison): HTMLElement {
  const head = [make('td'), ...columns.map(({ title }) => make('th', { scope: 'col' }, title))];
  const body = rows.map(({ name, cells, best }) =>
    make('tr', {}, make('th', { scope: 'row' }, name), ...cells.map((cell, i) => make('td', best.includes(i) ? { class: 'best' } : {}, cell))),
  );
  const caption = make('caption', {}, 'The least of a row is bold; changes are from the solid of the same size');
  return make('table', { class: 'comparison' }, caption, make('thead', {}, make('tr', {}, ...head)), make('tbody', {}, ...body));
}

// Moves and cuts one as the other is.
function link(slots: readonly [Slot, Slot]): void {
  const [left, right] = slots.map((slot) => slot.viewer);
  if (!left || !right) return;
  const follow = (leader: Viewer, other: Viewer): void => {
    leader.onMoved = () => {
      const { cut, cutAlone, outer } = leader.state();
      other.set({ cut: shareIn(leader, other, cut), cutAlone, outer });
      other.lookAs(viewIn(leader, other));
    };
  };
  follow(left, right);
  follow(right, left);
  // The solid has no cut of its own.
  (left.state().cut.axis ? left : right).onMoved?.();
}

const longest = ({ size }: Viewer): number => Math.max(...size);

// How much larger one is than the other, where that is more than what hollowing may do to a box.
function growth(leader: Viewer, other: Viewer): number | null {
  const isOther = other.size.some((side, k) => Math.abs(side / leader.size[k] - 1) > 0.01);
  return isOther ? longest(other) / longest(leader) : null;
}

// The same place in mm: their boxes may differ a little. Where one was scaled, the same share.
function shareIn(leader: Viewer, other: Viewer, cut: ReturnType<Viewer['state']>['cut']): typeof cut {
  const k = cut.axis ? 'xyz'.indexOf(cut.axis) : -1;
  if (k < 0 || growth(leader, other) !== null) return cut;
  const place = leader.centre[k] + (cut.share - 0.5) * leader.size[k];
  return { ...cut, share: Math.min(Math.max((place - other.centre[k]) / other.size[k] + 0.5, 0), 1) };
}

// From the same place, or as large in the picture where one was scaled.
function viewIn(leader: Viewer, other: Viewer): ReturnType<Viewer['view']> {
  const view = leader.view();
  const by = growth(leader, other);
  if (by === null) return view;
  const place = (at: Vec3): Vec3 => [0, 1, 2].map((k) => other.centre[k] + by * (at[k] - leader.centre[k])) as unknown as Vec3;
  return { from: place(view.from), at: place(view.at) };
}

export class ComparisonView {
  readonly element = make('div', { class: 'comparing' });
  private readonly slots: readonly [Slot, Slot];
  private readonly choosers: readonly [HTMLSelectElement, HTMLSelectElement];
  private readonly table = make('div', { class: 'scrolled', tabindex: '0', role: 'region', 'aria-label': 'Figures compared' });
  private readonly missing = make('div', { class: 'missing' });
  private readonly reports = new Map<string, Report>();
  private last = '';

  constructor(
    private readonly session: Session,
    scenes: Scenes,
  ) {
    this.slots = [new Slot(scenes, 'left-'), new Slot(scenes, 'right-')];
    this.choosers = [make('select', { 'aria-label': 'Left' }), make('select', { 'aria-label': 'Right' })];
    const sides = this.slots.map((slot, i) => {
      this.choosers[i].addEventListener('change', ({ currentTarget }) => {
        const { dataset } = currentTarget as HTMLSelectElement;
        dataset.chosen = dataset.model ?? '';
        this.showSide(i);
      });
      slot.onViewer = () => link(this.slots);
      return make('div', { class: 'side' }, this.choosers[i], slot.element);
    });
    this.element.append(this.missing, make('div', { class: 'sides' }, ...sides), this.table);
  }

  show(page: Page): void {
    const model = modelChosen(page);
    if (!model) return;
    const jobs = jobsOf(page).filter(({ state }) => state === 'done');
    const now = [model.id, ...jobsOf(page).map(({ id, state }) => id + state)].join();
    if (now === this.last) return;
    this.last = now;
    this.offerMissing(page, jobs);
    void this.fill(model, jobs, now);
  }

  hide(): void {
    this.last = '';
    for (const slot of this.slots) slot.clear();
  }

  private async fill(model: Model, jobs: readonly Job[], now: string): Promise<void> {
    try {
      const done: Done[] = [];
      for (const job of jobs) {
        const report = this.reports.get(job.id) ?? (await this.session.api.report<Report>(job.id));
        this.reports.set(job.id, report);
        done.push({ job, report });
      }
      if (now !== this.last) return;
      const comparison = compare(model, done);
      this.table.replaceChildren(tableOf(comparison));
      this.fillChoosers(model, comparison);
    } catch (error) {
      if (now === this.last) this.table.replaceChildren(trouble(troubleOf(error)));
    }
  }

  private fillChoosers(model: Model, { sides }: Comparison): void {
    const last = sides.length - 1;
    // The two that were made last, or the solid and what was made, until others are chosen.
    const first = [Math.max(last - 1, 0), last];
    this.choosers.forEach((chooser, i) => {
      const old = chooser.value;
      const isKept = chooser.dataset.chosen === model.id && sides.some(({ id }) => id === old);
      chooser.replaceChildren(...sides.map(({ id, title }) => make('option', { value: id }, title)));
      chooser.value = isKept ? old : sides[first[i]].id;
      chooser.dataset.model = model.id;
      this.showSide(i);
    });
  }

  private showSide(i: number): void {
    const chooser = this.choosers[i];
    const id = chooser.value;
    this.slots[i].show(id === kSolid ? `models/${chooser.dataset.model}/scene` : `jobs/${id}/scene`);
  }

  // One press makes the other form, with the same options.
  private offerMissing(page: Page, jobs: readonly Job[]): void {
    const last = jobs.at(-1);
    const isModifiers = ({ options }: Job): boolean => options.as === 'modifiers';
    const wanted = [
      { has: jobs.some((job) => !isModifiers(job)), as: null, text: 'Make voids, to compare' },
      { has: jobs.some(isModifiers), as: 'modifiers', text: 'Make modifiers, to compare' },
    ];
    const isMaking = jobsOf(page).some((job) => !isEnded(job));
    const offers = wanted.filter(({ has }) => !has).map(({ as, text }) => {
      const options = withValue(last?.options ?? page.options, 'as', as);
      const offer: HTMLButtonElement = button(text, () => this.make(options, offer));
      offer.disabled = isMaking;
      return offer;
    });
    this.missing.replaceChildren(...offers, ...(isMaking ? [make('p', { class: 'note', role: 'status' }, 'One is being made …')] : []));
  }

  private async make(options: Page['options'], offer: HTMLElement): Promise<void> {
    await attempt(async () => {
      await this.session.hollow(options);
      this.session.store.set({ shown: { kind: 'comparison' } });
    }, offer);
  }
}
