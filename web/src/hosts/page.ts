// The page that `wavesplat view` opens. The token of the link goes where nobody sees it, and out of the address.

import { socketChannel } from "../engine/channel_socket.ts";
import { remoteEngine } from "../engine/remote.ts";
import { mountApp } from "../view/app.tsx";

const KEY = "wavesplat-session";

export function openPage(element: HTMLElement): () => void {
  const parts = new URLSearchParams(location.hash.slice(1));
  const [token, link] = [parts.get("token"), parts.get("state") ?? undefined];
  history.replaceState(null, "", location.pathname);
  document.documentElement.style.height = "100%";
  document.body.style.cssText = "margin:0;height:100%;background:#0d1014";
  element.style.cssText = "display:block;height:100vh";
  const channel = socketChannel(`ws://${location.host}/socket`);
  let unused = token;
  const engine = remoteEngine(channel, {
    hello: () => {
      const session = stored();
      return { ...(unused === null ? {} : { token: unused }), ...(session === null ? {} : { session }) };
    },
    onOtherData: () => location.reload(),
    onSession: (key) => {
      unused = null;
      sessionStorage.setItem(KEY, key);
      // A window that is opened from here gets in too.
      localStorage.setItem(`${KEY}:${location.host}`, key);
    },
  });
  // The program was started again, and another window has come in by its new link.
  const onStorage = ({ key }: StorageEvent): void => {
    if (key === `${KEY}:${location.host}`) engine.retry();
  };
  window.addEventListener("storage", onStorage);
  const onVolumes = (names: readonly string[]): void => {
    document.title = `${names.join(", ")} – Wavesplat`;
  };
  const unmount = mountApp(element, engine, { kind: "page", link, onVolumes });
  return () => {
    window.removeEventListener("storage", onStorage);
    unmount();
  };
}

function stored(): string | null {
  return localStorage.getItem(`${KEY}:${location.host}`) ?? sessionStorage.getItem(KEY);
}
