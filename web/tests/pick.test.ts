import { expect, it } from 'vitest';
import { pick } from '../src/pick';
import { fixture } from './fixture';

const kMiddle = { normal: [0, -1, 0], offset: 0 } as const; // what is before the middle is away
const kFront = [0.05, -40, -2.05] as const; // before the void
const kInto = [0, 1, 0] as const;

it('finds the surface that is met first', async () => {
  const { geometry } = await fixture();
  expect(pick(geometry, kFront, kInto, [], () => true, false)?.kind).toBe('outer');
  expect(pick(geometry, [30, -40, 0], kInto, [], () => true, false)).toBeNull();
});

it('finds the void that is cut open, and not through the cut face beside it', async () => {
  const { geometry } = await fixture();
  expect(pick(geometry, kFront, kInto, [kMiddle], () => true, false)?.kind).toBe('void');
  expect(pick(geometry, [8.1, -40, 8.1], kInto, [kMiddle], () => true, false)).toBeNull();
});

it('sees through a surface that is off', async () => {
  const { geometry } = await fixture();
  expect(pick(geometry, kFront, kInto, [], (part) => part.kind === 'void', true)?.kind).toBe('void');
});
