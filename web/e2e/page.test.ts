// Pages that the program wrote (scripts/test-web), as a browser shows them that opens them from disk.
import { existsSync } from 'node:fs';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it } from 'vitest';
import { raised } from '../src/figures';
import { launch } from './browser';
import { pixelsOf } from './pixels';
import { unreadable } from './readable';

const kPages = process.env.AERATE_PAGES ?? '';

let browser: Browser;
let messages: string[] = [];
let requests: string[] = [];

beforeAll(async () => {
  if (!existsSync(kPages)) throw new Error('AERATE_PAGES names no folder: run scripts/test-web');
  browser = await launch();
});
afterAll(async () => browser?.close());
beforeEach(() => {
  messages = [];
  requests = [];
});
afterEach(() => {
  expect(messages).toEqual([]);
  expect(requests.filter((url) => !url.startsWith('file:') && !url.startsWith('data:'))).toEqual([]);
});

async function open(options: BrowserContextOptions = {}, name = 'voids'): Promise<Page> {
  const context = await browser.newContext({ viewport: { width: 1200, height: 800 }, colorScheme: 'light', ...options });
  const page = await context.newPage();
  page.on('console', (message) => messages.push(message.text()));
  page.on('pageerror', (error) => messages.push(error.message));
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(`file://${kPages}/${name}.html`);
  await page.waitForSelector('html[data-ready]');
  expect(await page.getAttribute('html', 'data-ready')).toBe('true');
  return page;
}

// Cuts through the middle of the largest void, and tells where that is, a place in the solid beside it and one outside of the
// model, in pixels of the canvas.
async function cutLargest(page: Page) {
  await page.check('input[name=axis][value=y]');
  const { number, share, ...places } = await page.evaluate(() => {
    const { scene, project, size, centre } = window.aerate!;
    const largest = scene.voids.radius.indexOf(Math.max(...scene.voids.radius));
    const [x, y, z] = [0, 1, 2].map((k) => scene.voids.place[3 * largest + k]);
    const kInSolid = 0.4; // mm from its wall, less than any gap
    return {
      number: scene.voids.number[largest],
      share: (y - centre[1]) / size[1] + 0.5,
      middle: project([x, y, z]),
      beside: project([x + scene.voids.radius[largest] + kInSolid, y, z]),
      outside: [8, 8] as const,
    };
  });
  await page.fill('#cut', String(Math.round(500 * share)));
  return { number, ...places };
}

