// The form of a job's options: the process, what is asked first, and groups of the rest that open.
import { make } from '../dom';
import { raised } from '../figures';
import { descriptionOf, entryOf, fieldOf, groupsOf, kMain, valueOf, withValue, type Field } from './fields';
import { onChange, type Page, type Store } from './store';
import type { OptionRow, Options, Process, Told } from './told';
import { sentence } from './words';

// Id of what says why a value is refused.
export const kRefused = 'refused';

interface Entry {
  readonly element: HTMLElement;
  readonly show: (options: Options, process: Process | undefined) => void;
}

type Set = (name: string, entry: string) => void;

export function processOf(told: Told, options: Options): Process | undefined {
  const standard = told.options.find(({ name }) => name === 'process')?.default ?? told.processes[0]?.name;
  const name = options.process ?? standard;
  return told.processes.find((process) => process.name === name);
}

export function showForm(into: HTMLElement, store: Store): void {
  const form = make('div', { class: 'fields', id: 'options' });
  into.append(form);
  let entries: readonly Entry[] = [];
  const show = ({ told, options }: Page): void => {
    if (told) for (const entry of entries) entry.show(options, processOf(told, options));
  };
  store.listen(
    onChange(
      (page) => page.told?.options.map(({ name }) => name).join() ?? '',
      (page) => {
        if (!page.told) return;
        const { told } = page;
        const set: Set = (name, entry) => {
          const row = told.options.find((one) => one.name === name);
          if (row) store.set({ options: withValue(store.now.options, name, valueOf(row, entry)) });
        };
        entries = makeEntries(form, told, set);
        show(page);
      },
    ),
  );
  store.listen(onChange((page) => page.options, show));
  store.listen(onChange((page) => page.refused, ({ refused }) => markRefused(form, refused)));
}

// Ties what is refused to its field, and brings that to light.
function markRefused(form: HTMLElement, option: string | null): void {
  for (const field of form.querySelectorAll<HTMLElement>('[data-option]')) {
    const isRefused = field.dataset.option === option;
    field.classList.toggle('refused', isRefused);
    for (const input of field.querySelectorAll('input, select, textarea')) {
      if (isRefused) input.setAttribute('aria-describedby', kRefused);
      else input.removeAttribute('aria-describedby');
      if (isRefused && input.getAttribute('type') !== 'radio') input.setAttribute('aria-invalid', 'true');
      else input.removeAttribute('aria-invalid');
    }
    if (isRefused) field.closest('details')?.setAttribute('open', '');
  }
}

function makeEntries(form: HTMLElement, told: Told, set: Set): readonly Entry[] {
  const process = processChoice(told, set);
  const row = (name: string): OptionRow | undefined => told.options.find((one) => one.name === name);
  const main = kMain.flatMap((name) => row(name) ?? []).map((one) => makeEntry(one, set, name(one)));
  const groups = groupsOf(told.options, undefined).map(({ title, fields }) => {
    const entries = fields.map((field) => makeEntry(field.row, set, false));
    const count = make('span', { class: 'count' });
    const element = make('details', { class: 'group' }, make('summary', {}, title, count), ...entries.map((entry) => entry.element));
    // A group says how much of it is given while it is closed.
    const show = (options: Options, of: Process | undefined): void => {
      for (const entry of entries) entry.show(options, of);
      const given = fields.filter((field) => field.row.name in options).length;
      count.textContent = given > 0 ? `${given} given` : '';
    };
    return { element, show };
  });
  const all = [process, ...main, ...groups];
  form.replaceChildren(...all.map(({ element }) => element));
  return all;
}

// What is asked first says its source without being asked.
const name = ({ name: one }: OptionRow): boolean => one === 'wall' || one === 'gap';

const kProcessNames: Readonly<Record<string, string>> = { fdm: 'Filament', sla: 'Resin', sls: 'Powder', metal: 'Metal' };

