// The page of --view: one viewer, of the data that stands in the page.
import licence from '../node_modules/three/LICENSE?raw';
import './base.css';
import './viewer.css';
import './page.css';
import { byId, make } from './dom';
import { unpack } from './payload';
import type { Viewer } from './viewer';
import { mountViewer } from './viewer';

// For tests, and for who puts the page into another one.
declare global {
  interface Window {
    aerate?: Viewer;
  }
}

async function main(): Promise<void> {
  const data = byId('data', HTMLScriptElement);
  const payload = unpack(data.textContent ?? '').then((unpacked) => {
    document.title = `${unpacked.scene.title}, ${unpacked.scene.is}`;
    return unpacked;
  });
  data.remove();
  const root = byId('viewer', HTMLElement);
  const mounted = mountViewer(root, payload, { ids: '', level: 1 });
  root.querySelector('footer')?.append(
    make(
      'details',
      {},
      make('summary', {}, 'Licences'),
      make('p', {}, 'The code of this page is part of aerate: GPL-3.0-or-later. It contains three.js:'),
      make('pre', {}, licence.trim()),
    ),
  );
  const viewer = await mounted;
  window.aerate = viewer;
  await viewer.drawn;
  performance.mark('first-frame');
  document.documentElement.dataset.ready = 'true';
}

main().catch(() => {
  document.documentElement.dataset.ready = 'failed';
});
