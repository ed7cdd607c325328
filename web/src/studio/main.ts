// The page of `aerate studio`.
import licence from '../../node_modules/three/LICENSE?raw';
import '../base.css';
import '../viewer.css';
import './studio.css';
import { byId, make } from '../dom';
import { Api } from './api';
import { listenToDrops } from './drop';
import { showForm } from './form_view';
import { showModels } from './models_view';
import { Session } from './session';
import { showTabs, showView } from './show_view';
import { showStart } from './start_view';
import { onChange, Store, type Connection } from './store';
import { listenToAddress, takeToken } from './token';

const kConnection: Readonly<Record<Connection, string>> = {
  opening: 'Asking the program …',
  open: '',
  lost: 'The program does not answer. Trying again …',
  refused: '',
};

function showConnection(store: Store): void {
  const words = byId('connection', HTMLParagraphElement);
  store.listen(
    onChange(
      (page) => page.connection,
      ({ connection }) => {
        words.textContent = kConnection[connection];
        words.classList.toggle('bad', connection === 'lost');
        document.documentElement.dataset.connection = connection;
        if (connection === 'refused') askForAddress();
      },
    ),
  );
  store.listen(onChange((page) => page.told, ({ told }) => (byId('version', HTMLParagraphElement).textContent = told?.version ?? '')));
}

// Without the token nothing else can be done here.
function askForAddress(): void {
  const printed = 'http://127.0.0.1:PORT/#…';
  byId('studio', HTMLElement).replaceChildren(
    make(
      'div',
      { class: 'welcome', role: 'alert' },
      make('h2', {}, 'This page needs the address that the program printed'),
      make('p', {}, 'Go to where ', make('code', {}, 'aerate studio'), ' was started, and open the address that it printed there, as a whole: ', make('code', {}, printed)),
      make('p', { class: 'note' }, 'What stands behind the # shows that it is you. It is new each time the program starts.'),
    ),
  );
}

function main(): void {
  const store = new Store();
  const session = new Session(new Api(takeToken()), store);
  const setup = byId('setup', HTMLFormElement);
  listenToAddress();
  showConnection(store);
  showModels(byId('models', HTMLElement), session);
  showForm(byId('print', HTMLElement), store);
  showStart(byId('start', HTMLElement), setup, session);
  showTabs(byId('tabs', HTMLElement), byId('view', HTMLElement), session);
  showView(byId('view', HTMLElement), session);
  listenToDrops(byId('over', HTMLElement), (files) => session.send(files));
  byId('start', HTMLElement).before(
    make(
      'details',
      { class: 'licences' },
      make('summary', {}, 'Licences'),
      make('p', {}, 'aerate: GPL-3.0-or-later. This page contains three.js:'),
      make('pre', {}, licence.trim()),
    ),
  );
  void session.run();
}

main();