function processChoice(told: Told, set: Set): Entry {
  const standard = processOf(told, {})?.name;
  const inputs = told.processes.map((process) => {
    const input = make('input', { type: 'radio', name: 'process', value: process.name });
    input.addEventListener('change', () => set('process', process.name === standard ? '' : process.name));
    const title = kProcessNames[process.name] ?? process.name;
    return { name: process.name, input, label: make('label', {}, input, make('span', {}, title, make('small', {}, process.name))) };
  });
  const about = make('p', { class: 'note' });
  const table = make('tbody');
  const head = ['Figure', 'Value', 'Source'].map((title) => make('th', { scope: 'col' }, title));
  const figures = make(
    'details',
    { class: 'sources' },
    make('summary', {}, 'Figures of this process, and their sources'),
    make('table', {}, make('thead', {}, make('tr', {}, ...head)), table),
  );
  const element = make(
    'fieldset',
    { class: 'process', 'data-option': 'process' },
    make('legend', {}, 'Process'),
    make('div', { class: 'choice' }, ...inputs.map(({ label }) => label)),
    about,
    figures,
  );
  let last: Process | undefined;
  const show = (_: Options, process: Process | undefined): void => {
    for (const one of inputs) one.input.checked = one.name === process?.name;
    if (process === last) return;
    last = process;
    about.textContent = process ? sentence(`${process.title}; material ${process.material}`) : '';
    const rows = process?.rows ?? [];
    table.replaceChildren(
      ...rows.map(({ name: figure, value, unit, source }) =>
        make(
          'tr',
          {},
          make('th', { scope: 'row' }, figure),
          make('td', {}, value === null ? 'none' : raised(`${value} ${unit}`.trim())),
          make('td', {}, source ?? ''),
        ),
      ),
    );
  };
  return { element, show };
}

const kWords: Readonly<Record<string, Readonly<Record<string, string>>>> = {
  as: { voids: 'Voids', modifiers: 'Modifiers' },
  shape: { '': 'As fits', spheres: 'Spheres', cells: 'Cells' },
  drain: { '': 'Default', true: 'Yes', false: 'No' },
};

interface Control {
  readonly element: HTMLElement;
  readonly labelled: string | null; // id of what the label is for; none if it names itself
  readonly show: (entry: string, field: Field) => void;
}

function makeEntry(row: OptionRow, set: Set, tellsSource: boolean): Entry {
  const id = `option-${row.name}`;
  const field = fieldOf(row, undefined);
  const put = (entry: string): void => set(row.name, entry);
  const control = kWords[row.name] ? buttons(row, field, put) : row.kind === 'flag' && !row.off ? box(row, field, put) : input(row, put);
  const about = make('p', { class: 'note about', id: `${id}-about`, hidden: '' });
  const help = make('span');
  about.append(help, ' ', make('code', {}, `--${row.name}`));
  const ask = make('button', { type: 'button', class: 'ask', 'aria-expanded': 'false', 'aria-controls': about.id, 'aria-label': `About ${field.title}` }, '?');
  ask.addEventListener('click', () => {
    about.hidden = !about.hidden;
    ask.setAttribute('aria-expanded', String(!about.hidden));
  });
  const source = make('p', { class: 'note source', hidden: '' });
  const parts = control.labelled
    ? [make('div', { class: 'line' }, make('label', { for: control.labelled }, field.title), control.element, ask)]
    : [make('div', { class: 'line alone' }, control.element, ask)];
  const element = make('div', { class: 'field', 'data-option': row.name }, ...parts, source, about);
  const show = (options: Options, process: Process | undefined): void => {
    const now = fieldOf(row, process);
    control.show(entryOf(options[row.name]), now);
    element.classList.toggle('given', row.name in options);
    source.hidden = !tellsSource || now.source === '';
    help.textContent = sentence(descriptionOf(row, process));
    source.textContent = `${now.standard} ${now.unit}: ${now.source}`;
  };
  return { element, show };
}