describe('the page', () => {
  it('shows the figures of the report', async () => {
    const page = await open();
    expect(await page.textContent('h1')).toContain('.stl');
    const figures = await page.textContent('#figures');
    const told = await page.evaluate(() => window.aerate!.scene.figures);
    expect(told.length).toBeGreaterThan(0);
    for (const [name, value] of told) {
      expect(figures).toContain(name);
      expect(figures).toContain(raised(value));
    }
    expect(await page.locator('.histogram rect').count()).toBeGreaterThan(0);
    expect(await page.textContent('#footer')).toContain('three.js authors');
    await page.context().close();
  });

  it('closes the cut face: background in a void, hatched solid beside it', async () => {
    const page = await open();
    const { middle, beside, outside } = await cutLargest(page);
    await page.check('#alone');
    const face = await pixelsOf(page);
    expect(await face.opacity(middle)).toBe(0);
    expect(await face.opacity(outside)).toBe(0);
    expect(await face.opacity(beside)).toBe(255);
    // Two colours, of the face and of its lines.
    expect(await face.coloursRound(beside)).toBeGreaterThan(1);
    await page.uncheck('#alone');
    const whole = await pixelsOf(page);
    expect(await whole.opacity(middle)).toBe(255); // the void's far wall
    expect(await whole.isBlue(middle)).toBe(true);
    expect(await whole.isBlue(beside)).toBe(false);
    await page.context().close();
  });

  it('moves the cut by the slider, by keys, and turns', async () => {
    const page = await open();
    const first = await pixelsOf(page);
    const { middle } = await cutLargest(page);
    const before = await pixelsOf(page);
    expect(await before.isBlue(middle)).toBe(true);
    await page.focus('#cut');
    for (let i = 0; i < 3; ++i) await page.keyboard.press('PageUp');
    const moved = await pixelsOf(page);
    expect(moved.differs(before)).toBe(true);
    // Out of the model nothing is cut away, and the surface hides the void.
    await page.fill('#cut', '0');
    expect(await (await pixelsOf(page)).isBlue(middle)).toBe(false);
    await page.focus('#canvas');
    await page.keyboard.press('Home');
    expect((await pixelsOf(page)).differs(first)).toBe(false);
    await page.keyboard.press('ArrowLeft');
    expect((await pixelsOf(page)).differs(first)).toBe(true);
    await page.context().close();
  });

  it('tells of the void that is clicked', async () => {
    const page = await open();
    const { middle, number, outside } = await cutLargest(page);
    await page.mouse.click(...middle);
    const told = await page.textContent('#chosen');
    expect(told).toContain(`${number}`);
    expect(told).toMatch(/Radius[\d.,]+ mm/);
    expect(told).toMatch(/Place/);
    expect(told).toMatch(/Wall[\d.,]+ mm/);
    await page.mouse.click(...outside);
    expect(await page.isHidden('#chosen')).toBe(true);
    await page.context().close();
  });

  it('shows what is printed up to a layer', async () => {
    const page = await open();
    const before = await pixelsOf(page);
    await page.fill('#layer', '1');
    expect(await page.inputValue('#layer')).toBe('1');
    const first = await pixelsOf(page);
    expect(await first.covered()).toBeLessThan(0.5 * (await before.covered()));
    await page.context().close();
  });

  it('switches surfaces and colours', async () => {
    const page = await open();
    const before = await pixelsOf(page);
    await page.check('input[name=outer][value=off]');
    const voids = await pixelsOf(page);
    expect(await voids.covered()).toBeLessThan(await before.covered());
    expect(await voids.covered()).toBeGreaterThan(0);
    await page.check('input[name=outer][value=faded]');
    expect((await pixelsOf(page)).differs(voids)).toBe(true);
    await page.check('input[name=outer][value=solid]');
    await page.uncheck('#show-void');
    expect((await pixelsOf(page)).differs(before)).toBe(true);
    await page.check('#show-void');
    expect(await page.isHidden('#legend')).toBe(true);
    await page.check('input[name=by][value=radius]');
    expect(await page.textContent('#legend')).toContain('mm');
    expect((await pixelsOf(page)).differs(before)).toBe(true);
    await page.context().close();
  });

  it('fits a telephone, in the dark', async () => {
    const page = await open({ viewport: { width: 390, height: 844 }, colorScheme: 'dark', hasTouch: true, isMobile: true });
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
    const { middle } = await cutLargest(page);
    await page.touchscreen.tap(...middle);
    expect(await page.isVisible('#chosen')).toBe(true);
    await page.context().close();
  });

  it('is printed with its picture and its figures, without its controls', async () => {
    const page = await open({ colorScheme: 'dark' });
    await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
    await page.emulateMedia({ media: 'print' });
    expect(await page.isVisible('#printed')).toBe(true);
    expect(await page.isVisible('#controls')).toBe(false);
    expect(await page.isVisible('#figures')).toBe(true);
    expect(await page.evaluate(() => getComputedStyle(document.body).backgroundColor)).toBe('rgb(255, 255, 255)');
    expect((await page.pdf()).length).toBeGreaterThan(10_000);
    await page.context().close();
  });

  it('has words that can be read: 4.5 to 1 and more, and names for all that is pressed', async () => {
    for (const colorScheme of ['light', 'dark'] as const) {
      const page = await open({ colorScheme });
      await page.check('input[name=by][value=radius]');
      await page.click('#help summary');
      expect(await unreadable(page, '#panel, #legend')).toEqual([]);
      await page.context().close();
    }
  });
});

it('says so where nothing can be drawn, and tells the figures all the same', async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.addInitScript(() => (HTMLCanvasElement.prototype.getContext = () => null));
  await page.goto(`file://${kPages}/voids.html`);
  await page.waitForSelector('html[data-ready=failed]');
  expect(await page.textContent('#state')).toContain('WebGL');
  expect(await page.textContent('#figures')).toContain('Before and after');
  await context.close();
});

describe('pages of other jobs', () => {
  const kinds = (page: Page) => page.locator('#controls fieldset label.check[for^=show-]').allTextContents();

  it('have channels and holes to switch where voids drain', async () => {
    const page = await open({}, 'drained');
    expect(await kinds(page)).toEqual(expect.arrayContaining(['Voids', 'Channels', 'Holes']));
    await page.check('input[name=outer][value=off]');
    const all = await pixelsOf(page);
    await page.uncheck('#show-channel');
    await page.uncheck('#show-hole');
    expect(await (await pixelsOf(page)).covered()).toBeLessThan(await all.covered());
    await page.context().close();
  });

  it('show modifiers in a model that stays solid', async () => {
    const page = await open({}, 'modifiers');
    expect(await kinds(page)).toContain('Modifiers');
    const { middle } = await cutLargest(page);
    await page.check('#alone');
    const filled = await pixelsOf(page);
    expect(await filled.opacity(middle)).toBe(255);
    await page.uncheck('#show-void');
    const plain = await pixelsOf(page);
    expect(await plain.opacity(middle)).toBe(255);
    expect(plain.differs(filled)).toBe(true);
    await page.context().close();
  });

  it('show hollows of a model that was only read', async () => {
    const page = await open({}, 'inspected');
    expect(await kinds(page)).toContain('Hollows');
    expect(await page.textContent('#figures')).toContain('shells');
    await page.context().close();
  });
});
