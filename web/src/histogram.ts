import { format } from './colours';
import { svg } from './dom';

export interface Bin {
  readonly low: number;
  readonly high: number;
  readonly count: number;
}

// As many bins as the square root of the values says, 6 to 24, in even steps.
export function binsOf(values: readonly number[]): readonly Bin[] {
  if (values.length === 0) return [];
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (high - low <= 1e-6 * Math.abs(high)) return [{ low, high, count: values.length }];
  const count = Math.min(Math.max(Math.ceil(Math.sqrt(values.length)), 6), 24);
  const width = (high - low) / count;
  const counts = new Array<number>(count).fill(0);
  for (const value of values) ++counts[Math.min(Math.floor((value - low) / width), count - 1)];
  return counts.map((n, i) => ({ low: low + i * width, high: low + (i + 1) * width, count: n }));
}

const kWidth = 320;
const kHeight = 128;
const kLeft = 30;
const kBottom = 20;

export function histogram(values: readonly number[], name: string): SVGElement {
  const bins = binsOf(values);
  const most = Math.max(...bins.map((bin) => bin.count));
  const wide = (kWidth - kLeft) / bins.length;
  const high = kHeight - kBottom - 12;
  const bars = bins.map((bin, i) => {
    const height = (bin.count / most) * high;
    return svg(
      'rect',
      { x: kLeft + i * wide + 1, y: 12 + high - height, width: Math.max(wide - 2, 1), height, rx: 1.5, class: 'bar' },
      svg('title', {}, `${format(bin.low)} to ${format(bin.high)} mm: ${bin.count}`),
    );
  });
  const low = bins[0].low;
  const top = bins[bins.length - 1].high;
  const label = `${name}: ${values.length} from ${format(low)} to ${format(top)} mm; up to ${most} in a bar`;
  return svg(
    'svg',
    { viewBox: `0 0 ${kWidth} ${kHeight}`, role: 'img', 'aria-label': label, class: 'histogram' },
    svg('line', { x1: kLeft, x2: kWidth, y1: 12 + high, y2: 12 + high, class: 'axis' }),
    ...bars,
    svg('text', { x: kLeft - 5, y: 20, 'text-anchor': 'end' }, String(most)),
    svg('text', { x: kLeft - 5, y: 12 + high, 'text-anchor': 'end' }, '0'),
    svg('text', { x: kLeft, y: kHeight - 4 }, `${format(low)} mm`),
    svg('text', { x: kWidth, y: kHeight - 4, 'text-anchor': 'end' }, `${format(top)} mm`),
  );
}
