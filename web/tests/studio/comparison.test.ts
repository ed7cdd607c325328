import { describe, expect, it } from 'vitest';
import { compare, nameOfJob, type Done } from '../../src/studio/comparison';
import type { Job, Model, Report } from '../../src/studio/told';

const kInput = { format: 'STL', triangles: 1200, filled_volume_mm3: 20000, box: { lower_mm: [0, 0, 0], upper_mm: [20, 20, 50] } };
const kModel: Model = { id: 'm1', name: 'box.stl', bytes: 60084, report: { input: kInput }, usable: true, use: '' };

const kReport: Report = {
  input: kInput,
  process: { name: 'fdm' },
  output: { bytes: 1_500_000, triangles: 30000 },
  voids: { shape: 'spheres', count: 40, min_radius_mm: 0.7, max_radius_mm: 8 },
  measured: { wall_mm: 1.2, gap_mm: 0.9 },
  volume: { before_mm3: 20000, after_mm3: 9000 },
  modifiers: null,
  strength_and_balance: { relative_stiffness_upper_bound: 0.31 },
  print: {
    infill_percent: 100,
    filament_before_mm3: 20100,
    filament_after_mm3: 9100,
    verdict: { infill_percent: 15, filament_before_mm3: 6000, filament_after_mm3: 9000 },
  },
  material: { name: 'PLA', mass_before_g: 24.8, mass_after_g: 11.16, cost_before: 0.62, cost_after: 0.279 },
  seconds: 1.4,
};
const kModifiers: Report = {
  ...kReport,
  volume: { before_mm3: 20000, after_mm3: null },
  modifiers: { infill_percent: 0, volume_mm3: 12000, volume_percent: 60 },
  strength_and_balance: null,
  material: null,
  print: { infill_percent: 15, filament_before_mm3: 6000, filament_after_mm3: 4200, verdict: null },
};

function done(id: string, report: Report, options: Job['options'] = {}): Done {
  const job: Job = { id, model: 'm1', options, state: 'done', command: '', seconds: 1.4, files: [{ form: 'stl', name: 'a.stl', bytes: 1_500_000 }] };
  return { job, report };
}

it('has a column for the solid and one for each job', () => {
  const { columns } = compare(kModel, [done('j1', kReport), done('j2', kModifiers, { as: 'modifiers', process: 'fdm' })]);
  expect(columns.map(({ title }) => title)).toEqual(['Solid', 'Voids 1', 'Modifiers 2, fdm']);
  expect(nameOfJob(done('j7', kReport, { process: 'sla' }).job)).toBe('Voids 7, sla');
});

it('says what changed from the solid, and which is least', () => {
  const { rows } = compare(kModel, [done('j1', kReport), done('j2', kModifiers, { as: 'modifiers' })]);
  const row = (name: string) => rows.find((one) => one.name === name);
  expect(row('Solid material')).toEqual({ name: 'Solid material', cells: ['20 cm³', '9 cm³ (−55 %)', '–'], best: [1] });
  // At one infill for all.
  expect(row('Filament at 15 % infill')).toMatchObject({ cells: ['6 cm³', '9 cm³ (+50 %)', '4.2 cm³ (−30 %)'], best: [2] });
  expect(row('Filament at 100 % infill')).toBeUndefined();
  expect(row('Mass, PLA, printed solid')?.cells).toEqual(['24.8 g', '11.2 g (−55 %)', '–']);
  expect(row('Of other infill')?.cells).toEqual(['–', '–', '60 % at 0 %']);
  expect(row('Stiffness, about')?.cells).toEqual(['100 %', '31 %', '–']);
  expect(row('Triangles')?.cells[0]).toBe('1,200');
});

it('compares nothing that is of another infill or material', () => {
  const dense = { ...kReport, print: { infill_percent: 40, filament_before_mm3: 9000, filament_after_mm3: 8000, verdict: null } };
  const resin = { ...dense, material: { ...kReport.material!, name: 'resin' } };
  const { rows } = compare(kModel, [done('j1', kReport), done('j2', resin)]);
  const cells = (name: string) => rows.find((one) => one.name === name)?.cells;
  expect(cells('Filament at 15 % infill')).toEqual(['6 cm³', '9 cm³ (+50 %)', '–']);
  expect(cells('Filament at 40 % infill')).toEqual(['9 cm³', '–', '8 cm³ (−11.1 %)']);
  expect(cells('Mass, PLA, printed solid')).toEqual(['24.8 g', '11.2 g (−55 %)', '–']);
});

