// The controls of the page. They hold no state: `state` is what they show, and `change` what they ask for.
import { choicesOf, legendOf, type ColourBy, type Rgb } from './colours';
import type { Axis, Cut, Layers } from './cut';
import { kAxes } from './cut';
import { format } from './colours';
import { make } from './dom';
import type { Frame } from './frame';
import type { Geometry } from './geometry';
import { nameOfVoids, type Kind, type Scene } from './scene';
import type { Outer } from './stage';

export interface State {
  readonly cut: Cut;
  readonly cutAlone: boolean;
  readonly printed: number; // layers
  readonly outer: Outer;
  readonly kinds: ReadonlySet<Kind>;
  readonly marks: boolean;
  readonly by: ColourBy;
  readonly chosen: number | null; // index of a void
}

type Change = (change: Partial<State>) => void;

const kColourNames: Readonly<Record<ColourBy, string>> = {
  kind: 'What it is',
  radius: 'Radius',
  wall: 'Wall left',
  ceiling: 'Ceilings',
};

interface Choice<T extends string> {
  readonly value: T;
  readonly text: string;
}

// A row of radio buttons, which the arrow keys move among.
function choice<T extends string>(title: string, name: string, choices: readonly Choice<T>[], onPick: (value: T) => void) {
  const inputs = choices.map(({ value, text }) => {
    const input = make('input', { type: 'radio', name, value });
    input.addEventListener('change', () => onPick(value));
    return { value, input, label: make('label', {}, input, make('span', {}, text)) };
  });
  const row = make('div', { class: 'choice' }, ...inputs.map(({ label }) => label));
  return {
    element: make('fieldset', {}, make('legend', {}, title), row),
    set: (value: T) => inputs.forEach((one) => (one.input.checked = one.value === value)),
  };
}

function slider(title: string, id: string, max: number, onMove: (value: number) => void) {
  const input = make('input', { type: 'range', id, min: '0', max: String(max), step: '1' });
  const output = make('output', { for: id });
  input.addEventListener('input', () => onMove(Number(input.value)));
  const label = make('label', { for: id }, title);
  return { element: make('div', { class: 'slider' }, label, output, input), input, output };
}

function check(title: string, id: string, onChange: (on: boolean) => void, swatch?: Rgb) {
  const input = make('input', { type: 'checkbox', id });
  input.addEventListener('change', () => onChange(input.checked));
  const label = make('label', { for: id, class: 'check' }, input);
  if (swatch) {
    const dot = make('span', { class: 'swatch' });
    dot.style.background = `rgb(${swatch.join(' ')})`;
    label.append(dot);
  }
  label.append(title);
  return { element: label, input };
}

export const kCutSteps = 500;

