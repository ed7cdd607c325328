// The secret that the program printed with its address. It stands behind the '#', so that no request carries it by itself, and
// is taken away from there at once. It is kept until the tab is closed, so that the page can be loaded again.

const kKey = 'aerate-token';

export function takeToken(): string {
  const given = window.location.hash.slice(1);
  if (given) {
    window.history.replaceState(null, '', window.location.pathname);
    window.sessionStorage.setItem(kKey, given);
    return given;
  }
  return window.sessionStorage.getItem(kKey) ?? '';
}

// A new address in the same tab changes nothing but what is behind the '#'.
export function listenToAddress(): void {
  window.addEventListener('hashchange', () => {
    if (window.location.hash.length <= 1) return;
    takeToken();
    window.location.reload();
  });
}