it('marks all that are least, and none where all are the same', () => {
  const { rows } = compare(kModel, [done('j1', kReport), done('j2', kReport)]);
  expect(rows.find(({ name }) => name === 'Solid material')?.best).toEqual([1, 2]);
  const same = { ...kReport, volume: { before_mm3: 20000, after_mm3: 20000 } };
  expect(compare(kModel, [done('j1', same)]).rows[0].best).toEqual([]);
});

it('leaves out what nobody knows', () => {
  const { rows } = compare(kModel, [done('j1', { ...kReport, strength_and_balance: null, print: null, material: null })]);
  expect(rows.map(({ name }) => name)).not.toContain('Of other infill');
  expect(rows.some(({ name }) => name.startsWith('Filament') || name.startsWith('Mass'))).toBe(false);
});

describe('jobs of other sizes', () => {
  // Twice as large, so that all is eight times as much.
  const large = (report: Report): Report => ({
    ...report,
    input: { ...kInput, filled_volume_mm3: 160000, box: { lower_mm: [0, 0, 0], upper_mm: [40, 40, 100] } },
    volume: { before_mm3: 160000, after_mm3: 40000 },
    print: { infill_percent: 15, filament_before_mm3: 48000, filament_after_mm3: 24000, verdict: null },
    material: { ...report.material!, mass_before_g: 198.4, mass_after_g: 49.6, cost_before: 4.96, cost_after: 1.24 },
  });
  const cellsIn = ({ rows }: ReturnType<typeof compare>, name: string) => rows.find((one) => one.name === name);

  it('are compared with the model of their size, not as it was read', () => {
    const scaled = compare(kModel, [done('j1', large(kReport), { scale: '2' })]);
    expect(scaled.columns.map(({ title }) => title)).toEqual(['Solid, 40 × 40 × 100 mm', 'Voids 1']);
    expect(cellsIn(scaled, 'Solid material')).toMatchObject({ cells: ['160 cm³', '40 cm³ (−75 %)'], best: [1] });
    expect(scaled.sides.map(({ title }) => title)).toEqual(['Solid as it was read, 20 × 20 × 50 mm', 'Voids 1']);
  });

  it('have a solid of their own, and are not the least because another is larger', () => {
    const mixed = compare(kModel, [done('j1', large(kReport), { scale: '2' }), done('j2', kReport), done('j3', large(kReport))]);
    expect(mixed.columns.map(({ title }) => title)).toEqual(['Solid, 40 × 40 × 100 mm', 'Voids 1', 'Voids 3', 'Solid, 20 × 20 × 50 mm', 'Voids 2']);
    expect(cellsIn(mixed, 'Solid material')).toEqual({
      name: 'Solid material',
      cells: ['160 cm³', '40 cm³ (−75 %)', '40 cm³ (−75 %)', '20 cm³', '9 cm³ (−55 %)'],
      best: [1, 2, 4],
    });
    expect(cellsIn(mixed, 'Mass, PLA, printed solid')?.cells).toEqual(['198.4 g', '49.6 g (−75 %)', '49.6 g (−75 %)', '24.8 g', '11.2 g (−55 %)']);
    expect(cellsIn(mixed, 'Cost, printed solid')?.cells).toEqual(['4.96', '1.24 (−75 %)', '1.24 (−75 %)', '0.62', '0.28 (−55 %)']);
    expect(cellsIn(mixed, 'Filament at 15 % infill')?.cells).toEqual(['48 cm³', '24 cm³ (−50 %)', '24 cm³ (−50 %)', '6 cm³', '9 cm³ (+50 %)']);
    expect(mixed.sides.map(({ id }) => id)).toEqual(['solid', 'j1', 'j3', 'j2']);
  });

  it('are set beside what they began with themselves, where that differs in one size', () => {
    const dense = { ...kReport, material: { ...kReport.material!, mass_before_g: 40, mass_after_g: 10 } };
    expect(cellsIn(compare(kModel, [done('j1', kReport), done('j2', dense)]), 'Mass, PLA, printed solid')?.cells[2]).toBe('10 g (−75 %)');
  });
});