export function makePanel(
  frame: Frame,
  scene: Scene,
  geometry: Geometry,
  layers: Layers,
  closesCuts: boolean,
  kinds: readonly Kind[],
  colours: Readonly<Record<Kind, Rgb>>,
  change: Change,
  current: () => State,
  onPrint: () => void,
): (state: State) => void {
  const form = frame.controls;
  const id = (name: string): string => frame.ids + name;
  form.addEventListener('submit', (event) => event.preventDefault());
  const names = nameOfVoids(scene.use);

  const axes = choice<Axis | 'none'>(
    'Cut across',
    'axis',
    [...kAxes.map((axis) => ({ value: axis, text: axis })), { value: 'none', text: 'not cut' }],
    (axis) => change({ cut: { ...current().cut, axis: axis === 'none' ? null : axis } }),
  );
  const place = slider('Place', id('cut'), kCutSteps, (at) => change({ cut: { ...current().cut, share: at / kCutSteps } }));
  const flip = check('Keep the other half', id('flip'), (flipped) => change({ cut: { ...current().cut, flipped } }));
  const alone = check('Cut face alone', id('alone'), (cutAlone) => change({ cutAlone }));
  const openNote = make('p', { class: 'note' }, scene.closed ? 'This device cannot close the cut face.' : 'The surface is open: the cut shows no face.');
  axes.element.append(place.element, make('div', { class: 'checks' }, flip.element, alone.element));
  if (!closesCuts) axes.element.append(openNote);

  const layer = slider('Printed up to layer', id('layer'), layers.count, (printed) => change({ printed: Math.max(printed, 1) }));
  layer.input.min = '1';
  const layerNote = make(
    'p',
    { class: 'note' },
    `Layers of ${format(layers.height)} mm${layers.assumed ? ', since the print was not described' : ''}.`,
  );

  const outer = choice<Outer>(
    'Outer surface',
    'outer',
    [
      { value: 'solid', text: 'solid' },
      { value: 'faded', text: 'faded' },
      { value: 'off', text: 'off' },
    ],
    (value) => change({ outer: value }),
  );

  const kindNames: Partial<Record<Kind, string>> = { void: names.many, channel: 'Channels', hole: 'Holes' };
  const boxes = kinds.map((kind) => ({
    kind,
    ...check(
      kindNames[kind] ?? kind,
      id(`show-${kind}`),
      (on) => {
        const shown = new Set(current().kinds);
        if (on) shown.add(kind);
        else shown.delete(kind);
        change({ kinds: shown });
      },
      colours[kind],
    ),
  }));
  const marks = check('Marks', id('show-marks'), (on) => change({ marks: on }));
  const shown = make('fieldset', {}, make('legend', {}, 'Show'));
  shown.append(make('div', { class: 'checks' }, ...boxes.map(({ element }) => element)));
  if (scene.marks.length > 0) shown.firstElementChild?.nextElementSibling?.append(marks.element);

  const by = choice<ColourBy>(
    'Colour by',
    'by',
    choicesOf(scene).map((value) => ({ value, text: kColourNames[value] })),
    (value) => change({ by: value }),
  );

  const count = scene.voids.radius.length;
  const number = make('input', { type: 'number', id: id('number'), min: '1', max: String(count), inputmode: 'numeric' });
  number.addEventListener('change', () => {
    const at = scene.voids.number.indexOf(Number(number.value));
    change({ chosen: at >= 0 ? at : null });
  });
  const step = (by_: number) => (): void => change({ chosen: nextVoid(count, current().chosen, by_) });
  const button = (text: string, label: string, onClick: () => void): HTMLButtonElement => {
    const element = make('button', { type: 'button', 'aria-label': label, title: label }, text);
    element.addEventListener('click', onClick);
    return element;
  };
  const one = names.one.toLowerCase();
  const voids = make(
    'div',
    { class: 'void-row' },
    make('label', { for: id('number') }, names.one),
    button('\u2039', `Previous ${one}`, step(-1)),
    number,
    button('\u203a', `Next ${one}`, step(1)),
    make('span', { class: 'note' }, `of ${format(count)}, or click one`),
  );
  const print = make('button', { type: 'button', class: 'wide' }, 'Print or save as PDF');
  print.addEventListener('click', onPrint);

  form.append(axes.element, make('div', {}, layer.element, layerNote), outer.element);
  if (kinds.length > 0 || scene.marks.length > 0) form.append(shown);
  if (count > 0) form.append(by.element, voids);
  form.append(print);
  form.hidden = false;

  return (state) => {
    axes.set(state.cut.axis ?? 'none');
    const { axis, share } = state.cut;
    place.input.disabled = flip.input.disabled = !axis;
    alone.input.disabled = !closesCuts || (!axis && state.printed >= layers.count);
    place.input.value = String(Math.round(share * kCutSteps));
    const k = axis ? kAxes.indexOf(axis) : 0;
    const at = geometry.centre[k] + (share - 0.5) * geometry.size[k];
    place.output.value = axis ? `${axis} = ${at.toFixed(1)} mm` : 'not cut';
    place.input.setAttribute('aria-valuetext', place.output.value);
    flip.input.checked = state.cut.flipped;
    alone.input.checked = state.cutAlone;
    layer.input.value = String(state.printed);
    const height = Math.min(state.printed * layers.height, layers.count * layers.height);
    layer.output.value = `${state.printed} of ${layers.count} (${height.toFixed(1)} mm)`;
    layer.input.setAttribute('aria-valuetext', layer.output.value);
    outer.set(state.outer);
    for (const box of boxes) box.input.checked = state.kinds.has(box.kind);
    marks.input.checked = state.marks;
    by.set(state.by);
    number.value = state.chosen === null ? '' : String(scene.voids.number[state.chosen]);
    showLegend(frame.legend, scene, state.by);
    showChosen(frame.chosen, scene, state.chosen);
  };
}

export function nextVoid(count: number, chosen: number | null, by: number): number | null {
  if (count === 0) return null;
  if (chosen === null) return by > 0 ? 0 : count - 1;
  return (chosen + by + count) % count;
}

function showLegend(box: HTMLElement, scene: Scene, by: ColourBy): void {
  const legend = legendOf(scene, by);
  box.hidden = !legend;
  if (!legend) return;
  const bar = make('div', { class: 'bar' });
  bar.style.background = `linear-gradient(to right, ${legend.stops.map((stop) => `rgb(${stop.join(' ')})`).join(', ')})`;
  const ends = make('div', { class: 'ends' }, make('span', {}, legend.low), make('span', {}, legend.high));
  box.replaceChildren(make('p', {}, legend.title), bar, ends);
}

function showChosen(box: HTMLElement, scene: Scene, chosen: number | null): void {
  box.hidden = chosen === null;
  if (chosen === null) return box.replaceChildren();
  const { number, place, radius, volume, wall } = scene.voids;
  const at = [0, 1, 2].map((k) => place[3 * chosen + k].toFixed(1)).join(', ');
  const lines: [string, string][] = [
    ['Radius', `${format(radius[chosen])} mm`],
    ['Place', `${at} mm`],
    ['Volume', `${format(volume[chosen], 1)} mm\u00b3`],
  ];
  const thickness = wall[chosen];
  if (thickness !== null) lines.push(['Wall', `${format(thickness)} mm`]);
  const list = make('dl');
  for (const [name, value] of lines) list.append(make('div', {}, make('dt', {}, name), make('dd', {}, value)));
  box.replaceChildren(make('p', {}, `${nameOfVoids(scene.use).one} ${number[chosen]}`), list);
}
