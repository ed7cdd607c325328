// The elements of a viewer: the model on its stage, and a panel of controls and figures beside it.
import { make } from './dom';

export interface FrameOptions {
  readonly ids: string; // what the names of its elements begin with, where several stand in one page
  readonly level: 1 | 2; // of its heading
}

export interface Frame extends FrameOptions {
  readonly canvas: HTMLCanvasElement;
  readonly printed: HTMLImageElement;
  readonly state: HTMLParagraphElement;
  readonly legend: HTMLDivElement;
  readonly chosen: HTMLDivElement;
  readonly title: HTMLHeadingElement;
  readonly is: HTMLParagraphElement;
  readonly controls: HTMLFormElement;
  readonly figures: HTMLDivElement;
  readonly made: HTMLParagraphElement;
  readonly footer: HTMLElement;
}

function keysAndTouch(id: string): HTMLElement {
  const key = (name: string): HTMLElement => make('kbd', {}, name);
  const text = make(
    'p',
    { id: `${id}keys` },
    'Drag or one finger turns, the wheel or two fingers zoom, the right button or two fingers move. With the model in focus: arrow keys turn, ',
    ...[key('+'), ' and ', key('-'), ' zoom, ', key('Page Up'), ' and ', key('Page Down'), ' move the cut, '],
    ...[key('['), ' and ', key(']'), ' take layers away and back, ', key('n'), ' and ', key('p')],
    ...[' choose the next and the previous void, ', key('Home'), ' is the view of the beginning.'],
  );
  return make('details', { id: `${id}help`, class: 'help' }, make('summary', {}, 'Keys and touch'), text);
}

// Fills `root` with them.
export function makeFrame(root: HTMLElement, options: FrameOptions): Frame {
  const { ids, level } = options;
  const frame: Frame = {
    ...options,
    canvas: make('canvas', {
      id: `${ids}canvas`,
      tabindex: '0',
      role: 'application',
      'aria-roledescription': 'model to turn and cut',
      'aria-describedby': `${ids}keys`,
    }),
    printed: make('img', { id: `${ids}printed`, class: 'printed', alt: '', hidden: '' }),
    state: make('p', { id: `${ids}state`, class: 'state', role: 'status' }, 'Reading the model …'),
    legend: make('div', { id: `${ids}legend`, class: 'legend', hidden: '' }),
    chosen: make('div', { id: `${ids}chosen`, class: 'chosen', role: 'status', hidden: '' }),
    title: make(`h${level}`, { class: 'title' }),
    is: make('p'),
    controls: make('form', { id: `${ids}controls`, hidden: '' }),
    figures: make('div', { id: `${ids}figures`, class: 'figures' }),
    made: make('p'),
    footer: make('footer', { id: `${ids}footer` }),
  };
  frame.footer.append(frame.made);
  const parts = [frame.canvas, frame.printed, frame.state, frame.legend, frame.chosen];
  const panel = [make('header', {}, frame.title, frame.is), frame.controls, frame.figures, keysAndTouch(ids), frame.footer];
  root.classList.add('viewer');
  root.replaceChildren(
    make('section', { id: `${ids}stage`, class: 'stage', 'aria-label': 'The model' }, ...parts),
    make('section', { id: `${ids}panel`, class: 'panel', 'aria-label': 'Controls and figures' }, ...panel),
  );
  return frame;
}

export function say({ state }: Frame, text: string, isError = false): void {
  state.textContent = text;
  state.hidden = text === '';
  state.classList.toggle('error', isError);
}
