import type { Frame } from './frame';
import type { Stage } from './stage';
import { kLight, themeNow } from './themes';

// What is printed is a picture of what is seen, in the colours of paper.
export function listenToPrint({ canvas, printed }: Frame, stage: Stage, signal: AbortSignal): void {
  const before = (): void => {
    stage.paint(kLight);
    stage.drawNow();
    printed.src = trimmed(canvas);
    printed.alt = canvas.getAttribute('aria-label') ?? '';
    printed.hidden = false;
  };
  const after = (): void => {
    printed.hidden = true;
    stage.paint(themeNow());
  };
  window.addEventListener('beforeprint', before, { signal });
  window.addEventListener('afterprint', after, { signal });
}

// Without the margins on which nothing is drawn.
function trimmed(canvas: HTMLCanvasElement): string {
  const copy = document.createElement('canvas');
  const { width, height } = canvas;
  copy.width = width;
  copy.height = height;
  const context = copy.getContext('2d', { willReadFrequently: true });
  if (!context) return canvas.toDataURL();
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  let [left, right, top, bottom] = [width, 0, height, 0];
  for (let y = 0, at = 3; y < height; ++y) {
    for (let x = 0; x < width; ++x, at += 4) {
      if (data[at] === 0) continue;
      left = Math.min(left, x);
      right = Math.max(right, x + 1);
      top = Math.min(top, y);
      bottom = Math.max(bottom, y + 1);
    }
  }
  if (left >= right) return canvas.toDataURL();
  copy.width = right - left;
  copy.height = bottom - top;
  context.drawImage(canvas, -left, -top);
  return copy.toDataURL();
}
