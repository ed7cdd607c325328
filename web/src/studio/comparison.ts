// Voids, modifiers and the solid by their figures: one column each.
import { format } from '../colours';
import type { Job, Model, Report } from './told';
import { bytesIn, secondsIn } from './words';

export interface Column {
  readonly id: string; // of the job; 'solid' for the model as it is
  readonly title: string;
}

export interface Row {
  readonly name: string;
  readonly cells: readonly string[];
  readonly best: number | null; // the least, where that is what one wants
}

export interface Comparison {
  readonly columns: readonly Column[];
  readonly rows: readonly Row[];
}

export interface Done {
  readonly job: Job;
  readonly report: Report;
}

export function nameOfJob({ id, options }: Job): string {
  const process = typeof options.process === 'string' ? `, ${options.process}` : '';
  return `${options.as === 'modifiers' ? 'Modifiers' : 'Voids'} ${id.replace(/\D/g, '')}${process}`;
}

// A prediction for sparse infill, where there is one.
export function filamentOf({ print }: Report): { readonly infill: number; readonly before: number; readonly after: number } | null {
  const told = print?.verdict ?? print;
  return told ? { infill: told.infill_percent, before: told.filament_before_mm3, after: told.filament_after_mm3 } : null;
}

const cubic = (mm3: number): string => `${format(mm3 / 1000, mm3 < 1e5 ? 2 : 1)} cm³`;

function bestOf(values: readonly (number | null)[]): number | null {
  let best: number | null = null;
  values.forEach((value, i) => {
    if (value !== null && (best === null || value < (values[best] ?? Infinity))) best = i;
  });
  const known = values.filter((value) => value !== null);
  return known.length > 1 && known.some((value) => value !== known[0]) ? best : null;
}

function changeOf(value: number, first: number): string {
  const percent = Math.round((1000 * (value - first)) / first) / 10;
  return percent === 0 ? '' : ` (${percent > 0 ? '+' : '−'}${format(Math.abs(percent), 1)} %)`;
}

// Numbers with what they are beside the first of them.
function measured(name: string, values: readonly (number | null)[], shown: (value: number) => string): Row {
  const first = values[0];
  const cells = values.map((value, i) => {
    if (value === null) return '–';
    return shown(value) + (i > 0 && first ? changeOf(value, first) : '');
  });
  return { name, cells, best: bestOf(values) };
}

function told(name: string, first: string, done: readonly Done[], tell: (one: Done) => string | null): Row {
  return { name, cells: [first, ...done.map((one) => tell(one) ?? '–')], best: null };
}

// Of one infill each, since others cannot be compared.
function filamentRows(done: readonly Done[]): readonly Row[] {
  const infills = [...new Set(done.map(({ report }) => filamentOf(report)?.infill).filter((one) => one !== undefined))];
  return infills.map((infill) => {
    const of = done.map(({ report }) => filamentOf(report)).map((one) => (one?.infill === infill ? one : null));
    const before = of.find((one) => one !== null)?.before ?? null;
    return measured(`Filament at ${format(infill)} % infill`, [before, ...of.map((one) => one?.after ?? null)], cubic);
  });
}

export function compare(model: Model, done: readonly Done[]): Comparison {
  const { input } = model.report;
  const material = done.map(({ report }) => report.material);
  const first = material.find((one) => one !== null);
  const same = first ? material.map((one) => (one?.name === first.name ? one : null)) : [];
  const rows: Row[] = [
    measured('Solid material', [input.filled_volume_mm3, ...done.map(({ report }) => report.volume.after_mm3)], cubic),
    ...(first
      ? [
          measured(`Mass, ${first.name}, printed solid`, [first.mass_before_g, ...same.map((one) => one?.mass_after_g ?? null)], (g) => `${format(g, 1)} g`),
          measured('Cost, printed solid', [first.cost_before, ...same.map((one) => one?.cost_after ?? null)], (cost) => cost.toFixed(2)),
        ]
      : []),
    ...filamentRows(done),
    told('Of other infill', '–', done, ({ report: { modifiers } }) =>
      modifiers ? `${format(modifiers.volume_percent, 1)} % at ${format(modifiers.infill_percent)} %` : null,
    ),
    told('Stiffness, about', '100 %', done, ({ report: { strength_and_balance: strength } }) =>
      strength ? `${format(100 * strength.relative_stiffness_upper_bound, 0)} %` : null,
    ),
    told('Voids', '–', done, ({ report: { voids } }) =>
      `${format(voids.count)} ${voids.shape}, r ${format(voids.min_radius_mm, 1)} to ${format(voids.max_radius_mm, 1)} mm`,
    ),
    told('Thinnest wall', '–', done, ({ report }) => (report.measured.wall_mm === null ? null : `${format(report.measured.wall_mm)} mm`)),
    told('Triangles', format(input.triangles), done, ({ report }) => format(report.output.triangles)),
    told('File', bytesIn(model.bytes), done, ({ job }) => job.files?.map((file) => `${file.form.toUpperCase()} ${bytesIn(file.bytes)}`).join(', ') ?? null),
    told('Made in', '–', done, ({ job, report }) => secondsIn(job.seconds ?? report.seconds)),
  ];
  return {
    columns: [{ id: 'solid', title: 'Solid' }, ...done.map(({ job }) => ({ id: job.id, title: nameOfJob(job) }))],
    rows: rows.filter(({ cells }) => cells.some((cell) => cell !== '–')),
  };
}
