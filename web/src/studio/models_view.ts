// Where models come in, and the list of those that are there.
import { format } from '../colours';
import { make } from '../dom';
import { whyUnusable } from './advice';
import { button, isWanted, trouble } from './pieces';
import type { Session } from './session';
import { onChange, type Page, type Upload } from './store';
import type { Model } from './told';
import { bytesIn, sentence } from './words';

export function sizeOf({ report: { input } }: Model): string {
  const { lower_mm: lower, upper_mm: upper } = input.box;
  return `${upper.map((high, k) => format(high - lower[k], 1)).join(' × ')} mm`;
}

export function showModels(into: HTMLElement, session: Session): void {
  const { store } = session;
  const chooser = make('input', { type: 'file', id: 'chooser', multiple: '', hidden: '', tabindex: '-1', 'aria-label': 'Models' });
  chooser.addEventListener('change', () => {
    session.send(chooser.files ?? []);
    chooser.value = '';
  });
  const limits = make('span', { class: 'note' });
  const words = make('span');
  const drop = make('button', { type: 'button', id: 'drop', class: 'drop' }, make('strong', {}, 'Drop a model here'), words, limits);
  drop.addEventListener('click', () => chooser.click());
  const list = make('ul', { class: 'models', id: 'model-list' });
  const sent = make('ul', { class: 'models', id: 'uploads', role: 'status' });
  into.append(chooser, list, sent, drop);

  store.listen(onChange((page) => page.told, ({ told }) => {
    if (!told) return;
    chooser.accept = told.limits.formats.join(',');
    limits.textContent = `${told.limits.formats.map((ending) => ending.replace('.', '').toUpperCase()).join(', ')}; up to ${bytesIn(told.limits.bodyBytes)}`;
  }));
  let shown: readonly unknown[] = [];
  store.listen((page) => {
    const now = [page.models, page.chosen];
    const isFirst = page.models.length === 0;
    drop.classList.toggle('compact', !isFirst);
    words.textContent = isFirst ? 'or choose a file' : 'Add another model';
    if (now.every((one, i) => one === shown[i])) return;
    shown = now;
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.model : undefined;
    list.replaceChildren(...page.models.map((model) => entry(model, page, session)));
    if (focused) list.querySelector<HTMLElement>(`[data-model="${focused}"]`)?.focus();
  });
  store.listen(onChange((page) => page.uploads, ({ uploads }) => showUploads(sent, uploads, session)));
}

function entry(model: Model, { chosen }: Page, session: Session): HTMLElement {
  const isChosen = model.id === chosen;
  const { input } = model.report;
  const choose = make(
    'button',
    { type: 'button', class: 'model', 'aria-pressed': String(isChosen), 'data-model': model.id },
    make('strong', {}, model.name),
    make('span', { class: 'note' }, `${sizeOf(model)}, ${format(input.triangles)} triangles`),
  );
  choose.addEventListener('click', () => session.choose(model.id));
  const remove = button('×', () => removeIfWanted(model, session), `Remove ${model.name}`);
  remove.classList.add('small');
  const item = make('li', { class: isChosen ? 'chosen-model' : '' }, choose, remove);
  if (isChosen || !model.usable) {
    const use = model.usable ? model.use.replace(/^'aerate hollow'/, 'hollowing') : whyUnusable(model);
    item.append(make('p', { class: `note use ${model.usable ? '' : 'bad'}` }, sentence(use)));
  }
  return item;
}

// Results that nobody has saved go with their model.
async function removeIfWanted({ id, name }: Model, session: Session): Promise<void> {
  const results = session.store.now.jobs.filter(({ model, state }) => model === id && state === 'done').length;
  const what = results === 1 ? 'the result' : `the ${results} results`;
  if (results === 0 || (await isWanted(`Remove ${name} and ${what} made of it?`, 'Remove'))) await session.removeModel(id);
}

// Bars are moved, not made anew: screen readers would begin again with each.
function showUploads(list: HTMLElement, uploads: readonly Upload[], session: Session): void {
  for (const item of [...list.children])
    if (!uploads.some(({ id }) => item.id === `upload-${id}`)) item.remove();
  for (const upload of uploads) {
    const id = `upload-${upload.id}`;
    const old = document.getElementById(id);
    const bar = old?.querySelector('progress');
    if (old && bar && !upload.trouble) {
      moveBar(old, bar, upload);
      continue;
    }
    if (old?.dataset.ended) continue;
    const item = uploadEntry(id, upload, session);
    if (old) old.replaceWith(item);
    else list.append(item);
  }
}

function uploadEntry(id: string, upload: Upload, session: Session): HTMLElement {
  const cancel = button('×', () => session.cancel(upload.id), upload.trouble ? `Dismiss ${upload.name}` : `Do not send ${upload.name}`);
  cancel.classList.add('small');
  const item = make('li', { id }, make('strong', {}, upload.name), cancel);
  if (upload.trouble) {
    item.dataset.ended = 'true';
    item.append(trouble(upload.trouble));
    return item;
  }
  const bar = make('progress', { max: '1', 'aria-label': `Sending ${upload.name}` });
  item.append(bar, make('span', { class: 'note' }));
  moveBar(item, bar, upload);
  return item;
}

function moveBar(item: Element, bar: HTMLProgressElement, { share, bytes }: Upload): void {
  const words = item.querySelector('.note');
  if (share === null) {
    if (words) words.textContent = 'waits';
    return;
  }
  bar.value = share;
  if (words) words.textContent = share < 1 ? `${Math.floor(100 * share)} % of ${bytesIn(bytes)} sent` : 'sent; the program reads it …';
}
