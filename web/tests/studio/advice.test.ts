import { expect, it } from 'vitest';
import { advised, optionOf, titled } from '../../src/studio/advice';
import type { Model, Trouble } from '../../src/studio/told';

// As the program says them.
const kOpen: Trouble = {
  what: 'lid.off: 3 boundary edges form 1 hole near (13.3, 13.3, 20.0) mm, 28.3 mm across',
  hint: "holes of more than 3.46 mm are not closed unasked: close it in a mesh editor, or let 'aerate hollow --surface remesh' span it with --max-hole 28.3",
  exit: 4,
};
const kHuge: Trouble = {
  what: 'huge.off: the model is 4e+06 x 4e+06 x 4e+06 mm; what is printed is 0.001 mm to 1000 m long',
  hint: 'are --unit and --scale right?',
  exit: 4,
};
const kTwisted: Trouble = { what: 'twisted.off: the triangles on either side of 2 edges face opposite ways', hint: 'make the normals consistent in a mesh editor', exit: 4 };
const kWall: Trouble = { what: '--wall: -1 mm is too little (at least 0 mm)', hint: "see 'aerate hollow --help'", exit: 2 };

function unusable({ what, hint }: Trouble): Model {
  const input = { format: 'OFF', triangles: 11, filled_volume_mm3: 0, box: { lower_mm: [0, 0, 0], upper_mm: [20, 20, 20] } };
  return { id: 'm1', name: 'lid.off', bytes: 300, report: { input }, usable: false, use: `none: ${what}; ${hint}` };
}

it('says once what is wrong with a model, and which fields help', () => {
  const { what, hint, exit } = advised(kOpen, unusable(kOpen));
  expect(what).toBe('this model cannot be hollowed as it is');
  expect(hint).toContain('"Surface: remesh" and "Largest hole to close: 28.3"');
  expect(hint).not.toContain('--');
  expect(exit).toBe(4);
});

it('does not send a model of the wrong size to be meshed anew', () => {
  const { what, hint } = advised(kHuge, unusable(kHuge));
  expect(what).toContain('cannot be hollowed');
  expect(hint).toMatch(/"Unit of the file" and "Scale"/);
  expect(hint).not.toMatch(/remesh|anew/);
});

it('names no field where none helps', () => {
  expect(advised(kTwisted, unusable(kTwisted)).hint).toMatch(/said above/);
});

it('says in full what does not stand in the list', () => {
  expect(advised(kWall, unusable(kOpen))).toEqual(kWall);
  const smaller = { ...kOpen, what: kOpen.what.replace('28.3', '14.1') };
  expect(advised(smaller, unusable(kOpen)).what).toBe(smaller.what);
  expect(advised(kOpen, { ...unusable(kOpen), usable: true }).what).toBe(kOpen.what);
  expect(advised(kTwisted)).toEqual(kTwisted);
});

it('knows the option that a refusal begins with, and gives it its title', () => {
  const radius = { what: '--min-radius 9999 mm (command line) is more than --max-radius 25 mm (default of fdm)' };
  expect([kWall, radius, kOpen].map(optionOf)).toEqual(['wall', 'min-radius', null]);
  expect(titled(kWall, 'Wall')).toEqual({ ...kWall, what: 'Wall (--wall): -1 mm is too little (at least 0 mm)' });
  expect(titled(radius, 'Smallest radius').what).toMatch(/^Smallest radius \(--min-radius\) 9999 mm .* --max-radius 25 mm/);
});