// A few choices that all want to see.
function buttons(row: OptionRow, field: Field, put: (entry: string) => void): Control {
  const words = kWords[row.name];
  const standard = row.kind === 'choice' ? (row.default ?? '') : '';
  const values = row.kind === 'choice' ? [...(row.default === null ? [''] : []), ...(row.choices ?? [])] : ['', 'true', 'false'];
  const inputs = values.map((value) => {
    const element = make('input', { type: 'radio', name: `choice-${row.name}`, value });
    element.addEventListener('change', () => put(value === standard ? '' : value));
    const text = make('span', {}, words[value] ?? value);
    return { value, element, text, label: make('label', {}, element, text) };
  });
  const element = make('fieldset', {}, make('legend', {}, field.title), make('div', { class: 'choice' }, ...inputs.map(({ label }) => label)));
  const show = (entry: string, { standard: now }: Field): void => {
    for (const one of inputs) {
      one.element.checked = one.value === (entry || standard);
      if (one.value === '' && now) one.text.textContent = `${words['']} (${now})`;
    }
  };
  return { element, labelled: null, show };
}

function box(row: OptionRow, field: Field, put: (entry: string) => void): Control {
  const element = make('input', { type: 'checkbox', id: `option-${row.name}` });
  element.addEventListener('change', () => put(element.checked ? 'true' : ''));
  const show = (entry: string): void => {
    element.checked = entry === 'true';
  };
  return { element: make('label', { class: 'check' }, element, field.title), labelled: null, show };
}

function select(row: OptionRow, put: (entry: string) => void): Control {
  const id = `option-${row.name}`;
  const element = make('select', { id });
  const values = row.kind === 'choice' ? (row.choices ?? []) : ['true', 'false'];
  const first = make('option', { value: '' });
  const words: Readonly<Record<string, string>> = { true: 'yes', false: 'no' };
  element.append(first, ...values.map((value) => make('option', { value }, words[value] ?? value)));
  element.addEventListener('change', () => put(element.value));
  const show = (entry: string, { standard }: Field): void => {
    first.textContent = standard ? `${standard} (default)` : 'default';
    element.value = entry;
  };
  return { element, labelled: id, show };
}

// Of a number that can be given without one: whether it is on, and the number.
function bare(row: OptionRow, put: (entry: string) => void): Control {
  const id = `option-${row.name}`;
  const on = make('input', { type: 'checkbox', id: `${id}-on` });
  const number = make('input', { type: 'text', id, inputmode: 'decimal', autocomplete: 'off', 'aria-label': `${fieldOf(row, undefined).title}, ${row.unit}` });
  const tell = (): void => put(on.checked ? number.value.trim() || 'true' : '');
  on.addEventListener('change', tell);
  number.addEventListener('input', () => {
    on.checked = true;
    tell();
  });
  const show = (entry: string, { standard }: Field): void => {
    on.checked = entry !== '';
    if (document.activeElement !== number) number.value = entry === 'true' ? '' : entry;
    number.placeholder = standard || '0';
  };
  const element = make('span', { class: 'measure' }, on, number, make('span', { class: 'unit' }, row.unit));
  return { element, labelled: `${id}-on`, show };
}

function input(row: OptionRow, put: (entry: string) => void): Control {
  if (row.kind === 'choice' || row.kind === 'flag') return select(row, put);
  if (row.bare) return bare(row, put);
  const id = `option-${row.name}`;
  const element =
    row.kind === 'list'
      ? make('textarea', { id, rows: '2', placeholder: 'one on a line', autocomplete: 'off', spellcheck: 'false' })
      : make('input', { type: 'text', id, autocomplete: 'off', spellcheck: 'false' });
  if (row.kind === 'number') element.inputMode = 'decimal';
  element.addEventListener('input', () => put(element.value));
  const unit = make('span', { class: 'unit' });
  const show = (entry: string, { standard, unit: of }: Field): void => {
    if (document.activeElement !== element) element.value = entry;
    if (row.kind !== 'list') element.placeholder = standard || 'auto';
    unit.textContent = of;
  };
  return { element: make('span', { class: 'measure' }, element, unit), labelled: id, show };
}
