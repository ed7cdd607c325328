// The report: before and after, its figures, how large the voids are, what is marked.
import { format } from './colours';
import { make } from './dom';
import type { Frame } from './frame';
import { histogram } from './histogram';
import { nameOfVoids, type Change, type Mark, type Scene } from './scene';

// "cm3" as it is read.
export const raised = (text: string): string => text.replace(/\b([cm]m)3\b/g, '$1\u00b3').replace(/\b([cm]m)2\b/g, '$1\u00b2');

const digits = (value: number): number => (value >= 1000 ? 0 : value >= 10 ? 1 : 2);

function changeOf({ before, after }: Change): string {
  if (before === 0) return '';
  const percent = (100 * (after - before)) / before;
  return `${percent > 0 ? '+' : percent < 0 ? '\u2212' : ''}${format(Math.abs(percent), 1)} %`;
}

function beforeAndAfter(changes: readonly Change[]): HTMLElement {
  const head = ['', 'Before', 'After', 'Change'].map((name) => make('th', { scope: 'col' }, name));
  const rows = changes.map((change) => {
    const decimals = change.unit === '' ? 2 : digits(Math.max(Math.abs(change.before), Math.abs(change.after)));
    const shown = (value: number): string =>
      `${value.toLocaleString('en', { minimumFractionDigits: decimals, maximumFractionDigits: decimals })} ${raised(change.unit)}`.trim();
    return make(
      'tr',
      {},
      make('th', { scope: 'row' }, change.name),
      make('td', {}, shown(change.before)),
      make('td', {}, shown(change.after)),
      make('td', { class: 'change' }, changeOf(change)),
    );
  });
  return make('table', {}, make('thead', {}, make('tr', {}, ...head)), make('tbody', {}, ...rows));
}

function listOf(figures: Scene['figures']): HTMLElement {
  const list = make('dl');
  for (const [name, value] of figures) list.append(make('div', {}, make('dt', {}, name), make('dd', {}, raised(value))));
  return list;
}

function marksOf(marks: readonly Mark[], onMark: (mark: Mark) => void): HTMLElement {
  const kMost = 100;
  const list = make('ul', { class: 'marks' });
  for (const mark of marks.slice(0, kMost)) {
    const button = make('button', { type: 'button' }, raised(mark.text));
    button.addEventListener('click', () => onMark(mark));
    list.append(make('li', {}, button));
  }
  if (marks.length > kMost) list.append(make('li', {}, `and ${format(marks.length - kMost)} more, marked in the model alone`));
  return list;
}

export function showFigures(scene: Scene, { figures, level }: Frame, onMark: (mark: Mark) => void): void {
  const section = (title: string, ...content: readonly Node[]): void => {
    figures.append(make('section', {}, make(level === 1 ? 'h2' : 'h3', {}, title), ...content));
  };
  if (scene.changes.length > 0) section('Before and after', beforeAndAfter(scene.changes));
  if (scene.marks.length > 0) section('Marked in the model', marksOf(scene.marks, onMark));
  if (scene.voids.radius.length > 0) {
    const name = `Radii of the ${nameOfVoids(scene.use).many.toLowerCase()}`;
    section(name, histogram(scene.voids.radius, name));
  }
  if (scene.figures.length > 0) section('Figures', listOf(scene.figures));
}
