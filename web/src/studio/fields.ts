// From the rows of options that the program tells, to the fields of a form, and from what is put into these to a job's options.
import type { OptionRow, Options, Process, Value } from './told';

export interface Field {
  readonly row: OptionRow;
  readonly title: string;
  readonly unit: string;
  readonly standard: string; // what holds where nothing is given; '' if the program decides by the model
  readonly source: string; // of that
}

export interface Group {
  readonly title: string;
  readonly fields: readonly Field[];
}

const kTitles: Readonly<Record<string, string>> = {
  as: 'What is made',
  shape: 'Shape of voids',
  wall: 'Wall',
  gap: 'Gap',
  drain: 'Drain voids',
  infill: 'Infill of the print',
  'min-radius': 'Smallest radius',
  'max-radius': 'Largest radius',
  up: 'Up in print',
  stand: 'Keep it standing',
  'max-voids': 'Most voids',
  'max-hole': 'Largest hole to close',
  'max-triangles': 'Most triangles',
  'keep-solid': 'Keep solid',
  'target-mass': 'Stop at mass',
  'target-saving': 'Stop at saving',
  'target-density': 'Stop at density',
  'escape-hole': 'Escape holes at',
  'holes-on': 'Holes come out on',
  'holes-not-on': 'Holes never on',
  'drain-cavities': 'Open its own cavities too',
  'channel-diameter': 'Channel diameter',
  'hole-diameter': 'Hole diameter',
  'cell-size': 'Size of cells',
  fillet: 'Rounding of cells',
  unit: 'Unit of the file',
  overhang: 'Overhang',
  bridge: 'Bridge',
  build: 'The part is printed',
  force: 'Make it even if heavier',
};

// Where nothing holds unless it is given, and nothing is chosen by the model either.
const kUnlimited: readonly string[] = ['target-mass', 'target-saving', 'target-density', 'max-voids', 'max-triangles'];

// What is asked first; the rest waits in groups.
export const kMain: readonly string[] = ['as', 'shape', 'wall', 'gap', 'drain', 'infill'];

export function titleOf(name: string): string {
  const words = name.replaceAll('-', ' ');
  return kTitles[name] ?? words[0].toUpperCase() + words.slice(1);
}

export function fieldOf(row: OptionRow, process: Process | undefined): Field {
  const limit = process?.rows.find(({ option }) => option === row.name);
  const field = { row, title: titleOf(row.name), unit: row.unit || limit?.unit || '' };
  if (row.name === 'drain' && process) return { ...field, standard: process.drains ? 'yes' : 'no', source: '' };
  if (row.name === 'material' && process) return { ...field, standard: process.material, source: '' };
  if (!limit) return { ...field, standard: row.default ?? (kUnlimited.includes(row.name) ? 'none' : ''), source: '' };
  return { ...field, standard: String(limit.value ?? (row.name === 'cell-size' ? '' : 'none')), source: limit.source ?? '' };
}

// What the command line alone can do, or says in another way here.
const kElsewhere: readonly (readonly [RegExp, string])[] = [
  [/, --spheres or (?=--)/, ' or '],
  [/a mesh file, a modifier's name in a 3MF project, /, ''],
  [/; may be repeated/, '; one on a line'],
  [/ \(write --up=-z\)/, ''],
];

// The help of the command line, for the process that is chosen.
export function descriptionOf(row: OptionRow, process: Process | undefined): string {
  const text = kElsewhere.reduce((words, [old, here]) => words.replace(old, here), row.description);
  if (!process) return text;
  const { standard, unit } = fieldOf(row, process);
  const isKnown = process.rows.some(({ option, value }) => option === row.name && value !== null) || row.name === 'material' || row.name === 'drain';
  const value = isKnown ? `default ${[standard, unit].filter(Boolean).join(' ')}, of ${process.name}` : `no default of ${process.name}`;
  const told = isKnown ? text.replace(/, \d+ where it has none/, '') : text.replace(/default of the process, (\d+) where it has none/, 'default $1');
  return told.replace(/default of the process((, here of|;|:) (none for )?(fdm|sla|sls|metal)\b[^;)]*)?/, value).replace(/; \d+ for sla and sls/, '');
}

export const isAsked = ({ name }: OptionRow): boolean => name !== 'process';

// All but what is asked first, as the program sorts them.
export function groupsOf(rows: readonly OptionRow[], process: Process | undefined): readonly Group[] {
  const groups = new Map<string, Field[]>();
  for (const row of rows) {
    if (!isAsked(row) || kMain.includes(row.name)) continue;
    const fields = groups.get(row.group) ?? [];
    fields.push(fieldOf(row, process));
    groups.set(row.group, fields);
  }
  return [...groups].map(([title, fields]) => ({ title, fields }));
}

// "1,5" as it is written in many countries; "1,2,3" is left as it is.
function plain(row: OptionRow, text: string): string {
  return row.kind === 'number' && /^[+-]?\d+,\d+$/.test(text) ? text.replace(',', '.') : text;
}

// What an entry says; null where it says nothing.
export function valueOf(row: OptionRow, entry: string): Value | null {
  if (row.kind === 'flag') return entry === 'true' ? true : entry === 'false' && row.off ? false : null;
  if (row.kind === 'list') {
    const lines = entry.split('\n').map((line) => line.trim());
    const given = lines.filter(Boolean);
    return given.length > 0 ? given : null;
  }
  const text = plain(row, entry.trim());
  if (row.bare && text === 'true') return true;
  return text === '' ? null : text;
}

export function entryOf(value: Value | undefined): string {
  if (value === undefined) return '';
  return typeof value === 'object' ? value.join('\n') : String(value);
}

export function withValue(options: Options, name: string, value: Value | null): Options {
  const { [name]: _, ...others } = options;
  return value === null ? others : { ...others, [name]: value };
}
