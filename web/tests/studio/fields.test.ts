import { expect, it } from 'vitest';
import { descriptionOf, entryOf, fieldOf, groupsOf, isAsked, kMain, valueOf, withValue } from '../../src/studio/fields';
import type { OptionRow, Process } from '../../src/studio/told';

const row = (name: string, kind: OptionRow['kind'], more: Partial<OptionRow> = {}): OptionRow => ({
  name,
  kind,
  unit: '',
  default: null,
  description: '',
  group: '',
  ...more,
});

const kProcess: Process = {
  name: 'sla',
  title: 'resin printers',
  material: 'resin',
  drains: true,
  rows: [
    { option: 'wall', name: 'wall', value: 2, unit: 'mm', source: 'a guide' },
    { option: 'bridge', name: 'bridge', value: null, unit: 'mm', source: null },
    { option: 'cell-size', name: 'cell-size', value: 33, unit: 'mm', source: null },
    { option: null, name: 'least-wall', value: 0.5, unit: 'mm', source: 'another guide' },
  ],
};

it('takes what holds by default from the process, with its source, before what the program says', () => {
  const wall = row('wall', 'number', { unit: 'mm', default: '1.2' });
  expect(fieldOf(wall, kProcess)).toMatchObject({ title: 'Wall', standard: '2', unit: 'mm', source: 'a guide' });
  expect(fieldOf(wall, undefined)).toMatchObject({ standard: '1.2', source: '' });
  expect(fieldOf(row('bridge', 'number'), kProcess).standard).toBe('none');
  expect(fieldOf(row('drain', 'flag', { off: true }), kProcess).standard).toBe('yes');
  for (const name of ['target-saving', 'target-mass', 'target-density', 'max-voids', 'max-triangles']) expect(fieldOf(row(name, 'number'), kProcess).standard).toBe('none');
  expect(fieldOf(row('material', 'text'), kProcess).standard).toBe('resin');
  expect(fieldOf(row('some-new-thing', 'text'), kProcess)).toMatchObject({ title: 'Some new thing', standard: '' });
});

it('shows each option once, in the groups and the order that the program tells', () => {
  const names = ['process', 'up', 'wall', 'max-radius', 'infill', 'layer-height', 'force'];
  const group = ['Process', 'Process', 'Limits', 'Limits', 'The print', 'The print', 'More'];
  const rows = names.map((name, i) => row(name, 'text', { group: group[i] }));
  const groups = groupsOf(rows, kProcess).map(({ title, fields }) => [title, ...fields.map((field) => field.row.name)]);
  expect(groups).toEqual([['Process', 'up'], ['Limits', 'max-radius'], ['The print', 'layer-height'], ['More', 'force']]);
  const main = rows.filter((one) => kMain.includes(one.name)).map(({ name }) => name);
  expect(main).toEqual(['wall', 'infill']);
  expect(rows.filter(isAsked)).toHaveLength(names.length - 1);
});

it('sends what was given, and nothing else', () => {
  const wall = row('wall', 'number');
  expect(valueOf(wall, ' 2.5 ')).toBe('2.5');
  expect(valueOf(wall, '1,5')).toBe('1.5');
  expect(valueOf(wall, '')).toBeNull();
  expect(valueOf(wall, 'thick')).toBe('thick'); // the program says what is wrong with it
  expect(valueOf(row('scale', 'text'), '1,1,1.02')).toBe('1,1,1.02');
  expect(valueOf(row('holes-on', 'list'), 'bottom\n\n left ')).toEqual(['bottom', 'left']);
  expect(valueOf(row('holes-on', 'list'), '\n')).toBeNull();
});

it('knows flags that are off from flags that nobody touched', () => {
  const drain = row('drain', 'flag', { off: true });
  expect([valueOf(drain, 'true'), valueOf(drain, 'false'), valueOf(drain, '')]).toEqual([true, false, null]);
  const blockers = row('support-blockers', 'flag');
  expect([valueOf(blockers, 'true'), valueOf(blockers, 'false')]).toEqual([true, null]);
  const stand = row('stand', 'number', { bare: true });
  expect([valueOf(stand, 'true'), valueOf(stand, '-2'), valueOf(stand, '')]).toEqual([true, '-2', null]);
});

it('shows again what was given', () => {
  for (const entry of ['2.5', 'true', 'false', '']) expect(entryOf(entry === '' ? undefined : entry)).toBe(entry);
  expect(entryOf(false)).toBe('false');
  expect(entryOf(['bottom', 'left'])).toBe('bottom\nleft');
  expect(withValue({ wall: '2' }, 'gap', '1')).toEqual({ wall: '2', gap: '1' });
  expect(withValue({ wall: '2', gap: '1' }, 'gap', null)).toEqual({ wall: '2' });
});

it('tells what an option does for the process that is chosen', () => {
  const tell = (name: string, description: string, unit = 'mm') => descriptionOf(row(name, 'number', { unit, description }), kProcess);
  expect(tell('wall', 'Least thickness (default of the process, here of fdm)')).toBe('Least thickness (default 2 mm, of sla)');
  expect(tell('bridge', 'Ceiling (default of the process; none for sla and sls; there are both)')).toBe('Ceiling (no default of sla; there are both)');
  expect(tell('drain', 'Join voids (default of the process: sla, sls and metal drain, fdm does not)', '')).toBe('Join voids (default yes, of sla)');
  expect(tell('material', 'For mass (default of the process; fdm: PLA)', '')).toBe('For mass (default resin, of sla)');
  expect(tell('keep-solid', 'Stays: a mesh file, a modifier\'s name in a 3MF project, box:X; may be repeated')).toBe('Stays: box:X; one on a line');
  const cells = 'Apart (default of the process, 21 where it has none, or what --max-radius gives; 33 for sla and sls); half';
  expect(tell('cell-size', cells)).toBe('Apart (default 33 mm, of sla, or what --max-radius gives); half');
  const none = { ...kProcess, name: 'fdm', rows: [{ option: 'cell-size', name: 'cell-size', value: null, unit: 'mm', source: null }] };
  expect(descriptionOf(row('cell-size', 'number', { description: cells }), none)).toBe('Apart (default 21, or what --max-radius gives); half');
  expect(fieldOf(row('cell-size', 'number'), none).standard).toBe('');
  expect(tell('gap', 'Between two voids')).toBe('Between two voids');
});
