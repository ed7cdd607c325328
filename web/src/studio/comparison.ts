// Voids, modifiers and the solid by their figures: one column each.
import { format } from '../colours';
import type { Input, Job, Model, Report } from './told';
import { bytesIn, secondsIn } from './words';

export interface Column {
  readonly id: string; // of the job; kSolid for the model as it is
  readonly title: string;
}

export interface Row {
  readonly name: string;
  readonly cells: readonly string[];
  readonly best: readonly number[]; // which are the least of their size, where that is what one wants
}

export interface Comparison {
  readonly columns: readonly Column[];
  readonly rows: readonly Row[];
  readonly sides: readonly Column[]; // what there is to see
}

export const kSolid = 'solid';

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

type Box = Input['box'];

// Jobs of models that are equally large: others cannot be compared by their figures.
interface Size {
  readonly box: Box;
  readonly done: readonly Done[];
}

const sidesOf = ({ lower_mm: lower, upper_mm: upper }: Box): readonly number[] => upper.map((high, k) => high - lower[k]);

const isAsLarge = (a: Box, b: Box): boolean => sidesOf(a).every((side, k) => Math.abs(side - sidesOf(b)[k]) <= 1e-5 * side);

export const inWords = (box: Box): string => `${sidesOf(box).map((side) => format(side, 1)).join(' × ')} mm`;

function sizesOf(model: Model, done: readonly Done[]): readonly Size[] {
  const sizes: { readonly box: Box; readonly done: Done[] }[] = [];
  for (const one of done) {
    const { box } = one.report.input;
    const same = sizes.find((size) => isAsLarge(size.box, box));
    if (same) same.done.push(one);
    else sizes.push({ box, done: [one] });
  }
  return sizes.length > 0 ? sizes : [{ box: model.report.input.box, done: [] }];
}

// What a job made of something, and what it was; null where it does not say.
interface Change {
  readonly before: number;
  readonly after: number | null;
}

function changeOf({ before, after }: Change): string {
  if (after === null || before === 0) return '';
  const percent = Math.round((1000 * (after - before)) / before) / 10;
  return percent === 0 ? '' : ` (${percent > 0 ? '+' : '−'}${format(Math.abs(percent), 1)} %)`;
}

function bestOf(values: readonly (number | null)[]): readonly number[] {
  const known = values.filter((value) => value !== null);
  const least = Math.min(...known);
  if (known.every((value) => value === least)) return [];
  return [...values.keys()].filter((i) => values[i] === least);
}

// The solid of each size, and jobs with what they are beside what each of them began with.
//   alone: of the solid where there is no job
function measured(name: string, sizes: readonly Size[], tell: (one: Done) => Change | null, shown: (value: number) => string, alone: number | null = null): Row {
  const cells: string[] = [];
  const best: number[] = [];
  for (const { done } of sizes) {
    const changes = done.map(tell);
    const solid = changes.find((one) => one !== null)?.before ?? alone;
    const values = [solid, ...changes.map((one) => one?.after ?? null)];
    best.push(...bestOf(values).map((i) => cells.length + i));
    cells.push(...values.map((value, i) => (value === null ? '–' : shown(value) + (i > 0 ? changeOf(changes[i - 1]!) : ''))));
  }
  return { name, cells, best };
}

function told(name: string, solid: string, sizes: readonly Size[], tell: (one: Done) => string | null): Row {
  return { name, cells: sizes.flatMap(({ done }) => [solid, ...done.map((one) => tell(one) ?? '–')]), best: [] };
}

// Of one infill each, since others cannot be compared.
function filamentRows(sizes: readonly Size[]): readonly Row[] {
  const reports = sizes.flatMap(({ done }) => done.map(({ report }) => report));
  const infills = [...new Set(reports.map((report) => filamentOf(report)?.infill).filter((one) => one !== undefined))];
  return infills.map((infill) => {
    const ofInfill = ({ report }: Done): Change | null => {
      const filament = filamentOf(report);
      return filament?.infill === infill ? filament : null;
    };
    return measured(`Filament at ${format(infill)} % infill`, sizes, ofInfill, cubic);
  });
}

function materialRows(sizes: readonly Size[]): readonly Row[] {
  const materials = sizes.flatMap(({ done }) => done.map(({ report }) => report.material));
  const name = materials.find((one) => one !== null)?.name;
  if (name === undefined) return [];
  const same = ({ report: { material } }: Done): Report['material'] => (material?.name === name ? material : null);
  const mass = (one: Done): Change | null => {
    const material = same(one);
    return material && { before: material.mass_before_g, after: material.mass_after_g };
  };
  const cost = (one: Done): Change | null => {
    const material = same(one);
    return material && { before: material.cost_before, after: material.cost_after };
  };
  return [
    measured(`Mass, ${name}, printed solid`, sizes, mass, (g) => `${format(g, 1)} g`),
    measured('Cost, printed solid', sizes, cost, (price) => price.toFixed(2)),
  ];
}

function columnsOf(model: Model, sizes: readonly Size[]): readonly Column[] {
  const asRead = sizes.length === 1 && isAsLarge(sizes[0].box, model.report.input.box);
  return sizes.flatMap(({ box, done }) => [
    { id: kSolid, title: asRead ? 'Solid' : `Solid, ${inWords(box)}` },
    ...done.map(({ job }) => ({ id: job.id, title: nameOfJob(job) })),
  ]);
}

// The model is there to see as it was read alone.
function viewsOf(model: Model, columns: readonly Column[]): readonly Column[] {
  const { box } = model.report.input;
  const isOther = columns.some(({ id, title }) => id === kSolid && title !== 'Solid');
  return [{ id: kSolid, title: isOther ? `Solid as it was read, ${inWords(box)}` : 'Solid' }, ...columns.filter(({ id }) => id !== kSolid)];
}

export function compare(model: Model, done: readonly Done[]): Comparison {
  const { input } = model.report;
  const sizes = sizesOf(model, done);
  const volume = ({ report }: Done): Change => ({ before: report.volume.before_mm3, after: report.volume.after_mm3 });
  const rows: Row[] = [
    measured('Solid material', sizes, volume, cubic, input.filled_volume_mm3),
    ...materialRows(sizes),
    ...filamentRows(sizes),
    told('Of other infill', '–', sizes, ({ report: { modifiers } }) =>
      modifiers ? `${format(modifiers.volume_percent, 1)} % at ${format(modifiers.infill_percent)} %` : null,
    ),
    told('Stiffness, about', '100 %', sizes, ({ report: { strength_and_balance: strength } }) =>
      strength ? `${format(100 * strength.relative_stiffness_upper_bound, 0)} %` : null,
    ),
    told('Voids', '–', sizes, ({ report: { voids } }) =>
      `${format(voids.count)} ${voids.shape}, r ${format(voids.min_radius_mm, 1)} to ${format(voids.max_radius_mm, 1)} mm`,
    ),
    told('Thinnest wall', '–', sizes, ({ report }) => (report.measured.wall_mm === null ? null : `${format(report.measured.wall_mm)} mm`)),
    told('Triangles', format(input.triangles), sizes, ({ report }) => format(report.output.triangles)),
    told('File', bytesIn(model.bytes), sizes, ({ job }) => job.files?.map((file) => `${file.form.toUpperCase()} ${bytesIn(file.bytes)}`).join(', ') ?? null),
    told('Made in', '–', sizes, ({ job, report }) => secondsIn(job.seconds ?? report.seconds)),
  ];
  const columns = columnsOf(model, sizes);
  return { columns, rows: rows.filter(({ cells }) => cells.some((cell) => cell !== '–')), sides: viewsOf(model, columns) };
}
