import type { Page } from 'playwright-core';

// Words of less contrast than 4.5 to 1 with what they stand on, and what is pressed or filled in without a name.
//   where: selectors of what is looked through
export function unreadable(page: Page, where: string): Promise<readonly string[]> {
  return page.evaluate((within) => {
    const channel = (value: number) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
    const light = (colour: string) => {
      const [r, g, b] = (colour.match(/[\d.]+/g) ?? []).map((part) => channel(Number(part) / 255));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const ground = (element: Element | null): string => {
      for (let at = element; at; at = at.parentElement) {
        const colour = getComputedStyle(at).backgroundColor;
        if (!/, 0\)$/.test(colour)) return colour;
      }
      return 'rgb(255, 255, 255)';
    };
    const found: string[] = [];
    for (const element of document.querySelectorAll<HTMLElement>(`:is(${within}) *`)) {
      const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent?.trim());
      if (!own || !(element instanceof HTMLElement) || element.offsetParent === null) continue;
      if (element.closest('fieldset :disabled')) continue;
      const [a, b] = [light(getComputedStyle(element).color), light(ground(element))];
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (ratio < 4.5) found.push(`${element.textContent}: ${ratio.toFixed(2)}`);
    }
    for (const input of document.querySelectorAll<HTMLInputElement>(`:is(${within}) :is(input, select, textarea)`))
      if (!input.labels?.length && !input.getAttribute('aria-label')) found.push(`${input.id} has no label`);
    for (const button of document.querySelectorAll(`:is(${within}) button`))
      if (!(button.getAttribute('aria-label') ?? button.textContent)) found.push('a button has no name');
    return found;
  }, where);
}
