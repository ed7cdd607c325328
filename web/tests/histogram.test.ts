import { expect, it } from 'vitest';
import { binsOf } from '../src/histogram';

it('counts each value once', () => {
  const values = Array.from({ length: 100 }, (_, i) => 1 + i / 10);
  const bins = binsOf(values);
  expect(bins).toHaveLength(10);
  expect(bins.reduce((sum, bin) => sum + bin.count, 0)).toBe(100);
  expect(bins[0].low).toBe(1);
  expect(bins[9].high).toBeCloseTo(10.9);
});

it('has one bar for values that are all the same, and none for none', () => {
  expect(binsOf([3, 3, 3])).toEqual([{ low: 3, high: 3, count: 3 }]);
  expect(binsOf([])).toEqual([]);
});
