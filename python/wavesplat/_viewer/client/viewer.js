// Built from web/ by `make web`; change that, not this.
// src/engine/framing.ts
function packed(header, payload = new Uint8Array()) {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const message = new Uint8Array(4 + text.length + payload.length);
  new DataView(message.buffer).setUint32(0, text.length, true);
  message.set(text, 4);
  message.set(payload, 4 + text.length);
  return message;
}
function unpacked(message) {
  if (message.byteLength < 4) throw new Error("message: it is shorter than the length of a header");
  const length2 = new DataView(message).getUint32(0, true);
  if (length2 > message.byteLength - 4) throw new Error(`message: the header has ${length2} bytes, which did not come`);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(message, 4, length2)));
  if (typeof header !== "object" || header === null || Array.isArray(header)) {
    throw new Error("message: the header must be an object");
  }
  return { header, payload: new Uint8Array(message, 4 + length2) };
}

// src/engine/channel_socket.ts
var FIRST_WAIT_MS = 250;
var LONGEST_WAIT_MS = 8e3;
var REFUSED = [4400, 4401];
function socketChannel(url) {
  const messages = /* @__PURE__ */ new Set();
  const states = /* @__PURE__ */ new Set();
  let socket = null;
  let wait = FIRST_WAIT_MS;
  let timer;
  let isClosed = false;
  const open = () => {
    clearTimeout(timer);
    const opened = new WebSocket(url);
    opened.binaryType = "arraybuffer";
    socket = opened;
    opened.onopen = () => {
      states.forEach((listener) => listener({ kind: "open" }));
    };
    opened.onmessage = (event) => {
      wait = FIRST_WAIT_MS;
      const { header, payload } = unpacked(event.data);
      messages.forEach((listener) => listener(header, payload));
    };
    opened.onclose = (event) => {
      if (isClosed || socket !== opened) return;
      const retries = !REFUSED.includes(event.code);
      states.forEach((listener) => listener({ kind: "closed", reason: event.reason, retries }));
      if (!retries) return;
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  };
  queueMicrotask(open);
  return {
    send(header, payload) {
      if (socket?.readyState === WebSocket.OPEN) socket.send(packed(header, payload));
    },
    onMessage(listener) {
      messages.add(listener);
      return () => messages.delete(listener);
    },
    onState(listener) {
      states.add(listener);
      return () => states.delete(listener);
    },
    retry() {
      wait = FIRST_WAIT_MS;
      if (socket?.readyState !== WebSocket.OPEN) open();
    },
    close() {
      isClosed = true;
      clearTimeout(timer);
      socket?.close();
    }
  };
}

// src/state/patch.ts
var MOST_STEPS = 16;
function patched(document2, operations) {
  let changed = document2;
  operations.forEach((operation, number) => {
    const what = `patch: operations[${number}]: '${operation.path}'`;
    const value = operation.op === "remove" ? void 0 : operation.value;
    changed = done(changed, operation.op, stepsOf(operation.path, what), value, what);
  });
  return changed;
}
function pathOf(...steps) {
  return steps.map((step) => `/${String(step).replaceAll("~", "~0").replaceAll("/", "~1")}`).join("");
}
function set(value, ...steps) {
  return { op: typeof steps.at(-1) === "number" ? "replace" : "add", path: pathOf(...steps), value };
}
function stepsOf(path, what) {
  if (path !== "" && !path.startsWith("/")) throw new Error(`${what}: field 'path' must be '' or begin with '/'`);
  const steps = path.split("/").slice(1).map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));
  if (steps.length > MOST_STEPS) throw new Error(`${what}: field 'path' has ${steps.length} steps`);
  return steps;
}
function done(inside, op, steps, value, what) {
  const [step, ...rest] = steps;
  if (step === void 0) {
    if (op === "remove") throw new Error(`${what}: the whole document cannot be removed`);
    return value;
  }
  if (Array.isArray(inside)) return doneInList([...inside], op, step, rest, value, what);
  if (typeof inside !== "object" || inside === null) throw new Error(`${what}: before '${step}' stands no object`);
  const fields = inside;
  if ((rest.length > 0 || op !== "add") && !Object.hasOwn(fields, step)) {
    throw new Error(`${what}: there is no field '${step}'`);
  }
  if (rest.length === 0 && op === "remove") {
    return Object.fromEntries(Object.entries(fields).filter(([name]) => name !== step));
  }
  const inner = rest.length > 0 ? done(fields[step], op, rest, value, what) : value;
  return Object.fromEntries([...Object.entries(fields).filter(([name]) => name !== step), [step, inner]]);
}
function doneInList(items, op, step, rest, value, what) {
  if (step === "-" && op === "add" && rest.length === 0) return [...items, value];
  if (!/^(0|[1-9][0-9]{0,8})$/.test(step)) throw new Error(`${what}: '${step}' is no place in a list`);
  const place = Number(step);
  if (place > items.length || place === items.length && (rest.length > 0 || op !== "add")) {
    throw new Error(`${what}: the list has ${items.length} items, so there is none at ${place}`);
  }
  if (rest.length > 0) items[place] = done(items[place], op, rest, value, what);
  else if (op === "add") items.splice(place, 0, value);
  else if (op === "remove") items.splice(place, 1);
  else items[place] = value;
  return items;
}

// src/engine/remote.ts
var BUSY_MS = 600;
function remoteEngine(channel, options) {
  const frames = /* @__PURE__ */ new Set();
  const states = /* @__PURE__ */ new Set();
  const connections = /* @__PURE__ */ new Set();
  const problems = /* @__PURE__ */ new Set();
  const waiting = /* @__PURE__ */ new Map();
  const sizes = /* @__PURE__ */ new Map();
  const nextFrame = options.nextFrame ?? ((callback) => void requestAnimationFrame(callback));
  let welcomed = () => void 0;
  let failed = () => void 0;
  const welcome = new Promise((resolve, reject) => {
    welcomed = resolve;
    failed = reject;
  });
  welcome.catch(() => void 0);
  let state = null;
  let seq = 0;
  let nextId = 1;
  let outgoing = [];
  let isMoving = false;
  let isScheduled = false;
  let isOpen = false;
  let helloTimer;
  let busyTimer;
  let isBusy = false;
  const tell = (connection) => connections.forEach((listener) => listener(connection));
  const heard = () => {
    clearTimeout(busyTimer);
    busyTimer = void 0;
    if (isBusy) {
      isBusy = false;
      tell({ kind: "open" });
    }
  };
  const expect = () => {
    busyTimer ??= setTimeout(() => {
      busyTimer = void 0;
      if (!isOpen) return;
      isBusy = true;
      tell({ kind: "busy", text: "No answer yet: what draws is busy" });
    }, BUSY_MS);
  };
  const flush = () => {
    isScheduled = false;
    if (!isOpen) return;
    channel.send({ type: "patch", seq, operations: outgoing, moving: isMoving });
    if (outgoing.length > 0 && sizes.size > 0) expect();
    outgoing = [];
  };
  const sayHello = () => channel.send({ type: "hello", protocol: 1, ...options.hello() });
  const start = (header) => {
    clearInterval(helloTimer);
    if (typeof header["session"] === "string") options.onSession?.(header["session"]);
    const isFirst = state === null;
    isOpen = true;
    if (isFirst) {
      state = header.state;
      welcomed(header);
    }
    for (const [view, { width, height }] of sizes) channel.send({ type: "view", view, size: [width, height] });
    if (!isFirst && state !== null) {
      outgoing = [{ op: "replace", path: "", value: state }];
      isMoving = false;
      flush();
    }
    tell({ kind: "open" });
  };
  const fail = (header) => {
    const problem = {
      code: String(header["code"] ?? "failed"),
      message: String(header["message"] ?? "it failed without a reason"),
      ...typeof header["field"] === "string" ? { field: header["field"] } : {},
      ...typeof header["remedy"] === "string" ? { remedy: header["remedy"] } : {}
    };
    const id = header["id"];
    if (typeof id === "number") {
      waiting.get(id)?.reject(problem);
      waiting.delete(id);
      return;
    }
    if (state === null) {
      failed(problem);
      tell({ kind: "lost", problem, retries: false });
      return;
    }
    problems.forEach((listener) => listener(problem));
  };
  const receive = (header, payload) => {
    heard();
    switch (header["type"]) {
      case "welcome":
        start(header);
        return;
      case "progress": {
        const part = typeof header["part"] === "number" ? header["part"] : void 0;
        if (typeof header["id"] === "number") waiting.get(header["id"])?.progress?.(part ?? 0);
        else {
          const text = String(header["text"] ?? "");
          tell(part === void 0 ? { kind: "connecting", text } : { kind: "connecting", text, part });
        }
        return;
      }
      case "patch": {
        const operations = header["operations"];
        if (state !== null) state = patched(state, operations);
        states.forEach((listener) => listener(operations));
        return;
      }
      case "frame":
        frames.forEach((listener) => listener({ ...header, bytes: payload }));
        return;
      case "answer": {
        const one = waiting.get(Number(header["id"]));
        waiting.delete(Number(header["id"]));
        one?.resolve(payload.length > 0 ? { ...header, bytes: payload } : header);
        return;
      }
      case "failed":
        fail(header);
        return;
      default:
    }
  };
  channel.onMessage(receive);
  channel.onState((next) => {
    if (next.kind === "open") {
      if (state === null) tell({ kind: "connecting", text: "Opening" });
      sayHello();
      clearInterval(helloTimer);
      if (options.repeatHelloMs) helloTimer = setInterval(sayHello, options.repeatHelloMs);
      return;
    }
    isOpen = false;
    heard();
    clearInterval(helloTimer);
    for (const one of waiting.values()) one.reject({ code: "lost", message: "the connection was lost" });
    waiting.clear();
    const problem = next.retries ? {
      code: "lost",
      message: "The connection to the program that draws is lost",
      remedy: "If it was stopped, start it again with the same --port; what you changed here is kept."
    } : {
      code: "refused",
      message: next.reason || "The program that draws refused this page",
      remedy: "Open the link that the command has printed, or a new one."
    };
    if (!next.retries && state === null) failed(problem);
    tell({ kind: "lost", problem, retries: next.retries });
  });
  return {
    welcome,
    patch(operations, moving) {
      if (state !== null) state = patched(state, operations);
      seq += 1;
      outgoing.push(...operations);
      isMoving = moving;
      if (!isScheduled) {
        isScheduled = true;
        nextFrame(flush);
      }
      return seq;
    },
    show(view, size) {
      if (size === null) sizes.delete(view);
      else sizes.set(view, size);
      if (isOpen) channel.send({ type: "view", view, size: size === null ? null : [size.width, size.height] });
    },
    shown(frame) {
      channel.send({ type: "shown", view: frame.view, frame: frame.number });
    },
    onFrame: (listener) => added(frames, listener),
    onState: (listener) => added(states, listener),
    onConnection: (listener) => added(connections, listener),
    onProblem: (listener) => added(problems, listener),
    ask(name, question, progress, signal) {
      const id = nextId;
      nextId += 1;
      return new Promise((resolve, reject) => {
        waiting.set(id, { resolve, reject, progress });
        signal?.addEventListener("abort", () => {
          channel.send({ type: "cancel", id });
        });
        if (!isOpen) {
          waiting.delete(id);
          reject({ code: "lost", message: "the connection was lost" });
          return;
        }
        channel.send({ type: "ask", id, question: name, arguments: question });
      });
    },
    retry: () => channel.retry(),
    close() {
      clearInterval(helloTimer);
      clearTimeout(busyTimer);
      channel.close();
    }
  };
}
function added(listeners, listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

// node_modules/preact/dist/preact.mjs
var n;
var t;
var r;
var u;
var i;
var f;
var o;
var e;
var l;
var c;
var a;
var s;
var h = /* @__PURE__ */ Symbol.for("pv");
var p = {};
var y = [];
var v = /^m(i|n|o|s|text|space)$/;
var w = Array.isArray;
var d = y.slice;
var _ = Object.assign;
function g(n2) {
  n2 && n2.parentNode && n2.remove();
}
function m(r3, u3, i3, f4, o4) {
  var e3 = { type: r3, props: u3, key: i3, ref: f4, __k: null, __: null, __b: 0, __e: null, __c: null, constructor: h, __v: o4 || ++t, __i: -1, __u: 0 };
  return !o4 && n.vnode && n.vnode(e3), e3;
}
function $(n2) {
  return n2.children;
}
function x(n2, t3) {
  this.props = n2, this.context = t3, this.__g = 0;
}
function S(n2, t3) {
  if (null == t3) return n2.__ && S(n2.__, n2.__i + 1);
  for (var r3; t3 < n2.__k.length; t3++) if ((r3 = n2.__k[t3]) && r3.__e) return r3.__e;
  return "function" != typeof n2.type || n2.props.__P ? null : S(n2);
}
function C(t3) {
  var r3, u3 = t3.__v, i3 = u3.__e, f4 = [], o4 = [], e3 = t3.__P;
  e3 && ((r3 = _({ constructor: h }, u3)).__v = u3.__v + 1, n.vnode && n.vnode(r3), z(e3, r3, u3, t3.__n, e3.namespaceURI, 32 & u3.__u ? [i3] : null, f4, i3 || S(u3), 32 & u3.__u, o4), r3.__v = u3.__v, r3.__.__k[r3.__i] = r3, E(f4, r3, o4), u3.__ = u3.__e = null, r3.__e != i3 && j(r3));
}
function j(n2) {
  if ((n2 = n2.__) && n2.__c && !n2.props.__P) return n2.__e = null, n2.__k.some(function(t3) {
    return t3 && (n2.__e = t3.__e);
  }), j(n2);
}
function L(t3) {
  (8 & t3.__g || (t3.__g |= 8, u.push(t3), f++)) && i == n.debounceRendering || ((i = n.debounceRendering) || queueMicrotask)(H);
}
function H() {
  try {
    for (var n2, t3 = 1; u.length; ) u.length > t3 && u.sort(o), n2 = u.shift(), t3 = u.length, 8 & n2.__g && C(n2);
  } finally {
    (f = u.length) && (i || queueMicrotask)(H);
  }
}
function I(n2, t3, r3, u3, i3, f4, o4, e3, l3, c3, a4) {
  var s3, h3, v3, w3, d3, _3, g3 = u3.__k || y, k2 = t3.length;
  for (l3 = q(r3, t3, g3, l3, k2), s3 = 0; s3 < k2; s3++) null != (v3 = r3.__k[s3]) && (h3 = ~v3.__i && g3[v3.__i] || p, v3.__i = s3, _3 = z(n2, v3, h3, i3, f4, o4, e3, l3, c3, a4), w3 = v3.__e, (h3.ref != v3.ref || 8 & h3.__u) && (h3.ref && G(h3.ref, null, v3, h3), v3.ref && a4.push(v3.ref, v3.__c || w3, v3)), d3 = d3 || w3, 4 & v3.__u ? (l3 = A(v3, l3, n2, !h3.__v), h3.__e && (h3.__e = null)) : "function" == typeof v3.type && void 0 !== _3 ? l3 = _3 : w3 && (l3 = w3.nextSibling), v3.__u &= -21);
  return r3.__e = d3, l3;
}
function q(n2, t3, r3, u3, i3) {
  var f4, o4, e3, l3, c3, a4, s3, p3, y3, v3 = r3.length, d3 = v3, _3 = 0, g3 = 0, k2 = n2.__k = Array(i3);
  for (f4 = 0; f4 < i3; f4++) null != (o4 = t3[f4]) && "boolean" != typeof o4 && "function" != typeof o4 ? ("object" != typeof o4 || o4.constructor === String ? o4 = k2[f4] = m(null, o4) : w(o4) ? o4 = k2[f4] = m($, { children: o4 }) : o4.constructor === h && o4.__b ? o4 = k2[f4] = m(o4.type, o4.props, o4.key, o4.ref, o4.__v) : k2[f4] = o4, l3 = f4 + _3, o4.__ = n2, o4.__b = n2.__b + 1, e3 = null, ~(c3 = o4.__i = P(o4, r3, l3, d3)) && (d3--, (e3 = r3[c3]) && (e3.__u |= 2)), e3 && e3.__v ? (o4.__u |= 16, c3 == l3 - 1 ? _3-- : c3 == l3 + 1 ? _3++ : c3 != l3 && (c3 > l3 ? _3-- : _3++, g3 = 1)) : (~c3 || (i3 > v3 ? _3-- : i3 < v3 && _3++), "function" != typeof o4.type && (o4.__u |= 4))) : k2[f4] = null;
  if (g3) {
    for (a4 = [], s3 = [], f4 = 0; f4 < i3; f4++) if ((o4 = k2[f4]) && 16 & o4.__u) {
      for (_3 = 0, p3 = a4.length; _3 < p3; ) a4[y3 = _3 + p3 >> 1] < o4.__i ? _3 = y3 + 1 : p3 = y3;
      a4[_3] = o4.__i, s3[f4] = _3 + 1;
    }
    for (_3 = a4.length; f4--; ) s3[f4] && (s3[f4] == _3 ? _3-- : k2[f4].__u |= 4);
  }
  if (d3) for (f4 = 0; f4 < v3; f4++) !(e3 = r3[f4]) || 2 & e3.__u || (e3.__e == u3 && (u3 = S(e3)), J(e3, e3));
  return u3;
}
function A(n2, t3, r3, u3) {
  var i3, f4, o4, e3;
  if ("function" == typeof n2.type) {
    if (n2.props.__P) return t3;
    if (i3 = n2.__k) for (f4 = 0; f4 < i3.length; f4++) i3[f4] && (i3[f4].__ = n2, t3 = A(i3[f4], t3, r3, false));
    return t3;
  }
  for (t3 && !t3.parentNode && (t3 = S(n2)) && !t3.parentNode && (t3 = null), o4 = n2.__e, e3 = t3; e3 && 8 == e3.nodeType; ) e3 = e3.nextSibling;
  for (o4 != e3 && (!u3 && r3.moveBefore && o4.parentNode ? r3.moveBefore(o4, t3) : r3.insertBefore(o4, t3 || null)), t3 = o4; (t3 = t3 && t3.nextSibling) && 8 == t3.nodeType && !t3.data.startsWith("$s"); ) ;
  return t3;
}
function P(n2, t3, r3, u3) {
  var i3, f4 = n2.key, o4 = n2.type, e3 = t3[r3], l3 = e3 && !(2 & e3.__u);
  if (null === e3 && null == f4 || l3 && f4 == e3.key && o4 == e3.type) return r3;
  if (u3 > (l3 ? 1 : 0)) {
    for (i3 = r3 - 1; i3 >= 0; i3--) if ((e3 = t3[i3]) && !(2 & e3.__u) && f4 == e3.key && o4 == e3.type) return i3;
    for (i3 = r3 + 1; i3 < t3.length; i3++) if ((e3 = t3[i3]) && !(2 & e3.__u) && f4 == e3.key && o4 == e3.type) return i3;
  }
  return -1;
}
function T(n2, t3, r3) {
  null == r3 && (r3 = ""), "-" == t3[0] ? n2.setProperty(t3, r3) : n2[t3] = r3;
}
function N(n2, t3, r3, u3, i3) {
  var f4, o4;
  if ("style" == t3) if ("string" == typeof r3) n2.style.cssText = r3;
  else {
    if ("string" == typeof u3 && (n2.style.cssText = u3 = ""), u3) for (t3 in u3) r3 && t3 in r3 || T(n2.style, t3);
    if (r3) for (t3 in r3) u3 && r3[t3] == u3[t3] || T(n2.style, t3, r3[t3]);
  }
  else if ("o" == t3[0] && "n" == t3[1]) "function" != typeof r3 && (r3 = null), "function" != typeof u3 && (u3 = null), (n2.__e || (n2.__e = {}))[t3] = r3, r3 && u3 || (o4 = a[t3] || (a[t3] = V(t3)), (n2.__a || (n2.__a = {}))[t3] = c, f4 = t3 != (t3 = t3.replace(l, "$1")), (t3 = t3.slice(2))[0] < "a" && (t3 = t3.toLowerCase()), r3 ? n2.addEventListener(t3, o4, f4) : n2.removeEventListener(t3, o4, f4));
  else {
    if ("http://www.w3.org/2000/svg" == i3) t3 = t3.replace(/xlink(H|:h)/, "h").replace(/sName$/, "s");
    else if ("width" != t3 && "height" != t3 && "href" != t3 && "list" != t3 && "form" != t3 && "tabIndex" != t3 && "download" != t3 && "rowSpan" != t3 && "colSpan" != t3 && "role" != t3 && "popover" != t3 && t3 in n2) try {
      return void (n2[t3] = null == r3 ? "" : r3);
    } catch (n3) {
    }
    if ("function" == typeof r3) return;
    null == r3 || false === r3 && "-" != t3[4] ? n2.removeAttribute(t3) : n2.setAttribute(t3, "popover" == t3 && 1 == r3 ? "" : r3);
  }
}
function V(t3) {
  return function(r3) {
    var u3 = this.__e;
    if (u3) {
      if (u3 = u3[t3], null == r3[e]) r3[e] = c++;
      else if (r3[e] < this.__a[t3]) return;
      return u3(n.event ? n.event(r3) : r3);
    }
  };
}
function z(t3, r3, u3, i3, f4, o4, e3, l3, c3, a4) {
  var s3, p3, v3, d3, k2, b, m3, M, C3, j2, L2, H2, q2, A3, O, P3, T3, N2, V2 = r3.type;
  if (r3.constructor !== h) return null;
  128 & u3.__u && (c3 = 32 & u3.__u, s3 = u3.__c.__z) && (r3.__u |= c3, p3 = o4 = [], 8 == s3.nodeType ? l3 = B(s3, o4) : o4.push(s3), l3 = o4[0] || l3), (s3 = n.__b) && s3(r3);
  n: if ("function" == typeof V2) {
    v3 = e3.length;
    try {
      if (M = r3.props, C3 = (s3 = V2.prototype) && s3.render, j2 = (s3 = V2.contextType) && i3[s3.__c], L2 = s3 ? j2 ? j2.props.value : s3.__ : i3, (d3 = u3.__c) ? (r3.__c = d3, 2 & d3.__g && (d3.__g |= 1)) : (C3 ? r3.__c = d3 = new V2(M, L2) : (r3.__c = d3 = new x(M, L2), d3.constructor = V2, d3.render = K), j2 && j2.sub(d3), d3.state || (d3.state = {}), d3.__n = i3, d3.__g |= 8, d3.__h = [], d3.__k = []), C3 && (d3.__s || (d3.__s = d3.state), V2.getDerivedStateFromProps && (d3.__s == d3.state && (d3.__s = _({}, d3.__s)), _(d3.__s, V2.getDerivedStateFromProps(M, d3.__s)))), k2 = d3.props, b = d3.state, d3.__v = r3, u3.__c) {
        if (M !== k2 && C3 && !V2.getDerivedStateFromProps && d3.componentWillReceiveProps && d3.componentWillReceiveProps(M, L2), r3.__v == u3.__v && !(8 & d3.__g) || !(4 & d3.__g) && d3.shouldComponentUpdate && false === d3.shouldComponentUpdate(M, d3.__s, L2)) {
          r3.__v != u3.__v && (d3.props = M, d3.state = d3.__s, d3.__g &= -9), r3.__e = u3.__e, r3.__k = u3.__k, r3.__k.some(function(n2) {
            n2 && (n2.__ = r3);
          }), y.push.apply(d3.__h, d3.__k), d3.__k = [], d3.__h.length && e3.push(d3), l3 = S(u3);
          break n;
        }
        d3.componentWillUpdate && d3.componentWillUpdate(M, d3.__s, L2), C3 && d3.componentDidUpdate && d3.__h.push(function() {
          d3.componentDidUpdate(k2, b, m3);
        });
      } else C3 && !V2.getDerivedStateFromProps && d3.componentWillMount && d3.componentWillMount(), C3 && d3.componentDidMount && d3.__h.push(d3.componentDidMount);
      d3.context = L2, d3.props = M, d3.__P = t3, d3.__g &= -5, H2 = n.__r, q2 = C3 ? 25 : 0;
      do {
        d3.__g &= -9, H2 && H2(r3), s3 = d3.render(d3.props, d3.state = d3.__s, d3.context);
      } while (8 & d3.__g && ++q2 < 25);
      C3 && (y.push.apply(d3.__h, d3.__k), d3.__k = []), d3.state = d3.__s, d3.getChildContext && (i3 = _({}, i3, d3.getChildContext())), C3 && u3.__c && d3.getSnapshotBeforeUpdate && (m3 = d3.getSnapshotBeforeUpdate(k2, b)), A3 = s3 && s3.type === $ && null == s3.key ? s3.props.children : s3, M.__P && (s3 = l3, f4 = (t3 = M.__P).namespaceURI, c3 = o4 = null, u3.props && u3.props.__P != t3 && (u3.__k.some(function(n2) {
        n2 && J(n2, n2);
      }), u3.__k = null), l3 = u3.__k ? S(u3, 0) : null), l3 = I(t3, w(A3) ? A3 : [A3], r3, u3, i3, f4, o4, e3, l3, c3, a4), M.__P && (r3.__e = null, l3 = s3), r3.__u &= -161, p3 && p3.some(g), d3.__h.length && e3.push(d3), 1 & d3.__g && (d3.__g &= -4);
    } catch (t4) {
      if (e3.length = v3, r3.__v = null, c3 || o4) if (t4 && t4.then) {
        if (r3.__u |= 128 | c3, o4) {
          for (~(T3 = o4.indexOf(l3 || void 0)) || (T3 = o4.length); (N2 = o4[T3 - 1]) && 8 == N2.nodeType; ) T3--;
          for (; T3 < o4.length; T3++) if (N2 = o4[T3]) if (o4[T3] = null, O) {
            if (N2 == P3) break;
          } else {
            if (8 != N2.nodeType) break;
            N2.data.startsWith("$s") && (P3 = B(O = N2));
          }
        }
        if (!O) {
          for (; l3 && 8 == l3.nodeType && l3.nextSibling; ) l3 = l3.nextSibling;
          O = l3;
        }
        (s3 = B(O = r3.__c.__z || (r3.__c.__z = O))) ? (r3.__e = O, l3 = s3) : r3.__e = l3, l3 = l3 && l3.nextSibling;
      } else o4 && o4.some(g);
      else r3.__e = u3.__e;
      r3.__k || (r3.__k = u3.__k || []), t4 && t4.then || D(r3), n.__e(t4, r3, u3);
    }
  } else l3 = r3.__e = F(u3.__e, r3, u3, i3, f4, o4, e3, c3, a4, t3);
  return (s3 = n.diffed) && s3(r3), l3;
}
function B(n2, t3) {
  if (n2 && 8 == n2.nodeType && n2.data.startsWith("$s")) for (var r3 = 1; n2 = n2.nextSibling; ) {
    if (8 == n2.nodeType) {
      if (n2.data.startsWith("$s")) r3++;
      else if (n2.data.startsWith("/$s") && !--r3) return n2;
    }
    t3 && t3.push(n2);
  }
}
function D(n2) {
  n2 && (n2.__c && (n2.__c.__g |= 4), n2.__k && n2.__k.some(D));
}
function E(t3, r3, u3) {
  for (var i3 = 0; i3 < u3.length; ) G(u3[i3++], u3[i3++], u3[i3++]);
  n.__c && n.__c(r3, t3), t3.some(function(r4) {
    try {
      t3 = r4.__h, r4.__h = [], t3.some(function(n2) {
        n2.call(r4);
      });
    } catch (t4) {
      n.__e(t4, r4.__v);
    }
  });
}
function F(t3, r3, u3, i3, f4, o4, e3, l3, c3, a4) {
  var s3, h3, y3, _3, k2, b, m3, M, $2 = u3.props || p, x2 = r3.props, C3 = r3.type;
  if ("svg" == C3 ? f4 = "http://www.w3.org/2000/svg" : "math" == C3 ? f4 = "http://www.w3.org/1998/Math/MathML" : f4 || (f4 = "http://www.w3.org/1999/xhtml"), o4) {
    for (s3 = 0; s3 < o4.length; s3++) if ((k2 = o4[s3]) && (C3 ? k2.localName == C3 : 3 == k2.nodeType)) {
      t3 = k2, o4[s3] = null;
      break;
    }
  }
  if (!t3) {
    if (M = a4.ownerDocument || document, !C3) return M.createTextNode(x2);
    t3 = M.createElementNS(f4, C3, x2.is ? x2 : a4), l3 && (n.__m && n.__m(r3, o4), l3 = false), o4 = null;
  }
  if (C3) {
    if (a4 = "template" == C3 && t3.content || t3, o4 = "textarea" == C3 && null != x2.defaultValue ? null : o4 && d.call(a4.childNodes), !l3 && o4) for ($2 = {}, s3 = 0; s3 < t3.attributes.length; s3++) $2[(k2 = t3.attributes[s3]).name] = k2.value;
    for (s3 in $2) k2 = $2[s3], "dangerouslySetInnerHTML" == s3 ? y3 = k2 : "children" == s3 || s3 in x2 || "value" == s3 && "defaultValue" in x2 || "checked" == s3 && "defaultChecked" in x2 || N(t3, s3, null, k2, f4);
    for (s3 in x2) k2 = x2[s3], "children" == s3 ? _3 = k2 : "dangerouslySetInnerHTML" == s3 ? h3 = k2 : "value" == s3 ? b = k2 : "checked" == s3 ? m3 = k2 : l3 && "function" != typeof k2 || $2[s3] === k2 || N(t3, s3, k2, $2[s3], f4);
    h3 ? (l3 || y3 && (h3.__html == y3.__html || h3.__html == t3.innerHTML) || (t3.innerHTML = h3.__html), r3.__k = []) : (y3 && (t3.textContent = ""), ("foreignObject" == C3 || "http://www.w3.org/1998/Math/MathML" == f4 && v.test(C3)) && (f4 = "http://www.w3.org/1999/xhtml"), I(a4, w(_3) ? _3 : [_3], r3, u3, i3, f4, o4, e3, o4 ? o4[0] : u3.__k && S(u3, 0), l3, c3), o4 && o4.some(g)), l3 && "textarea" != C3 || (s3 = "value", "progress" == C3 && null == b ? t3.removeAttribute(s3) : null == b || b === t3[s3] && ("progress" != C3 || b) || N(t3, s3, b, $2[s3], f4), s3 = "checked", null != m3 && m3 != t3[s3] && N(t3, s3, m3, $2[s3], f4));
  } else $2 === x2 || l3 && t3.data == x2 || (t3.data = x2);
  return t3;
}
function G(t3, r3, u3, i3) {
  try {
    "function" == typeof t3 ? r3 ? r3.__x = t3(r3) || 1 : i3 && (i3 = i3.__c || i3.__e) && (r3 = i3.__x) && (i3.__x = null, "function" == typeof r3 ? r3() : t3(null)) : t3.current = r3;
  } catch (t4) {
    n.__e(t4, u3);
  }
}
function J(t3, r3, u3) {
  var i3, f4, o4, e3;
  if (n.unmount && n.unmount(t3), !(i3 = t3.ref) || i3.current && i3.current != t3.__e || G(i3, null, r3, t3), i3 = t3.__c) {
    if (i3.componentWillUnmount) try {
      i3.componentWillUnmount();
    } catch (t4) {
      n.__e(t4, r3);
    }
    i3.__P = i3.__n = null;
  }
  if (i3 = t3.__k) for (e3 = 0; e3 < i3.length; e3++) i3[e3] && J(i3[e3], r3, "function" != typeof t3.type || u3 && !t3.props.__P);
  !u3 && (i3 = t3.__c) && (i3 = i3.__z) && (f4 = B(i3, o4 = [])) && (i3 == t3.__e && o4.some(g), g(f4), g(i3)), u3 || g(t3.__e), t3.__e = t3.__c = t3.__ = null;
}
function K(n2, t3, r3) {
  return this.constructor(n2, r3);
}
function Q(t3, r3) {
  var u3, i3, f4, o4;
  n.__ && n.__(t3, r3), 9 == r3.nodeType && (r3 = r3.documentElement), i3 = (u3 = t3 && 32 & t3.__u) ? null : r3.__k, r3.__k = m($, { children: [t3] }), f4 = [], o4 = [], z(r3, r3.__k, i3 || p, p, r3.namespaceURI, i3 ? null : r3.firstChild ? d.call(r3.childNodes) : null, f4, i3 ? i3.__e : r3.firstChild, u3, o4), E(f4, r3.__k, o4), r3.__k.props.children = null;
}
n = { __e: function(n2, t3, r3, u3) {
  for (var i3, o4, e3; t3 = t3.__; ) if ((i3 = t3.__c) && !(1 & i3.__g)) {
    i3.__g |= 4;
    try {
      if ((e3 = (o4 = i3.constructor) && o4.getDerivedStateFromError) && i3.setState(o4.getDerivedStateFromError(n2)), i3.componentDidCatch && (i3.componentDidCatch(n2, u3 || {}), e3 = 1), e3 && 8 & i3.__g) return void (i3.__g |= 2);
    } catch (t4) {
      n2 = t4;
    }
  }
  throw f = 0, n2;
} }, t = 0, r = function(n2) {
  return null != n2 && n2.constructor === h;
}, x.prototype.setState = function(n2, t3) {
  var r3 = this.__s;
  r3 && r3 != this.state || (r3 = this.__s = _({}, this.state)), "function" == typeof n2 && (n2 = n2(_({}, r3), this.props)), n2 && (_(r3, n2), this.__v && (t3 && this.__k.push(t3), L(this)));
}, x.prototype.forceUpdate = function(n2) {
  this.__v && (this.__g |= 4, n2 && this.__h.push(n2), L(this));
}, x.prototype.render = $, u = [], f = 0, o = function(n2, t3) {
  return n2.__v.__b - t3.__v.__b;
}, e = /* @__PURE__ */ Symbol(), l = /(PointerCapture)$|Capture$/i, c = 0, a = {}, s = 0;

// src/input/keys.ts
var KEYS = [
  { keys: ["ArrowLeft"], action: "turn-left", shown: "←", text: "Turn to the left" },
  { keys: ["ArrowRight"], action: "turn-right", shown: "→", text: "Turn to the right" },
  { keys: ["ArrowUp"], action: "turn-up", shown: "↑", text: "Turn upwards" },
  { keys: ["ArrowDown"], action: "turn-down", shown: "↓", text: "Turn downwards" },
  { keys: ["Shift+ArrowLeft"], action: "pan-left", shown: "Shift ←", text: "Move to the left" },
  { keys: ["Shift+ArrowRight"], action: "pan-right", shown: "Shift →", text: "Move to the right" },
  { keys: ["Shift+ArrowUp"], action: "pan-up", shown: "Shift ↑", text: "Move up" },
  { keys: ["Shift+ArrowDown"], action: "pan-down", shown: "Shift ↓", text: "Move down" },
  { keys: ["+", "="], action: "zoom-in", shown: "+", text: "Magnify" },
  { keys: ["-", "_"], action: "zoom-out", shown: "−", text: "Make smaller" },
  { keys: [","], action: "roll-left", shown: ",", text: "Roll to the left" },
  { keys: ["."], action: "roll-right", shown: ".", text: "Roll to the right" },
  { keys: ["1"], action: "view-front", shown: "1", text: "From the front" },
  { keys: ["2"], action: "view-back", shown: "2", text: "From the back" },
  { keys: ["3"], action: "view-left", shown: "3", text: "From the left" },
  { keys: ["4"], action: "view-right", shown: "4", text: "From the right" },
  { keys: ["5"], action: "view-top", shown: "5", text: "From above" },
  { keys: ["6"], action: "view-bottom", shown: "6", text: "From below" },
  { keys: ["0"], action: "fit", shown: "0", text: "Fit all into view" },
  { keys: ["["], action: "slice-back", shown: "[", text: "Slice before" },
  { keys: ["]"], action: "slice-on", shown: "]", text: "Next slice" },
  { keys: ["Ctrl+z"], action: "undo", shown: "Ctrl Z", text: "Undo" },
  { keys: ["Ctrl+Shift+Z", "Ctrl+y"], action: "redo", shown: "Ctrl Shift Z", text: "Redo" },
  { keys: ["?"], action: "help", shown: "?", text: "Show this table" },
  { keys: ["Escape"], action: "leave", shown: "Esc", text: "End what was begun" }
];
var GESTURES = [
  ["Drag", "Turn"],
  ["Shift drag, or middle button", "Move"],
  ["Wheel, or right button", "Magnify"],
  ["Ctrl drag", "Roll"],
  ["Alt drag", "Window and level: of slices, in space of the opacities and colours"],
  ["Ctrl click", "Put the crosshair on what is seen there"],
  ["Double click in a slice", "Window as it was"],
  ["One finger, two fingers", "Turn; move, magnify and roll"]
];
function keyName(event) {
  if (event.altKey) return "";
  const isLetter = event.key.length > 1 || /[a-z]/i.test(event.key);
  const shift = event.shiftKey && isLetter ? "Shift+" : "";
  return `${event.ctrlKey || event.metaKey ? "Ctrl+" : ""}${shift}${event.key}`;
}
function actionOf(name) {
  return KEYS.find(({ keys }) => keys.includes(name))?.action;
}

// src/state/link.ts
var MOST_CHARACTERS = 8e3;
async function linkPart(state, fingerprint) {
  const text = JSON.stringify({ fingerprint, state });
  const packed2 = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  const part = btoa(Array.from(packed2, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return part.length > MOST_CHARACTERS ? null : part;
}
async function fromLink(part) {
  const binary = atob(part.replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const text = new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw")));
  const found = JSON.parse(text);
  if (typeof found !== "object" || found === null || !("fingerprint" in found) || !("state" in found)) {
    throw new Error("the link holds no state of the viewer");
  }
  return { fingerprint: String(found.fingerprint), state: found.state };
}
async function through(bytes, stream) {
  const piped = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(piped).arrayBuffer());
}

// src/state/state.ts
var PANES = ["axial", "coronal", "sagittal"];
var OVERLAYS = ["scale_bar", "letters", "cube", "color_bar", "crosshair", "crop_box", "legend"];

// src/state/store.ts
var MOST_STEPS2 = 200;
var INTERFACE = ["/view/interface", "/view/layout"];
function createStore(initial, engine) {
  let state = initial;
  let seq = 0;
  let gesture = null;
  let past = [];
  let future = [];
  const listeners = /* @__PURE__ */ new Set();
  const tell = () => listeners.forEach((listener) => listener());
  const remember = (before) => {
    past = [...past.slice(1 - MOST_STEPS2), before];
    future = [];
  };
  const go = (target) => {
    const { layout, interface: shown } = state.view;
    state = { ...target, view: { ...target.view, layout, interface: shown } };
    gesture = null;
    seq = engine.patch([{ op: "replace", path: "", value: state }], false);
    tell();
  };
  engine.onState((operations) => {
    state = patched(state, operations);
    tell();
  });
  return {
    get state() {
      return state;
    },
    get seq() {
      return seq;
    },
    change(operations, name) {
      const before = state;
      state = patched(state, operations);
      const isStep = operations.some(({ path }) => !INTERFACE.some((start) => path.startsWith(start)));
      if (isStep && (name === void 0 || name !== gesture)) remember(before);
      if (isStep) gesture = name ?? null;
      seq = engine.patch(operations, name !== void 0);
      tell();
    },
    settle() {
      if (gesture === null) return;
      gesture = null;
      seq = engine.patch([], false);
    },
    undo() {
      const target = past.at(-1);
      if (target === void 0) return;
      past = past.slice(0, -1);
      future = [...future, state];
      go(target);
    },
    redo() {
      const target = future.at(-1);
      if (target === void 0) return;
      future = future.slice(0, -1);
      past = [...past, state];
      go(target);
    },
    get canUndo() {
      return past.length > 0;
    },
    get canRedo() {
      return future.length > 0;
    },
    subscribe(listener) {
      listeners.add(listener);
      return () => listeners.delete(listener);
    }
  };
}

// src/input/camera.ts
var TURN_DEG = 180;
var LEAST_ANGLE_DEG = 0.01;
var MOST_ANGLE_DEG = 170;
var add = (a4, b) => [a4[0] + b[0], a4[1] + b[1], a4[2] + b[2]];
var sub = (a4, b) => [a4[0] - b[0], a4[1] - b[1], a4[2] - b[2]];
var scaled = (a4, factor) => [a4[0] * factor, a4[1] * factor, a4[2] * factor];
var dot = (a4, b) => a4[0] * b[0] + a4[1] * b[1] + a4[2] * b[2];
var cross = (a4, b) => [
  a4[1] * b[2] - a4[2] * b[1],
  a4[2] * b[0] - a4[0] * b[2],
  a4[0] * b[1] - a4[1] * b[0]
];
var length = (a4) => Math.hypot(a4[0], a4[1], a4[2]);
var unit = (a4) => scaled(a4, 1 / length(a4));
function axesOf(camera) {
  const back = unit(sub(camera.position, camera.focal_point));
  const right = unit(cross(camera.view_up, back));
  return { right, up: cross(back, right), back };
}
function turnedAbout(vector2, axis, angle) {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return add(
    add(scaled(vector2, cos), scaled(cross(axis, vector2), sin)),
    scaled(axis, dot(axis, vector2) * (1 - cos))
  );
}
function turned(camera, dx, dy, height) {
  const radians = TURN_DEG * Math.PI / 180 / height;
  const { right, up } = axesOf(camera);
  const about = (vector2) => turnedAbout(turnedAbout(vector2, up, -dx * radians), right, -dy * radians);
  return {
    ...camera,
    position: add(camera.focal_point, about(sub(camera.position, camera.focal_point))),
    view_up: about(up)
  };
}
function rolled(camera, angle) {
  const { back, up } = axesOf(camera);
  return { ...camera, view_up: turnedAbout(up, back, angle) };
}
function unitsPerPixel(camera, height, distance2) {
  if (camera.parallel_scale !== void 0) return 2 * camera.parallel_scale / height;
  const away = distance2 ?? length(sub(camera.position, camera.focal_point));
  return 2 * away * Math.tan((camera.view_angle ?? 30) / 2 * Math.PI / 180) / height;
}
function panned(camera, dx, dy, height) {
  const { right, up } = axesOf(camera);
  const pixel = unitsPerPixel(camera, height);
  const way = add(scaled(right, -dx * pixel), scaled(up, dy * pixel));
  return { ...camera, position: add(camera.position, way), focal_point: add(camera.focal_point, way) };
}
function zoomed(camera, factor) {
  if (camera.parallel_scale !== void 0) return { ...camera, parallel_scale: camera.parallel_scale / factor };
  const away = sub(camera.position, camera.focal_point);
  return { ...camera, position: add(camera.focal_point, scaled(away, 1 / factor)) };
}
function withLens(camera, angle) {
  const { parallel_scale: _scale, view_angle: _angle, ...place } = camera;
  const { back } = axesOf(camera);
  const half = unitsPerPixel(camera, 2);
  if (angle === void 0) return { ...place, parallel_scale: half };
  const bounded = Math.min(Math.max(angle, LEAST_ANGLE_DEG), MOST_ANGLE_DEG);
  const away = half / Math.tan(bounded / 2 * Math.PI / 180);
  return { ...place, position: add(camera.focal_point, scaled(back, away)), view_angle: bounded };
}
function project(camera, size, point) {
  const { right, up, back } = axesOf(camera);
  const away = sub(point, camera.position);
  const depth = -dot(away, back);
  if (camera.parallel_scale === void 0 && depth <= 0) return null;
  const pixel = unitsPerPixel(camera, size.height, depth);
  return { x: size.width / 2 + dot(away, right) / pixel, y: size.height / 2 - dot(away, up) / pixel, depth };
}
function ray(camera, size, x2, y3) {
  const { right, up, back } = axesOf(camera);
  const pixel = unitsPerPixel(camera, size.height, 1);
  const aside = add(scaled(right, (x2 - size.width / 2) * pixel), scaled(up, (size.height / 2 - y3) * pixel));
  if (camera.parallel_scale !== void 0) return { origin: add(camera.position, aside), direction: scaled(back, -1) };
  return { origin: camera.position, direction: unit(sub(aside, back)) };
}

// node_modules/preact/hooks/dist/hooks.mjs
var t2;
var r2;
var u2;
var i2;
var o2 = Object.is;
var f2 = 0;
var c2 = [];
var e2 = [];
var a2 = n;
var v2 = a2.__b;
var l2 = a2.__r;
var m2 = a2.diffed;
var h2 = a2.__c;
var s2 = a2.unmount;
var p2 = a2.__;
function y2(n2, t3) {
  a2.__h && a2.__h(r2, n2, f2 || t3), f2 = 0;
  var u3 = r2.__H || (r2.__H = { __: [], __h: [] });
  return n2 >= u3.__.length && u3.__.push({}), u3.__[n2];
}
function d2(n2) {
  return f2 = 1, _2(G2, n2);
}
function _2(n2, u3, i3) {
  var f4 = y2(t2++, 2);
  if (f4.t = n2, !f4.__c && (f4.__ = [i3 ? i3(u3) : G2(void 0, u3), function(n3) {
    var t3 = (f4.__N || f4.__)[0], r3 = f4.t(t3, n3);
    o2(t3, r3) || (f4.__N = [r3, f4.__[1]], f4.__c.setState({}));
  }], f4.__c = r2, !r2.__f)) {
    r2.__f = true;
    var c3 = r2.shouldComponentUpdate;
    r2.shouldComponentUpdate = function(n3, t3, r3) {
      var u4 = this.__H;
      if (!u4) return true;
      var i4 = false, f5 = this.props != n3;
      if (u4.__.some(function(n4) {
        n4.__N && (i4 = true, o2(n4.__[0], n4.__N[0]) || (f5 = true));
      }), c3) {
        var e3 = c3.call(this, n3, t3, r3);
        return i4 ? e3 || f5 : e3;
      }
      return !i4 || f5;
    };
  }
  return f4.__;
}
function A2(n2, u3) {
  var i3 = y2(t2++, 3);
  !a2.__s && E2(i3.__H, u3) && (i3.__P = true, i3.__ = n2, i3.u = u3, r2.__H.__h.push(i3));
}
function F2(n2, u3) {
  var i3 = y2(t2++, 4);
  !a2.__s && E2(i3.__H, u3) && (i3.__P = false, i3.__ = n2, i3.u = u3, r2.__h.push(i3));
}
function T2(n2) {
  return f2 = 5, w2(function() {
    return { current: n2 };
  }, []);
}
function w2(n2, r3) {
  var u3 = y2(t2++, 7);
  return E2(u3.__H, r3) && (u3.__ = n2(), u3.__H = r3), u3.__;
}
function P2() {
  var n2 = y2(t2++, 11);
  if (!n2.__) {
    for (var u3 = r2.__v; !u3.__m && u3.__; ) u3 = u3.__;
    var i3 = u3.__m || (u3.__m = [0, 0]);
    n2.__ = "P" + i3[0] + "-" + i3[1]++;
  }
  return n2.__;
}
function g2() {
  var n2;
  do {
    for (; n2 = e2.shift(); ) try {
      C2(n2);
    } catch (t4) {
      a2.__e(t4, { __: (n2 = n2.__P) && n2.__v });
    }
    for (; n2 = c2.shift(); ) {
      var t3 = n2.__H;
      if (n2.__P && t3) try {
        t3.__h.some(C2), t3.__h.some(D2), t3.__h = [];
      } catch (r3) {
        t3.__h = [], a2.__e(r3, n2.__v);
      }
    }
  } while (e2.length);
}
a2.__b = function(n2) {
  r2 = null, v2 && v2(n2);
}, a2.__ = function(n2, t3) {
  n2 && t3.__k && t3.__k.__m && (n2.__m = t3.__k.__m), p2 && p2(n2, t3);
}, a2.__r = function(n2) {
  l2 && l2(n2), t2 = 0;
  var i3 = (r2 = n2.__c).__H;
  i3 && (u2 == r2 ? r2.__h = [] : (i3.__h.some(C2), i3.__h.some(D2), t2 = 0), i3.__h = [], i3.__.some(function(n3) {
    n3.__N && (n3.__ = n3.__N), n3.u = n3.__N = void 0;
  })), u2 = r2;
}, a2.diffed = function(n2) {
  m2 && m2(n2);
  var t3 = n2.__c;
  t3 && t3.__H && (t3.__H.__h.length && B2(c2.push(t3)), t3.__H.__.some(function(n3) {
    n3.u && (n3.__H = n3.u);
  })), u2 = r2 = null;
}, a2.__c = function(n2, t3) {
  t3.some(function(n3) {
    try {
      n3.__h.some(C2), n3.__h = n3.__h.filter(function(n4) {
        return !n4.__ || D2(n4);
      });
    } catch (t4) {
      n3.__h = [function() {
        throw t4;
      }];
    }
  }), h2 && h2(n2, t3);
}, a2.unmount = function(n2) {
  s2 && s2(n2);
  var t3, r3, u3 = n2.__c;
  u3 && u3.__H && (u3.__H.__.some(function(u4) {
    try {
      if (u4.__P && u4.__c) {
        if (void 0 === r3) {
          for (r3 = n2.__; r3 && (!r3.__c || !r3.__c.__P); ) r3 = r3.__;
          r3 = r3 && r3.__c;
        }
        u4.__P = r3, B2(e2.push(u4));
      } else C2(u4);
    } catch (n3) {
      t3 = n3;
    }
  }), u3.__H = void 0, t3 && a2.__e(t3, u3.__v));
};
var k = "function" == typeof requestAnimationFrame;
function z2(n2) {
  var t3, r3 = function() {
    clearTimeout(u3), k && cancelAnimationFrame(t3), setTimeout(n2);
  }, u3 = setTimeout(r3, 35);
  k && (t3 = requestAnimationFrame(r3));
}
function B2(n2) {
  1 != n2 && i2 == a2.requestAnimationFrame || ((i2 = a2.requestAnimationFrame) || z2)(g2);
}
function C2(n2) {
  var t3 = r2, u3 = n2.__c;
  "function" == typeof u3 && (n2.__c = void 0, u3()), r2 = t3;
}
function D2(n2) {
  var t3 = r2;
  n2.__c = n2.__(), r2 = t3;
}
function E2(n2, t3) {
  return !n2 || n2.length != t3.length || t3.some(function(t4, r3) {
    return !o2(t4, n2[r3]);
  });
}
function G2(n2, t3) {
  return "function" == typeof t3 ? t3(n2) : t3;
}

// src/view/look/curves.ts
var WIDTH_PX = 250;
var LEVEL_PX = 500;
function isEditable(curves) {
  return !("rgba" in curves);
}
function at(curve, value) {
  const next = curve.findIndex((point) => valueOf(point) > value);
  const right = next < 0 ? curve.length - 1 : next;
  const [a4, b] = [curve[next < 0 ? right : Math.max(0, right - 1)], curve[right]];
  if (a4 === void 0 || b === void 0) return [];
  const width = valueOf(b) - valueOf(a4);
  const share = width > 0 ? clamped((value - valueOf(a4)) / width, 0, 1) : 0;
  return a4.slice(1).map((start, k2) => start + share * ((b[k2 + 1] ?? start) - start));
}
function withPoint(curve, point) {
  const next = curve.findIndex((other) => valueOf(other) > valueOf(point));
  const index = next < 0 ? curve.length : next;
  return { curve: [...curve.slice(0, index), point, ...curve.slice(index)], index };
}
function withPointOn(curve, value) {
  return withPoint(curve, [value, ...at(curve, value)]);
}
function withPointBeside(curve, index, span) {
  const here = valueOf(curve[index] ?? [middle(span)]);
  const [next, before] = [curve[index + 1], curve[index - 1]];
  if (next !== void 0 && valueOf(next) > here) return withPointOn(curve, (here + valueOf(next)) / 2);
  if (before !== void 0 && valueOf(before) < here) return withPointOn(curve, (here + valueOf(before)) / 2);
  return withPointOn(curve, here + 0.1 * (span[1] - span[0]));
}
function withMoved(curve, index, point) {
  const least = index > 0 ? valueOf(curve[index - 1] ?? []) : -Infinity;
  const most = index < curve.length - 1 ? valueOf(curve[index + 1] ?? []) : Infinity;
  const moved = [clamped(valueOf(point), least, most), ...point.slice(1).map((share) => clamped(share, 0, 1))];
  return curve.map((other, k2) => k2 === index ? moved : other);
}
function without(curve, index) {
  return curve.length > 1 ? curve.filter((_3, k2) => k2 !== index) : curve;
}
function spanOf(...curves) {
  const values = curves.flat().map(valueOf);
  return [Math.min(...values), Math.max(...values)];
}
function spanOfFunction(curves) {
  return spanOf(curves.opacity, curves.color);
}
function mapped(curve, factor, centre, shift = 0) {
  const points = curve.map((point) => {
    const value = centre + factor * (valueOf(point) - centre) + shift;
    return [value, ...point.slice(1)];
  });
  return factor < 0 ? points.reverse() : points;
}
function shifted(curves, shift) {
  return onValues(curves, 1, 0, shift);
}
function widened(curves, factor) {
  return onValues(curves, factor, middle(spanOfFunction(curves)), 0);
}
function withOpacities(curves, factor) {
  const opacity = curves.opacity.map(([value, alpha]) => [value, clamped(factor * alpha, 0, 1)]);
  return { ...curves, opacity };
}
function mirrored(curve) {
  return mapped(curve, -1, middle(spanOf(curve)));
}
function windowed(look, dx, dy, range) {
  const curves = look.transfer_function;
  if (!isEditable(curves)) return look;
  const wide = widened(curves, Math.exp(dx / WIDTH_PX));
  return { ...look, transfer_function: shifted(wide, -dy / LEVEL_PX * (range[1] - range[0])) };
}
function firstGradientCurve(scale) {
  return [
    [0, 0],
    [0.5 * scale, 1]
  ];
}
function surfaceValue(curves, range) {
  if (!isEditable(curves)) return middle(range);
  const half = Math.max(...curves.opacity.map(([, alpha]) => alpha)) / 2;
  const next = curves.opacity.findIndex(([, alpha]) => alpha >= half);
  const [a4, b] = [curves.opacity[Math.max(0, next - 1)], curves.opacity[next]];
  if (half <= 0 || a4 === void 0 || b === void 0) return middle(range);
  const rise = b[1] - a4[1];
  return rise > 0 ? a4[0] + (half - a4[1]) / rise * (b[0] - a4[0]) : b[0];
}
function outline(curve, [low, high], pieces = 1) {
  const ends = [low, high].map((value) => [value, at(curve, value)[0] ?? 0]);
  const inside = curve.filter(([value]) => value > low && value < high);
  const [first, last] = ends;
  const corners2 = [first, ...inside, last];
  return corners2.flatMap((to, k2) => {
    const from = corners2[k2 - 1];
    if (from === void 0 || pieces === 1 || from[0] === to[0] || from[1] === to[1]) return [to];
    return Array.from({ length: pieces }, (_3, n2) => between(from, to, (n2 + 1) / pieces));
  });
}
function hexOf([, red, green, blue]) {
  const byte = (share) => Math.round(255 * clamped(share, 0, 1)).toString(16).padStart(2, "0");
  return `#${byte(red)}${byte(green)}${byte(blue)}`;
}
function rgbOf(hex) {
  const byte = (start) => parseInt(hex.slice(start, start + 2), 16) / 255;
  return [byte(1), byte(3), byte(5)];
}
function clamped(value, least, most) {
  return Math.min(most, Math.max(least, value));
}
function middle([low, high]) {
  return (low + high) / 2;
}
function between(a4, b, share) {
  return [a4[0] + share * (b[0] - a4[0]), a4[1] + share * (b[1] - a4[1])];
}
function onValues(curves, factor, centre, shift) {
  return {
    ...curves,
    opacity: mapped(curves.opacity, factor, centre, shift),
    color: mapped(curves.color, factor, centre, shift)
  };
}
function valueOf(point) {
  return point[0] ?? 0;
}

// src/view/look/axis.ts
var CLOSEST = 1e-4;
function wholeOf(data, points) {
  const [low, high] = [Math.min(data[0], points[0]), Math.max(data[1], points[1])];
  const room = 0.02 * (high > low ? high - low : Math.abs(low) || 1);
  return [low - room, high + room];
}
function zoomed2(seen, factor, centre, whole) {
  const most = whole[1] - whole[0];
  const width = clamped((seen[1] - seen[0]) / factor, CLOSEST * most, most);
  const share = clamped((centre - seen[0]) / (seen[1] - seen[0]), 0, 1);
  return within([centre - share * width, centre + (1 - share) * width], whole);
}
function within([low, high], whole) {
  const width = Math.min(high - low, whole[1] - whole[0]);
  const start = clamped(low, whole[0], whole[1] - width);
  return [start, start + width];
}
function ticks([low, high], n2 = 5) {
  const step = roundStep((high - low) / n2);
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: Math.max(0, Math.min(count, 50)) }, (_3, k2) => tidy((first + k2) * step, step));
}
function rounded(value, span) {
  const step = 10 ** Math.floor(Math.log10(Math.max(Math.abs(span), Number.MIN_VALUE) / 1e3));
  return Number.isFinite(step) && step > 0 ? tidy(Math.round(value / step) * step, step) : value;
}
function numberText(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e7 || size < 1e-4)) return value.toExponential(2).replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(6)));
}
function outOfSight(curve, [low, high]) {
  const values = curve.map(([value]) => value ?? 0);
  return { below: values.filter((value) => value < low).length, above: values.filter((value) => value > high).length };
}
function around(points, whole) {
  const width = points[1] - points[0];
  const room = width > 0 ? 0.15 * width : 0.05 * (whole[1] - whole[0]);
  return within([points[0] - room, points[1] + room], whole);
}
function heights(counts, isLog) {
  const most = Math.max(1, ...counts);
  return counts.map((count) => isLog ? Math.log1p(count) / Math.log1p(most) : count / most);
}
function keyStep([low, high], fine) {
  return roundStep((high - low) / (fine ? 200 : 20));
}
function roundStep(least) {
  if (!(least > 0) || !Number.isFinite(least)) return 1;
  const power = 10 ** Math.floor(Math.log10(least));
  const factor = [1, 2, 5, 10].find((one) => one * power >= least * (1 - 1e-9)) ?? 10;
  return factor * power;
}
function tidy(value, step) {
  const places = Math.max(0, Math.min(12, 1 - Math.floor(Math.log10(step))));
  return Number(value.toFixed(places)) + 0;
}

// node_modules/preact/jsx-runtime/dist/jsxRuntime.mjs
var f3 = /* @__PURE__ */ Symbol.for("pv");
var o3 = 0;
function a3(t3, e3, n2, u3, a4, i3) {
  e3 || (e3 = {});
  var c3, l3, p3 = e3;
  if ("ref" in p3 && "function" != typeof t3) for (l3 in p3 = {}, e3) "ref" == l3 ? c3 = e3[l3] : p3[l3] = e3[l3];
  var s3 = { type: t3, props: p3, key: n2, ref: c3, __k: null, __: null, __b: 0, __e: null, __c: null, constructor: f3, __v: --o3, __i: -1, __u: 0 };
  return (a4 || i3) && (s3.__source = a4, s3.__self = i3), n.vnode && n.vnode(s3), s3;
}

// src/view/look/fields.tsx
function NumberField(props) {
  const { label, value, min, max, step = "any", unit: unit2 = "", disabled = false, id } = props;
  const [typed, setTyped] = d2(null);
  const done2 = () => {
    setTyped(null);
    props.onDone();
  };
  return /* @__PURE__ */ a3(
    "input",
    {
      type: "number",
      id,
      "aria-label": unit2 === "" ? label : `${label}, ${unit2}`,
      value: typed ?? numberText(value),
      min,
      max,
      step,
      disabled,
      onInput: (event) => {
        const field = event.currentTarget;
        setTyped(field.value);
        const number = field.valueAsNumber;
        if (Number.isFinite(number)) props.onValue(clamped(number, min ?? -Infinity, max ?? Infinity));
      },
      onChange: done2,
      onBlur: done2,
      onKeyDown: (event) => {
        if (event.key === "Enter") done2();
      }
    }
  );
}
function NamedNumber(props) {
  const { label, shown = label, unit: unit2 = "" } = props;
  return /* @__PURE__ */ a3("span", { class: "look-named", children: [
    /* @__PURE__ */ a3("span", { class: "dim", "aria-hidden": "true", children: shown }),
    /* @__PURE__ */ a3(NumberField, { ...props }),
    unit2 !== "" && /* @__PURE__ */ a3("span", { class: "dim", "aria-hidden": "true", children: unit2 })
  ] });
}
function SliderField(props) {
  const {
    label,
    value,
    min,
    max,
    step = roundStep((max - min) / 500),
    unit: unit2 = "",
    disabled = false,
    least,
    most
  } = props;
  const { shown = label } = props;
  return /* @__PURE__ */ a3("div", { class: "field look-slider", children: [
    shown !== "" && /* @__PURE__ */ a3("span", { "aria-hidden": "true", children: shown }),
    /* @__PURE__ */ a3(
      "input",
      {
        type: "range",
        "aria-label": label,
        "aria-valuetext": `${numberText(value)}${unit2 && ` ${unit2}`}`,
        value,
        min,
        max,
        step,
        disabled,
        onInput: (event) => props.onValue(event.currentTarget.valueAsNumber),
        onChange: () => props.onDone()
      }
    ),
    /* @__PURE__ */ a3(NumberField, { ...props, min: least ?? min, max: most ?? max, step, label: `${label}, number` })
  ] });
}
function RelativeSlider(props) {
  const { label, neutral, unit: unit2 = "", disabled = false } = props;
  const [amount, setAmount] = d2(null);
  const [typed, setTyped] = d2("");
  const done2 = () => {
    setAmount(null);
    props.onDone();
  };
  const apply = () => {
    const number = Number(typed);
    setTyped("");
    if (typed.trim() === "" || !Number.isFinite(number)) return;
    props.onAmount(number);
    done2();
  };
  const shown = numberText(amount ?? neutral);
  return /* @__PURE__ */ a3("div", { class: "field look-slider", children: [
    /* @__PURE__ */ a3("span", { "aria-hidden": "true", children: label }),
    /* @__PURE__ */ a3(
      "input",
      {
        type: "range",
        "aria-label": label,
        "aria-valuetext": `${shown}${unit2 && ` ${unit2}`}`,
        min: -1,
        max: 1,
        step: 0.01,
        value: amount === null ? 0 : props.position(amount),
        disabled,
        onInput: (event) => {
          const next = props.amount(event.currentTarget.valueAsNumber);
          setAmount(next);
          props.onAmount(next);
        },
        onChange: done2
      }
    ),
    /* @__PURE__ */ a3(
      "input",
      {
        type: "number",
        step: "any",
        "aria-label": `${label}, number${unit2 && `, ${unit2}`}`,
        value: amount === null ? typed : Number(amount.toPrecision(3)),
        placeholder: numberText(neutral),
        disabled,
        onInput: (event) => setTyped(event.currentTarget.value),
        onBlur: apply,
        onKeyDown: (event) => {
          if (event.key === "Enter") apply();
        }
      }
    )
  ] });
}
function SelectField({ label, value, options, onChoice }) {
  return /* @__PURE__ */ a3("label", { class: "field", children: [
    /* @__PURE__ */ a3("span", { children: label }),
    /* @__PURE__ */ a3("select", { class: "look-grow", value, onChange: (event) => onChoice(event.currentTarget.value), children: options.map((option) => /* @__PURE__ */ a3("option", { value: option.value, disabled: option.disabled ?? false, children: option.text }, option.value)) })
  ] });
}
function CheckField({
  label,
  checked,
  onCheck
}) {
  return /* @__PURE__ */ a3("label", { class: "row look-check", children: [
    /* @__PURE__ */ a3("input", { type: "checkbox", checked, onChange: (event) => onCheck(event.currentTarget.checked) }),
    /* @__PURE__ */ a3("span", { children: label })
  ] });
}
function ColorField({ label, value, onColor, onDone }) {
  const [picked, setPicked] = d2(null);
  A2(() => setPicked(null), [value]);
  return /* @__PURE__ */ a3(
    "input",
    {
      type: "color",
      "aria-label": label,
      value: picked ?? value,
      onInput: (event) => {
        setPicked(event.currentTarget.value);
        onColor(event.currentTarget.value);
      },
      onChange: onDone,
      onBlur: onDone
    }
  );
}
function Button(props) {
  return /* @__PURE__ */ a3(
    "button",
    {
      type: "button",
      class: "button",
      "aria-label": props.label,
      title: props.label,
      "aria-pressed": props.pressed,
      disabled: props.disabled ?? false,
      onClick: () => props.onClick(),
      children: props.children
    }
  );
}

// src/view/fields.tsx
function NumberField2(props) {
  const { onInput, onSettle, ...others } = props;
  return /* @__PURE__ */ a3(SliderField, { ...others, least: -Infinity, most: Infinity, onValue: onInput, onDone: onSettle });
}
function Choice(props) {
  const { label, value, options, onChoose } = props;
  return /* @__PURE__ */ a3(SelectField, { ...{ label, value }, options: options.map(([name, text]) => ({ value: name, text })), onChoice: onChoose });
}
function Switch(props) {
  return /* @__PURE__ */ a3(CheckField, { label: props.label, checked: props.on, onCheck: props.onToggle });
}
function Panel(props) {
  const { name, title, open, onToggle, children } = props;
  return /* @__PURE__ */ a3(
    "details",
    {
      class: "panel",
      open,
      "data-panel": name,
      onToggle: (event) => {
        const now = event.currentTarget.open;
        if (now !== open) onToggle(name, now);
      },
      children: [
        /* @__PURE__ */ a3("summary", { children: title }),
        open && /* @__PURE__ */ a3("div", { class: "body", children })
      ]
    }
  );
}

// src/view/overlay3d/box.ts
var FACES = [0, 1, 2].flatMap((axis) => [
  { axis, side: "lower" },
  { axis, side: "upper" }
]);
function corners(box) {
  return [...Array(8).keys()].map(
    (bits) => [0, 1, 2].map((axis) => (bits >> axis & 1 ? box.upper : box.lower)[axis])
  );
}
var EDGES = [0, 1, 2].flatMap(
  (axis) => [...Array(8).keys()].filter((bits) => !(bits >> axis & 1)).map((bits) => ({ a: bits, b: bits | 1 << axis, axis }))
);
function faceCenter(box, { axis, side }) {
  const middle2 = center(box);
  return middle2.map((value, a4) => a4 === axis ? box[side][axis] : value);
}
var center = (box) => scaled(add(box.lower, box.upper), 0.5);
function isSeen(box, face, camera) {
  const outward = [0, 0, 0].map((_3, a4) => a4 === face.axis ? face.side === "upper" ? 1 : -1 : 0);
  const toEye = camera.parallel_scale === void 0 ? sub(camera.position, faceCenter(box, face)) : axesOf(camera).back;
  return dot(outward, toEye) > 0;
}
function isHidden(box, edge, camera) {
  return [0, 1, 2].filter((axis) => axis !== edge.axis).every((axis) => {
    const side = edge.a >> axis & 1 ? "upper" : "lower";
    return !isSeen(box, { axis, side }, camera);
  });
}
function alongAxis(camera, size, from, axis, dx, dy) {
  const here = project(camera, size, from);
  const there = project(camera, size, add(from, axis));
  if (here === null || there === null) return 0;
  const [ux, uy] = [there.x - here.x, there.y - here.y];
  const square = ux * ux + uy * uy;
  return square < 1e-6 ? 0 : (dx * ux + dy * uy) / square;
}
function withFace(box, face, to, bounds, least) {
  const { axis, side } = face;
  const [low, high] = [bounds[0][axis], bounds[1][axis]];
  const inside = side === "lower" ? Math.max(low, Math.min(to, box.upper[axis] - least)) : Math.min(high, Math.max(to, box.lower[axis] + least));
  const moved = box[side].map((value, a4) => a4 === axis ? inside : value);
  return { ...box, [side]: moved };
}
function movedBy(box, by, bounds) {
  const clamped2 = by.map((way, a4) => {
    const [room, back] = [(bounds[1][a4] ?? 0) - (box.upper[a4] ?? 0), (bounds[0][a4] ?? 0) - (box.lower[a4] ?? 0)];
    return Math.min(Math.max(way, back), room);
  });
  return { ...box, lower: add(box.lower, clamped2), upper: add(box.upper, clamped2) };
}
function inPicture(camera, size, from, dx, dy) {
  const here = project(camera, size, from);
  if (here === null) return [0, 0, 0];
  const moved = ray(camera, size, here.x + dx, here.y + dy);
  const { back } = axesOf(camera);
  const depth = -dot(sub(from, moved.origin), back) / -dot(moved.direction, back);
  return sub(add(moved.origin, scaled(moved.direction, depth)), from);
}
var placeOfBox = (clips, kind) => clips.findIndex((clip) => kind in clip && !isIndexed(boxOf(clip)));
function boxOf(clip) {
  return "keep" in clip ? clip.keep : "cut_out" in clip ? clip.cut_out : null;
}
var isIndexed = (box) => box?.space === "index";

// src/view/cut_panel.tsx
var AXES = ["x", "y", "z"];
function CutPanel(props) {
  const { store, welcome } = props;
  const { clip, view } = store.state;
  const whole = { lower: welcome.bounds[0], upper: welcome.bounds[1], space: "world" };
  const add2 = (one) => store.change([set(one, "clip", "-"), set(true, "view", "overlays", "crop_box")]);
  const remove = (place) => store.change([{ op: "remove", path: `/clip/${place}` }]);
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(
      Switch,
      {
        label: "Handles in the views",
        on: view.overlays.crop_box,
        onToggle: (on) => store.change([set(on, "view", "overlays", "crop_box")])
      }
    ),
    ["keep", "cut_out"].map((kind) => {
      const place = placeOfBox(clip, kind);
      const found = clip[place];
      const box = found === void 0 ? null : boxOf(found);
      const title = kind === "keep" ? "Crop box" : "Box that is cut out";
      return /* @__PURE__ */ a3("fieldset", { children: [
        /* @__PURE__ */ a3("legend", { children: title }),
        box === null ? /* @__PURE__ */ a3(
          "button",
          {
            class: "button",
            onClick: () => add2({ [kind]: kind === "keep" ? whole : corner(whole) }),
            children: kind === "keep" ? "Crop" : "Cut a corner out"
          }
        ) : /* @__PURE__ */ a3($, { children: [
          /* @__PURE__ */ a3(BoxNumbers, { ...props, kind, place, box }),
          /* @__PURE__ */ a3("div", { class: "row", children: [
            /* @__PURE__ */ a3("button", { class: "button", onClick: () => store.change([set({ [kind]: whole }, "clip", place)]), children: "Reset" }),
            /* @__PURE__ */ a3("button", { class: "button", onClick: () => remove(place), children: "Remove" })
          ] })
        ] })
      ] }, kind);
    }),
    /* @__PURE__ */ a3("fieldset", { children: [
      /* @__PURE__ */ a3("legend", { children: "Clip planes" }),
      clip.map(
        (one, place) => "plane" in one ? /* @__PURE__ */ a3(PlaneNumbers, { ...props, place, plane: one.plane, onRemove: () => remove(place) }, place) : null
      ),
      /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          onClick: () => {
            const { back } = axesOf(store.state.camera);
            add2({ plane: { point: store.state.view.slices.crosshair, normal: scaled(back, -1) } });
          },
          children: "Add a plane that faces you"
        }
      )
    ] })
  ] });
}
function corner(box) {
  const middle2 = (axis) => ((box.lower[axis] ?? 0) + (box.upper[axis] ?? 0)) / 2;
  return { ...box, lower: [box.lower[0], middle2(1), middle2(2)], upper: [middle2(0), box.upper[1], box.upper[2]] };
}
function BoxNumbers(props) {
  const { store, welcome, kind, place, box } = props;
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const unitName = welcome.volumes[0]?.unit ?? "units";
  return /* @__PURE__ */ a3($, { children: AXES.flatMap(
    (name, a4) => ["lower", "upper"].map((side) => {
      const face = { axis: a4, side };
      const [low, high] = [welcome.bounds[0][a4] ?? 0, welcome.bounds[1][a4] ?? 1];
      return /* @__PURE__ */ a3(
        NumberField2,
        {
          label: `${name} ${side === "lower" ? "from" : "to"}`,
          unit: unitName,
          value: box[side][a4] ?? 0,
          min: low,
          max: high,
          onInput: (value) => store.change(
            [set({ [kind]: withFace(box, face, value, welcome.bounds, spacing[a4] ?? 1) }, "clip", place)],
            `${kind} ${name} ${side}`
          ),
          onSettle: () => store.settle()
        },
        `${name}${side}`
      );
    })
  ) });
}
function PlaneNumbers(props) {
  const { store, welcome, place, plane, onRemove } = props;
  const normal = unit(plane.normal);
  const [lower, upper] = welcome.bounds;
  const ends = [0, 1, 2].map((a4) => [(lower[a4] ?? 0) * (normal[a4] ?? 0), (upper[a4] ?? 0) * (normal[a4] ?? 0)]);
  const low = ends.reduce((sum, end) => sum + Math.min(...end), 0);
  const high = ends.reduce((sum, end) => sum + Math.max(...end), 0);
  const along = dot(plane.point, normal);
  const change = (next, gesture) => store.change([set({ plane: next }, "clip", place)], gesture);
  const number = store.state.clip.slice(0, place + 1).filter((clip) => "plane" in clip).length;
  return /* @__PURE__ */ a3("div", { class: "plane", children: [
    /* @__PURE__ */ a3(
      NumberField2,
      {
        label: `Plane ${number} at`,
        unit: welcome.volumes[0]?.unit ?? "units",
        value: along,
        min: low,
        max: high,
        onInput: (value) => {
          const point = plane.point.map((x2, a4) => x2 + (value - along) * (normal[a4] ?? 0));
          change({ ...plane, point }, "plane at");
        },
        onSettle: () => store.settle()
      }
    ),
    /* @__PURE__ */ a3("div", { class: "row", children: AXES.map((name, a4) => /* @__PURE__ */ a3("label", { class: "row", children: [
      `Normal ${name}`,
      /* @__PURE__ */ a3(
        "input",
        {
          type: "number",
          step: "any",
          value: Number((normal[a4] ?? 0).toFixed(4)),
          onChange: (event) => {
            const value = event.currentTarget.valueAsNumber;
            const next = normal.map((x2, b) => b === a4 ? value : x2);
            if (Number.isFinite(value) && next.some((x2) => x2 !== 0)) change({ ...plane, normal: unit(next) });
          }
        }
      )
    ] }, name)) }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3("button", { class: "button", onClick: () => change({ ...plane, normal: scaled(plane.normal, -1) }), children: "Flip" }),
      /* @__PURE__ */ a3("button", { class: "button", onClick: onRemove, children: "Remove" })
    ] })
  ] });
}

// src/view/frame_statistics.ts
var MOST_RECORDS = 4e3;
var MOST_EVENTS = 1e3;
var FrameStatistics = class {
  records = [];
  events = [];
  /** A change with this number came from an event at this time. */
  event(seq, at2) {
    this.events.push({ seq, at: at2 });
    if (this.events.length > MOST_EVENTS) this.events.shift();
  }
  /** A frame is on the canvas. */
  drawn(frame, at2) {
    const shown = this.events.filter((event) => event.seq <= frame.seq).at(-1);
    if (shown !== void 0) this.events = this.events.filter((event) => event.seq > frame.seq);
    const { bytes, ...header } = frame;
    this.records.push({ at: at2, latency: shown === void 0 ? null : at2 - shown.at, bytes: bytes.length, frame: header });
    if (this.records.length > MOST_RECORDS) this.records.shift();
  }
  /** Of the moving frames of the last so many milliseconds. */
  recent(now, span = 2e3) {
    const moving = this.records.filter((record) => record.at > now - span && !record.frame.at_rest);
    const first = moving[0];
    const last = moving.at(-1);
    if (first === void 0 || last === void 0 || moving.length < 3) return null;
    const latencies = moving.flatMap((record) => record.latency === null ? [] : [record.latency]);
    return {
      framesPerSecond: (moving.length - 1) * 1e3 / Math.max(last.at - first.at, 1),
      latency: median(latencies),
      kilobytes: (median(moving.map((record) => record.bytes)) ?? 0) / 1e3
    };
  }
};
function median(values) {
  const sorted = [...values].sort((a4, b) => a4 - b);
  return sorted[Math.floor(sorted.length / 2)] ?? null;
}

// src/view/help.tsx
function Help({ onClose }) {
  const dialog = T2(null);
  A2(() => {
    dialog.current?.showModal();
  }, []);
  return /* @__PURE__ */ a3("dialog", { ref: dialog, "aria-labelledby": "help-title", onClose, children: [
    /* @__PURE__ */ a3("h2", { id: "help-title", children: "Keys and gestures" }),
    /* @__PURE__ */ a3("p", { class: "dim", children: "Keys act in the view that has the focus. In a slice arrows move the crosshair." }),
    /* @__PURE__ */ a3("table", { children: [
      /* @__PURE__ */ a3("caption", { class: "hidden", children: "Mouse and touch" }),
      /* @__PURE__ */ a3("tbody", { children: GESTURES.map(([gesture, what]) => /* @__PURE__ */ a3("tr", { children: [
        /* @__PURE__ */ a3("th", { scope: "row", children: gesture }),
        /* @__PURE__ */ a3("td", { children: what })
      ] }, gesture)) })
    ] }),
    /* @__PURE__ */ a3("table", { children: [
      /* @__PURE__ */ a3("caption", { class: "hidden", children: "Keys" }),
      /* @__PURE__ */ a3("tbody", { children: KEYS.map(({ shown, text }) => /* @__PURE__ */ a3("tr", { children: [
        /* @__PURE__ */ a3("th", { scope: "row", children: /* @__PURE__ */ a3("kbd", { children: shown }) }),
        /* @__PURE__ */ a3("td", { children: text })
      ] }, shown)) })
    ] }),
    /* @__PURE__ */ a3("form", { method: "dialog", children: /* @__PURE__ */ a3("button", { class: "button", children: "Close" }) })
  ] });
}

// src/view/look/point_keys.ts
function pointKey(key, isShifted, seen, rise) {
  const share = isShifted ? 0.2 : 1;
  const fine = share * keyStep(seen, true);
  const coarse = keyStep(seen, false);
  const steps = {
    ArrowLeft: [-fine, 0],
    ArrowRight: [fine, 0],
    ArrowUp: [0, share * rise],
    ArrowDown: [0, -share * rise],
    PageDown: [-coarse, 0],
    PageUp: [coarse, 0],
    Home: [0, -1],
    End: [0, 1]
  };
  const step = steps[key];
  if (step !== void 0) return { does: "move", value: step[0], rise: step[1] };
  if (key === "Delete" || key === "Backspace") return { does: "remove" };
  if (key === "Insert") return { does: "insert" };
  return key === "Enter" ? { does: "type" } : null;
}

// src/view/look/curve_plot.tsx
var TEXT = {
  below: (n2) => `${n2} below what is seen: show all points`,
  above: (n2) => `${n2} above what is seen: show all points`
};
var KEYS2 = "Arrows move, Page up and down move far, Delete removes, Insert adds, Enter goes to the number";
var MARGIN = { left: 34, right: 12, top: 12, bottom: 20 };
var DOT_PX = 6;
var REACH_PX = 13;
var ROOT = 1 / 3;
var PIECES = 16;
var WHEEL_ZOOM = 1.2;
var N_TICKS = 5;
function CurvePlot(props) {
  const { label, height, seen, whole, unit: unit2, curve, colors, histogram, isMagnified, selected } = props;
  const [svg, width] = useWidth();
  const drag = T2(null);
  const fill = P2();
  const inner = { width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
  const power = isMagnified ? ROOT : 1;
  const xOf = (value) => MARGIN.left + (value - seen[0]) / (seen[1] - seen[0]) * inner.width;
  const yOf = (alpha) => MARGIN.top + (1 - alpha ** power) * inner.height;
  const valueAt = (x2) => seen[0] + (x2 - MARGIN.left) / inner.width * (seen[1] - seen[0]);
  const alphaAt = (y3) => clamped(1 - (y3 - MARGIN.top) / inner.height, 0, 1) ** (1 / power);
  const inside = (event) => {
    const box = svg.current?.getBoundingClientRect();
    return { x: event.clientX - (box?.left ?? 0), y: event.clientY - (box?.top ?? 0) };
  };
  const tidy2 = (value, alpha) => [
    Math.max(props.least ?? -Infinity, rounded(value, seen[1] - seen[0])),
    Number(alpha.toPrecision(3))
  ];
  const move = (index, value, alpha) => props.onCurve(withMoved(curve, index, tidy2(value, alpha)), index);
  const onPlotMove = (event) => {
    const begun = drag.current;
    if (begun === null) return;
    const { x: x2, y: y3 } = inside(event);
    if (begun.index !== null) {
      move(begun.index, valueAt(x2 - begun.x), alphaAt(y3 - begun.y));
      return;
    }
    const shift = (begun.x - x2) / inner.width * (begun.seen[1] - begun.seen[0]);
    props.onSeen(within([begun.seen[0] + shift, begun.seen[1] + shift], whole));
  };
  const onPlotUp = () => {
    if (drag.current?.index != null) props.onDone();
    drag.current = null;
  };
  const onHandleKey = (event, index) => {
    const latest = props.latest();
    const point = latest[index];
    if (point === void 0) return;
    const rise = isMagnified ? Math.max(5e-4, 0.1 * point[1]) : 0.01;
    const key = pointKey(event.key, event.shiftKey, seen, rise);
    if (key === null || key.does === "remove" && latest.length === 1) return;
    if (key.does === "move") {
      const value = Math.max(props.least ?? -Infinity, point[0] + key.value);
      props.onCurve(withMoved(latest, index, [value, Number((point[1] + key.rise).toPrecision(6))]), index);
    } else if (key.does === "type") props.onType();
    else changePoints(props, key.does, index);
    event.preventDefault();
    event.stopPropagation();
  };
  const line = outline(curve, seen, isMagnified ? PIECES : 1).map(
    ([value, alpha]) => `${px(xOf(value))},${px(yOf(alpha))}`
  );
  const hidden = outOfSight(curve, seen);
  const marks = isMagnified ? [0, 0.01, 0.1, 0.5, 1] : [0, 0.25, 0.5, 0.75, 1];
  const marked = ticks(seen, N_TICKS).filter((value) => unit2 === "" || xOf(value) > MARGIN.left + 14);
  return /* @__PURE__ */ a3(
    "svg",
    {
      ref: svg,
      class: "look-plot",
      height,
      role: "group",
      "aria-label": label,
      onWheel: (event) => {
        const root = event.currentTarget.getRootNode();
        if (!event.ctrlKey && !event.currentTarget.contains(root.activeElement)) return;
        event.preventDefault();
        props.onSeen(zoomed2(seen, event.deltaY < 0 ? WHEEL_ZOOM : 1 / WHEEL_ZOOM, valueAt(inside(event).x), whole));
      },
      onDblClick: (event) => {
        const { x: x2, y: y3 } = inside(event);
        const added2 = withPoint(curve, tidy2(valueAt(x2), alphaAt(y3)));
        props.onCurve(added2.curve, added2.index);
        props.onDone();
      },
      onPointerDown: (event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        drag.current = { index: null, x: inside(event).x, y: 0, seen };
      },
      onPointerMove: onPlotMove,
      onLostPointerCapture: onPlotUp,
      children: [
        /* @__PURE__ */ a3(Fill, { id: fill, colors, xOf }),
        /* @__PURE__ */ a3("g", { "aria-hidden": "true", children: [
          marks.map((alpha) => /* @__PURE__ */ a3("g", { children: [
            /* @__PURE__ */ a3("line", { class: "look-grid", x1: MARGIN.left, x2: width - MARGIN.right, y1: yOf(alpha), y2: yOf(alpha) }),
            /* @__PURE__ */ a3("text", { class: "look-tick", x: MARGIN.left - 4, y: yOf(alpha) + 4, "text-anchor": "end", children: alpha })
          ] }, alpha)),
          marked.map((value) => /* @__PURE__ */ a3("g", { children: [
            /* @__PURE__ */ a3("line", { class: "look-grid", x1: xOf(value), x2: xOf(value), y1: MARGIN.top, y2: height - MARGIN.bottom + 3 }),
            /* @__PURE__ */ a3("text", { class: "look-tick", x: Math.min(xOf(value), width - 20), y: height - 5, "text-anchor": "middle", children: numberText(value) })
          ] }, value)),
          /* @__PURE__ */ a3("text", { class: "look-tick", x: MARGIN.left - 4, y: height - 5, "text-anchor": "end", children: unit2 }),
          /* @__PURE__ */ a3(
            "polygon",
            {
              points: `${line.join(" ")} ${px(xOf(seen[1]))},${yOf(0)} ${px(xOf(seen[0]))},${yOf(0)}`,
              fill: colors === null ? "var(--accent)" : `url(#${fill})`,
              "fill-opacity": 0.7
            }
          ),
          histogram !== null && /* @__PURE__ */ a3("path", { class: "look-counts", d: barsPath(histogram, xOf, inner.height, seen) }),
          /* @__PURE__ */ a3("polyline", { class: "look-line-under", points: line.join(" ") }),
          /* @__PURE__ */ a3("polyline", { class: "look-line", points: line.join(" ") })
        ] }),
        hidden.below > 0 && /* @__PURE__ */ a3(Mark, { side: "left", x: MARGIN.left, y: height / 2, text: TEXT.below(hidden.below), onClick: props.onShowPoints }),
        hidden.above > 0 && /* @__PURE__ */ a3(
          Mark,
          {
            side: "right",
            x: width - MARGIN.right,
            y: height / 2,
            text: TEXT.above(hidden.above),
            onClick: props.onShowPoints
          }
        ),
        curve.map(
          (point, index) => point[0] < seen[0] || point[0] > seen[1] ? null : /* @__PURE__ */ a3(
            Handle,
            {
              x: xOf(point[0]),
              y: yOf(point[1]),
              isSelected: index === selected,
              color: null,
              label: `Point ${index + 1} of ${curve.length}`,
              value: point[0],
              range: seen,
              text: `${props.what} ${numberText(point[1])} at ${numberText(point[0])}${unit2 && ` ${unit2}`}`,
              onSelect: () => props.onSelect(index),
              onKeyDown: (event) => onHandleKey(event, index),
              onKeyUp: () => props.onDone(),
              onGrab: (event) => {
                const { x: x2, y: y3 } = inside(event);
                svg.current?.setPointerCapture(event.pointerId);
                drag.current = { index, x: x2 - xOf(point[0]), y: y3 - yOf(point[1]), seen };
              }
            },
            index
          )
        ),
        props.children
      ]
    }
  );
}
function changePoints({ latest, seen, onCurve, onDone }, what, index) {
  const curve = latest();
  if (what === "remove") onCurve(without(curve, index), Math.min(index, curve.length - 2));
  else {
    const added2 = withPointBeside(curve, index, seen);
    onCurve(added2.curve, added2.index);
  }
  onDone();
}
function Handle(props) {
  const { x: x2, y: y3, isSelected, color, range, value } = props;
  return /* @__PURE__ */ a3(
    "g",
    {
      class: "look-handle",
      role: "slider",
      tabindex: 0,
      "aria-label": props.label,
      "aria-valuemin": Math.min(range[0], value),
      "aria-valuemax": Math.max(range[1], value),
      "aria-valuenow": value,
      "aria-valuetext": props.text,
      "aria-description": KEYS2,
      "data-selected": isSelected,
      transform: `translate(${px(x2)} ${px(y3)})`,
      onFocus: props.onSelect,
      onKeyDown: props.onKeyDown,
      onKeyUp: props.onKeyUp,
      onDblClick: (event) => event.stopPropagation(),
      onPointerDown: (event) => {
        if (event.button !== 0) return;
        event.stopPropagation();
        event.preventDefault();
        event.currentTarget.focus();
        props.onSelect();
        props.onGrab(event);
      },
      children: [
        /* @__PURE__ */ a3("title", { children: props.text }),
        /* @__PURE__ */ a3("circle", { class: "look-reach", r: REACH_PX }),
        color === null ? /* @__PURE__ */ a3("circle", { class: "look-dot", r: DOT_PX }) : /* @__PURE__ */ a3("path", { class: "look-dot", d: "M0 -10 L7 -2 V9 H-7 V-2 Z", style: { fill: color } })
      ]
    }
  );
}
function Mark(props) {
  const { side, x: x2, y: y3, text, onClick } = props;
  const stop = (event) => event.stopPropagation();
  return /* @__PURE__ */ a3(
    "g",
    {
      class: "look-mark",
      role: "button",
      tabindex: 0,
      "aria-label": text,
      transform: `translate(${x2} ${y3})${side === "left" ? "" : " scale(-1 1)"}`,
      onPointerDown: stop,
      onDblClick: stop,
      onClick,
      onKeyDown: (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        event.stopPropagation();
        onClick();
      },
      children: [
        /* @__PURE__ */ a3("title", { children: text }),
        /* @__PURE__ */ a3("rect", { class: "look-reach", x: -6, y: -14, width: 28, height: 28 }),
        /* @__PURE__ */ a3("path", { d: "M1 0 L13 -8 V8 Z" })
      ]
    }
  );
}
function Fill({
  id,
  colors,
  xOf
}) {
  const [first, last] = [colors?.[0], colors?.at(-1)];
  if (colors === null || first === void 0 || last === void 0) return null;
  const width = last[0] - first[0] || 1;
  return /* @__PURE__ */ a3("defs", { children: /* @__PURE__ */ a3(
    "linearGradient",
    {
      id,
      gradientUnits: "userSpaceOnUse",
      x1: xOf(first[0]),
      x2: xOf(first[0] + width),
      y1: 0,
      y2: 0,
      children: colors.map((point, index) => /* @__PURE__ */ a3("stop", { offset: (point[0] - first[0]) / width, "stop-color": hexOf(point) }, index))
    }
  ) });
}
function useWidth() {
  const element = T2(null);
  const [width, setWidth] = d2(310);
  A2(() => {
    const seen = element.current;
    if (seen === null) return void 0;
    const observer = new ResizeObserver(([entry]) => {
      if (entry !== void 0 && entry.contentRect.width > 0) setWidth(entry.contentRect.width);
    });
    observer.observe(seen);
    return () => observer.disconnect();
  }, []);
  return [element, width];
}
function barsPath({ heights: heights2, range }, xOf, height, seen) {
  const bin = (range[1] - range[0]) / heights2.length;
  const [left, right] = [xOf(seen[0]), xOf(seen[1])];
  const bottom = MARGIN.top + height;
  const steps = heights2.flatMap((share, k2) => {
    const [a4, b] = [xOf(range[0] + k2 * bin), xOf(range[0] + (k2 + 1) * bin)];
    if (b < left || a4 > right) return [];
    return [
      `L${px(Math.max(a4, left))} ${px(bottom - share * height)}`,
      `L${px(Math.min(b, right))} ${px(bottom - share * height)}`
    ];
  });
  const first = clamped(xOf(range[0]), left, right);
  const last = clamped(xOf(range[1]), left, right);
  return `M${px(first)} ${bottom} ${steps.join(" ")} L${px(last)} ${bottom} Z`;
}
function px(value) {
  return value.toFixed(2);
}

// src/view/look/color_strip.tsx
var TEXT2 = {
  label: "Colours of the values",
  hidden: (n2) => `${n2} outside what is seen: show all points`
};
var RAMP_PX = 16;
var HEIGHT_PX = 44;
function ColorStrip(props) {
  const { seen, unit: unit2, curve, selected } = props;
  const [svg, width] = useWidth();
  const drag = T2(null);
  const fill = P2();
  const inner = width - MARGIN.left - MARGIN.right;
  const xOf = (value) => MARGIN.left + (value - seen[0]) / (seen[1] - seen[0]) * inner;
  const valueAt = (x2) => seen[0] + (x2 - MARGIN.left) / inner * (seen[1] - seen[0]);
  const inside = (event) => event.clientX - (svg.current?.getBoundingClientRect().left ?? 0);
  const move = (index, value) => {
    const latest = props.latest();
    const point = latest[index];
    if (point !== void 0) props.onCurve(withMoved(latest, index, [value, point[1], point[2], point[3]]), index);
  };
  const onUp = () => {
    if (drag.current !== null) props.onDone();
    drag.current = null;
  };
  const onKeyDown = (event, index) => {
    const key = pointKey(event.key, event.shiftKey, seen, 0);
    if (key === null || key.does === "remove" && curve.length === 1) return;
    if (key.does === "move") move(index, (props.latest()[index]?.[0] ?? 0) + key.value);
    else if (key.does === "type") props.onType();
    else changePoints(props, key.does, index);
    event.preventDefault();
    event.stopPropagation();
  };
  const { below, above } = outOfSight(curve, seen);
  const only = curve[0];
  const isPlain = curve.length === 1 && only !== void 0;
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(
      "svg",
      {
        ref: svg,
        class: "look-plot",
        height: HEIGHT_PX,
        role: "group",
        "aria-label": TEXT2.label,
        onDblClick: (event) => {
          const added2 = withPointOn(curve, rounded(valueAt(inside(event)), seen[1] - seen[0]));
          props.onCurve(added2.curve, added2.index);
          props.onDone();
        },
        onPointerMove: (event) => {
          const begun = drag.current;
          if (begun !== null) move(begun.index, rounded(valueAt(inside(event) - begun.x), seen[1] - seen[0]));
        },
        onLostPointerCapture: onUp,
        children: [
          /* @__PURE__ */ a3(Fill, { id: fill, colors: curve, xOf }),
          /* @__PURE__ */ a3(
            "rect",
            {
              class: "look-ramp",
              x: MARGIN.left,
              y: 1,
              width: Math.max(0, inner),
              height: RAMP_PX,
              fill: isPlain ? hexOf(only) : `url(#${fill})`
            }
          ),
          curve.map(
            (point, index) => point[0] < seen[0] || point[0] > seen[1] ? null : /* @__PURE__ */ a3(
              Handle,
              {
                x: xOf(point[0]),
                y: RAMP_PX + 13,
                isSelected: index === selected,
                color: hexOf(point),
                label: `Colour ${index + 1} of ${curve.length}`,
                value: point[0],
                range: seen,
                text: `${hexOf(point)} at ${numberText(point[0])}${unit2 && ` ${unit2}`}`,
                onSelect: () => props.onSelect(index),
                onKeyDown: (event) => onKeyDown(event, index),
                onKeyUp: () => props.onDone(),
                onGrab: (event) => {
                  svg.current?.setPointerCapture(event.pointerId);
                  drag.current = { index, x: inside(event) - xOf(point[0]) };
                }
              },
              index
            )
          )
        ]
      }
    ),
    below + above > 0 && /* @__PURE__ */ a3("button", { type: "button", class: "button", onClick: () => props.onShowPoints(), children: TEXT2.hidden(below + above) })
  ] });
}

// src/view/look/gradient_editor.tsx
var TEXT3 = {
  title: "Gradient opacity",
  none: "Opacity does not depend on the gradient.",
  add: "Make boundaries stand out",
  remove: "Remove gradient opacity",
  label: "Factor of the opacity over the gradient",
  what: "factor",
  gradient: "Gradient",
  factor: "Factor",
  addPoint: "Add point",
  delete: "Delete point"
};
var PLOT_PX = 130;
function GradientEditor({ store, ui, curves, volume, latest }) {
  const curve = curves.gradient_opacity ?? [];
  const scale = strongGradient(volume);
  const least = spanOf([[0], [scale]], curve);
  const whole = [0, 1.1 * least[1]];
  const [zoom, setZoom] = d2(null);
  const [chosen2, setChosen] = d2(0);
  const path = ["layers", ui.layer, "look", "transfer_function", "gradient_opacity"];
  const index = Math.min(chosen2, curve.length - 1);
  const point = curve[index];
  const change = (next, at2) => {
    store.change([set(next, ...path)], "gradient opacity");
    if (at2 !== null) setChosen(at2);
  };
  const done2 = () => store.settle();
  const unit2 = [volume.value_unit, volume.unit].every((one) => one) ? `${volume.value_unit}/${volume.unit}` : "";
  if (point === void 0) {
    return /* @__PURE__ */ a3("details", { class: "look-details", children: [
      /* @__PURE__ */ a3("summary", { children: TEXT3.title }),
      /* @__PURE__ */ a3("p", { class: "dim", children: TEXT3.none }),
      /* @__PURE__ */ a3(Button, { onClick: () => store.change([set(firstGradientCurve(rounded(scale, 10 * scale)), ...path)]), children: TEXT3.add })
    ] });
  }
  return /* @__PURE__ */ a3("details", { class: "look-details", open: true, children: [
    /* @__PURE__ */ a3("summary", { children: TEXT3.title }),
    /* @__PURE__ */ a3(
      CurvePlot,
      {
        label: TEXT3.label,
        what: TEXT3.what,
        height: PLOT_PX,
        seen: within(zoom ?? whole, whole),
        whole,
        unit: unit2,
        least: 0,
        curve,
        latest,
        colors: null,
        histogram: null,
        isMagnified: false,
        selected: index,
        onSelect: setChosen,
        onCurve: change,
        onDone: done2,
        onSeen: setZoom,
        onShowPoints: () => setZoom(around(spanOf(curve), whole)),
        onType: () => {
        }
      }
    ),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(
        NamedNumber,
        {
          label: TEXT3.gradient,
          unit: unit2,
          min: 0,
          value: point[0],
          onValue: (value) => change(withMoved(curve, index, [value, point[1]]), index),
          onDone: done2
        }
      ),
      /* @__PURE__ */ a3(
        NamedNumber,
        {
          label: TEXT3.factor,
          min: 0,
          max: 1,
          step: 0.01,
          value: point[1],
          onValue: (factor) => change(withMoved(curve, index, [point[0], factor]), index),
          onDone: done2
        }
      )
    ] }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(
        Button,
        {
          onClick: () => {
            const added2 = withPointBeside(curve, index, whole);
            change(added2.curve, added2.index);
            done2();
          },
          children: TEXT3.addPoint
        }
      ),
      /* @__PURE__ */ a3(
        Button,
        {
          disabled: curve.length === 1,
          onClick: () => {
            change(without(curve, index), Math.max(0, index - 1));
            done2();
          },
          children: TEXT3.delete
        }
      ),
      /* @__PURE__ */ a3(Button, { onClick: () => store.change([{ op: "remove", path: `/${path.join("/")}` }]), children: TEXT3.remove })
    ] })
  ] });
}
function strongGradient(volume) {
  const [low, high] = volume.robust_range;
  return 0.5 * (high - low || 1) / Math.min(...volume.spacing);
}

// src/view/look/own_presets.ts
var KEY = "wavesplat.presets";
function keeper() {
  try {
    return globalThis.localStorage ?? null;
  } catch {
    return null;
  }
}
function ownPresets(kept = keeper()) {
  try {
    const found = JSON.parse(kept?.getItem(KEY) ?? "[]");
    return Array.isArray(found) ? found.filter(isPreset) : [];
  } catch {
    return [];
  }
}
function ownPreset(name, kept = keeper()) {
  return ownPresets(kept).find((preset) => preset.name === name);
}
function keepPreset(preset, kept = keeper()) {
  return write([...ownPresets(kept).filter(({ name }) => name !== preset.name), preset], kept);
}
function dropPreset(name, kept = keeper()) {
  return write(
    ownPresets(kept).filter((preset) => preset.name !== name),
    kept
  );
}
function renamePreset(from, to, kept = keeper()) {
  const renamed = ownPresets(kept).filter(({ name }) => name !== to || name === from).map((preset) => preset.name === from ? { ...preset, name: to, look: { ...preset.look, name: to } } : preset);
  return write(renamed, kept);
}
function nameProblem(name, taken) {
  if (name === "") return "Give the preset a name.";
  if (name.length > 100) return "The name is longer than 100 characters; give a shorter one.";
  const same = taken.find((one) => one.toLowerCase() === name.toLowerCase());
  return same === void 0 ? null : `“${same}” comes with the program; give another name.`;
}
function write(presets, kept) {
  if (kept === null) throw new Error("This browser keeps nothing for this page; export the look to a file instead.");
  kept.setItem(KEY, JSON.stringify(presets));
  return presets;
}
function isPreset(found) {
  if (typeof found !== "object" || found === null) return false;
  const { name, look, picture } = found;
  return typeof name === "string" && typeof picture === "string" && typeof look === "object" && look !== null;
}

// src/view/look/looks.ts
var DEFAULT_SHADING = {
  ambient: 0.22,
  diffuse: 1,
  specular: 0.25,
  specular_power: 16,
  gradient_smoothing: 0.8,
  gradient_offset: 1,
  unoriented: 0.5,
  shoulder: 0.75,
  exposure: 1,
  lights: [],
  ambient_occlusion: 0,
  occlusion_radius: null,
  shadow: 0
};
var DEFAULT_LIGHTS = [
  { direction: [-0.55, 0.65, 1], color: [1, 1, 1], frame: "camera" },
  { direction: [0, 0, 1], color: [0.3, 0.3, 0.3], frame: "camera" }
];
var DEFAULT_BACKGROUND = "black";
function chosen(state, layer, look, composite) {
  const before = state.layers[layer]?.look;
  const operations = [set(look, "layers", layer, "look")];
  if (state.shading !== "look" && state.layers.length === 1) operations.push(set("look", "shading"));
  const named = look.composite === "first-hit" ? "over" : look.composite;
  if (state.layers.length === 1) operations.push(set(composite ?? named, "render", "composite"));
  const [old, now] = [before?.background ?? DEFAULT_BACKGROUND, look.background ?? DEFAULT_BACKGROUND];
  if (layer === 0 && state.background === old && old !== now) operations.push(set(now, "background"));
  return operations;
}
function shadingOf(state, layer) {
  if (state.shading !== "look") return { shading: state.shading, path: ["shading"] };
  return { shading: state.layers[layer]?.look.shading ?? null, path: ["layers", layer, "look", "shading"] };
}
async function lookAsChosen(engine, welcome, layer, name) {
  const own = ownPreset(name);
  if (own !== void 0) return own.look;
  if (name === "auto" || welcome.presets.some((preset) => preset.name === name)) {
    return (await engine.ask("preset", { layer, name })).look;
  }
  return welcome.state.layers[layer]?.look ?? null;
}
function lookText(look) {
  return `${JSON.stringify({ version: 1, ...look }, null, 2)}
`;
}
function lookFromText(text) {
  const found = JSON.parse(text);
  if (typeof found !== "object" || found === null || !("transfer_function" in found)) {
    throw new Error("it has no field 'transfer_function'; choose a file that was exported here or by Look.save");
  }
  const { version: _3, kind: __, ...look } = found;
  const empty = {
    name: "",
    description: "",
    shading: DEFAULT_SHADING,
    composite: "over",
    view: null,
    background: null
  };
  return { ...empty, ...look };
}
function anglesOf([x2, y3, z3]) {
  const degrees = 180 / Math.PI;
  const length2 = Math.hypot(x2, y3, z3) || 1;
  return [degrees * Math.atan2(x2, z3), degrees * Math.asin(y3 / length2)];
}
function directionOf([azimuth, elevation]) {
  const [a4, e3] = [azimuth * Math.PI / 180, elevation * Math.PI / 180];
  return [Math.sin(a4) * Math.cos(e3), Math.sin(e3), Math.cos(a4) * Math.cos(e3)];
}
function hexColor(color, named) {
  if (color === null) return "#000000";
  if (typeof color !== "string") {
    const byte = (share) => Math.round(255 * Math.min(1, Math.max(0, share))).toString(16).padStart(2, "0");
    return `#${color.slice(0, 3).map(byte).join("")}`;
  }
  const digits = /^#([0-9a-f]{3,8})$/i.exec(color)?.[1];
  if (digits === void 0) return named(color);
  const six = digits.length < 6 ? digits.slice(0, 3).replace(/./g, "$&$&") : digits.slice(0, 6);
  return `#${six.toLowerCase()}`;
}
function namedColor(name) {
  const context = document.createElement("canvas").getContext("2d");
  if (context === null) return "#000000";
  context.fillStyle = "#000000";
  context.fillStyle = name;
  return /^#[0-9a-f]{6}$/.test(context.fillStyle) ? context.fillStyle : "#000000";
}

// src/view/look/point_fields.tsx
var TEXT4 = {
  none: "Choose a point to type its numbers.",
  opacityPoint: (n2, of) => `Opacity point ${n2} of ${of}`,
  colorPoint: (n2, of) => `Colour ${n2} of ${of}`,
  value: "Value",
  opacity: "Opacity",
  color: "Colour",
  remove: "Delete",
  before: "Point before",
  after: "Next point"
};
function PointFields(props) {
  const { curves, selected, onDone } = props;
  const index = selected?.index ?? -1;
  const [node, color] = [curves.opacity[index], curves.color[index]];
  if (selected?.kind === "opacity" && node !== void 0) {
    return /* @__PURE__ */ a3(Point, { ...props, title: TEXT4.opacityPoint, curve: curves.opacity, index, onCurve: props.onOpacity, children: (move) => /* @__PURE__ */ a3(
      NamedNumber,
      {
        label: TEXT4.opacity,
        value: node[1],
        min: 0,
        max: 1,
        step: 0.01,
        onValue: (opacity) => move([node[0], opacity]),
        onDone
      }
    ) });
  }
  if (selected?.kind === "color" && color !== void 0) {
    return /* @__PURE__ */ a3(Point, { ...props, title: TEXT4.colorPoint, curve: curves.color, index, onCurve: props.onColor, children: (move) => /* @__PURE__ */ a3(
      ColorField,
      {
        label: TEXT4.color,
        value: hexOf(color),
        onColor: (hex) => move([color[0], ...rgbOf(hex)]),
        onDone
      }
    ) });
  }
  return /* @__PURE__ */ a3("p", { class: "dim look-small", children: TEXT4.none });
}
function Point(props) {
  const { title, unit: unit2, selected, curve, index, onCurve, onSelect, onDone, children } = props;
  const point = curve[index];
  if (point === void 0) return null;
  const move = (moved) => onCurve(withMoved(curve, index, moved), index);
  const go = (next) => {
    if (selected !== null) onSelect({ ...selected, index: next });
  };
  return /* @__PURE__ */ a3("fieldset", { class: "look-point", children: [
    /* @__PURE__ */ a3("legend", { children: title(index + 1, curve.length) }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(
        NamedNumber,
        {
          label: TEXT4.value,
          unit: unit2,
          value: point[0] ?? 0,
          onValue: (value) => move([value, ...point.slice(1)]),
          onDone
        }
      ),
      children(move)
    ] }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(Button, { label: TEXT4.before, disabled: index === 0, onClick: () => go(index - 1), children: "‹" }),
      /* @__PURE__ */ a3(Button, { label: TEXT4.after, disabled: index === curve.length - 1, onClick: () => go(index + 1), children: "›" }),
      /* @__PURE__ */ a3(
        Button,
        {
          disabled: curve.length === 1,
          onClick: () => {
            onCurve(without(curve, index), Math.max(0, index - 1));
            onDone();
          },
          children: TEXT4.remove
        }
      )
    ] })
  ] });
}

// src/view/look/function_panel.tsx
var TEXT5 = {
  layer: "Layer",
  curve: "Opacity over the values",
  opacity: "opacity",
  log: "Log counts",
  magnified: "Magnify low opacities",
  seen: "Seen",
  from: "Seen from",
  to: "Seen to",
  nearer: "Nearer",
  farther: "Farther",
  all: "All values",
  points: "Points",
  usual: "Usual values",
  addOpacity: "Add opacity point",
  addColor: "Add colour",
  shift: "Shift",
  width: "Width",
  opacities: "Opacities ×",
  global: "Layer opacity",
  mirrorOpacity: "Mirror opacities",
  mirrorColor: "Mirror colours",
  reset: (name) => name === "" ? "Reset" : `Reset to ${name}`,
  gone: "The look as it was chosen is not known any more.",
  table: "This function is a table of value and gradient, which has no single curve to edit. Choose a preset to get one, or make another table in Python.",
  hint: "Double click adds a point. Wheel zooms while a point has the focus, and with Ctrl."
};
var BINS = 256;
var PLOT_PX2 = 190;
var STILL_MS = 120;
var MOST_OPACITY = 10;
var MOST_WIDTH = 4;
function FunctionPanel(props) {
  const { store, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const volume = welcome.volumes[ui.layer];
  if (layer === void 0 || volume === void 0) return null;
  const curves = layer.look.transfer_function;
  return /* @__PURE__ */ a3("div", { class: "look-panel", children: [
    /* @__PURE__ */ a3(LayerChoice, { ...props }),
    isEditable(curves) ? /* @__PURE__ */ a3(Editor, { ...props, curves, look: layer.look, volume }, ui.layer) : /* @__PURE__ */ a3($, { children: [
      /* @__PURE__ */ a3("p", { children: TEXT5.table }),
      /* @__PURE__ */ a3(GlobalOpacity, { ...props })
    ] })
  ] });
}
function LayerChoice({ store, ui }) {
  const { layers } = store.state;
  if (layers.length < 2) return null;
  return /* @__PURE__ */ a3(
    SelectField,
    {
      label: TEXT5.layer,
      value: String(ui.layer),
      options: layers.map(({ name }, index) => ({ value: String(index), text: name })),
      onChoice: (value) => ui.setLayer(Number(value))
    }
  );
}
function Editor(props) {
  const { store, engine, ui, welcome, curves, look, volume } = props;
  const span = spanOfFunction(curves);
  const whole = wholeOf(volume.range, span);
  const usual = wholeOf(volume.robust_range, span);
  const [zoom, setZoom] = d2(usual);
  const [selected, setSelected] = d2(null);
  const [isLog, setLog] = d2(true);
  const [isMagnified, setMagnified] = d2(false);
  const base = T2(null);
  const value = T2(null);
  const seen = within(zoom, whole);
  const histogram = useHistogram(props, seen, isLog);
  const unit2 = volume.value_unit;
  const usualWidth = volume.robust_range[1] - volume.robust_range[0] || 1;
  const path = ["layers", ui.layer, "look", "transfer_function"];
  const done2 = () => {
    base.current = null;
    store.settle();
  };
  const latest = () => {
    const now = store.state.layers[ui.layer]?.look.transfer_function;
    return now !== void 0 && isEditable(now) ? now : curves;
  };
  const setOpacity = (curve, index) => {
    store.change([set(curve, ...path, "opacity")], "opacity curve");
    if (index !== null) setSelected({ kind: "opacity", index });
  };
  const setColor = (curve, index) => {
    store.change([set(curve, ...path, "color")], "colours");
    if (index !== null) setSelected({ kind: "color", index });
  };
  const setAll = (change, gesture) => {
    base.current ??= latest();
    store.change([set(change(base.current), ...path)], gesture);
  };
  const once = (change) => {
    store.change([set(change(latest()), ...path)]);
  };
  const showPoints = () => setZoom(around(spanOf(curves.opacity, curves.color), whole));
  const typeValue = () => value.current?.querySelector("input[type=number]")?.select();
  const chosenIndex = (kind, length2) => selected?.kind === kind && selected.index < length2 ? selected.index : null;
  const opacityIndex = chosenIndex("opacity", curves.opacity.length);
  const colorIndex = chosenIndex("color", curves.color.length);
  const reset = async () => {
    try {
      const first = await lookAsChosen(engine, welcome, ui.layer, look.name);
      if (first === null) ui.announce(TEXT5.gone);
      else store.change([set(first.transfer_function, ...path)]);
    } catch (problem) {
      ui.problem(problem);
    }
  };
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(
      CurvePlot,
      {
        label: TEXT5.curve,
        what: TEXT5.opacity,
        height: PLOT_PX2,
        seen,
        whole,
        unit: unit2,
        curve: curves.opacity,
        latest: () => latest().opacity,
        colors: curves.color,
        histogram,
        isMagnified,
        selected: opacityIndex,
        onSelect: (index) => setSelected({ kind: "opacity", index }),
        onCurve: setOpacity,
        onDone: done2,
        onSeen: setZoom,
        onShowPoints: showPoints,
        onType: typeValue
      }
    ),
    /* @__PURE__ */ a3(
      ColorStrip,
      {
        seen,
        unit: unit2,
        curve: curves.color,
        latest: () => latest().color,
        selected: colorIndex,
        onSelect: (index) => setSelected({ kind: "color", index }),
        onCurve: setColor,
        onDone: done2,
        onType: typeValue,
        onShowPoints: showPoints
      }
    ),
    /* @__PURE__ */ a3("div", { ref: value, children: /* @__PURE__ */ a3(
      PointFields,
      {
        curves,
        selected,
        unit: unit2,
        onOpacity: setOpacity,
        onColor: setColor,
        onDone: done2,
        onSelect: setSelected
      }
    ) }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(
        Button,
        {
          onClick: () => {
            const added2 = withPointBeside(curves.opacity, opacityIndex ?? widestGap(curves.opacity), seen);
            setOpacity(added2.curve, added2.index);
            done2();
          },
          children: TEXT5.addOpacity
        }
      ),
      /* @__PURE__ */ a3(
        Button,
        {
          onClick: () => {
            const added2 = withPointBeside(curves.color, colorIndex ?? widestGap(curves.color), seen);
            setColor(added2.curve, added2.index);
            done2();
          },
          children: TEXT5.addColor
        }
      )
    ] }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(
        NamedNumber,
        {
          shown: TEXT5.seen,
          label: TEXT5.from,
          value: rounded(seen[0], seen[1] - seen[0]),
          onValue: (low) => low < seen[1] && setZoom([low, seen[1]]),
          onDone: () => {
          }
        }
      ),
      /* @__PURE__ */ a3(
        NamedNumber,
        {
          shown: "–",
          label: TEXT5.to,
          unit: unit2,
          value: rounded(seen[1], seen[1] - seen[0]),
          onValue: (high) => high > seen[0] && setZoom([seen[0], high]),
          onDone: () => {
          }
        }
      ),
      /* @__PURE__ */ a3(Button, { label: TEXT5.nearer, onClick: () => setZoom(zoomed2(seen, 1.5, middle(seen), whole)), children: "+" }),
      /* @__PURE__ */ a3(Button, { label: TEXT5.farther, onClick: () => setZoom(zoomed2(seen, 1 / 1.5, middle(seen), whole)), children: "−" })
    ] }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(Button, { onClick: () => setZoom(usual), children: TEXT5.usual }),
      /* @__PURE__ */ a3(Button, { onClick: () => setZoom(whole), children: TEXT5.all }),
      /* @__PURE__ */ a3(Button, { onClick: showPoints, children: TEXT5.points })
    ] }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(CheckField, { label: TEXT5.log, checked: isLog, onCheck: setLog }),
      /* @__PURE__ */ a3(CheckField, { label: TEXT5.magnified, checked: isMagnified, onCheck: setMagnified })
    ] }),
    /* @__PURE__ */ a3("p", { class: "dim look-small", children: TEXT5.hint }),
    /* @__PURE__ */ a3(
      RelativeSlider,
      {
        label: TEXT5.shift,
        unit: unit2,
        neutral: 0,
        amount: (position) => rounded(position * usualWidth, usualWidth),
        position: (amount) => amount / usualWidth,
        onAmount: (amount) => setAll((before) => shifted(before, amount), "shift"),
        onDone: done2
      }
    ),
    /* @__PURE__ */ a3(
      RelativeSlider,
      {
        label: `${TEXT5.width} ×`,
        neutral: 1,
        amount: (position) => MOST_WIDTH ** position,
        position: (amount) => Math.log(amount) / Math.log(MOST_WIDTH),
        onAmount: (amount) => amount > 0 && setAll((before) => widened(before, amount), "width"),
        onDone: done2
      }
    ),
    /* @__PURE__ */ a3(
      RelativeSlider,
      {
        label: TEXT5.opacities,
        neutral: 1,
        amount: (position) => MOST_OPACITY ** position,
        position: (amount) => Math.log(amount) / Math.log(MOST_OPACITY),
        onAmount: (amount) => amount >= 0 && setAll((before) => withOpacities(before, amount), "opacities"),
        onDone: done2
      }
    ),
    /* @__PURE__ */ a3(GlobalOpacity, { ...props }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(Button, { onClick: () => once((before) => ({ ...before, opacity: mirrored(before.opacity) })), children: TEXT5.mirrorOpacity }),
      /* @__PURE__ */ a3(Button, { onClick: () => once((before) => ({ ...before, color: mirrored(before.color) })), children: TEXT5.mirrorColor }),
      /* @__PURE__ */ a3(Button, { onClick: () => void reset(), children: TEXT5.reset(look.name) })
    ] }),
    /* @__PURE__ */ a3(GradientEditor, { ...props, latest: () => latest().gradient_opacity ?? [] })
  ] });
}
function GlobalOpacity({ store, ui }) {
  const opacity = store.state.layers[ui.layer]?.opacity ?? 1;
  return /* @__PURE__ */ a3(
    SliderField,
    {
      label: TEXT5.global,
      min: 0,
      max: 1,
      step: 0.01,
      value: opacity,
      onValue: (value) => store.change([set(value, "layers", ui.layer, "opacity")], "layer opacity"),
      onDone: () => store.settle()
    }
  );
}
function useHistogram({ engine, store, ui }, seen, isLog) {
  const [found, setFound] = d2(null);
  const time = store.state.layers[ui.layer]?.time;
  A2(() => {
    let isStale = false;
    const timer = setTimeout(() => {
      const [low, high] = seen;
      engine.ask("histogram", { layer: ui.layer, bins: BINS, low, high }).then(
        (answer) => {
          if (!isStale) setFound({ counts: answer.counts, range: [answer.low, answer.high] });
        },
        (problem) => {
          if (!isStale) ui.problem(problem);
        }
      );
    }, STILL_MS);
    return () => {
      isStale = true;
      clearTimeout(timer);
    };
  }, [engine, ui.layer, time, seen[0], seen[1]]);
  return found === null ? null : { heights: heights(found.counts, isLog), range: found.range };
}
function widestGap(curve) {
  const gaps = curve.slice(1).map((point, k2) => (point[0] ?? 0) - (curve[k2]?.[0] ?? 0));
  return gaps.length === 0 ? 0 : gaps.indexOf(Math.max(...gaps));
}

// src/view/look/layers.ts
var LABEL_OPACITY = 0.8;
function isSolo(layers, index) {
  return layers.every((layer, k2) => layer.visible === (k2 === index));
}
function soloLayer(layers, index) {
  const all = isSolo(layers, index);
  return layers.map((_3, k2) => set(all || k2 === index, "layers", k2, "visible"));
}
function labelRows(labels, filter = "") {
  const wanted = filter.trim().toLowerCase();
  return Object.entries(labels).sort(([a4], [b]) => Number(a4) - Number(b)).map(([number, look]) => {
    const opacity = look.opacity ?? LABEL_OPACITY;
    return {
      number,
      look,
      name: look.name || `Label ${number}`,
      opacity,
      isShown: opacity > 0 || (look.tint ?? 0) > 0
    };
  }).filter(({ number, name }) => wanted === "" || number === wanted || name.toLowerCase().includes(wanted));
}
var NOTHING = { opacity: 0, tint: 0, scan: 1 };
var USUAL = { opacity: LABEL_OPACITY, tint: 0, scan: 0 };
function shownLabels(labels, isShown, hidden) {
  return labelRows(labels).flatMap(({ number, look, opacity, isShown: before }) => {
    if (before === isShown(number)) return [];
    const now = { opacity, tint: look.tint ?? 0, scan: look.scan ?? (opacity > 0 ? 0 : 1) };
    const next = before ? NOTHING : hidden.get(number) ?? USUAL;
    if (before) hidden.set(number, now);
    const fields = ["opacity", "tint", "scan"];
    return fields.flatMap(
      (field) => now[field] === next[field] ? [] : [set(next[field], "labels", "labels", number, field)]
    );
  });
}
function isSoloLabel(rows, number) {
  return rows.every((row) => row.isShown === (row.number === number));
}

// src/view/look/labels_panel.tsx
var TEXT6 = {
  none: "There is no segmentation. Open one with --labels FILE, or in Python with labels=.",
  filter: "Filter",
  showAll: "Show all",
  hideAll: "Hide all",
  smooth: "Smooth outlines",
  count: (shown, all) => `${shown} of ${all} shown`,
  more: (n2) => `${n2} more; filter by name or number to see them.`,
  empty: "No label has this name or number.",
  shown: (name) => `Show ${name}`,
  color: (name) => `Colour of ${name}`,
  opacity: (name) => `Opacity of ${name}`,
  solo: "Solo",
  soloThis: (name) => `Solo: show ${name} alone, or all again`
};
var MOST_ROWS = 150;
var FILTERED_FROM = 9;
function LabelsPanel({ store }) {
  const [filter, setFilter] = d2("");
  const hidden = w2(() => /* @__PURE__ */ new Map(), [store]);
  const labels = store.state.labels;
  if (labels === null) return /* @__PURE__ */ a3("p", { class: "dim", children: TEXT6.none });
  const all = labelRows(labels.labels);
  const rows = labelRows(labels.labels, filter);
  const show = (isShown) => store.change(shownLabels(store.state.labels?.labels ?? {}, isShown, hidden));
  const inRows = new Set(rows.map(({ number }) => number));
  const isOnShown = new Map(all.map(({ number, isShown }) => [number, isShown]));
  const others = (number) => isOnShown.get(number) ?? false;
  return /* @__PURE__ */ a3("div", { class: "look-panel", children: [
    all.length >= FILTERED_FROM && /* @__PURE__ */ a3("label", { class: "field", children: [
      /* @__PURE__ */ a3("span", { children: TEXT6.filter }),
      /* @__PURE__ */ a3(
        "input",
        {
          type: "search",
          class: "look-grow",
          value: filter,
          onInput: (event) => setFilter(event.currentTarget.value)
        }
      )
    ] }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(Button, { onClick: () => show((number) => inRows.has(number) || others(number)), children: TEXT6.showAll }),
      /* @__PURE__ */ a3(Button, { onClick: () => show((number) => !inRows.has(number) && others(number)), children: TEXT6.hideAll }),
      /* @__PURE__ */ a3("span", { class: "dim", children: TEXT6.count(all.filter(({ isShown }) => isShown).length, all.length) })
    ] }),
    rows.length === 0 && /* @__PURE__ */ a3("p", { class: "dim", children: TEXT6.empty }),
    /* @__PURE__ */ a3("ul", { class: "look-list", "aria-label": "Labels", children: rows.slice(0, MOST_ROWS).map(({ number, name, look, opacity, isShown }) => /* @__PURE__ */ a3("li", { class: "look-label", children: [
      /* @__PURE__ */ a3(
        "input",
        {
          type: "checkbox",
          "aria-label": TEXT6.shown(name),
          checked: isShown,
          onChange: (event) => {
            const on = event.currentTarget.checked;
            show((other) => other === number ? on : others(other));
          }
        }
      ),
      /* @__PURE__ */ a3(
        ColorField,
        {
          label: TEXT6.color(name),
          value: hexColor(look.color, namedColor),
          onColor: (hex) => store.change([set(hex, "labels", "labels", number, "color")], `colour of label ${number}`),
          onDone: () => store.settle()
        }
      ),
      /* @__PURE__ */ a3("span", { class: "look-grow look-name", title: `${name} (${number})`, children: name }),
      /* @__PURE__ */ a3(
        Button,
        {
          label: TEXT6.soloThis(name),
          pressed: all.length > 1 && isSoloLabel(all, number),
          onClick: () => show((other) => isSoloLabel(all, number) || other === number),
          children: TEXT6.solo
        }
      ),
      /* @__PURE__ */ a3(
        SliderField,
        {
          label: TEXT6.opacity(name),
          shown: "",
          min: 0,
          max: 1,
          step: 0.01,
          value: opacity,
          onValue: (value) => store.change([set(value, "labels", "labels", number, "opacity")], `opacity of label ${number}`),
          onDone: () => store.settle()
        }
      )
    ] }, number)) }),
    rows.length > MOST_ROWS && /* @__PURE__ */ a3("p", { class: "dim", children: TEXT6.more(rows.length - MOST_ROWS) }),
    /* @__PURE__ */ a3(
      CheckField,
      {
        label: TEXT6.smooth,
        checked: labels.smooth,
        onCheck: (on) => store.change([set(on, "labels", "smooth")])
      }
    )
  ] });
}

// src/view/look/layers_panel.tsx
var TEXT7 = {
  edit: "Edit the look",
  editThis: (name) => `Edit the look of ${name}`,
  name: (index) => `Name of layer ${index + 1}`,
  shown: (name) => `Show ${name}`,
  opacity: "Opacity",
  opacityOf: (name) => `Opacity of ${name}`,
  solo: "Solo",
  soloThis: (name) => `Solo: show ${name} alone, or all again`,
  look: (look) => `look: ${look || "of its own"}`
};
function LayersPanel({ store, ui }) {
  const { layers } = store.state;
  return /* @__PURE__ */ a3("ul", { class: "look-list", "aria-label": "Layers", children: layers.map((layer, index) => /* @__PURE__ */ a3("li", { class: "look-layer", "data-chosen": index === ui.layer && layers.length > 1, children: [
    /* @__PURE__ */ a3("div", { class: "row look-nowrap", children: [
      /* @__PURE__ */ a3(
        "input",
        {
          type: "checkbox",
          "aria-label": TEXT7.shown(layer.name),
          title: TEXT7.shown(layer.name),
          checked: layer.visible,
          onChange: (event) => store.change([set(event.currentTarget.checked, "layers", index, "visible")])
        }
      ),
      /* @__PURE__ */ a3(Ramp, { layer }),
      /* @__PURE__ */ a3(
        "input",
        {
          type: "text",
          class: "look-grow",
          "aria-label": TEXT7.name(index),
          value: layer.name,
          maxLength: 200,
          onChange: (event) => {
            const name = event.currentTarget.value.trim();
            if (name === "") event.currentTarget.value = layer.name;
            else store.change([set(name, "layers", index, "name")]);
          }
        }
      ),
      layers.length > 1 && /* @__PURE__ */ a3(
        Button,
        {
          label: TEXT7.soloThis(layer.name),
          pressed: isSolo(layers, index),
          onClick: () => store.change(soloLayer(layers, index)),
          children: TEXT7.solo
        }
      )
    ] }),
    /* @__PURE__ */ a3(
      SliderField,
      {
        label: layers.length > 1 ? TEXT7.opacityOf(layer.name) : TEXT7.opacity,
        shown: TEXT7.opacity,
        min: 0,
        max: 1,
        step: 0.01,
        value: layer.opacity,
        onValue: (value) => store.change([set(value, "layers", index, "opacity")], `opacity of layer ${index}`),
        onDone: () => store.settle()
      }
    ),
    layers.length > 1 && /* @__PURE__ */ a3("label", { class: "row look-check", children: [
      /* @__PURE__ */ a3(
        "input",
        {
          type: "radio",
          name: "look-layer",
          "aria-label": TEXT7.editThis(layer.name),
          checked: index === ui.layer,
          onChange: () => ui.setLayer(index)
        }
      ),
      /* @__PURE__ */ a3("span", { children: TEXT7.edit }),
      /* @__PURE__ */ a3("span", { class: "dim", children: TEXT7.look(layer.look.name) })
    ] })
  ] }, index)) });
}
function Ramp({ layer }) {
  const curves = layer.look.transfer_function;
  if (!isEditable(curves)) return /* @__PURE__ */ a3("span", { class: "chip" });
  const [low, high] = spanOf(curves.color);
  const stops = curves.color.map((point) => `${hexOf(point)} ${100 * (point[0] - low) / (high - low || 1)}%`);
  const first = curves.color[0];
  const background = stops.length > 1 ? `linear-gradient(90deg, ${stops.join(", ")})` : first && hexOf(first);
  return /* @__PURE__ */ a3("span", { class: "chip look-chip", style: { background } });
}

// src/view/look/composites.ts
var COMPOSITE_NAMES = {
  over: "Volume rendering (over)",
  maximum: "Maximum intensity (MIP)",
  "depth-shaded-maximum": "Maximum, dimmed by depth",
  "local-maximum": "First local maximum (LMIP)",
  minimum: "Minimum intensity (MinIP)",
  mean: "Mean",
  sum: "Sum",
  "x-ray": "X-ray",
  "first-hit": "Isosurface (first hit)"
};
var KERNEL_NAMES = {
  linear: "Linear",
  "catmull-rom": "Catmull-Rom (sharp)",
  bspline2: "Quadratic B-spline (smooth)",
  bspline3: "Cubic B-spline (smoother)",
  gaussian: "Gaussian"
};
var DIMMING = 0.6;
var SHADED = ["over", "first-hit"];
function nameOf(composite) {
  return typeof composite === "string" ? composite : Object.keys(composite)[0] ?? "over";
}
function numberOf(composite, field) {
  return typeof composite === "string" ? null : composite[nameOf(composite)]?.[field] ?? null;
}
function withNumber(composite, field, value) {
  const name = nameOf(composite);
  const before = typeof composite === "string" ? {} : composite[name] ?? {};
  return { [name]: { ...before, [field]: value } };
}
function compositeNamed(name, isoValue) {
  return name === "first-hit" ? { "first-hit": { iso_value: isoValue } } : name;
}

// src/view/look/light_pad.tsx
var TEXT8 = {
  pad: "Direction of the light",
  keys: "Arrows turn the light, with Page up and down far",
  azimuth: "From right",
  elevation: "From above",
  degrees: "°",
  text: (azimuth, elevation) => `${Math.abs(Math.round(azimuth))}° from the ${azimuth < 0 ? "left" : "right"}, ${Math.abs(Math.round(elevation))}° from ${elevation < 0 ? "below" : "above"}`
};
var SIZE_PX = 96;
var RADIUS_PX = 40;
function LightPad({ direction, latest, onDirection, onDone }) {
  const isDragging = T2(false);
  const [azimuth, elevation] = anglesOf(direction);
  const length2 = Math.hypot(...direction) || 1;
  const spot = { x: direction[0] / length2 * RADIUS_PX, y: -direction[1] / length2 * RADIUS_PX };
  const set2 = (direction2) => onDirection(direction2.map((part) => Number(part.toFixed(4))));
  const turn = (by, up) => {
    const [a4, e3] = anglesOf(latest());
    set2(directionOf([wrapped(a4 + by), Math.max(-90, Math.min(90, e3 + up))]));
  };
  const point = (event) => {
    const box = event.currentTarget.getBoundingClientRect();
    const x2 = (event.clientX - box.left - SIZE_PX / 2) / RADIUS_PX;
    const y3 = -(event.clientY - box.top - SIZE_PX / 2) / RADIUS_PX;
    const share = Math.max(1, Math.hypot(x2, y3));
    const [a4, b] = [x2 / share, y3 / share];
    const front = Math.sqrt(Math.max(0, 1 - a4 * a4 - b * b));
    set2([a4, b, front]);
  };
  const stop = () => {
    if (isDragging.current) onDone();
    isDragging.current = false;
  };
  return /* @__PURE__ */ a3("div", { class: "row look-nowrap", children: [
    /* @__PURE__ */ a3(
      "svg",
      {
        class: "look-pad",
        width: SIZE_PX,
        height: SIZE_PX,
        viewBox: `${-SIZE_PX / 2} ${-SIZE_PX / 2} ${SIZE_PX} ${SIZE_PX}`,
        role: "slider",
        tabindex: 0,
        "aria-label": TEXT8.pad,
        "aria-valuemin": -180,
        "aria-valuemax": 180,
        "aria-valuenow": Math.round(azimuth),
        "aria-valuetext": TEXT8.text(azimuth, elevation),
        "aria-description": TEXT8.keys,
        onPointerDown: (event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          isDragging.current = true;
          point(event);
        },
        onPointerMove: (event) => {
          if (isDragging.current) point(event);
        },
        onLostPointerCapture: stop,
        onKeyUp: onDone,
        onKeyDown: (event) => {
          const steps = {
            ArrowLeft: [-2, 0],
            ArrowRight: [2, 0],
            ArrowUp: [0, 2],
            ArrowDown: [0, -2],
            PageUp: [0, 15],
            PageDown: [0, -15],
            Home: [-15, 0],
            End: [15, 0]
          };
          const step = steps[event.key];
          if (step === void 0) return;
          event.preventDefault();
          event.stopPropagation();
          turn(...step);
        },
        children: [
          /* @__PURE__ */ a3("circle", { class: "look-ball", r: RADIUS_PX }),
          /* @__PURE__ */ a3("path", { class: "look-grid", d: `M${-RADIUS_PX} 0 H${RADIUS_PX} M0 ${-RADIUS_PX} V${RADIUS_PX}` }),
          /* @__PURE__ */ a3("circle", { class: "look-spot", cx: spot.x, cy: spot.y, r: 6, "data-behind": direction[2] < 0 })
        ]
      }
    ),
    /* @__PURE__ */ a3("div", { class: "look-grow look-angles", children: [
      /* @__PURE__ */ a3(
        Angle,
        {
          label: TEXT8.azimuth,
          value: azimuth,
          most: 180,
          onValue: (angle) => set2(directionOf([angle, elevation])),
          onDone
        }
      ),
      /* @__PURE__ */ a3(
        Angle,
        {
          label: TEXT8.elevation,
          value: elevation,
          most: 90,
          onValue: (angle) => set2(directionOf([azimuth, angle])),
          onDone
        }
      )
    ] })
  ] });
}
function Angle(props) {
  const { label, value, most, onValue, onDone } = props;
  return /* @__PURE__ */ a3("div", { class: "row", children: [
    /* @__PURE__ */ a3("span", { "aria-hidden": "true", children: label }),
    /* @__PURE__ */ a3(
      NumberField,
      {
        label,
        unit: "degrees",
        min: -most,
        max: most,
        step: 1,
        value: Math.round(10 * value) / 10,
        onValue,
        onDone
      }
    ),
    /* @__PURE__ */ a3("span", { "aria-hidden": "true", children: TEXT8.degrees })
  ] });
}
function wrapped(degrees) {
  return ((degrees + 180) % 360 + 360) % 360 - 180;
}

// src/view/look/light_panel.tsx
var TEXT9 = {
  composite: "Rays show",
  overOnly: "Several layers, and labels, are drawn by volume rendering alone.",
  iso: "Surface at",
  threshold: "Threshold",
  automatic: (what) => `${what}: automatic`,
  strength: "Dimming",
  clear: "Clear below",
  attenuation: "Attenuation",
  kernel: "Kernel",
  background: "Background",
  shading: "Shading",
  all: "This light is that of all layers.",
  unshaded: "This operator has no shading: light changes nothing here.",
  ambient: "Ambient",
  diffuse: "Diffuse",
  specular: "Specular",
  power: "Shininess",
  exposure: "Exposure",
  shoulder: "Highlights",
  occlusion: "Occlusion",
  radius: "Reach",
  reach: "Reach of occlusion",
  shadow: "Shadow",
  smoothing: "Smoothing",
  smoothingOn: "Smooth surfaces",
  offset: "Normal width",
  world: "The light stands still in the world.",
  reset: "Reset light to the look's"
};
var SMOOTHING = [0.5, 1.25];
var SMOOTH = 0.8;
var WATER = 2059e-8;
function LightPanel(props) {
  return /* @__PURE__ */ a3("div", { class: "look-panel", children: [
    /* @__PURE__ */ a3(Operator, { ...props }),
    /* @__PURE__ */ a3(LayerChoice, { ...props }),
    /* @__PURE__ */ a3(LightFields, { ...props }),
    /* @__PURE__ */ a3(Rest, { ...props })
  ] });
}
function Operator({ store, ui, welcome }) {
  const { render: render2, layers, labels } = store.state;
  const volume = welcome.volumes[ui.layer];
  const name = nameOf(render2.composite);
  const isOverOnly = layers.filter((layer) => layer.visible).length > 1 || labels !== null;
  const look = layers[ui.layer]?.look;
  const [low, high] = volume?.range ?? [0, 1];
  const surface = () => {
    const usual = volume?.robust_range ?? [0, 1];
    return look === void 0 ? (low + high) / 2 : rounded(surfaceValue(look.transfer_function, usual), high - low);
  };
  const number = (field, value, gesture) => store.change([set(withNumber(render2.composite, field, value), "render", "composite")], gesture);
  const slider = (label, field, value, min, max, unit3 = "", beyond = {}) => /* @__PURE__ */ a3(
    SliderField,
    {
      label,
      unit: unit3,
      min,
      max,
      value,
      ...beyond,
      onValue: (next) => number(field, next, `${name} ${field}`),
      onDone: () => store.settle()
    }
  );
  const optional = (label, field, first, min, max, unit3 = "") => {
    const value = numberOf(render2.composite, field);
    return /* @__PURE__ */ a3($, { children: [
      /* @__PURE__ */ a3(
        CheckField,
        {
          label: TEXT9.automatic(label),
          checked: value === null,
          onCheck: (on) => number(field, on ? null : first)
        }
      ),
      value !== null && slider(label, field, value, min, max, unit3, { least: -Infinity, most: Infinity })
    ] });
  };
  const unit2 = volume?.value_unit ?? "";
  const attenuation = unit2 === "HU" ? WATER : 3 / ((high - low || 1) * longestSide(volume?.bounds));
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(
      SelectField,
      {
        label: TEXT9.composite,
        value: name,
        options: welcome.composites.map((value) => ({
          value,
          text: COMPOSITE_NAMES[value] ?? value,
          disabled: isOverOnly && value !== "over" && value !== name
        })),
        onChoice: (value) => store.change([set(compositeNamed(value, surface()), "render", "composite")])
      }
    ),
    isOverOnly && /* @__PURE__ */ a3("p", { class: "dim look-small", children: TEXT9.overOnly }),
    name === "first-hit" && slider(TEXT9.iso, "iso_value", numberOf(render2.composite, "iso_value") ?? surface(), low, high, unit2),
    name === "local-maximum" && optional(TEXT9.threshold, "threshold", surface(), low, high, unit2),
    name === "depth-shaded-maximum" && slider(TEXT9.strength, "strength", numberOf(render2.composite, "strength") ?? DIMMING, 0, 1),
    name === "x-ray" && optional(TEXT9.clear, "clear", low, low, high, unit2),
    name === "x-ray" && optional(TEXT9.attenuation, "attenuation", attenuation, attenuation / 100, 5 * attenuation)
  ] });
}
function LightFields({ store, engine, ui, welcome }) {
  const { state } = store;
  const { shading, path } = shadingOf(state, ui.layer);
  const look = state.layers[ui.layer]?.look;
  const kept = T2(null);
  if (shading !== null) kept.current = shading;
  const name = nameOf(state.render.composite);
  const isShaded = SHADED.includes(name);
  const reset = async () => {
    try {
      const first2 = look === void 0 ? null : await lookAsChosen(engine, welcome, ui.layer, look.name);
      const operations = state.shading === "look" ? [] : [set("look", "shading")];
      if (first2 !== null) store.change([...operations, set(first2.shading, "layers", ui.layer, "look", "shading")]);
    } catch (problem) {
      ui.problem(problem);
    }
  };
  const toggle = (on) => store.change([set(on ? kept.current ?? DEFAULT_SHADING : null, ...path)]);
  const resetButton = /* @__PURE__ */ a3(Button, { onClick: () => void reset(), children: TEXT9.reset });
  const head = /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(CheckField, { label: TEXT9.shading, checked: shading !== null, onCheck: toggle }),
    !isShaded && /* @__PURE__ */ a3("p", { class: "dim look-small", children: TEXT9.unshaded }),
    state.shading !== "look" && state.layers.length > 1 && /* @__PURE__ */ a3("p", { class: "dim look-small", children: TEXT9.all })
  ] });
  if (shading === null) {
    return /* @__PURE__ */ a3($, { children: [
      head,
      resetButton
    ] });
  }
  const change = (field, value) => store.change([set(value, ...path, field)], `light ${field}`);
  const done2 = () => store.settle();
  const slider = (label, field, min, max, more = {}) => /* @__PURE__ */ a3(
    SliderField,
    {
      label,
      min,
      max,
      value: shading[field] ?? min,
      ...more,
      onValue: (value) => change(field, value),
      onDone: done2
    },
    field
  );
  const lights = lightsOf(shading);
  const first = lights[0];
  const latest = () => (lightsOf(shadingOf(store.state, ui.layer).shading ?? shading)[0] ?? first).direction;
  const setDirection = (direction) => change("lights", [{ ...first, direction }, ...lights.slice(1)]);
  const isSmooth = shading.gradient_smoothing > 0;
  const side = longestSide(welcome.volumes[ui.layer]?.bounds);
  return /* @__PURE__ */ a3($, { children: [
    head,
    slider(TEXT9.exposure, "exposure", 0, 3, { most: 100, step: 0.01 }),
    slider(TEXT9.ambient, "ambient", 0, 1, { most: 10, step: 0.01 }),
    slider(TEXT9.diffuse, "diffuse", 0, 2, { most: 10, step: 0.01 }),
    slider(TEXT9.specular, "specular", 0, 1, { most: 10, step: 0.01 }),
    slider(TEXT9.power, "specular_power", 1, 100, { most: 1e3, step: 1 }),
    slider(TEXT9.shoulder, "shoulder", 0, 1, { step: 0.01 }),
    slider(TEXT9.occlusion, "ambient_occlusion", 0, 1, { step: 0.01 }),
    shading.ambient_occlusion > 0 && /* @__PURE__ */ a3($, { children: [
      /* @__PURE__ */ a3(
        CheckField,
        {
          label: TEXT9.automatic(TEXT9.reach),
          checked: shading.occlusion_radius === null,
          onCheck: (on) => store.change([set(on ? null : side / 10, ...path, "occlusion_radius")])
        }
      ),
      shading.occlusion_radius !== null && slider(TEXT9.radius, "occlusion_radius", side / 500, side / 2, {
        unit: welcome.volumes[ui.layer]?.unit ?? ""
      })
    ] }),
    slider(TEXT9.shadow, "shadow", 0, 1, { step: 0.01 }),
    first["frame"] === "world" && /* @__PURE__ */ a3("p", { class: "dim look-small", children: TEXT9.world }),
    /* @__PURE__ */ a3(LightPad, { direction: first.direction, latest, onDirection: setDirection, onDone: done2 }),
    /* @__PURE__ */ a3(
      CheckField,
      {
        label: TEXT9.smoothingOn,
        checked: isSmooth,
        onCheck: (on) => store.change([set(on ? SMOOTH : 0, ...path, "gradient_smoothing")])
      }
    ),
    isSmooth ? slider(TEXT9.smoothing, "gradient_smoothing", ...SMOOTHING, { unit: "voxels", step: 0.01 }) : slider(TEXT9.offset, "gradient_offset", 0.01, 4, { unit: "voxels", step: 0.01 }),
    resetButton
  ] });
}
function Rest({ store, welcome }) {
  const { render: render2, background } = store.state;
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(
      SelectField,
      {
        label: TEXT9.kernel,
        value: render2.kernel,
        options: welcome.kernels.map((value) => ({ value, text: KERNEL_NAMES[value] ?? value })),
        onChoice: (value) => store.change([set(value, "render", "kernel")])
      }
    ),
    /* @__PURE__ */ a3("div", { class: "field", children: [
      /* @__PURE__ */ a3("span", { "aria-hidden": "true", children: TEXT9.background }),
      /* @__PURE__ */ a3(
        ColorField,
        {
          label: TEXT9.background,
          value: hexColor(background, namedColor),
          onColor: (hex) => store.change([set(hex, "background")], "background"),
          onDone: () => store.settle()
        }
      )
    ] })
  ] });
}
function lightsOf({ lights }) {
  return lights.length > 0 ? lights : DEFAULT_LIGHTS;
}
function longestSide(bounds) {
  if (bounds === void 0) return 1;
  const [lower, upper] = bounds;
  return Math.max(...upper.map((end, axis) => end - (lower[axis] ?? 0)));
}

// src/view/look/own_presets_fields.tsx
var TEXT10 = {
  title: "Save this look",
  name: "Name",
  save: "Save as preset",
  rename: "Rename",
  remove: "Delete",
  export: "Export look…",
  import: "Import look…",
  saved: (name) => `Preset ${name} saved`,
  removed: (name) => `Preset ${name} deleted`,
  notKept: "This preset cannot be kept",
  remedy: "Export the look to a file instead.",
  notRead: "This file is no look"
};
var PICTURE_PX = 96;
function OwnPresets({ store, ui, welcome, own, onOwn, onTake }) {
  const [name, setName] = d2("");
  const [why, setWhy] = d2("");
  const layer = store.state.layers[ui.layer];
  if (layer === void 0) return null;
  const chosen2 = own.find((preset) => preset.name === layer.look.name);
  const taken = ["auto", ...welcome.presets.map((preset) => preset.name)];
  const rename = (to) => store.change([{ op: "replace", path: `/layers/${ui.layer}/look/name`, value: to }]);
  const attempt = (change) => {
    try {
      onOwn(change());
      return true;
    } catch (problem) {
      ui.problem({ code: "not_kept", message: `${TEXT10.notKept}: ${problem.message}`, remedy: TEXT10.remedy });
      return false;
    }
  };
  const checked = () => {
    const wanted = name.trim();
    const found = nameProblem(wanted, taken);
    setWhy(found ?? "");
    return found === null ? wanted : null;
  };
  const save = async () => {
    const wanted = checked();
    if (wanted === null) return;
    const composite = store.state.render.composite;
    const look = {
      ...layer.look,
      name: wanted,
      composite: typeof composite === "string" && store.state.layers.length === 1 ? composite : layer.look.composite,
      background: typeof store.state.background === "string" ? store.state.background : layer.look.background
    };
    const operator = store.state.layers.length === 1 && typeof composite !== "string" ? { composite } : {};
    const picture = await pictureOf(ui.frames["3d"]);
    if (!attempt(() => keepPreset({ name: wanted, look, picture, ...operator }))) return;
    setName("");
    store.change([{ op: "replace", path: `/layers/${ui.layer}/look`, value: look }]);
    ui.announce(TEXT10.saved(wanted));
  };
  const open = async (input) => {
    const file = input.files?.[0];
    if (file === void 0) return;
    try {
      onTake(lookFromText(await file.text()));
    } catch (problem) {
      ui.problem({ code: "no_look", message: `${TEXT10.notRead}: ${file.name}: ${problem.message}` });
    }
    input.value = "";
  };
  return /* @__PURE__ */ a3("details", { class: "look-details", children: [
    /* @__PURE__ */ a3("summary", { children: TEXT10.title }),
    /* @__PURE__ */ a3(
      "form",
      {
        class: "look-panel",
        onSubmit: (event) => {
          event.preventDefault();
          void save();
        },
        children: [
          /* @__PURE__ */ a3("label", { class: "field", children: [
            /* @__PURE__ */ a3("span", { children: TEXT10.name }),
            /* @__PURE__ */ a3(
              "input",
              {
                type: "text",
                class: "look-grow",
                value: name,
                maxLength: 100,
                "aria-invalid": why !== "",
                onInput: (event) => {
                  setName(event.currentTarget.value);
                  setWhy("");
                }
              }
            )
          ] }),
          why !== "" && /* @__PURE__ */ a3("p", { role: "alert", class: "look-why", children: why }),
          /* @__PURE__ */ a3("div", { class: "row", children: [
            /* @__PURE__ */ a3("button", { type: "submit", class: "button", children: TEXT10.save }),
            chosen2 !== void 0 && /* @__PURE__ */ a3($, { children: [
              /* @__PURE__ */ a3(
                Button,
                {
                  label: `${TEXT10.rename} ${chosen2.name}`,
                  onClick: () => {
                    const wanted = checked();
                    if (wanted === null || !attempt(() => renamePreset(chosen2.name, wanted))) return;
                    setName("");
                    rename(wanted);
                  },
                  children: TEXT10.rename
                }
              ),
              /* @__PURE__ */ a3(
                Button,
                {
                  label: `${TEXT10.remove} ${chosen2.name}`,
                  onClick: () => attempt(() => dropPreset(chosen2.name)) && ui.announce(TEXT10.removed(chosen2.name)),
                  children: TEXT10.remove
                }
              )
            ] })
          ] }),
          /* @__PURE__ */ a3("div", { class: "row", children: [
            /* @__PURE__ */ a3(
              Button,
              {
                onClick: () => ui.download(`${layer.look.name || "look"}.json`, lookText(layer.look), "application/json"),
                children: TEXT10.export
              }
            ),
            /* @__PURE__ */ a3("label", { class: "button look-file", children: [
              TEXT10.import,
              /* @__PURE__ */ a3(
                "input",
                {
                  type: "file",
                  class: "hidden",
                  accept: ".json,application/json",
                  onChange: (event) => void open(event.currentTarget)
                }
              )
            ] })
          ] })
        ]
      }
    )
  ] });
}
async function pictureOf(frame) {
  if (frame === void 0) return "";
  const picture = await createImageBitmap(new Blob([frame.bytes], { type: `image/${frame.format}` }));
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = PICTURE_PX;
  const side = Math.min(picture.width, picture.height);
  const context = canvas.getContext("2d");
  context?.drawImage(
    picture,
    (picture.width - side) / 2,
    (picture.height - side) / 2,
    side,
    side,
    0,
    0,
    PICTURE_PX,
    PICTURE_PX
  );
  picture.close();
  return canvas.toDataURL("image/jpeg", 0.8);
}

// src/view/look/preset_pictures.ts
var SIZE_PX2 = 192;
var STILL_MS2 = 350;
var RETRY_MS = 2e3;
var PresetPictures = class {
  constructor(engine, layer, changed) {
    this.engine = engine;
    this.layer = layer;
    this.changed = changed;
  }
  engine;
  layer;
  changed;
  urls = /* @__PURE__ */ new Map();
  reasons = /* @__PURE__ */ new Map();
  wanted = [];
  isBusy = false;
  drawing = null;
  lastChange = -Infinity;
  isClosed = false;
  /** The address of a picture, where there is one. */
  get(name) {
    return this.urls.get(name);
  }
  /** Why there is none. */
  reason(name) {
    return this.reasons.get(name);
  }
  /** Asks for a picture, if it is not there. */
  want(name) {
    if (this.urls.has(name) || this.reasons.has(name) || this.wanted.includes(name) || name === this.drawing) return;
    this.wanted.push(name);
    void this.next();
  }
  /** It has left the screen before its turn. */
  leave(name) {
    this.wanted = this.wanted.filter((other) => other !== name);
  }
  /** Something in the picture is being changed: no pictures for a moment. */
  pause() {
    this.lastChange = performance.now();
  }
  /** All pictures are drawn anew, as they are seen. */
  clear() {
    const before = [...this.urls.keys(), ...this.reasons.keys()];
    this.reasons.clear();
    this.urls.forEach((url) => URL.revokeObjectURL(url));
    this.urls.clear();
    return before;
  }
  close() {
    this.isClosed = true;
    this.wanted = [];
    this.clear();
  }
  async next() {
    if (this.isBusy || this.isClosed) return;
    this.isBusy = true;
    for (; ; ) {
      const wait = this.lastChange + STILL_MS2 - performance.now();
      if (wait > 0) {
        await new Promise((resolve) => setTimeout(resolve, wait));
        continue;
      }
      const name = this.wanted.shift();
      if (name === void 0 || this.isClosed) break;
      this.drawing = name;
      await this.draw(name);
      this.drawing = null;
    }
    this.isBusy = false;
  }
  async draw(name) {
    try {
      const { bytes } = await this.engine.ask("preset_picture", { layer: this.layer, name, size: SIZE_PX2 });
      if (!this.isClosed) this.urls.set(name, URL.createObjectURL(new Blob([bytes], { type: "image/png" })));
    } catch (problem) {
      const { code, message } = problem;
      if (code === "lost") {
        this.wanted.unshift(name);
        await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
        return;
      }
      this.reasons.set(name, message);
    }
    if (!this.isClosed) this.changed();
  }
};

// src/view/look/preset_tiles.tsx
var TEXT11 = { noPicture: "No picture" };
function PresetTiles({ label, tiles, selected, pictures, onChoose }) {
  const list = T2(null);
  const [focused, setFocused] = d2(null);
  const entry = [focused, selected].find((name) => tiles.some((tile) => tile.name === name)) ?? tiles[0]?.name;
  const names = tiles.map(({ name }) => name).join("\n");
  A2(() => {
    const seen = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        const name = target.dataset["name"] ?? "";
        if (isIntersecting) pictures.want(name);
        else pictures.leave(name);
      }
    });
    list.current?.querySelectorAll("[data-drawn]").forEach((tile) => seen.observe(tile));
    return () => seen.disconnect();
  }, [pictures, names]);
  const onKeyDown = (event, index) => {
    const all = [...list.current?.querySelectorAll("[role=option]") ?? []];
    const columns = Math.max(
      1,
      all.findIndex((tile) => tile.offsetTop > (all[0]?.offsetTop ?? 0))
    );
    const row = all.length > columns ? columns : 1;
    const steps = {
      ArrowLeft: index - 1,
      ArrowRight: index + 1,
      ArrowUp: index - row,
      ArrowDown: index + row,
      Home: 0,
      End: all.length - 1
    };
    const target = steps[event.key];
    if (event.key === "Enter" || event.key === " ") onChoose(tiles[index]?.name ?? "");
    else if (target !== void 0) all[Math.max(0, Math.min(all.length - 1, target))]?.focus();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return /* @__PURE__ */ a3("div", { class: "look-tiles", role: "listbox", "aria-label": label, ref: list, children: tiles.map(({ name, description, picture }, index) => {
    const address = picture ?? pictures.get(name);
    const reason = pictures.reason(name);
    const about = reason === void 0 ? description : `${description} ${TEXT11.noPicture}: ${reason}`;
    return /* @__PURE__ */ a3(
      "div",
      {
        class: "look-tile",
        role: "option",
        "aria-selected": name === selected,
        "aria-label": `${name}: ${about}`,
        title: about,
        tabIndex: name === entry ? 0 : -1,
        "data-name": name,
        "data-drawn": picture === void 0 ? true : void 0,
        onClick: () => onChoose(name),
        onFocus: () => setFocused(name),
        onKeyDown: (event) => onKeyDown(event, index),
        children: [
          address ? /* @__PURE__ */ a3("img", { src: address, alt: "", width: 96, height: 96 }) : /* @__PURE__ */ a3("span", { class: "look-blank", children: reason !== void 0 && TEXT11.noPicture }),
          /* @__PURE__ */ a3("span", { class: "look-name", children: name })
        ]
      },
      name
    );
  }) });
}

// src/view/look/preset_search.ts
function matching(presets, search) {
  const words = search.toLowerCase().split(/[\s_-]+/).filter((word) => word !== "");
  const has = (text) => words.every((word) => text.toLowerCase().includes(word));
  const found = presets.filter(({ name, description }) => has(`${name} ${description}`));
  return words.length === 0 ? found : [...found.filter(({ name }) => has(name)), ...found.filter(({ name }) => !has(name))];
}

// src/view/look/presets_panel.tsx
var TEXT12 = {
  search: "Search",
  fitting: "Presets that fit",
  own: "Your own",
  all: (n2) => `All presets (${n2} more)`,
  none: "No preset has this in its name or description.",
  auto: "By the kind of data, from its histogram.",
  redraw: "Draw the pictures anew",
  old: "The camera or the time is another one than in these pictures.",
  chosen: (name) => `Look ${name}`,
  ownPreset: "Saved by you",
  alone: "This look is made for a layer alone: with others it is drawn as a volume, which may hide them."
};
var ALIKE = 0.996;
function PresetsPanel(props) {
  const { store, engine, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const [search, setSearch] = d2("");
  const [showsAll, setShowsAll] = d2(false);
  const [own, setOwn] = d2(() => ownPresets());
  const [, redraw] = _2((count) => count + 1, 0);
  const pictures = w2(() => new PresetPictures(engine, ui.layer, () => redraw(null)), [engine, ui.layer]);
  A2(() => () => pictures.close(), [pictures]);
  A2(() => store.subscribe(() => pictures.pause()), [store, pictures]);
  const now = { camera: store.state.camera, time: layer?.time };
  const drawn2 = T2(now);
  w2(() => drawn2.current = now, [pictures]);
  if (layer === void 0) return null;
  const isOld = drawn2.current.time !== now.time || !looksAlike(drawn2.current.camera, now.camera);
  const drawAnew = () => {
    drawn2.current = now;
    pictures.clear().forEach((name) => pictures.want(name));
    redraw(null);
  };
  const take2 = (look, composite) => {
    store.change(chosen(store.state, ui.layer, look, composite));
    ui.announce(TEXT12.chosen(look.name));
  };
  const choose = async (name) => {
    try {
      take2((await engine.ask("preset", { layer: ui.layer, name })).look);
    } catch (found2) {
      ui.problem(found2);
    }
  };
  const tiles = [
    { name: "auto", description: TEXT12.auto, fits: true },
    ...welcome.presets.map(({ name, description, layers }) => ({ name, description, fits: layers.includes(ui.layer) }))
  ];
  const found = matching(tiles, search);
  const fitting = found.filter(({ fits }) => fits);
  const rest = found.filter(({ fits }) => !fits);
  const ownTiles = matching(
    own.map(({ name, look, picture }) => ({ name, description: look.description || TEXT12.ownPreset, picture })),
    search
  );
  const grid = { selected: layer.look.name, pictures, onChoose: (name) => void choose(name) };
  return /* @__PURE__ */ a3("div", { class: "look-panel", children: [
    /* @__PURE__ */ a3(LayerChoice, { ...props }),
    /* @__PURE__ */ a3("label", { class: "field", children: [
      /* @__PURE__ */ a3("span", { children: TEXT12.search }),
      /* @__PURE__ */ a3(
        "input",
        {
          type: "search",
          class: "look-grow",
          value: search,
          onInput: (event) => setSearch(event.currentTarget.value)
        }
      )
    ] }),
    ownTiles.length > 0 && /* @__PURE__ */ a3($, { children: [
      /* @__PURE__ */ a3("h3", { children: TEXT12.own }),
      /* @__PURE__ */ a3(
        PresetTiles,
        {
          ...grid,
          label: TEXT12.own,
          tiles: ownTiles,
          onChoose: (name) => {
            const preset = own.find((one) => one.name === name);
            if (preset !== void 0) take2(preset.look, preset.composite);
          }
        }
      )
    ] }),
    fitting.length > 0 && /* @__PURE__ */ a3(PresetTiles, { ...grid, label: TEXT12.fitting, tiles: fitting }),
    rest.length > 0 && /* @__PURE__ */ a3(
      "details",
      {
        class: "look-details",
        open: showsAll || search !== "",
        onToggle: (event) => search === "" && setShowsAll(event.currentTarget.open),
        children: [
          /* @__PURE__ */ a3("summary", { children: TEXT12.all(rest.length) }),
          (showsAll || search !== "") && /* @__PURE__ */ a3(PresetTiles, { ...grid, label: TEXT12.all(rest.length), tiles: rest })
        ]
      }
    ),
    found.length + ownTiles.length === 0 && /* @__PURE__ */ a3("p", { class: "dim", children: TEXT12.none }),
    store.state.layers.length > 1 && layer.look.composite !== "over" && /* @__PURE__ */ a3("p", { class: "look-small", children: TEXT12.alone }),
    isOld && /* @__PURE__ */ a3($, { children: [
      /* @__PURE__ */ a3("p", { class: "dim look-small", children: TEXT12.old }),
      /* @__PURE__ */ a3(Button, { onClick: drawAnew, children: TEXT12.redraw })
    ] }),
    /* @__PURE__ */ a3(OwnPresets, { ...props, own, onOwn: setOwn, onTake: take2 })
  ] });
}
function looksAlike(a4, b) {
  const [one, other] = [axesOf(a4), axesOf(b)];
  return Math.min(dot(one.back, other.back), dot(one.up, other.up)) > ALIKE;
}

// src/view/look/time_steps.ts
function shownViews({ name, main }) {
  if (name === "single") return [main];
  return name === "3d" ? ["3d"] : ["3d", ...PANES];
}
function nextTime(time, count, repeats) {
  if (time + 1 < count) return time + 1;
  return repeats && count > 1 ? 0 : null;
}
function waitFor(now, last, perSecond) {
  if (!last.isShown) return null;
  return Math.max(0, last.at + 1e3 / perSecond - now);
}

// src/view/look/time_bar.tsx
var TEXT13 = {
  title: "Time",
  of: (time, count) => `${time + 1} of ${count}`,
  before: "Time before",
  next: "Next time",
  play: "Play",
  pause: "Pause",
  rate: "Frames a second",
  perSecond: "a second",
  repeat: "Repeat"
};
var MOST_RATE = 60;
var GESTURE = "time";
function TimeBar({ store, ui, welcome }) {
  const count = Math.max(1, ...welcome.volumes.map((volume) => volume.n_times));
  const series = welcome.volumes.flatMap((volume, index) => volume.n_times > 1 ? [index] : []);
  const timeNow = () => Math.max(0, ...series.map((index) => store.state.layers[index]?.time ?? 0));
  const time = timeNow();
  const [isPlaying, setPlaying] = d2(false);
  const [rate, setRate] = d2(10);
  const [repeats, setRepeats] = d2(true);
  const last = T2({ at: 0, seq: 0 });
  const go = (next) => {
    const operations = series.map(
      (index) => set(Math.min(next, (welcome.volumes[index]?.n_times ?? 1) - 1), "layers", index, "time")
    );
    store.change(operations, GESTURE);
    last.current = { at: performance.now(), seq: store.seq };
  };
  const step = (by) => {
    go((timeNow() + by + count) % count);
    store.settle();
  };
  const stop = () => {
    setPlaying(false);
    store.settle();
  };
  const toggle = () => {
    if (isPlaying) stop();
    else {
      if (time === count - 1 && !repeats) go(0);
      setPlaying(true);
    }
  };
  const isShown = shownViews(store.state.view.layout).every(
    (view) => (ui.frames[view]?.seq ?? Infinity) >= last.current.seq
  );
  A2(() => {
    if (!isPlaying) return void 0;
    const wait = waitFor(performance.now(), { at: last.current.at, isShown }, rate);
    if (wait === null) return void 0;
    const timer = setTimeout(() => {
      const next = nextTime(time, count, repeats);
      if (next === null) stop();
      else go(next);
    }, wait);
    return () => clearTimeout(timer);
  }, [isPlaying, isShown, time, rate, repeats]);
  if (count < 2) return null;
  return /* @__PURE__ */ a3("div", { class: "look-time", role: "group", "aria-label": TEXT13.title, children: [
    /* @__PURE__ */ a3(Button, { label: TEXT13.before, onClick: () => step(-1), children: "‹" }),
    /* @__PURE__ */ a3(Button, { pressed: isPlaying, onClick: toggle, children: isPlaying ? TEXT13.pause : TEXT13.play }),
    /* @__PURE__ */ a3(Button, { label: TEXT13.next, onClick: () => step(1), children: "›" }),
    /* @__PURE__ */ a3(
      "input",
      {
        type: "range",
        "aria-label": TEXT13.title,
        "aria-valuetext": TEXT13.of(time, count),
        min: 0,
        max: count - 1,
        step: 1,
        value: time,
        onInput: (event) => {
          setPlaying(false);
          go(event.currentTarget.valueAsNumber);
        },
        onChange: () => store.settle()
      }
    ),
    /* @__PURE__ */ a3("output", { class: "look-count", children: TEXT13.of(time, count) }),
    /* @__PURE__ */ a3("label", { class: "row", children: [
      /* @__PURE__ */ a3(
        NumberField,
        {
          label: TEXT13.rate,
          min: 0.2,
          max: MOST_RATE,
          step: 1,
          value: rate,
          onValue: setRate,
          onDone: () => {
          }
        }
      ),
      /* @__PURE__ */ a3("span", { class: "dim", "aria-hidden": "true", children: TEXT13.perSecond })
    ] }),
    /* @__PURE__ */ a3(CheckField, { label: TEXT13.repeat, checked: repeats, onCheck: setRepeats })
  ] });
}

// src/view/look/window_drag.ts
var TEXT14 = { table: "The function of this layer is a table; it has no window" };
function windowDrag({ store, ui, welcome }, dx, dy) {
  const layer = store.state.layers[ui.layer];
  const range = welcome.volumes[ui.layer]?.robust_range;
  if (layer === void 0 || range === void 0 || dx === 0 && dy === 0) return;
  if (!isEditable(layer.look.transfer_function)) {
    ui.announce(TEXT14.table);
    return;
  }
  const { transfer_function } = windowed(layer.look, dx, dy, range);
  store.change([set(transfer_function, "layers", ui.layer, "look", "transfer_function")], "window of the function");
}

// src/view/look/look.css
var look_default = '.look-panel { display: grid; gap: 8px; min-width: 0 }\n.look-panel > *, .look-details > *, .look-list > * { min-width: 0 }\n.look-grow { flex: 1 1 0; min-width: 0 }\n.look-nowrap { flex-wrap: nowrap }\n.look-small { font-size: 12px }\n.look-check { min-height: 24px; flex-wrap: nowrap }\n.look-check > span { min-width: 0 }\n.look-panel .field > span:first-child { flex: 0 0 96px }\n.look-slider > span:first-child { flex: 0 0 96px }\n.look-slider input[type="number"] { flex: 0 0 72px; width: 72px }\n.look-plot { display: block; width: 100%; touch-action: pan-y; user-select: none; overflow: visible }\n.look-grid { stroke: var(--line); stroke-width: 1; opacity: .55 }\n.look-tick { fill: var(--dim); font-size: 11px }\n.look-counts { fill: var(--text); fill-opacity: .22 }\n.look-line { fill: none; stroke: var(--text); stroke-width: 1.5 }\n.look-line-under { fill: none; stroke: var(--panel); stroke-width: 4 }\n.look-handle { cursor: grab; touch-action: none }\n.wavesplat .look-handle:focus, .wavesplat .look-mark:focus, .look-pad:focus:not(:focus-visible) { outline: none }\n.look-handle:active { cursor: grabbing }\n.look-reach { fill: transparent; stroke: none }\n.look-dot { fill: var(--panel); stroke: var(--text); stroke-width: 2 }\n.look-handle[data-selected="true"] .look-dot { fill: var(--accent); stroke-width: 2.5 }\n.look-handle:focus-visible .look-reach { stroke: var(--focus); stroke-width: 2 }\n.look-mark { cursor: pointer }\n.look-mark path { fill: var(--accent); stroke: var(--panel) }\n.look-mark:focus-visible .look-reach { stroke: var(--focus); stroke-width: 2 }\n.look-ramp { stroke: var(--line) }\n.look-point { border: 1px solid var(--line); border-radius: var(--radius); display: grid; gap: 6px; margin: 0; padding: 4px 8px 8px; min-width: 0 }\n.look-point legend { color: var(--dim); font-size: 12px; padding: 0 4px }\n.look-details { border-top: 1px solid var(--line); padding-top: 6px }\n.look-details > summary { cursor: pointer; min-height: 24px; margin-bottom: 6px }\n.look-details > * + * { margin-top: 6px }\n.look-tiles { display: grid; grid-template-columns: repeat(auto-fill, 98px); gap: 6px; justify-content: space-between }\n.look-tile { display: grid; gap: 2px; border: 1px solid var(--line); border-radius: 4px; cursor: pointer; overflow: hidden; align-content: start }\n.look-tile:hover { border-color: var(--accent) }\n.look-tile[aria-selected="true"] { border-color: var(--accent); box-shadow: 0 0 0 2px var(--accent) }\n.look-tile[aria-selected="true"] .look-name { background: var(--accent); color: var(--accent-text) }\n.look-tile img, .look-blank { display: block; width: 96px; height: 96px; background: #000 }\n.look-blank { background: var(--raised); color: var(--dim); font-size: 12px; padding: 36px 0; text-align: center }\n.look-tile .look-name { padding: 1px 4px 3px; font-size: 12px; line-height: 1.25; overflow-wrap: anywhere }\n.look-name { min-width: 0; overflow: hidden; text-overflow: ellipsis }\n.wavesplat ul.look-list { list-style: none; margin: 0; padding: 0; display: grid; gap: 6px; max-height: 420px; overflow-y: auto }\n.look-layer { display: grid; gap: 4px; padding: 6px; border: 1px solid var(--line); border-radius: var(--radius) }\n.look-layer[data-chosen="true"] { border-color: var(--accent) }\n.look-chip { width: 30px }\n.look-label { display: flex; flex-wrap: wrap; align-items: center; gap: 2px 6px }\n.look-label > .look-name { white-space: nowrap }\n.look-label > .look-slider { flex: 1 0 100%; padding-left: 30px }\n.look-pad { flex: none; cursor: crosshair; touch-action: none; border-radius: var(--radius) }\n.look-ball { fill: var(--raised); stroke: var(--line) }\n.look-spot { fill: var(--accent); stroke: var(--text); stroke-width: 2 }\n.look-spot[data-behind="true"] { fill: none }\n.look-angles { display: grid; gap: 6px }\n.look-angles .row > span:first-child { flex: 0 0 92px; color: var(--dim) }\n.look-time { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 8px; padding: 4px 10px; background: var(--panel); border-top: 1px solid var(--line) }\n.look-time input[type="range"] { flex: 1 1 120px }\n.look-time input[type="number"] { width: 56px }\n.look-count { font-variant-numeric: tabular-nums; min-width: 62px }\n.look-file { position: relative; display: inline-flex; align-items: center }\n.look-file:focus-within { outline: 2px solid var(--focus); outline-offset: 1px }\n.look-why { color: var(--danger) }\n@media (pointer: coarse) { circle.look-reach { r: 22px } }\n@media (forced-colors: active) { .look-ramp, .look-dot, .look-spot { forced-color-adjust: none } }\n.look-named { display: inline-flex; align-items: center; gap: 4px }\n.look-panel .row input[type="number"] { width: 76px }\n';

// src/view/descriptions.ts
var SIDES = [
  ["front", [0, 1, 0]],
  ["back", [0, -1, 0]],
  ["left", [-1, 0, 0]],
  ["right", [1, 0, 0]],
  ["above", [0, 0, 1]],
  ["below", [0, 0, -1]]
];
var NAMED = 0.35;
function sceneLabel(state) {
  const shown = state.layers.filter((layer) => layer.visible);
  const what = shown.map((layer) => `${layer.name} as ${layer.look.name}`).join(", ") || "nothing";
  const { back } = axesOf(state.camera);
  const sides = SIDES.map(([name, way]) => [name, dot(back, way)]).filter(([, share]) => share > NAMED).sort((a4, b) => b[1] - a4[1]).map(([name]) => name === "above" || name === "below" ? name : `the ${name}`);
  const cut = state.clip.length > 0 ? ", cut open" : "";
  return `${what}, seen from ${sides.join(" and ")}${cut}`;
}
function compositeName(composite) {
  return typeof composite === "string" ? composite : Object.keys(composite)[0] ?? "over";
}
function shortNumber(value, digits = 3) {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 7) return value.toExponential(digits - 1);
  const places = Math.max(0, digits - 1 - size);
  return String(Number(value.toFixed(Math.min(places, 8))));
}

// src/view/handle.tsx
var COARSE = 10;
var STEPS = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: COARSE,
  PageDown: -COARSE
};
function stepOf(event) {
  const step = STEPS[event.key];
  if (step !== void 0) take(event);
  return step;
}
function take(event) {
  event.preventDefault();
  event.stopPropagation();
}
function Handle2(props) {
  const { label, text, value, range, x: x2, y: y3, color, round, onDrag, onKey, onEnd, onDouble } = props;
  const down = (event) => {
    event.stopPropagation();
    const element = event.currentTarget;
    element.setPointerCapture(event.pointerId);
    element.focus({ preventScroll: true });
    const box = element.ownerSVGElement?.getBoundingClientRect();
    let [px2, py] = [event.clientX, event.clientY];
    const move = (moved) => {
      onDrag(moved.clientX - (box?.left ?? 0), moved.clientY - (box?.top ?? 0), moved.clientX - px2, moved.clientY - py);
      [px2, py] = [moved.clientX, moved.clientY];
    };
    const up = () => {
      element.removeEventListener("pointermove", move);
      element.removeEventListener("pointerup", up);
      element.removeEventListener("pointercancel", up);
      onEnd();
    };
    element.addEventListener("pointermove", move);
    element.addEventListener("pointerup", up);
    element.addEventListener("pointercancel", up);
  };
  return /* @__PURE__ */ a3(
    "g",
    {
      "data-handle": true,
      role: "slider",
      tabindex: 0,
      "aria-label": label,
      "aria-valuenow": Number(value.toFixed(3)),
      "aria-valuemin": Number(range[0].toFixed(3)),
      "aria-valuemax": Number(range[1].toFixed(3)),
      "aria-valuetext": text,
      transform: `translate(${x2} ${y3})`,
      onPointerDown: down,
      onKeyDown: onKey,
      onKeyUp: onEnd,
      onDblClick: onDouble,
      children: [
        /* @__PURE__ */ a3("circle", { r: "13", fill: "transparent", stroke: "none" }),
        round ? /* @__PURE__ */ a3("circle", { r: "5", fill: "#000", stroke: color, "stroke-width": "2" }) : /* @__PURE__ */ a3("rect", { x: "-5", y: "-5", width: "10", height: "10", fill: color, stroke: "#000", "stroke-width": "1" })
      ]
    }
  );
}

// src/view/slices/geometry.ts
var AXES2 = { axial: [0, 0, 1], coronal: [0, 1, 0], sagittal: [1, 0, 0] };
function normalOf(state, pane) {
  const tilted2 = state.view.slices.normals?.[pane];
  return tilted2 === void 0 ? AXES2[pane] : unit(tilted2);
}
function worldAt({ geometry, size, width, height }, x2, y3) {
  const [column, row] = [x2 / size.width * width - 0.5, y3 / size.height * height - 0.5];
  const across = scaled(geometry.right, column * geometry.pixel);
  return add(geometry.origin, add(across, scaled(geometry.down, row * geometry.pixel)));
}
function placeOf(frame, point) {
  const { geometry, size, width, height } = frame;
  const from = sub(point, geometry.origin);
  const column = dot(from, geometry.right) / geometry.pixel;
  const row = dot(from, geometry.down) / geometry.pixel;
  return {
    x: (column + 0.5) / width * size.width,
    y: (row + 0.5) / height * size.height,
    away: Math.abs(dot(from, unit(geometry.normal)))
  };
}
function lineOf(frame, other) {
  const along = cross(frame.geometry.normal, other);
  if (length(along) < 1e-6) return null;
  const [dx, dy] = [dot(along, frame.geometry.right), dot(along, frame.geometry.down)];
  const norm = Math.hypot(dx, dy);
  return norm < 1e-9 ? null : { dx: dx / norm, dy: dy / norm };
}
function tilted(frame, other, dx, dy) {
  const before = lineOf(frame, other);
  if (before === null || dx === 0 && dy === 0) return other;
  const { right, down, normal } = frame.geometry;
  let angle = Math.atan2(dy, dx) - Math.atan2(before.dy, before.dx);
  if (angle > Math.PI / 2) angle -= Math.PI;
  if (angle < -Math.PI / 2) angle += Math.PI;
  const axis = unit(cross(right, down));
  const sign = Math.sign(dot(axis, normal)) || 1;
  return unit(turnedAbout(other, scaled(normal, sign), angle * (Math.sign(dot(axis, scaled(normal, sign))) || 1)));
}
function stepped(state, pane, distance2, range) {
  const normal = normalOf(state, pane);
  const { crosshair } = state.view.slices;
  const now = dot(normal, crosshair);
  const next = Math.min(Math.max(now + distance2, range[0]), range[1]);
  return add(crosshair, scaled(normal, next - now));
}
function sampleStep(affine, direction) {
  const column = (axis) => [0, 1, 2].map((row) => affine[row]?.[axis] ?? 0);
  const shares = [0, 1, 2].map((axis) => {
    const step = column(axis);
    const size = length(step);
    return { size, share: Math.abs(dot(step, direction)) / size };
  });
  const best = shares.reduce((a4, b) => b.share > a4.share ? b : a4);
  return best.size * best.share;
}
function barLength(longest) {
  const power = 10 ** Math.floor(Math.log10(longest));
  const lead = longest / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}
var othersOf = (pane) => PANES.filter((one) => one !== pane);
function angleDeg(points) {
  const [a4, b, c3] = points;
  const [from, to] = [sub(a4, b), sub(c3, b)];
  const cos = dot(from, to) / (length(from) * length(to));
  return Math.acos(Math.min(1, Math.max(-1, cos))) * 180 / Math.PI;
}
var distance = (points) => length(sub(points[1], points[0]));

// src/view/slices/measures.tsx
var COLOR = "#7df0ff";
function measured(measure, unit2) {
  return measure.kind === "distance" ? `${shortNumber(distance(measure.points), 4)} ${unit2}` : `${angleDeg(measure.points).toFixed(1)}°`;
}
function Drawn(props) {
  const { store, welcome, ui, placed, moved, isNear } = props;
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const pending = ui.points.map(placed);
  return /* @__PURE__ */ a3("g", { children: [
    store.state.view.measures.map((measure, n2) => {
      const places = measure.points.map(placed);
      if (!isNear(measure.points) || places.some((place) => place === null)) return null;
      const points = places;
      const middle2 = points[measure.kind === "angle" ? 1 : 0];
      const text = measured(measure, unit2);
      return /* @__PURE__ */ a3("g", { children: [
        /* @__PURE__ */ a3("path", { d: `M${points.map(({ x: x2, y: y3 }) => `${x2} ${y3}`).join("L")}`, fill: "none", stroke: COLOR, "stroke-width": "1.5" }),
        /* @__PURE__ */ a3("text", { x: middle2.x + 10, y: middle2.y - 8, children: text }),
        points.map(({ x: x2, y: y3 }, k2) => {
          const change = (to, gesture) => store.change([set(to, "view", "measures", n2, "points", k2)], gesture);
          const now = () => store.state.view.measures[n2]?.points[k2] ?? measure.points[k2];
          return /* @__PURE__ */ a3(
            Handle2,
            {
              round: true,
              label: `Measure ${n2 + 1}, point ${k2 + 1}`,
              text,
              value: k2,
              range: [0, points.length],
              x: x2,
              y: y3,
              color: COLOR,
              onDrag: (_x, _y, dx, dy) => change(moved(now(), dx, dy), "measure"),
              onKey: (event) => {
                const way = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
                if (event.key === "Delete") {
                  event.preventDefault();
                  store.change([{ op: "remove", path: `/view/measures/${n2}` }]);
                }
                if (way === void 0) return;
                take(event);
                change(moved(now(), way[0] ?? 0, way[1] ?? 0), "key measure");
              },
              onEnd: () => store.settle()
            },
            k2
          );
        })
      ] }, n2);
    }),
    pending.map((place, k2) => place && /* @__PURE__ */ a3("circle", { cx: place.x, cy: place.y, r: "4", fill: COLOR, stroke: "#000" }, k2))
  ] });
}
function MeasuresOnSlice(props) {
  const { on, store } = props;
  const thickness = Math.max(store.state.view.slices.thickness / 2, on.geometry.pixel * 1.5);
  return /* @__PURE__ */ a3(
    Drawn,
    {
      ...props,
      placed: (point) => placeOf(on, point),
      moved: (point, dx, dy) => {
        const { x: x2, y: y3 } = placeOf(on, point);
        return add(point, sub(worldAt(on, x2 + dx, y3 + dy), worldAt(on, x2, y3)));
      },
      isNear: (points) => points.every((point) => placeOf(on, point).away <= thickness)
    }
  );
}
function Measures3d(props) {
  const { camera, size } = props;
  return /* @__PURE__ */ a3(
    Drawn,
    {
      ...props,
      placed: (point) => project(camera, size, point),
      moved: (point, dx, dy) => add(point, inPicture(camera, size, point, dx, dy)),
      isNear: () => true
    }
  );
}
var isMeasure = (points) => points.every((point, n2) => n2 === 0 || length(sub(point, scaled(points[n2 - 1], 1))) > 0);

// src/view/measure_panel.tsx
function MeasurePanel({ store, welcome, ui }) {
  const { measures } = store.state.view;
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const csv = () => ["kind,value,unit,points", ...measures.map((one) => {
    const [value, of] = measured(one, unit2).replace("°", " degree").split(" ");
    return `${one.kind},${value},${of},"${one.points.map((point) => point.join(" ")).join("; ")}"`;
  })].join("\n");
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3("div", { class: "row", children: [
      ["distance", "angle"].map((tool) => /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          "aria-pressed": ui.tool === tool,
          onClick: () => ui.setTool(ui.tool === tool ? "turn" : tool),
          children: tool === "distance" ? "Distance" : "Angle"
        },
        tool
      )),
      /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          onClick: () => {
            const { crosshair } = store.state.view.slices;
            ui.addPoint(crosshair);
          },
          disabled: ui.tool !== "distance" && ui.tool !== "angle",
          children: "Point at the crosshair"
        }
      )
    ] }),
    ui.points.length > 0 && /* @__PURE__ */ a3("p", { class: "dim", children: `${ui.points.length} of ${ui.tool === "angle" ? 3 : 2} points` }),
    measures.length === 0 ? /* @__PURE__ */ a3("p", { class: "dim", children: "Choose distance or angle, then click in a slice or in space." }) : /* @__PURE__ */ a3("ol", { children: measures.map((one, n2) => /* @__PURE__ */ a3("li", { children: [
      /* @__PURE__ */ a3("span", { class: "row", children: [
        measured(one, unit2),
        /* @__PURE__ */ a3(
          "button",
          {
            class: "icon-button",
            "aria-label": `Delete measure ${n2 + 1}`,
            onClick: () => store.change([{ op: "remove", path: `/view/measures/${n2}` }]),
            children: "×"
          }
        )
      ] }),
      /* @__PURE__ */ a3("span", { class: "dim", children: one.points.map((point) => `(${point.map((x2) => shortNumber(x2, 4)).join(", ")})`).join(" – ") })
    ] }, n2)) }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3("button", { class: "button", disabled: measures.length === 0, onClick: () => store.change([set([], "view", "measures")]), children: "Delete all" }),
      /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          disabled: measures.length === 0,
          onClick: () => ui.download("measures.csv", csv(), "text/csv"),
          children: "Save as CSV"
        }
      )
    ] })
  ] });
}
function ProbeLine({ ui, welcome }) {
  const { probe: probe2, probed } = ui;
  if (probe2 === null || probed === null) return null;
  const values = probed.values.map((value, n2) => {
    const unit2 = welcome.volumes[n2]?.value_unit ?? "";
    return value === null ? "outside" : `${shortNumber(value, 5)} ${unit2}`.trim();
  });
  const label = probed.label === null ? "" : ` · ${probed.label.name}`;
  return /* @__PURE__ */ a3("span", { children: `${values.join(", ")}${label} at (${probe2.map((x2) => shortNumber(x2, 4)).join(", ")})` });
}

// src/view/overlay3d/box_handles.tsx
var NAMES = ["x", "y", "z"];
var UNITS = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
function BoxHandles(props) {
  const { store, welcome, kind, place, box, camera, size } = props;
  const color = kind === "keep" ? "#ffd166" : "#ff8fb1";
  const what = kind === "keep" ? "Crop" : "Cut-out";
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const change = (next, gesture) => store.change([set({ [kind]: next }, "clip", place)], gesture);
  const now = () => {
    const clip = store.state.clip[place];
    return clip?.[kind] ?? box;
  };
  const points = corners(box).map((corner2) => project(camera, size, corner2));
  const middle2 = project(camera, size, center(box));
  const moveFace = (face, to, gesture) => change(withFace(now(), face, to, welcome.bounds, spacing[face.axis]), gesture);
  return /* @__PURE__ */ a3("g", { children: [
    EDGES.map((edge) => {
      const [a4, b] = [points[edge.a], points[edge.b]];
      if (!a4 || !b) return null;
      const hidden = isHidden(box, edge, camera);
      const line = `M${a4.x} ${a4.y}L${b.x} ${b.y}`;
      return /* @__PURE__ */ a3("path", { d: line, stroke: color, "stroke-width": "1.3", opacity: hidden ? 0.3 : 0.95 }, `${edge.a}${edge.b}`);
    }),
    FACES.map((face) => {
      const at2 = project(camera, size, faceCenter(box, face));
      if (at2 === null) return null;
      const value = box[face.side][face.axis];
      const bounds = [welcome.bounds[0][face.axis], welcome.bounds[1][face.axis]];
      const name = `${what}, ${NAMES[face.axis]} ${face.side === "lower" ? "from" : "to"}`;
      const keys = (event) => {
        const n2 = stepOf(event);
        const end = { Home: bounds[0], End: bounds[1] }[event.key];
        if (n2 === void 0 && end === void 0) return;
        take(event);
        moveFace(face, end ?? now()[face.side][face.axis] + (n2 ?? 0) * spacing[face.axis], "key face");
      };
      return /* @__PURE__ */ a3("g", { opacity: isSeen(box, face, camera) ? 1 : 0.5, children: /* @__PURE__ */ a3(
        Handle2,
        {
          label: name,
          text: `${name} ${shortNumber(value, 4)}`,
          value,
          range: bounds,
          x: at2.x,
          y: at2.y,
          color,
          onDrag: (_x, _y, dx, dy) => {
            const before = now();
            const axis = UNITS[face.axis];
            const way = alongAxis(camera, size, faceCenter(before, face), axis, dx, dy);
            moveFace(face, before[face.side][face.axis] + way, "face");
          },
          onKey: keys,
          onEnd: () => store.settle(),
          onDouble: () => moveFace(face, bounds[face.side === "lower" ? 0 : 1], "face")
        }
      ) }, name);
    }),
    middle2 !== null && /* @__PURE__ */ a3(
      Handle2,
      {
        label: `${what} box`,
        text: `${what} box, middle`,
        value: 0,
        range: [0, 0],
        x: middle2.x,
        y: middle2.y,
        color,
        round: true,
        onDrag: (_x, _y, dx, dy) => {
          const before = now();
          change(movedBy(before, inPicture(camera, size, center(before), dx, dy), welcome.bounds), "box");
        },
        onKey: (event) => {
          const axis = { ArrowRight: 0, ArrowLeft: 0, ArrowUp: 2, ArrowDown: 2, PageUp: 1, PageDown: 1 }[event.key];
          if (axis === void 0) return;
          take(event);
          const sign = event.key === "ArrowRight" || event.key === "ArrowUp" || event.key === "PageUp" ? 1 : -1;
          const by = UNITS[axis]?.map((one) => one * sign * (spacing[axis] ?? 1));
          change(movedBy(now(), add(by, [0, 0, 0]), welcome.bounds), "key box");
        },
        onEnd: () => store.settle()
      }
    )
  ] });
}

// src/view/overlay3d/cube.tsx
var HALF = 24;
var MARGIN2 = 54;
var SIDES2 = [
  { outward: [-1, 0, 0], view: "left" },
  { outward: [1, 0, 0], view: "right" },
  { outward: [0, -1, 0], view: "back" },
  { outward: [0, 1, 0], view: "front" },
  { outward: [0, 0, -1], view: "bottom" },
  { outward: [0, 0, 1], view: "top" }
];
function Cube(props) {
  const { camera, width, welcome } = props;
  const { right, up, back } = axesOf(camera);
  const flat = (point) => `${(dot(point, right) * HALF).toFixed(2)} ${(-dot(point, up) * HALF).toFixed(2)}`;
  const seen = SIDES2.map((side, n2) => ({ ...side, name: welcome.axis_ends[n2] ?? "", towards: dot(side.outward, back) })).filter(({ towards }) => towards > 0.02).sort((a4, b) => a4.towards - b.towards);
  return /* @__PURE__ */ a3("g", { transform: `translate(${width - MARGIN2} ${MARGIN2})`, children: seen.map(({ outward, view, name, towards }) => {
    const axis = outward.findIndex((one) => one !== 0);
    const corner2 = (a4, b) => {
      const point = [...outward];
      point[(axis + 1) % 3] = a4;
      point[(axis + 2) % 3] = b;
      return point;
    };
    const outline2 = [corner2(1, 1), corner2(1, -1), corner2(-1, -1), corner2(-1, 1)].map(flat).join("L");
    const target = welcome.standard_views[view];
    const go = () => {
      if (target !== void 0) showFrom(props, target);
    };
    const shade = Math.round(38 + 70 * towards);
    return /* @__PURE__ */ a3(
      "g",
      {
        "data-handle": true,
        role: "button",
        tabindex: -1,
        "aria-label": `${name}, from the ${view}`,
        onClick: go,
        onPointerDown: (event) => event.stopPropagation(),
        style: { cursor: "pointer" },
        children: [
          /* @__PURE__ */ a3("path", { d: `M${outline2}Z`, fill: `rgb(${shade},${shade},${shade})`, stroke: "#cfd6e0", "stroke-width": "1" }),
          towards > 0.3 && /* @__PURE__ */ a3(
            "text",
            {
              x: dot(outward, right) * HALF,
              y: -dot(outward, up) * HALF + 5,
              "text-anchor": "middle",
              style: { strokeWidth: 0, fontWeight: 600 },
              children: name
            }
          )
        ]
      },
      view
    );
  }) });
}

// src/view/overlay3d/plane_handles.tsx
var COLOR2 = "#8be0d4";
var ARM_PX = 90;
var STEP_SHARE = 0.01;
var STEP_DEG = 2;
function PlaneHandles(props) {
  const { store, welcome, place, plane, camera, size } = props;
  const normal = unit(plane.normal);
  const at2 = project(camera, size, plane.point);
  if (at2 === null) return null;
  const number = store.state.clip.slice(0, place + 1).filter((clip) => "plane" in clip).length;
  const extent = length(sub(welcome.bounds[1], welcome.bounds[0]));
  const arm = ARM_PX * unitsPerPixel(camera, size.height, at2.depth);
  const now = () => store.state.clip[place]?.plane ?? plane;
  const change = (next, gesture) => store.change([set({ plane: next }, "clip", place)], gesture);
  const { right, up } = axesOf(camera);
  const first = unit(Math.abs(dot(up, normal)) < 0.99 ? sub(up, scaled(normal, dot(up, normal))) : sub(right, scaled(normal, dot(right, normal))));
  const second = cross(normal, first);
  const ends = [add(plane.point, scaled(first, arm)), add(plane.point, scaled(second, arm))];
  const square = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(
    ([a4, b]) => project(camera, size, add(plane.point, add(scaled(first, (a4 ?? 0) * arm), scaled(second, (b ?? 0) * arm))))
  );
  const tip = project(camera, size, add(plane.point, scaled(normal, arm * 0.6)));
  const slide = (way, gesture) => {
    const before = now();
    change({ ...before, point: add(before.point, scaled(unit(before.normal), way)) }, gesture);
  };
  const tilt = (axis, angle, gesture) => {
    const before = now();
    change({ ...before, normal: turnedAbout(unit(before.normal), axis, angle) }, gesture);
  };
  return /* @__PURE__ */ a3("g", { stroke: COLOR2, fill: "none", children: [
    square.every((corner2) => corner2 !== null) && /* @__PURE__ */ a3("path", { d: `M${square.map((corner2) => `${corner2?.x} ${corner2?.y}`).join("L")}Z`, "stroke-width": "1.3", fill: COLOR2, "fill-opacity": "0.08" }),
    tip !== null && /* @__PURE__ */ a3("path", { d: `M${at2.x} ${at2.y}L${tip.x} ${tip.y}`, "stroke-width": "2" }),
    /* @__PURE__ */ a3(
      Handle2,
      {
        label: `Clip plane ${number}`,
        text: `Clip plane ${number}, ${shortNumber(dot(plane.point, normal), 4)} along its normal`,
        value: dot(plane.point, normal),
        range: [-extent, extent],
        x: at2.x,
        y: at2.y,
        color: COLOR2,
        onDrag: (_x, _y, dx, dy) => slide(alongAxis(camera, size, now().point, unit(now().normal), dx, dy), "plane"),
        onKey: (event) => {
          const n2 = stepOf(event);
          if (n2 !== void 0) slide(n2 * STEP_SHARE * extent, "key plane");
        },
        onEnd: () => store.settle()
      }
    ),
    ends.map((end, k2) => {
      const shown = project(camera, size, end);
      if (shown === null) return null;
      const axis = k2 === 0 ? second : first;
      return /* @__PURE__ */ a3(
        Handle2,
        {
          round: true,
          label: `Tilt clip plane ${number}, ${k2 === 0 ? "forwards" : "sideways"}`,
          text: `Normal ${normal.map((one) => shortNumber(one, 2)).join(", ")}`,
          value: 0,
          range: [-180, 180],
          x: shown.x,
          y: shown.y,
          color: COLOR2,
          onDrag: (_x, _y, dx, dy) => {
            const way = alongAxis(camera, size, end, normal, dx, dy);
            tilt(axis, (k2 === 0 ? -1 : 1) * Math.atan2(way, arm), "tilt plane");
          },
          onKey: (event) => {
            const n2 = stepOf(event);
            if (n2 !== void 0) tilt(axis, n2 * STEP_DEG * Math.PI / 180, "key tilt plane");
          },
          onEnd: () => store.settle()
        },
        k2
      );
    })
  ] });
}

// src/view/overlay3d/scene_overlay.tsx
var DIRECTIONS = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
var NAMED2 = 0.5;
function SceneOverlay(props) {
  const { frame, size, store } = props;
  const { overlays } = store.state.view;
  const camera = frame.camera ?? store.state.camera;
  const clips = store.state.clip;
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3("svg", { class: "over", children: [
      overlays.crosshair && /* @__PURE__ */ a3(Crosshair, { ...props, camera }),
      overlays.crop_box && ["keep", "cut_out"].map((kind) => {
        const place = placeOfBox(clips, kind);
        const clip = clips[place];
        const box = clip === void 0 ? null : boxOf(clip);
        return box === null ? null : /* @__PURE__ */ a3(BoxHandles, { ...props, ...{ kind, place, box, camera, size } }, kind);
      }),
      overlays.crop_box && clips.map(
        (clip, place) => "plane" in clip ? /* @__PURE__ */ a3(PlaneHandles, { ...props, ...{ place, plane: clip.plane, camera, size } }, place) : null
      ),
      /* @__PURE__ */ a3(Measures3d, { ...props, camera }),
      overlays.letters && /* @__PURE__ */ a3(EdgeLetters, { ...props, camera }),
      overlays.scale_bar && /* @__PURE__ */ a3(ScaleBar, { ...props, camera }),
      overlays.cube && /* @__PURE__ */ a3(Cube, { ...props, camera, width: size.width })
    ] }),
    overlays.color_bar && /* @__PURE__ */ a3(ColorBar, { ...props }),
    overlays.legend && /* @__PURE__ */ a3(Legend, { ...props })
  ] });
}
function Crosshair({ store, welcome, camera, size }) {
  const { crosshair } = store.state.view.slices;
  if (store.state.view.layout.name === "3d") return null;
  const [lower, upper] = welcome.bounds;
  const colors = ["#6ba8ff", "#6bd46b", "#ff6b6b"];
  return /* @__PURE__ */ a3("g", { "aria-hidden": "true", "stroke-width": "1.2", opacity: "0.8", children: [0, 1, 2].map((axis) => {
    const end = (from) => crosshair.map((value, a5) => a5 === axis ? from[a5] : value);
    const [a4, b] = [project(camera, size, end(lower)), project(camera, size, end(upper))];
    return a4 && b ? /* @__PURE__ */ a3("path", { d: `M${a4.x} ${a4.y}L${b.x} ${b.y}`, stroke: colors[axis] }, axis) : null;
  }) });
}
function edgeNames(camera, names) {
  const { right, up } = axesOf(camera);
  const name = (way) => {
    const shares = DIRECTIONS.map((direction, n2) => ({ n: n2, share: dot(direction, way) }));
    return shares.filter(({ share }) => share > NAMED2).sort((a4, b) => b.share - a4.share).map(({ n: n2 }) => names[n2] ?? "").slice(0, 2).join("");
  };
  return { left: name(scaled(right, -1)), right: name(right), top: name(up), bottom: name(scaled(up, -1)) };
}
function EdgeLetters({ welcome, camera, size }) {
  if (!welcome.volumes[0]?.is_anatomical) return null;
  const names = edgeNames(camera, welcome.axis_ends);
  return /* @__PURE__ */ a3("g", { "aria-hidden": "true", "text-anchor": "middle", children: [
    /* @__PURE__ */ a3("text", { x: 16, y: size.height / 2, children: names.left }),
    /* @__PURE__ */ a3("text", { x: size.width - 16, y: size.height / 2, children: names.right }),
    /* @__PURE__ */ a3("text", { x: size.width / 2, y: 18, children: names.top }),
    /* @__PURE__ */ a3("text", { x: size.width / 2, y: size.height - 8, children: names.bottom })
  ] });
}
function ScaleBar({ welcome, camera, size }) {
  const perPixel = unitsPerPixel(camera, size.height);
  const bar = barLength(perPixel * size.width * 0.25);
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const where = camera.parallel_scale === void 0 ? " at the middle" : "";
  const [x2, y3] = [12, size.height - 14];
  return /* @__PURE__ */ a3("g", { "aria-hidden": "true", children: [
    /* @__PURE__ */ a3("path", { d: `M${x2} ${y3}h${bar / perPixel}`, stroke: "#000", "stroke-width": "5" }),
    /* @__PURE__ */ a3("path", { d: `M${x2} ${y3}h${bar / perPixel}`, stroke: "#fff", "stroke-width": "2.5" }),
    /* @__PURE__ */ a3("text", { x: x2, y: y3 - 6, children: `${shortNumber(bar)} ${unit2}${where}` })
  ] });
}
function ColorBar({ store, welcome, ui }) {
  const layer = store.state.layers[ui.layer];
  const info = welcome.volumes[ui.layer];
  if (layer === void 0 || info === void 0 || !("color" in layer.look.transfer_function)) return null;
  const points = layer.look.transfer_function.color;
  const [first, last] = [points[0], points.at(-1)];
  if (first === void 0 || last === void 0 || first[0] === last[0]) return null;
  const stops = points.map(
    ([value, ...rgb]) => `rgb(${rgb.map((one) => Math.round(255 * one)).join()}) ${100 * (value - first[0]) / (last[0] - first[0])}%`
  );
  return /* @__PURE__ */ a3("div", { class: "corner right low color-bar", role: "img", "aria-label": `Colours from ${shortNumber(first[0])} to ${shortNumber(last[0])} ${info.value_unit}`, children: [
    /* @__PURE__ */ a3("span", { children: `${shortNumber(last[0])} ${info.value_unit}` }),
    /* @__PURE__ */ a3("span", { class: "ramp", style: { background: `linear-gradient(to top, ${stops.join(", ")})` } }),
    /* @__PURE__ */ a3("span", { children: shortNumber(first[0]) })
  ] });
}
function Legend({ store }) {
  const { labels, layers } = store.state;
  const rows = Object.entries(labels?.labels ?? {}).filter(([, look]) => (look.opacity ?? 0.8) > 0 || (look.tint ?? 0) > 0).map(([number, look]) => ({ name: look.name || number, color: cssColor(look.color) }));
  if (layers.length > 1 && compositeName(store.state.render.composite) !== "first-hit") {
    rows.push(...layers.filter(({ visible }) => visible).map((layer) => ({ name: layer.name, color: brightest(layer.look.transfer_function) })));
  }
  if (rows.length === 0) return null;
  return /* @__PURE__ */ a3("ul", { class: "corner legend", "aria-label": "Legend", children: rows.slice(0, 24).map(({ name, color }) => /* @__PURE__ */ a3("li", { children: [
    /* @__PURE__ */ a3("span", { class: "chip", style: { background: color } }),
    " ",
    name
  ] }, name)) });
}
function cssColor(color) {
  return typeof color === "string" ? color : `rgb(${color.slice(0, 3).map((one) => Math.round(255 * one)).join()})`;
}
function brightest(curves) {
  const points = curves.color ?? [];
  const sum = (point) => point[1] + point[2] + point[3];
  const best = points.reduce((a4, b) => a4 === null || sum(b) > sum(a4) ? b : a4, null);
  return best === null ? "#888" : cssColor(best.slice(1));
}

// src/input/gestures.ts
var TAP_PX = 4;
var DOUBLE_MS = 400;
var Gestures = class {
  constructor(emit) {
    this.emit = emit;
  }
  emit;
  pointers = /* @__PURE__ */ new Map();
  what = "main";
  begun = { x: 0, y: 0 };
  isDragging = false;
  isPinching = false;
  lastTap = { at: -Infinity, x: 0, y: 0 };
  /** Whether anything is pressed. */
  get isActive() {
    return this.pointers.size > 0;
  }
  down(event, x2, y3) {
    if (this.pointers.size === 1 && event.pointerType === "touch" && this.isDragging) this.endDrag(event.timeStamp);
    this.pointers.set(event.pointerId, { x: x2, y: y3 });
    if (this.pointers.size > 1) {
      this.isPinching = true;
      return;
    }
    this.what = kindOf(event);
    this.begun = { x: x2, y: y3 };
    this.isDragging = false;
  }
  move(event, x2, y3) {
    const before = this.pointers.get(event.pointerId);
    if (before === void 0) return;
    if (this.isPinching) {
      this.pinch(event, before, { x: x2, y: y3 });
      return;
    }
    if (!this.isDragging && Math.hypot(x2 - this.begun.x, y3 - this.begun.y) < TAP_PX) return;
    const [dx, dy] = this.isDragging ? [x2 - before.x, y3 - before.y] : [x2 - this.begun.x, y3 - this.begun.y];
    if (!this.isDragging) {
      this.isDragging = true;
      const { x: x0, y: y0 } = this.begun;
      this.emit({ kind: "drag", phase: "start", what: this.what, x: x0, y: y0, dx: 0, dy: 0 }, event.timeStamp);
    }
    this.pointers.set(event.pointerId, { x: x2, y: y3 });
    this.emit({ kind: "drag", phase: "move", what: this.what, x: x2, y: y3, dx, dy }, event.timeStamp);
  }
  up(event, x2, y3, isCancelled = false) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.isPinching) {
      if (this.pointers.size === 0) {
        this.isPinching = false;
        this.emit({ kind: "pinch", phase: "end", dx: 0, dy: 0, factor: 1, angle: 0 }, event.timeStamp);
      }
      return;
    }
    if (this.isDragging) {
      this.endDrag(event.timeStamp, x2, y3);
      return;
    }
    if (isCancelled || event.button > 0) return;
    const { at: at2, x: x0, y: y0 } = this.lastTap;
    const double = event.timeStamp - at2 < DOUBLE_MS && Math.hypot(x2 - x0, y3 - y0) < 4 * TAP_PX;
    this.lastTap = { at: double ? -Infinity : event.timeStamp, x: x2, y: y3 };
    this.emit({ kind: "tap", x: x2, y: y3, ctrl: event.ctrlKey || event.metaKey, double }, event.timeStamp);
  }
  endDrag(at2, x2 = this.begun.x, y3 = this.begun.y) {
    this.isDragging = false;
    this.emit({ kind: "drag", phase: "end", what: this.what, x: x2, y: y3, dx: 0, dy: 0 }, at2);
  }
  pinch(event, before, after) {
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, after);
    if (other === void 0) return;
    const [from, to] = [vector(other, before), vector(other, after)];
    const lengths = [Math.hypot(from.x, from.y), Math.hypot(to.x, to.y)];
    const turn = Math.atan2(to.y, to.x) - Math.atan2(from.y, from.x);
    this.emit(
      {
        kind: "pinch",
        phase: "move",
        dx: (after.x - before.x) / 2,
        dy: (after.y - before.y) / 2,
        factor: lengths[0] > 0 ? lengths[1] / lengths[0] : 1,
        angle: Math.atan2(Math.sin(turn), Math.cos(turn))
      },
      event.timeStamp
    );
  }
};
function vector(from, to) {
  return { x: to.x - from.x, y: to.y - from.y };
}
function kindOf(event) {
  if (event.button === 1 || event.button === 0 && event.shiftKey) return "pan";
  if (event.button === 2) return "zoom";
  if (event.altKey) return "window";
  if (event.ctrlKey || event.metaKey) return "roll";
  return "main";
}
function wheelFactor(deltaY, deltaMode) {
  const pixels = deltaY * (deltaMode === 1 ? 33 : deltaMode === 2 ? 300 : 1);
  return Math.exp(-Math.min(Math.max(pixels, -300), 300) / 100 * Math.log(1.15));
}
function wheelSteps(deltaY, deltaMode) {
  const pixels = deltaY * (deltaMode === 1 ? 33 : deltaMode === 2 ? 300 : 1);
  return Math.sign(pixels) * Math.max(1, Math.round(Math.abs(pixels) / 100));
}

// src/view/viewport.tsx
var RESIZED_MS = 60;
function Viewport(props) {
  const { view, store, ui, label, children, transform } = props;
  const box = T2(null);
  const canvas = T2(null);
  const [size, setSize] = d2({ width: 0, height: 0 });
  const [hint, setHint] = d2(false);
  const latest = T2(props);
  latest.current = props;
  const sizeNow = T2(size);
  sizeNow.current = size;
  const frame = ui.frames[view];
  useSize(box, props, setSize);
  useFrames(canvas, latest);
  F2(() => {
    const element = box.current;
    if (element === null) return void 0;
    const noted = (at2, act) => {
      const before = store.seq;
      act();
      if (store.seq !== before) ui.statistics.event(store.seq, at2);
    };
    const gestures = new Gestures(
      (gesture, at2) => noted(at2, () => latest.current.onGesture(gesture, sizeNow.current))
    );
    const place = (event) => {
      const { left, top } = element.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    const isHandle = (event) => event.composedPath().some((one) => one instanceof Element && one.hasAttribute("data-handle"));
    const down = (event) => {
      if (isHandle(event)) return;
      element.focus({ preventScroll: true });
      element.setPointerCapture(event.pointerId);
      gestures.down(event, ...place(event));
    };
    const move = (event) => {
      if (gestures.isActive) gestures.move(event, ...place(event));
      else if (!isHandle(event)) {
        const [x2, y3] = place(event);
        latest.current.onHover?.({ x: x2, y: y3 }, sizeNow.current);
      }
    };
    const up = (event) => gestures.up(event, ...place(event));
    const cancel = (event) => gestures.up(event, ...place(event), true);
    const leave = () => latest.current.onHover?.(null, sizeNow.current);
    const wheel = (event) => {
      const root = element.getRootNode();
      const isFocused = element.contains(root.activeElement);
      if (ui.host === "widget" && !isFocused && !event.ctrlKey) {
        setHint(true);
        return;
      }
      event.preventDefault();
      setHint(false);
      const { deltaY, deltaMode } = event;
      const what = { factor: wheelFactor(deltaY, deltaMode), steps: wheelSteps(deltaY, deltaMode), ctrl: event.ctrlKey };
      noted(event.timeStamp, () => latest.current.onWheel(what));
    };
    const key = (event) => {
      const action = actionOf(keyName(event));
      if (action === void 0 || event.defaultPrevented) return;
      noted(event.timeStamp, () => {
        if (latest.current.onAction(action, event.shiftKey, sizeNow.current)) {
          event.preventDefault();
          event.stopPropagation();
        }
      });
    };
    const keyUp = () => store.settle();
    const menu = (event) => event.preventDefault();
    element.addEventListener("pointerdown", down);
    element.addEventListener("pointermove", move);
    element.addEventListener("pointerup", up);
    element.addEventListener("pointercancel", cancel);
    element.addEventListener("pointerleave", leave);
    element.addEventListener("wheel", wheel, { passive: false });
    element.addEventListener("keydown", key);
    element.addEventListener("keyup", keyUp);
    element.addEventListener("contextmenu", menu);
    return () => {
      element.removeEventListener("pointerdown", down);
      element.removeEventListener("pointermove", move);
      element.removeEventListener("pointerup", up);
      element.removeEventListener("pointercancel", cancel);
      element.removeEventListener("pointerleave", leave);
      element.removeEventListener("wheel", wheel);
      element.removeEventListener("keydown", key);
      element.removeEventListener("keyup", keyUp);
      element.removeEventListener("contextmenu", menu);
    };
  }, []);
  const moved = frame !== void 0 && transform !== void 0 && size.width > 0 ? transform(frame, size) : "";
  return /* @__PURE__ */ a3(
    "div",
    {
      class: "viewport",
      ref: box,
      tabIndex: 0,
      role: "group",
      "aria-label": view === "3d" ? "Picture in space" : `Slice, ${view}`,
      "data-view": view,
      onPointerDown: () => setHint(false),
      children: [
        /* @__PURE__ */ a3("canvas", { ref: canvas, role: "img", "aria-label": label, style: { transform: moved } }),
        frame !== void 0 && size.width > 0 && children?.(frame, size),
        hint && /* @__PURE__ */ a3("p", { class: "hint", children: "Click first, or hold Ctrl, to magnify with the wheel" })
      ]
    }
  );
}
function useSize(box, { engine, view }, setSize) {
  A2(() => {
    const element = box.current;
    if (element === null) return void 0;
    let timer;
    let pixels = null;
    let isSeen2 = true;
    const ask = () => {
      const shown = isSeen2 && !document.hidden ? pixels : null;
      engine.show(view, shown);
    };
    const resized = new ResizeObserver(([entry]) => {
      if (entry === void 0) return;
      const { width, height } = entry.contentRect;
      const ratio = window.devicePixelRatio || 1;
      const exact = entry.devicePixelContentBoxSize?.[0];
      const [w3, h3] = exact ? [exact.inlineSize, exact.blockSize] : [width * ratio, height * ratio];
      const isFirst = pixels === null;
      pixels = w3 >= 1 && h3 >= 1 ? { width: Math.round(w3), height: Math.round(h3) } : null;
      setSize({ width, height });
      clearTimeout(timer);
      if (isFirst) ask();
      else timer = setTimeout(ask, RESIZED_MS);
    });
    try {
      resized.observe(element, { box: "device-pixel-content-box" });
    } catch {
      resized.observe(element);
    }
    const seen = new IntersectionObserver(([entry]) => {
      if (entry === void 0 || entry.isIntersecting === isSeen2) return;
      isSeen2 = entry.isIntersecting;
      ask();
    });
    seen.observe(element);
    document.addEventListener("visibilitychange", ask);
    return () => {
      clearTimeout(timer);
      resized.disconnect();
      seen.disconnect();
      document.removeEventListener("visibilitychange", ask);
      engine.show(view, null);
    };
  }, []);
}
function useFrames(canvas, latest) {
  A2(() => {
    const { engine, view } = latest.current;
    let newest = null;
    let isDecoding = false;
    let isGone = false;
    const next = async () => {
      if (isDecoding) return;
      isDecoding = true;
      while (newest !== null && !isGone) {
        const frame = newest;
        newest = null;
        try {
          const picture = await decoded(frame);
          if (!isGone && canvas.current !== null) drawn(canvas.current, picture, frame);
          picture.close();
          latest.current.ui.frameShown(frame);
        } finally {
          engine.shown(frame);
        }
      }
      isDecoding = false;
    };
    const stop = engine.onFrame((frame) => {
      if (frame.view !== view) return;
      if (newest !== null) engine.shown(newest);
      newest = frame;
      void next();
    });
    return () => {
      isGone = true;
      stop();
    };
  }, []);
}
function decoded(frame) {
  const blob = new Blob([frame.bytes], { type: `image/${frame.format}` });
  return createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
}
function drawn(canvas, picture, frame) {
  const scale = Number(frame.settings["scale"] ?? 1);
  const [width, height] = [Math.round(frame.width / scale), Math.round(frame.height / scale)];
  if (frame.at_rest || Math.abs(canvas.width - width) > 2 || Math.abs(canvas.height - height) > 2) {
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
  }
  const context = canvas.getContext("2d");
  if (context === null) return;
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, 0, 0, canvas.width, canvas.height);
  canvas.dataset["seq"] = String(frame.seq);
  canvas.dataset["atRest"] = String(frame.at_rest);
}

// src/view/scene_view.tsx
var KEY_PX = 24;
var KEY_ZOOM = 1.1;
var KEY_ROLL = Math.PI / 36;
var VIEW_KEYS = {
  "view-front": "front",
  "view-back": "back",
  "view-left": "left",
  "view-right": "right",
  "view-top": "top",
  "view-bottom": "bottom"
};
function SceneView(props) {
  const { store, ui, welcome } = props;
  const camera = () => store.state.camera;
  const move = (next, gesture) => store.change([set(next, "camera")], gesture);
  const onGesture = (gesture, size) => {
    if (gesture.kind === "tap") {
      if (gesture.ctrl || ui.tool !== "turn") void pick(props, gesture.x / size.width, gesture.y / size.height, size);
      return;
    }
    if (gesture.phase === "end") {
      store.settle();
      return;
    }
    if (gesture.kind === "pinch") {
      const { dx: dx2, dy: dy2, factor, angle } = gesture;
      const moved = rolled(zoomed(panned(camera(), dx2, dy2, size.height), factor), angle);
      move(moved, "pinch");
      return;
    }
    if (gesture.phase === "start") return;
    const { what, dx, dy } = gesture;
    if (what === "window" || what === "main" && ui.tool === "window") windowDrag(props, dx, dy);
    else if (what === "pan") move(panned(camera(), dx, dy, size.height), "pan");
    else if (what === "zoom") move(zoomed(camera(), Math.exp(-2 * dy / size.height)), "zoom");
    else if (what === "roll") move(rolled(camera(), Math.PI * dx / size.width), "roll");
    else move(turned(camera(), dx, dy, size.height), "turn");
  };
  const onAction = (action, _shift, size) => {
    const turn = (dx, dy) => move(turned(camera(), dx, dy, size.height), "key turn");
    const pan = (dx, dy) => move(panned(camera(), dx, dy, size.height), "key pan");
    const view = VIEW_KEYS[action];
    if (view !== void 0) {
      const next = welcome.standard_views[view];
      if (next !== void 0) showFrom(props, next);
      return true;
    }
    switch (action) {
      case "turn-left":
        turn(-KEY_PX, 0);
        return true;
      case "turn-right":
        turn(KEY_PX, 0);
        return true;
      case "turn-up":
        turn(0, -KEY_PX);
        return true;
      case "turn-down":
        turn(0, KEY_PX);
        return true;
      case "pan-left":
        pan(-KEY_PX, 0);
        return true;
      case "pan-right":
        pan(KEY_PX, 0);
        return true;
      case "pan-up":
        pan(0, -KEY_PX);
        return true;
      case "pan-down":
        pan(0, KEY_PX);
        return true;
      case "zoom-in":
        move(zoomed(camera(), KEY_ZOOM), "key zoom");
        return true;
      case "zoom-out":
        move(zoomed(camera(), 1 / KEY_ZOOM), "key zoom");
        return true;
      case "roll-left":
        move(rolled(camera(), -KEY_ROLL), "key roll");
        return true;
      case "roll-right":
        move(rolled(camera(), KEY_ROLL), "key roll");
        return true;
      case "fit":
        void fit(props, size);
        return true;
      default:
        return false;
    }
  };
  return /* @__PURE__ */ a3(
    Viewport,
    {
      ...props,
      view: "3d",
      label: sceneLabel(store.state),
      onGesture,
      onAction,
      onWheel: ({ factor }) => {
        move(zoomed(camera(), factor), "wheel");
        settleSoon(store);
      },
      transform: (frame, size) => instant(frame, camera(), size),
      children: (frame, size) => /* @__PURE__ */ a3(SceneOverlay, { ...props, frame, size })
    }
  );
}
async function fit({ engine, store, ui }, { width, height }) {
  try {
    const asked = { camera: store.state.camera, width: Math.round(width), height: Math.round(height) };
    store.change([set((await engine.ask("fitted", asked)).camera, "camera")]);
  } catch (problem) {
    ui.problem(problem);
  }
}
var wheelTimer;
function settleSoon(store) {
  clearTimeout(wheelTimer);
  wheelTimer = setTimeout(() => store.settle(), 150);
}
function showFrom({ store }, target) {
  const now = store.state.camera;
  const lens = withLens(target, now.view_angle);
  store.change([set(now.parallel_scale === void 0 ? lens : { ...lens, parallel_scale: now.parallel_scale }, "camera")]);
}
async function pick(props, x2, y3, size) {
  const { engine, store, ui } = props;
  const asked = { x: x2, y: y3, width: Math.round(size.width), height: Math.round(size.height) };
  try {
    const { point } = await engine.ask("pick", asked);
    if (point === null) {
      ui.announce("Nothing is seen there");
      return;
    }
    if (ui.tool === "distance" || ui.tool === "angle") ui.addPoint(point);
    else store.change([set(point, "view", "slices", "crosshair")]);
  } catch (problem) {
    ui.problem(problem);
  }
}
function instant(frame, camera, size) {
  const before = frame.camera;
  if (before === void 0 || before === camera) return "";
  const [old, now] = [axesOf(before), axesOf(camera)];
  if (dot(old.back, now.back) < 1 - 1e-9 || before.view_angle !== camera.view_angle) return "";
  const at2 = (seen, point) => project(seen, size, point);
  const beside = add(before.focal_point, old.right);
  const [a4, b] = [at2(before, before.focal_point), at2(before, beside)];
  const [A3, B3] = [at2(camera, before.focal_point), at2(camera, beside)];
  if (a4 === null || b === null || A3 === null || B3 === null) return "";
  const [dx, dy, DX, DY] = [b.x - a4.x, b.y - a4.y, B3.x - A3.x, B3.y - A3.y];
  const square = dx * dx + dy * dy;
  const [p3, q2] = [(DX * dx + DY * dy) / square, (DY * dx - DX * dy) / square];
  const [tx, ty] = [A3.x - p3 * a4.x + q2 * a4.y, A3.y - q2 * a4.x - p3 * a4.y];
  const numbers = [p3, q2, -q2, p3, tx, ty].map((value) => value.toFixed(6));
  return numbers.join() === IDENTITY ? "" : `matrix(${numbers.join()})`;
}
var IDENTITY = "1.000000,0.000000,-0.000000,1.000000,0.000000,0.000000";

// src/view/settings_panel.tsx
var OVERLAY_NAMES = {
  scale_bar: "Scale bar",
  letters: "Letters of directions",
  cube: "Orientation cube",
  color_bar: "Colour bar",
  crosshair: "Crosshair",
  crop_box: "Crop box and clip planes",
  legend: "Legend"
};
var FIRST_ANGLE = 30;
function SettingsPanel(props) {
  const { store, figures, onFigures } = props;
  const { view, render: render2, camera } = store.state;
  const qualities = ["draft", "normal", "high"];
  const isNamed = typeof render2.quality === "string";
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(
      Choice,
      {
        label: "At rest",
        value: isNamed ? render2.quality : "own",
        options: [...qualities.map((name) => [name, name]), ...isNamed ? [] : [["own", "own sampling"]]],
        onChoose: (value) => value !== "own" && store.change([set(value, "render", "quality")])
      }
    ),
    /* @__PURE__ */ a3(
      Choice,
      {
        label: "While moving",
        value: view.quality.moving,
        options: [["smooth", "Smooth: 30 frames a second"], ["balanced", "Balanced: a better picture"], ["exact", "Exact: never less than at rest"]],
        onChoose: (value) => store.change([set(value, "view", "quality", "moving")])
      }
    ),
    /* @__PURE__ */ a3(
      Switch,
      {
        label: "Perspective",
        on: camera.view_angle !== void 0,
        onToggle: (on) => store.change([set(withLens(camera, on ? FIRST_ANGLE : void 0), "camera")])
      }
    ),
    camera.view_angle !== void 0 && /* @__PURE__ */ a3(
      NumberField2,
      {
        label: "View angle",
        unit: "°",
        value: camera.view_angle,
        min: 5,
        max: 100,
        onInput: (value) => store.change([set(withLens(camera, value), "camera")], "view angle"),
        onSettle: () => store.settle()
      }
    ),
    /* @__PURE__ */ a3(
      Choice,
      {
        label: "Theme",
        value: view.interface.theme,
        options: [["system", "As the system"], ["dark", "Dark"], ["light", "Light"]],
        onChoose: (value) => store.change([set(value, "view", "interface", "theme")])
      }
    ),
    /* @__PURE__ */ a3("fieldset", { children: [
      /* @__PURE__ */ a3("legend", { children: "Over the views" }),
      OVERLAYS.map((name) => /* @__PURE__ */ a3(
        Switch,
        {
          label: OVERLAY_NAMES[name],
          on: view.overlays[name],
          onToggle: (on) => store.change([set(on, "view", "overlays", name)])
        },
        name
      )),
      /* @__PURE__ */ a3(Switch, { label: "Frame rate, latency, error", on: figures, onToggle: onFigures })
    ] })
  ] });
}

// src/view/share.tsx
var SIZES = [
  ["view", "As in the window"],
  ["2", "Twice as large"],
  ["1920x1080", "1920 x 1080"],
  ["3840x2160", "3840 x 2160"],
  ["own", "Own size"]
];
var MOST_SIDE = 8192;
function SharePanel(props) {
  const { store, engine, welcome, ui } = props;
  const [size, setSize] = d2("view");
  const [own, setOwn] = d2([1600, 1200]);
  const [quality, setQuality] = d2("high");
  const [transparent, setTransparent] = d2(false);
  const [annotated, setAnnotated] = d2(false);
  const [part, setPart] = d2(null);
  const [abort, setAbort] = d2(null);
  const [text, setText] = d2("");
  const pixels = () => {
    const frame = ui.frames["3d"];
    const scale = Number(frame?.settings["scale"] ?? 1);
    const [w3, h3] = [Math.round((frame?.width ?? 1024) / scale), Math.round((frame?.height ?? 768) / scale)];
    if (size === "own") return { width: own[0], height: own[1] };
    if (size.includes("x")) {
      const [width = 0, height = 0] = size.split("x").map(Number);
      return { width, height };
    }
    const factor = size === "2" ? 2 : 1;
    return { width: Math.min(factor * w3, MOST_SIDE), height: Math.min(factor * h3, MOST_SIDE) };
  };
  const picture = async (use) => {
    const controller = new AbortController();
    setAbort(controller);
    setPart(0);
    try {
      const asked = { ...pixels(), quality, transparent, annotated };
      const { bytes, notes } = await engine.ask("picture", asked, setPart, controller.signal);
      await use(bytes);
      for (const note of notes) ui.announce(note);
    } catch (problem) {
      if (problem.code !== "cancelled") ui.problem(problemOf(problem));
    } finally {
      setPart(null);
      setAbort(null);
    }
  };
  const code = async (as, use) => {
    try {
      const found = await engine.ask("code", { as, ...pixels() });
      await use(found.text, found.name);
    } catch (problem) {
      ui.problem(problemOf(problem));
    }
  };
  const copy = async (what, name) => {
    setText(what);
    try {
      await navigator.clipboard.writeText(what);
      ui.announce(`${name} copied`);
    } catch {
      ui.announce(`${name} is in the field below; the browser does not let it be copied`);
    }
  };
  const link = async () => {
    const found = await linkPart(store.state, welcome.fingerprint);
    if (found === null) {
      ui.problem({ code: "link", message: "The state is too long for a link", remedy: "Save it as a file instead." });
      return;
    }
    await copy(`${location.origin}${location.pathname}#state=${found}`, "The link");
  };
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3(Choice, { label: "Size", value: size, options: SIZES, onChoose: setSize }),
    size === "own" && /* @__PURE__ */ a3("div", { class: "row", children: ["Width", "Height"].map((name, n2) => /* @__PURE__ */ a3("label", { class: "row", children: [
      name,
      /* @__PURE__ */ a3(
        "input",
        {
          type: "number",
          min: 1,
          max: MOST_SIDE,
          value: own[n2],
          onChange: (event) => {
            const value = Math.min(Math.max(Math.round(event.currentTarget.valueAsNumber || 1), 1), MOST_SIDE);
            setOwn(n2 === 0 ? [value, own[1]] : [own[0], value]);
          }
        }
      )
    ] }, name)) }),
    /* @__PURE__ */ a3(Choice, { label: "Quality", value: quality, options: [["normal", "normal"], ["high", "high"]], onChoose: setQuality }),
    /* @__PURE__ */ a3(Switch, { label: "Transparent background", on: transparent, onToggle: setTransparent }),
    /* @__PURE__ */ a3(Switch, { label: "With scale bar, letters and legend", on: annotated, onToggle: setAnnotated }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3("button", { class: "button", disabled: part !== null, onClick: () => void picture((bytes) => ui.download("picture.png", bytes, "image/png")), children: "Save picture" }),
      /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          disabled: part !== null,
          onClick: () => void picture(async (bytes) => {
            if (typeof ClipboardItem === "undefined") throw new Error("This browser cannot copy pictures; save it instead");
            await navigator.clipboard.write([new ClipboardItem({ "image/png": new Blob([bytes], { type: "image/png" }) })]);
            ui.announce("The picture is copied");
          }),
          children: "Copy picture"
        }
      ),
      abort !== null && /* @__PURE__ */ a3("button", { class: "button", onClick: () => abort.abort(), children: "Cancel" })
    ] }),
    part !== null && /* @__PURE__ */ a3("progress", { "aria-label": "Drawing the picture", max: 1, value: part }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3("button", { class: "button", onClick: () => void code("python", (found) => copy(found, "The Python program")), children: "Copy as Python" }),
      /* @__PURE__ */ a3("button", { class: "button", onClick: () => void code("command", (found) => copy(found, "The command")), children: "Copy as command" }),
      ui.host === "page" && /* @__PURE__ */ a3("button", { class: "button", onClick: () => void link(), children: "Copy link" })
    ] }),
    text !== "" && /* @__PURE__ */ a3("textarea", { "aria-label": "What was copied", readOnly: true, rows: 5, value: text, onFocus: (event) => event.currentTarget.select() }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3("button", { class: "button", onClick: () => void code("state", (found, name) => ui.download(name, found, "application/json")), children: "Save state" }),
      /* @__PURE__ */ a3("label", { class: "button", children: [
        "Open state",
        /* @__PURE__ */ a3(
          "input",
          {
            class: "hidden",
            type: "file",
            accept: ".json,application/json",
            onChange: (event) => {
              const file = event.currentTarget.files?.[0];
              event.currentTarget.value = "";
              if (file !== void 0) void openState(props, file);
            }
          }
        )
      ] }),
      /* @__PURE__ */ a3("button", { class: "button", onClick: () => void code("html", (found, name) => ui.download(name, found, "text/html")), children: "Save page (HTML)" })
    ] })
  ] });
}
async function openState({ engine, store, ui }, file) {
  try {
    const { state } = await engine.ask("open_state", { text: await file.text() });
    store.change([{ op: "replace", path: "", value: state }]);
    ui.announce(`${file.name} is open`);
  } catch (problem) {
    ui.problem(problemOf(problem));
  }
}
function problemOf(problem) {
  if (typeof problem === "object" && problem !== null && "message" in problem) {
    const code = "code" in problem ? String(problem.code) : "failed";
    return { ...problem, code, message: String(problem.message) };
  }
  return { code: "failed", message: String(problem) };
}

// src/view/overlay3d/crop_on_slice.tsx
var COLOR3 = "#ffd166";
var ALONG = 0.999;
function CropOnSlice(props) {
  const { store, welcome, on } = props;
  const place = placeOfBox(store.state.clip, "keep");
  const clip = store.state.clip[place];
  const box = clip === void 0 ? null : boxOf(clip);
  const normalAxis = on.geometry.normal.findIndex((one) => Math.abs(one) > ALONG);
  if (box === null || normalAxis < 0) return null;
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const { crosshair } = store.state.view.slices;
  const inPlane = (point) => point.map((value, a4) => a4 === normalAxis ? crosshair[a4] : value);
  const [from, to] = [placeOf(on, inPlane(box.lower)), placeOf(on, inPlane(box.upper))];
  const [left, top] = [Math.min(from.x, to.x), Math.min(from.y, to.y)];
  const now = () => {
    const found = store.state.clip[place];
    return (found === void 0 ? null : boxOf(found)) ?? box;
  };
  const faces = [0, 1, 2].filter((axis) => axis !== normalAxis).flatMap((axis) => [{ axis, side: "lower" }, { axis, side: "upper" }]);
  return /* @__PURE__ */ a3("g", { children: [
    /* @__PURE__ */ a3("rect", { x: left, y: top, width: Math.abs(to.x - from.x), height: Math.abs(to.y - from.y), stroke: COLOR3, fill: "none", "stroke-width": "1.3" }),
    faces.map((face) => {
      const middle2 = scaled(add(box.lower, box.upper), 0.5);
      const at2 = placeOf(on, inPlane(middle2.map((value2, a4) => a4 === face.axis ? box[face.side][face.axis] : value2)));
      const value = box[face.side][face.axis];
      const bounds = [welcome.bounds[0][face.axis], welcome.bounds[1][face.axis]];
      const name = `Crop, ${"xyz"[face.axis]} ${face.side === "lower" ? "from" : "to"}`;
      const move = (target, gesture) => store.change([set({ keep: withFace(now(), face, target, welcome.bounds, spacing[face.axis]) }, "clip", place)], gesture);
      return /* @__PURE__ */ a3(
        Handle2,
        {
          label: name,
          text: `${name} ${shortNumber(value, 4)}`,
          value,
          range: bounds,
          x: at2.x,
          y: at2.y,
          color: COLOR3,
          onDrag: (_x, _y, dx, dy) => {
            const per = on.geometry.pixel * on.width / on.size.width;
            const way = dx * (on.geometry.right[face.axis] ?? 0) + dy * (on.geometry.down[face.axis] ?? 0);
            move(now()[face.side][face.axis] + way * per, "face");
          },
          onKey: (event) => {
            const n2 = stepOf(event);
            if (n2 === void 0) return;
            move(now()[face.side][face.axis] + n2 * spacing[face.axis], "key face");
          },
          onEnd: () => store.settle()
        },
        name
      );
    })
  ] });
}

// src/view/slices/slice_pane.tsx
var PANE_COLORS = { axial: "#ff6b6b", coronal: "#6bd46b", sagittal: "#6ba8ff" };
var PANE_NAMES = { axial: "Axial", coronal: "Coronal", sagittal: "Sagittal" };
var COARSE2 = 10;
var PROBE_MS = 40;
function SlicePane(props) {
  const { pane, store, ui, welcome } = props;
  const frame = () => ui.frames[pane];
  const slices = () => store.state.view.slices;
  const step = () => sampleStep(welcome.volumes[0]?.affine ?? [], normalOf(store.state, pane));
  const scroll = (n2, gesture) => {
    const range = frame()?.slice?.range;
    if (range === void 0) return;
    store.change([set(stepped(store.state, pane, n2 * step(), range), "view", "slices", "crosshair")], gesture);
  };
  const window2 = (dx, dy, size) => {
    const volume = welcome.volumes[0];
    const now = slices().window ?? frame()?.slice?.window;
    if (volume === void 0 || !now) return;
    const span = volume.robust_range[1] - volume.robust_range[0] || 1;
    const width = Math.max(now[1] + dx / size.width * span, span * 1e-4);
    store.change([set([now[0] - dy / size.height * span, width], "view", "slices", "window")], "window");
  };
  const moveTo = (x2, y3, size, gesture) => {
    const on = sliceFrame(frame(), size);
    if (on !== null) store.change([set(worldAt(on, x2, y3), "view", "slices", "crosshair")], gesture);
  };
  const zoom = (factor) => {
    const next = Math.min(Math.max(slices().zoom * factor, 0.1), 100);
    store.change([set(next, "view", "slices", "zoom")], "slice zoom");
  };
  const onGesture = (gesture, size) => {
    if (gesture.kind === "tap") {
      const on = sliceFrame(frame(), size);
      if ((ui.tool === "distance" || ui.tool === "angle") && on !== null) ui.addPoint(worldAt(on, gesture.x, gesture.y));
      else if (gesture.double && slices().window !== void 0) store.change([{ op: "remove", path: "/view/slices/window" }]);
      else moveTo(gesture.x, gesture.y, size);
      return;
    }
    if (gesture.phase === "end") store.settle();
    else if (gesture.kind === "pinch") zoom(gesture.factor);
    else if (gesture.phase === "start") return;
    else if (gesture.what === "window" || gesture.what === "main" && ui.tool === "window") {
      window2(gesture.dx, gesture.dy, size);
    } else if (gesture.what === "zoom") zoom(Math.exp(-2 * gesture.dy / size.height));
    else if (gesture.what === "main" || gesture.what === "pan") moveTo(gesture.x, gesture.y, size, "crosshair");
  };
  const onAction = (action, shift, size) => {
    const on = sliceFrame(frame(), size);
    const nudge = (right, down) => {
      if (on === null) return true;
      const { geometry } = on;
      const moved = add(scaled(geometry.right, right * step()), scaled(geometry.down, down * step()));
      store.change([set(add(slices().crosshair, moved), "view", "slices", "crosshair")], "key crosshair");
      return true;
    };
    switch (action) {
      case "slice-back":
        scroll(shift ? -COARSE2 : -1, "key slice");
        return true;
      case "slice-on":
        scroll(shift ? COARSE2 : 1, "key slice");
        return true;
      case "turn-left":
        return nudge(-1, 0);
      case "turn-right":
        return nudge(1, 0);
      case "turn-up":
        return nudge(0, -1);
      case "turn-down":
        return nudge(0, 1);
      case "zoom-in":
        zoom(1.1);
        return true;
      case "zoom-out":
        zoom(1 / 1.1);
        return true;
      case "fit":
        store.change([set(1, "view", "slices", "zoom")]);
        return true;
      default:
        return false;
    }
  };
  const cutAt = frame()?.slice;
  const position = cutAt === void 0 ? "" : shortNumber(cutAt.position, 4);
  return /* @__PURE__ */ a3(
    Viewport,
    {
      ...props,
      view: pane,
      label: `${PANE_NAMES[pane]} slice at ${position}`,
      onGesture,
      onAction,
      onWheel: ({ factor, steps, ctrl }) => {
        if (ctrl) zoom(factor);
        else scroll(-steps, "wheel slice");
        settleSoon(store);
      },
      onHover: (place, size) => probe(props, place === null ? null : sliceFrame(frame(), size), place),
      children: (shown, size) => /* @__PURE__ */ a3(SliceOverlay, { ...props, frame: shown, size })
    }
  );
}
function sliceFrame(frame, size) {
  if (frame?.slice === void 0 || size.width === 0) return null;
  return { geometry: frame.slice, size, width: frame.width, height: frame.height };
}
function SliceOverlay(props) {
  const { pane, frame, size, store, welcome } = props;
  const { slices, overlays } = store.state.view;
  const on = sliceFrame(frame, size);
  if (on === null) return null;
  const { geometry } = on;
  const letters = geometry.letters;
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const perCss = geometry.pixel * frame.width / size.width;
  const bar = barLength(perCss * size.width * 0.3);
  const [level, width] = slices.window ?? geometry.window ?? [0, 0];
  const isTilted = slices.normals?.[pane] !== void 0;
  return /* @__PURE__ */ a3($, { children: [
    /* @__PURE__ */ a3("svg", { class: "over", "aria-hidden": false, children: [
      overlays.crosshair && othersOf(pane).map((other) => /* @__PURE__ */ a3(CrosshairLine, { ...props, on, other }, other)),
      overlays.crop_box && /* @__PURE__ */ a3(CropOnSlice, { ...props, on }),
      /* @__PURE__ */ a3(MeasuresOnSlice, { ...props, on }),
      overlays.letters && letters !== null && /* @__PURE__ */ a3("g", { "aria-hidden": "true", "text-anchor": "middle", children: [
        /* @__PURE__ */ a3("text", { x: 14, y: size.height / 2, children: letters.left }),
        /* @__PURE__ */ a3("text", { x: size.width - 14, y: size.height / 2, children: letters.right }),
        /* @__PURE__ */ a3("text", { x: size.width / 2, y: 18, children: letters.top }),
        /* @__PURE__ */ a3("text", { x: size.width / 2, y: size.height - 8, children: letters.bottom })
      ] }),
      overlays.scale_bar && /* @__PURE__ */ a3("g", { "aria-hidden": "true", children: [
        /* @__PURE__ */ a3("path", { d: `M12 ${size.height - 14}h${bar / perCss}`, stroke: "#000", "stroke-width": "5" }),
        /* @__PURE__ */ a3("path", { d: `M12 ${size.height - 14}h${bar / perCss}`, stroke: "#fff", "stroke-width": "2.5" }),
        /* @__PURE__ */ a3("text", { x: 12, y: size.height - 20, children: `${bar} ${unit2}` })
      ] })
    ] }),
    /* @__PURE__ */ a3("div", { class: "corner", style: { color: PANE_COLORS[pane] }, children: [
      `${PANE_NAMES[pane]}${isTilted ? ", tilted" : ""}
${shortNumber(geometry.position, 4)} ${unit2}`,
      slices.thickness > 0 ? `
${slices.slab} of ${shortNumber(slices.thickness)} ${unit2}` : ""
    ] }),
    geometry.window && /* @__PURE__ */ a3("div", { class: "corner right", children: `L ${shortNumber(level, 4)}
W ${shortNumber(width, 4)}` })
  ] });
}
function CrosshairLine(props) {
  const { store, on, other, welcome } = props;
  const { size } = on;
  const normal = normalOf(store.state, other);
  const line = lineOf(on, normal);
  if (line === null) return null;
  const at2 = placeOf(on, store.state.view.slices.crosshair);
  const reach = size.width + size.height;
  const color = PANE_COLORS[other];
  const far = Math.min(size.width, size.height) * 0.42;
  const position = dot(normal, store.state.view.slices.crosshair);
  const step = sampleStep(welcome.volumes[0]?.affine ?? [], normal);
  const range = props.ui.frames[other]?.slice?.range ?? rangeOf(welcome.bounds, normal);
  const move = (distance2, gesture) => store.change([set(stepped(store.state, other, distance2, range), "view", "slices", "crosshair")], gesture);
  const keys = (event) => {
    const n2 = stepOf(event);
    if (n2 === void 0) return;
    move(n2 * step, "key plane");
  };
  const tilt = (x2, y3) => store.change([tiltTo(store, other, tilted(on, normalOf(store.state, other), x2 - at2.x, y3 - at2.y))], "tilt");
  const tiltKeys = (event) => {
    const n2 = stepOf(event);
    if (n2 === void 0) return;
    const angle = Math.atan2(line.dy, line.dx) + n2 * Math.PI / 180;
    store.change([tiltTo(store, other, tilted(on, normal, Math.cos(angle), Math.sin(angle)))], "key tilt");
  };
  return /* @__PURE__ */ a3("g", { stroke: color, fill: "none", children: [
    /* @__PURE__ */ a3(
      "path",
      {
        d: `M${at2.x - line.dx * reach} ${at2.y - line.dy * reach}L${at2.x + line.dx * reach} ${at2.y + line.dy * reach}`,
        "stroke-width": "1.2",
        opacity: "0.85"
      }
    ),
    /* @__PURE__ */ a3(
      Handle2,
      {
        label: `${PANE_NAMES[other]} plane`,
        text: `${PANE_NAMES[other]} plane at ${shortNumber(position, 4)}`,
        value: position,
        range,
        x: at2.x - line.dx * far * 0.55,
        y: at2.y - line.dy * far * 0.55,
        color,
        onDrag: (_x, _y, dx, dy) => {
          const { geometry } = on;
          const per = geometry.pixel * on.width / size.width;
          const way = add(scaled(geometry.right, dx * per), scaled(geometry.down, dy * per));
          move(dot(way, normal), "drag plane");
        },
        onKey: keys,
        onEnd: () => store.settle()
      }
    ),
    /* @__PURE__ */ a3(
      Handle2,
      {
        label: `Tilt the ${other} plane`,
        text: `Tilt of the ${other} plane`,
        value: Math.atan2(line.dy, line.dx) * 180 / Math.PI,
        range: [-180, 180],
        x: at2.x + line.dx * far,
        y: at2.y + line.dy * far,
        color,
        round: true,
        onDrag: (x2, y3) => tilt(x2, y3),
        onKey: tiltKeys,
        onEnd: () => store.settle()
      }
    )
  ] });
}
function tiltTo(store, pane, normal) {
  return set({ ...store.state.view.slices.normals, [pane]: normal }, "view", "slices", "normals");
}
function rangeOf([lower, upper], normal) {
  const ends = [0, 1, 2].map((a4) => [(lower[a4] ?? 0) * (normal[a4] ?? 0), (upper[a4] ?? 0) * (normal[a4] ?? 0)]);
  const sum = (pick2) => ends.reduce((total, end) => total + pick2(...end), 0);
  return [sum(Math.min), sum(Math.max)];
}
var probeTimer;
function probe(props, on, place) {
  const { engine, ui } = props;
  clearTimeout(probeTimer);
  if (on === null || place === null) {
    ui.setProbe(null, null);
    return;
  }
  const point = worldAt(on, place.x, place.y);
  probeTimer = setTimeout(() => {
    engine.ask("probe", { point }).then(
      (found) => ui.setProbe(point, found),
      () => void 0
    );
  }, PROBE_MS);
}

// src/view/slices_panel.tsx
var AXES3 = ["x", "y", "z"];
function SlicesPanel(props) {
  const { store, welcome, ui } = props;
  const { slices } = store.state.view;
  const [lower, upper] = welcome.bounds;
  const info = welcome.volumes[0];
  const unit2 = info?.unit ?? "units";
  const settle = () => store.settle();
  const automatic = ui.frames.axial?.slice?.window ?? ui.frames.coronal?.slice?.window ?? ui.frames.sagittal?.slice?.window;
  const robust = info?.robust_range ?? [0, 1];
  const [level, width] = slices.window ?? automatic ?? [(robust[0] + robust[1]) / 2, robust[1] - robust[0]];
  const span = (info?.range[1] ?? 1) - (info?.range[0] ?? 0) || 1;
  const setWindow = (next, gesture) => store.change([set(next, "view", "slices", "window")], gesture);
  const names = Object.entries(welcome.window_names);
  const named = names.find(([, [l3, w3]]) => slices.window?.[0] === l3 && slices.window[1] === w3)?.[0];
  return /* @__PURE__ */ a3($, { children: [
    AXES3.map((name, axis) => /* @__PURE__ */ a3(
      NumberField2,
      {
        label: `Crosshair ${name}`,
        unit: unit2,
        value: slices.crosshair[axis] ?? 0,
        min: lower[axis] ?? 0,
        max: upper[axis] ?? 1,
        onInput: (value) => {
          const next = slices.crosshair.map((one, a4) => a4 === axis ? value : one);
          store.change([set(next, "view", "slices", "crosshair")], `crosshair ${name}`);
        },
        onSettle: settle
      },
      name
    )),
    /* @__PURE__ */ a3(
      NumberField2,
      {
        label: "Thickness",
        unit: unit2,
        value: slices.thickness,
        min: 0,
        max: Math.max(...AXES3.map((_3, a4) => (upper[a4] ?? 0) - (lower[a4] ?? 0))) / 4,
        onInput: (value) => store.change([set(Math.max(0, value), "view", "slices", "thickness")], "thickness"),
        onSettle: settle
      }
    ),
    /* @__PURE__ */ a3(
      Choice,
      {
        label: "Across it",
        value: slices.slab,
        options: [["maximum", "Maximum"], ["minimum", "Minimum"], ["mean", "Mean"]],
        onChoose: (value) => store.change([set(value, "view", "slices", "slab")])
      }
    ),
    info?.value_unit === "HU" && /* @__PURE__ */ a3(
      Choice,
      {
        label: "Window",
        value: named ?? (slices.window === void 0 ? "automatic" : "own"),
        options: [
          ["automatic", "Automatic"],
          ...names.map(([name, [l3, w3]]) => [name, `${name} (${l3}, ${w3})`]),
          ...named === void 0 && slices.window !== void 0 ? [["own", "Own"]] : []
        ],
        onChoose: (value) => {
          const window2 = welcome.window_names[value];
          if (window2 !== void 0) setWindow(window2);
          else if (slices.window !== void 0) store.change([{ op: "remove", path: "/view/slices/window" }]);
        }
      }
    ),
    /* @__PURE__ */ a3(
      NumberField2,
      {
        label: "Level",
        unit: info?.value_unit ?? "",
        value: level,
        min: info?.range[0] ?? 0,
        max: info?.range[1] ?? 1,
        onInput: (value) => setWindow([value, width], "level"),
        onSettle: settle
      }
    ),
    /* @__PURE__ */ a3(
      NumberField2,
      {
        label: "Width",
        unit: info?.value_unit ?? "",
        value: width,
        min: span * 1e-4,
        max: span,
        onInput: (value) => setWindow([level, Math.max(value, span * 1e-6)], "width"),
        onSettle: settle
      }
    ),
    /* @__PURE__ */ a3(
      NumberField2,
      {
        label: "Zoom",
        value: slices.zoom,
        min: 0.2,
        max: 20,
        onInput: (value) => store.change([set(Math.min(Math.max(value, 0.1), 100), "view", "slices", "zoom")], "zoom"),
        onSettle: settle
      }
    ),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          onClick: () => {
            const middle2 = [0, 1, 2].map((a4) => ((lower[a4] ?? 0) + (upper[a4] ?? 0)) / 2);
            store.change([set(middle2, "view", "slices", "crosshair")]);
          },
          children: "Crosshair to the middle"
        }
      ),
      /* @__PURE__ */ a3("button", { class: "button", onClick: () => void pick(props, 0.5, 0.5, ui.frames["3d"] ?? { width: 512, height: 512 }), children: "Crosshair to what is seen" }),
      /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          disabled: slices.window === void 0,
          onClick: () => store.change([{ op: "remove", path: "/view/slices/window" }]),
          children: "Automatic window"
        }
      ),
      /* @__PURE__ */ a3(
        "button",
        {
          class: "button",
          disabled: slices.normals === void 0,
          onClick: () => store.change([{ op: "remove", path: "/view/slices/normals" }]),
          children: "Reset tilt"
        }
      )
    ] })
  ] });
}

// src/view/status.tsx
function Opening({ connection, problem }) {
  if (problem !== null) {
    return /* @__PURE__ */ a3("div", { class: "opening", role: "alert", children: [
      /* @__PURE__ */ a3("h2", { children: "It could not be opened" }),
      /* @__PURE__ */ a3("p", { children: problem.message }),
      problem.remedy !== void 0 && /* @__PURE__ */ a3("p", { class: "dim", children: problem.remedy })
    ] });
  }
  const isOpening = connection.kind === "connecting";
  return /* @__PURE__ */ a3("div", { class: "opening", role: "status", children: [
    /* @__PURE__ */ a3("p", { children: isOpening ? connection.text || "Opening" : "Opening" }),
    isOpening && connection.part !== void 0 ? /* @__PURE__ */ a3("progress", { max: 1, value: connection.part }) : /* @__PURE__ */ a3("progress", {})
  ] });
}
function ProblemCard({ problem, onClose }) {
  return /* @__PURE__ */ a3("div", { class: "alert", role: "alert", children: [
    /* @__PURE__ */ a3("strong", { children: problem.message }),
    problem.field !== void 0 && /* @__PURE__ */ a3("span", { children: `Field: ${problem.field}` }),
    problem.remedy !== void 0 && /* @__PURE__ */ a3("span", { class: "dim", children: problem.remedy }),
    /* @__PURE__ */ a3("div", { class: "row", children: [
      /* @__PURE__ */ a3("button", { class: "button", onClick: () => void navigator.clipboard?.writeText([problem.message, problem.remedy ?? ""].join("\n")), children: "Copy text" }),
      /* @__PURE__ */ a3("button", { class: "button", onClick: onClose, children: "Close" })
    ] })
  ] });
}
function Status(props) {
  const { ui, engine, connection, figures } = props;
  const frame = ui.frames["3d"] ?? Object.values(ui.frames)[0];
  const notes = frame?.notes ?? [];
  return /* @__PURE__ */ a3("div", { class: "status", children: [
    connection.kind === "lost" && /* @__PURE__ */ a3("span", { class: "row", role: "alert", children: [
      connection.problem.message,
      ". ",
      /* @__PURE__ */ a3("span", { class: "dim", children: connection.problem.remedy }),
      connection.retries && /* @__PURE__ */ a3("button", { class: "button", onClick: () => engine.retry(), children: "Try again" })
    ] }),
    connection.kind === "busy" && /* @__PURE__ */ a3("span", { role: "status", children: connection.text }),
    notes.map((note) => /* @__PURE__ */ a3("span", { role: "note", children: note }, note)),
    /* @__PURE__ */ a3(ProbeLine, { ...props }),
    figures && /* @__PURE__ */ a3(Figures, { ...props })
  ] });
}
function Figures({ ui }) {
  const recent = ui.statistics.recent(performance.now());
  const frame = ui.frames["3d"];
  if (frame === void 0) return null;
  const { sheets_per_slice, oversampling, scale } = frame.settings;
  const parts = [
    recent === null ? null : `${recent.framesPerSecond.toFixed(0)} frames/s`,
    recent?.latency == null ? null : `${recent.latency.toFixed(0)} ms from event to picture`,
    `drawn in ${frame.ms.render.toFixed(0)} ms, encoded in ${frame.ms.encode.toFixed(0)} ms`,
    `${(frame.bytes.length / 1e3).toFixed(0)} kB ${frame.format}`,
    `${frame.width} x ${frame.height}`,
    `${Number(sheets_per_slice ?? 0).toFixed(1)} sheets a slice, ${(Number(oversampling ?? 0) * Number(scale ?? 1)).toFixed(2)} texels a pixel`,
    frame.expected_psnr_db === null ? null : `expected error ${frame.expected_psnr_db.toFixed(0)} dB`
  ];
  return /* @__PURE__ */ a3("span", { class: "figures", children: parts.filter((part) => part !== null).join(" · ") });
}

// src/view/style.css
var style_default = ':host { display: block; contain: content }\n.mount { height: 100% }\n.wavesplat {\n  --bg: #0d1014; --panel: #171b21; --raised: #242a33; --line: #3a424e; --text: #e6e9ee; --dim: #a9b2bf;\n  --accent: #6cb2ff; --accent-text: #08131f; --focus: #ffd166; --danger: #ff8f8f; --gap: 8px; --radius: 6px;\n  box-sizing: border-box; display: grid; grid-template: auto minmax(0, 1fr) auto / minmax(0, 1fr) auto;\n  grid-template-areas: "bar bar" "views panels" "status status";\n  width: 100%; height: 100%; background: var(--bg); color: var(--text);\n  font: 14px/1.4 system-ui, sans-serif; color-scheme: dark; position: relative;\n}\n.wavesplat[data-theme="light"] {\n  --bg: #f4f5f7; --panel: #fff; --raised: #e9ecf0; --line: #8a93a0; --text: #161a20; --dim: #4b5563;\n  --accent: #0a5cb8; --accent-text: #fff; --focus: #b45309; --danger: #b42318; color-scheme: light;\n}\n.wavesplat *, .wavesplat *::before { box-sizing: border-box }\n.wavesplat :focus-visible { outline: 2px solid var(--focus); outline-offset: 1px }\n.wavesplat h2, .wavesplat h3, .wavesplat p { margin: 0; font-size: inherit; font-weight: 600 }\n.wavesplat p { font-weight: 400 }\n.wavesplat button, .wavesplat select, .wavesplat input, .wavesplat textarea { font: inherit; color: inherit }\n.wavesplat input[type="range"] { accent-color: var(--accent); min-width: 0; flex: 1; height: 24px; margin: 0 }\n.wavesplat input[type="checkbox"], .wavesplat input[type="radio"] { accent-color: var(--accent); width: 18px; height: 18px; margin: 3px }\n.wavesplat input[type="color"] { width: 34px; height: 26px; padding: 1px; border: 1px solid var(--line); border-radius: 4px; background: none }\n.wavesplat input[type="number"], .wavesplat input[type="text"], .wavesplat input[type="search"], .wavesplat select, .wavesplat textarea {\n  background: var(--raised); border: 1px solid var(--line); border-radius: 4px; padding: 2px 6px; min-height: 26px; min-width: 0;\n}\n.wavesplat input[type="number"] { width: 82px }\n.button {\n  background: var(--raised); border: 1px solid var(--line); border-radius: 4px; padding: 3px 10px; min-height: 28px; cursor: pointer;\n}\n.button:hover, .icon-button:hover { border-color: var(--accent) }\n.button:disabled, .icon-button:disabled { opacity: .45; cursor: default }\n.button[aria-pressed="true"], .icon-button[aria-pressed="true"], .icon-button[aria-checked="true"] {\n  background: var(--accent); color: var(--accent-text); border-color: var(--accent);\n}\n.icon-button {\n  display: inline-grid; place-items: center; min-width: 30px; height: 30px; padding: 0 6px; border: 1px solid transparent;\n  border-radius: 4px; background: none; cursor: pointer;\n}\n.icon-button svg { width: 18px; height: 18px; fill: none; stroke: currentColor; stroke-width: 1.6; stroke-linecap: round; stroke-linejoin: round }\n.row { display: flex; flex-wrap: wrap; align-items: center; gap: 6px }\n.field { display: flex; align-items: center; gap: 6px; min-width: 0 }\n.field > span:first-child { flex: 0 0 112px; color: var(--dim) }\n.toolbar { grid-area: bar; display: flex; flex-wrap: wrap; align-items: center; gap: 2px var(--gap); padding: 4px 8px; background: var(--panel); border-bottom: 1px solid var(--line) }\n.toolbar .group { display: flex; align-items: center; gap: 1px }\n.toolbar .spring { flex: 1 }\n.wavesplat .title { margin: 0; font-size: inherit; font-weight: 400; max-width: 260px; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; color: var(--dim) }\n.views { grid-area: views; display: grid; gap: 2px; background: var(--line); min-height: 0; position: relative }\n.views[data-layout="3d"], .views[data-layout="single"] { grid-template: 1fr / 1fr }\n.views[data-layout="one-and-three"] { grid-template: repeat(3, minmax(0, 1fr)) / minmax(0, 2fr) minmax(0, 1fr) }\n.views[data-layout="one-and-three"] > :first-child { grid-row: 1 / 4 }\n.views[data-layout="two-by-two"] { grid-template: repeat(2, minmax(0, 1fr)) / repeat(2, minmax(0, 1fr)) }\n.viewport { position: relative; overflow: hidden; background: #000; min-width: 0; min-height: 0; touch-action: none; user-select: none; color: #fff }\n.viewport:focus-visible { outline-offset: -2px }\n.viewport canvas { position: absolute; inset: 0; width: 100%; height: 100%; display: block; transform-origin: 0 0 }\n.viewport svg.over { position: absolute; inset: 0; width: 100%; height: 100%; overflow: hidden; pointer-events: none }\n.viewport svg.over [data-handle] { pointer-events: auto; cursor: grab }\n.viewport svg.over text { fill: #fff; paint-order: stroke; stroke: #000; stroke-width: 3px; stroke-linejoin: round; font-size: 13px }\n.viewport .corner { position: absolute; left: 8px; top: 6px; font-size: 12px; text-shadow: 0 0 3px #000, 0 0 3px #000; pointer-events: none; white-space: pre-line }\n.viewport .corner.right { left: auto; right: 8px; text-align: right }\n.viewport .corner.low { top: auto; bottom: 6px }\n.hint { position: absolute; left: 50%; bottom: 12%; transform: translateX(-50%); background: #000c; padding: 6px 12px; border-radius: var(--radius) }\n.panels { grid-area: panels; width: 340px; overflow-y: auto; overflow-x: hidden; background: var(--panel); border-left: 1px solid var(--line) }\n.panel > summary { padding: 7px 12px; cursor: pointer; font-weight: 600; border-bottom: 1px solid var(--line); list-style-position: inside }\n.panel > .body { display: grid; gap: 8px; padding: 10px 12px; border-bottom: 1px solid var(--line) }\n.bottom { grid-area: status; background: var(--panel) }\n.status { display: flex; flex-wrap: wrap; gap: 4px 16px; padding: 3px 10px; background: var(--panel); border-top: 1px solid var(--line); color: var(--dim); font-size: 13px; min-height: 25px }\n.alert { position: absolute; left: 50%; top: 52px; transform: translateX(-50%); max-width: min(560px, 92%); z-index: 5; background: var(--panel); border: 1px solid var(--danger); border-radius: var(--radius); padding: 10px 14px; display: grid; gap: 6px }\n.opening { grid-area: views; display: grid; place-content: center; gap: 10px; padding: 24px; text-align: center }\n.opening progress { width: 260px; accent-color: var(--accent) }\n.dim { color: var(--dim) }\n.hidden { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap }\n.wavesplat dialog { background: var(--panel); color: var(--text); border: 1px solid var(--line); border-radius: var(--radius); padding: 16px 20px; max-width: min(640px, 94vw); max-height: 86vh; overflow: auto }\n.wavesplat dialog::backdrop { background: #0008 }\n.wavesplat table { border-collapse: collapse; width: 100% }\n.wavesplat th, .wavesplat td { text-align: left; padding: 3px 12px 3px 0; vertical-align: top; font-weight: 400 }\n.wavesplat kbd { background: var(--raised); border: 1px solid var(--line); border-radius: 3px; padding: 0 6px; font: inherit }\n.chip { width: 18px; height: 18px; border-radius: 3px; border: 1px solid var(--line); flex: none }\n@media (max-width: 760px) {\n  .wavesplat { grid-template: auto minmax(46%, 1fr) minmax(0, auto) auto / minmax(0, 1fr); grid-template-areas: "bar" "views" "panels" "status" }\n  .panels { width: auto; max-height: 44vh; border-left: 0; border-top: 1px solid var(--line) }\n  .views[data-layout="one-and-three"] { grid-template: minmax(0, 2fr) minmax(0, 1fr) / repeat(3, minmax(0, 1fr)) }\n  .views[data-layout="one-and-three"] > :first-child { grid-row: auto; grid-column: 1 / 4 }\n  .title { display: none }\n}\n@media (pointer: coarse) {\n  .icon-button, .button { min-width: 44px; min-height: 44px }\n}\n@media (forced-colors: active) {\n  .icon-button[aria-pressed="true"], .icon-button[aria-checked="true"], .button[aria-pressed="true"] { forced-color-adjust: none; background: Highlight; color: HighlightText }\n}\n.wavesplat fieldset { border: 1px solid var(--line); border-radius: var(--radius); margin: 0; padding: 6px 10px 10px; display: grid; gap: 6px; min-width: 0 }\n.wavesplat legend { padding: 0 4px; color: var(--dim) }\n.wavesplat ol, .wavesplat ul { margin: 0; padding-left: 20px }\n.viewport .legend { top: 8px; left: 8px; list-style: none; padding: 0; display: grid; gap: 3px }\n.viewport .legend li { display: flex; gap: 6px; align-items: center }\n.viewport .color-bar { display: grid; justify-items: end; gap: 3px; bottom: 24px }\n.viewport .color-bar .ramp { width: 14px; height: 150px; border: 1px solid #fff8 }\n';

// src/view/theme.ts
function themeOf(state) {
  const { theme } = state.view.interface;
  return theme === "system" ? surrounding() : theme;
}
function surrounding() {
  const lab = document.body?.dataset["jpThemeLight"];
  if (lab !== void 0) return lab === "true" ? "light" : "dark";
  const classes = document.body?.classList;
  if (classes?.contains("vscode-light") || classes?.contains("vscode-high-contrast-light")) return "light";
  if (classes?.contains("vscode-dark") || classes?.contains("vscode-high-contrast")) return "dark";
  return window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
}
function onThemeChange(listener) {
  const query = window.matchMedia("(prefers-color-scheme: light)");
  query.addEventListener("change", listener);
  const observer = new MutationObserver(listener);
  if (document.body !== null) observer.observe(document.body, { attributes: true, attributeFilter: ["class", "data-jp-theme-light"] });
  return () => {
    query.removeEventListener("change", listener);
    observer.disconnect();
  };
}

// src/view/icons.tsx
var PATHS = {
  undo: "M8 5 4 9l4 4M4 9h8a4 4 0 0 1 0 8H9",
  redo: "M12 5l4 4-4 4M16 9H8a4 4 0 0 0 0 8h3",
  fit: "M4 8V4h4M16 8V4h-4M4 12v4h4M16 12v4h-4M8 8h4v4H8z",
  turn: "M15 6a7 3 0 1 0 1 4M16 3v4h-4M10 10v7",
  window: "M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14",
  distance: "M3 17 17 3M3 13v4h4M17 7V3h-4",
  angle: "M16 16H4L14 4M9 16a6 6 0 0 0-1.5-4",
  share: "M10 12V3M6 7l4-4 4 4M4 11v6h12v-6",
  help: "M7.5 7.5a2.5 2.5 0 1 1 3.5 2.3c-.8.4-1 .9-1 1.7M10 14.6v.1M10 18a8 8 0 1 0 0-16 8 8 0 0 0 0 16z",
  light: "M10 2v2M10 16v2M2 10h2M16 10h2M4.5 4.5l1.4 1.4M14.1 14.1l1.4 1.4M15.5 4.5l-1.4 1.4M5.9 14.1l-1.4 1.4M10 6.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7z",
  dark: "M16 12A7 7 0 0 1 8 4a7 7 0 1 0 8 8z",
  panels: "M3 4h14v12H3zM12 4v12"
};
function Icon({ name }) {
  return /* @__PURE__ */ a3("svg", { viewBox: "0 0 20 20", "aria-hidden": "true", children: /* @__PURE__ */ a3("path", { d: PATHS[name] }) });
}

// src/view/toolbar.tsx
var LAYOUTS = [
  ["3d", "Space"],
  ["one-and-three", "Space and three slices"],
  ["two-by-two", "Two by two"],
  ["single", "One slice"]
];
var VIEWS = ["front", "back", "left", "right", "top", "bottom"];
var TOOLS = [
  ["turn", "Turn", "turn"],
  ["window", "Window and level", "window"],
  ["distance", "Measure a distance", "distance"],
  ["angle", "Measure an angle", "angle"]
];
function Toolbar(props) {
  const { store, welcome, ui, onHelp, onFit } = props;
  const { layout } = store.state.view;
  const theme = themeOf(store.state);
  const tools = (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (step === void 0) return;
    event.preventDefault();
    event.stopPropagation();
    const now = TOOLS.findIndex(([tool]) => tool === ui.tool);
    const next = TOOLS[(now + step + TOOLS.length) % TOOLS.length]?.[0];
    if (next === void 0) return;
    ui.setTool(next);
    const box = event.currentTarget;
    box.querySelector(`[data-tool="${next}"]`)?.focus();
  };
  return /* @__PURE__ */ a3("header", { class: "toolbar", children: [
    /* @__PURE__ */ a3("h1", { class: "title", title: store.state.layers.map(({ name }) => name).join(", "), children: store.state.layers.map(({ name }) => name).join(", ") }),
    /* @__PURE__ */ a3("label", { children: [
      /* @__PURE__ */ a3("span", { class: "hidden", children: "Layout" }),
      /* @__PURE__ */ a3(
        "select",
        {
          value: layout.name,
          onChange: (event) => {
            const name = event.currentTarget.value;
            const main = name === "single" && layout.main === "3d" ? "axial" : layout.main;
            store.change([set({ name, main: name === "single" ? main : "3d" }, "view", "layout")]);
          },
          children: LAYOUTS.map(([name, text]) => /* @__PURE__ */ a3("option", { value: name, selected: name === layout.name, children: text }, name))
        }
      )
    ] }),
    layout.name === "single" && /* @__PURE__ */ a3("label", { children: [
      /* @__PURE__ */ a3("span", { class: "hidden", children: "Slice" }),
      /* @__PURE__ */ a3("select", { value: layout.main, onChange: (event) => store.change([set(event.currentTarget.value, "view", "layout", "main")]), children: PANES.map((pane) => /* @__PURE__ */ a3("option", { value: pane, selected: pane === layout.main, children: pane }, pane)) })
    ] }),
    /* @__PURE__ */ a3("div", { class: "group", role: "group", "aria-label": "Standard views", children: VIEWS.map((view, n2) => /* @__PURE__ */ a3(
      "button",
      {
        class: "icon-button",
        title: `From the ${view} (${n2 + 1})`,
        "aria-label": `${letterOf(view, welcome.axis_ends)}, from the ${view}`,
        onClick: () => {
          const camera = welcome.standard_views[view];
          if (camera !== void 0) showFrom(props, camera);
        },
        children: letterOf(view, welcome.axis_ends)
      },
      view
    )) }),
    /* @__PURE__ */ a3("button", { class: "icon-button", title: "Fit all into view (0)", "aria-label": "Fit all into view", onClick: onFit, children: /* @__PURE__ */ a3(Icon, { name: "fit" }) }),
    /* @__PURE__ */ a3("div", { class: "group", role: "group", "aria-label": "History", children: [
      /* @__PURE__ */ a3("button", { class: "icon-button", title: "Undo (Ctrl Z)", "aria-label": "Undo", disabled: !store.canUndo, onClick: () => store.undo(), children: /* @__PURE__ */ a3(Icon, { name: "undo" }) }),
      /* @__PURE__ */ a3("button", { class: "icon-button", title: "Redo (Ctrl Shift Z)", "aria-label": "Redo", disabled: !store.canRedo, onClick: () => store.redo(), children: /* @__PURE__ */ a3(Icon, { name: "redo" }) })
    ] }),
    /* @__PURE__ */ a3("div", { class: "group", role: "radiogroup", "aria-label": "Dragging", onKeyDown: tools, children: TOOLS.map(([tool, text, icon]) => /* @__PURE__ */ a3(
      "button",
      {
        class: "icon-button",
        role: "radio",
        "data-tool": tool,
        tabIndex: tool === ui.tool ? 0 : -1,
        "aria-checked": tool === ui.tool,
        "aria-label": text,
        title: text,
        onClick: () => ui.setTool(tool),
        children: /* @__PURE__ */ a3(Icon, { name: icon })
      },
      tool
    )) }),
    /* @__PURE__ */ a3("span", { class: "spring" }),
    /* @__PURE__ */ a3(
      "button",
      {
        class: "icon-button",
        title: theme === "dark" ? "Light colours" : "Dark colours",
        "aria-label": theme === "dark" ? "Light colours" : "Dark colours",
        onClick: () => store.change([set(theme === "dark" ? "light" : "dark", "view", "interface", "theme")]),
        children: /* @__PURE__ */ a3(Icon, { name: theme === "dark" ? "light" : "dark" })
      }
    ),
    /* @__PURE__ */ a3("button", { class: "icon-button", title: "Keys and gestures (?)", "aria-label": "Keys and gestures", onClick: onHelp, children: /* @__PURE__ */ a3(Icon, { name: "help" }) }),
    /* @__PURE__ */ a3("button", { class: "icon-button", title: "Panels", "aria-label": "Panels", "aria-pressed": props.panels, onClick: props.onPanels, children: /* @__PURE__ */ a3(Icon, { name: "panels" }) })
  ] });
}
function letterOf(view, ends) {
  const place = { left: 0, right: 1, back: 2, front: 3, bottom: 4, top: 5 }[view];
  return ends[place] ?? view;
}

// src/view/app.tsx
var ANNOUNCED_MS = 1e3;
function mountApp(parent, engine, host) {
  const root = parent.shadowRoot ?? parent.attachShadow({ mode: "open" });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync([style_default, look_default].join("\n"));
  root.adoptedStyleSheets = [sheet];
  const mount = document.createElement("div");
  mount.className = "mount";
  root.append(mount);
  const app = new App(engine, host, root, mount);
  return () => {
    app.close();
    Q(null, mount);
    mount.remove();
    engine.close();
  };
}
var App = class {
  constructor(engine, host, root, mount) {
    this.engine = engine;
    this.host = host;
    this.root = root;
    this.mount = mount;
    this.stops.push(
      engine.onConnection((connection) => {
        this.connection = connection;
        this.schedule();
      }),
      engine.onProblem((problem) => {
        this.problem = problem;
        this.schedule();
      }),
      onThemeChange(() => this.schedule())
    );
    engine.welcome.then(
      (welcome) => void this.begin(welcome),
      (problem) => {
        this.failure = problemOf(problem);
        this.schedule();
      }
    );
    this.draw();
  }
  engine;
  host;
  root;
  mount;
  store = null;
  welcome = null;
  connection = { kind: "connecting", text: "" };
  problem = null;
  failure = null;
  frames = {};
  statistics = new FrameStatistics();
  tool = "turn";
  points = [];
  layer = 0;
  probe = null;
  probed = null;
  help = false;
  figures = false;
  showsPanels = true;
  said = "";
  lastSaid = 0;
  sayTimer;
  isScheduled = false;
  stops = [];
  close() {
    this.stops.forEach((stop) => stop());
  }
  async begin(welcome) {
    this.welcome = welcome;
    this.store = createStore(welcome.state, this.engine);
    this.stops.push(this.store.subscribe(() => this.schedule()));
    this.expose();
    this.schedule();
    if (this.host.link === void 0) return;
    try {
      const { fingerprint, state } = await fromLink(this.host.link);
      if (fingerprint !== welcome.fingerprint) throw new Error("The link is of other data than is open here");
      const { state: checked } = await this.engine.ask("open_state", { text: JSON.stringify(state) });
      this.store.change([{ op: "replace", path: "", value: checked }]);
    } catch (problem) {
      this.problem = problemOf(problem);
      this.schedule();
    }
  }
  /** For tests and benchmarks, and whoever looks at the console. */
  expose() {
    this.root.host.wavesplat = {
      store: this.store,
      statistics: this.statistics,
      frames: this.frames,
      welcome: this.welcome
    };
  }
  schedule() {
    if (this.isScheduled) return;
    this.isScheduled = true;
    requestAnimationFrame(() => {
      this.isScheduled = false;
      this.draw();
    });
  }
  ui = ((app) => ({
    get root() {
      return app.root;
    },
    get host() {
      return app.host.kind;
    },
    statistics: app.statistics,
    frames: app.frames,
    frameShown(frame) {
      app.frames[frame.view] = frame;
      app.statistics.drawn(frame, performance.now());
      app.schedule();
    },
    get tool() {
      return app.tool;
    },
    setTool(tool) {
      app.tool = tool;
      app.points = [];
      app.schedule();
    },
    get points() {
      return app.points;
    },
    addPoint(point) {
      app.addPoint(point);
    },
    get layer() {
      return Math.min(app.layer, (app.store?.state.layers.length ?? 1) - 1);
    },
    setLayer(layer) {
      app.layer = layer;
      app.schedule();
    },
    get probe() {
      return app.probe;
    },
    get probed() {
      return app.probed;
    },
    setProbe(point, found) {
      if (point === null && app.probe === null) return;
      [app.probe, app.probed] = [point, found];
      app.schedule();
    },
    announce(text) {
      app.announce(text);
    },
    problem(problem) {
      app.problem = problemOf(problem);
      app.schedule();
    },
    download(name, content, type) {
      const url = URL.createObjectURL(new Blob([content], { type }));
      const link = document.createElement("a");
      link.href = url;
      link.download = name;
      link.click();
      setTimeout(() => URL.revokeObjectURL(url), 1e4);
    }
  }))(this);
  addPoint(point) {
    const kind = this.tool === "angle" ? "angle" : "distance";
    const points = [...this.points, point];
    if (points.length < (kind === "angle" ? 3 : 2)) {
      this.points = points;
    } else {
      this.points = [];
      if (isMeasure(points)) this.store?.change([set({ kind, points }, "view", "measures", "-")]);
    }
    this.schedule();
  }
  announce(text) {
    clearTimeout(this.sayTimer);
    const wait = Math.max(0, this.lastSaid + ANNOUNCED_MS - performance.now());
    this.sayTimer = setTimeout(() => {
      this.said = text;
      this.lastSaid = performance.now();
      this.schedule();
    }, wait);
  }
  onKey = (event) => {
    const target = event.composedPath()[0];
    const isField = target instanceof HTMLElement && target.matches("input, select, textarea, [contenteditable]");
    const action = actionOf(keyName(event));
    if (event.defaultPrevented || this.store === null || isField && action !== "leave") return;
    if (action === "undo") this.store.undo();
    else if (action === "redo") this.store.redo();
    else if (action === "help") this.help = true;
    else if (action === "leave" && (this.tool !== "turn" || this.points.length > 0)) this.ui.setTool("turn");
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.schedule();
  };
  onPanel = (name, open) => {
    const panels = this.store?.state.view.interface.panels ?? [];
    const next = open ? [...panels.filter((one) => one !== name), name] : panels.filter((one) => one !== name);
    this.store?.change([set(next, "view", "interface", "panels")]);
  };
  draw() {
    const { store, welcome } = this;
    if (store === null || welcome === null) {
      const theme = window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
      Q(
        /* @__PURE__ */ a3("div", { class: "wavesplat", "data-theme": theme, "data-lm-suppress-shortcuts": "true", children: /* @__PURE__ */ a3(Opening, { connection: this.connection, problem: this.failure }) }),
        this.mount
      );
      return;
    }
    const part = { store, engine: this.engine, welcome, ui: this.ui };
    Q(/* @__PURE__ */ a3(Whole, { ...part, app: this.shown() }), this.mount);
  }
  shown() {
    return {
      connection: this.connection,
      problem: this.problem,
      help: this.help,
      figures: this.figures,
      showsPanels: this.showsPanels,
      said: this.said,
      onKey: this.onKey,
      onPanel: this.onPanel,
      onHelp: (on) => {
        this.help = on;
        this.schedule();
      },
      onFigures: (on) => {
        this.figures = on;
        this.schedule();
      },
      onPanels: () => {
        this.showsPanels = !this.showsPanels;
        this.schedule();
      },
      onProblemClosed: () => {
        this.problem = null;
        this.schedule();
      }
    };
  }
};
function Whole(props) {
  const { app, ...part } = props;
  const { store } = part;
  const { layout, interface: shown } = store.state.view;
  const isOpen = (name) => shown.panels.includes(name);
  const panel = { onToggle: app.onPanel };
  const hasTimes = part.welcome.volumes.some((volume) => volume.n_times > 1);
  return /* @__PURE__ */ a3(
    "div",
    {
      class: "wavesplat",
      "data-theme": themeOf(store.state),
      "data-lm-suppress-shortcuts": "true",
      onKeyDown: app.onKey,
      onDragOver: (event) => event.preventDefault(),
      onDrop: (event) => {
        event.preventDefault();
        const file = event.dataTransfer?.files[0];
        if (file !== void 0) void openState(part, file);
      },
      children: [
        /* @__PURE__ */ a3(Toolbar, { ...part, onHelp: () => app.onHelp(true), onFit: () => void fit(part, part.ui.frames["3d"] ?? { width: 4, height: 3 }), panels: app.showsPanels, onPanels: app.onPanels }),
        /* @__PURE__ */ a3("main", { class: "views", "data-layout": layout.name, children: [
          (layout.name !== "single" || layout.main === "3d") && /* @__PURE__ */ a3(SceneView, { ...part }),
          (layout.name === "one-and-three" || layout.name === "two-by-two") && PANES.map((pane) => /* @__PURE__ */ a3(SlicePane, { ...part, pane }, pane)),
          layout.name === "single" && layout.main !== "3d" && /* @__PURE__ */ a3(SlicePane, { ...part, pane: layout.main }, layout.main)
        ] }),
        app.showsPanels && /* @__PURE__ */ a3("aside", { class: "panels", "aria-label": "Panels", children: [
          /* @__PURE__ */ a3(Panel, { name: "presets", title: "Presets", open: isOpen("presets"), ...panel, children: /* @__PURE__ */ a3(PresetsPanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "function", title: "Colours and opacity", open: isOpen("function"), ...panel, children: /* @__PURE__ */ a3(FunctionPanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "layers", title: "Layers", open: isOpen("layers"), ...panel, children: /* @__PURE__ */ a3(LayersPanel, { ...part }) }),
          store.state.labels !== null && /* @__PURE__ */ a3(Panel, { name: "labels", title: "Labels", open: isOpen("labels"), ...panel, children: /* @__PURE__ */ a3(LabelsPanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "light", title: "Light and projection", open: isOpen("light"), ...panel, children: /* @__PURE__ */ a3(LightPanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "cut", title: "Cut", open: isOpen("cut"), ...panel, children: /* @__PURE__ */ a3(CutPanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "slices", title: "Slices", open: isOpen("slices"), ...panel, children: /* @__PURE__ */ a3(SlicesPanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "measure", title: "Measure", open: isOpen("measure"), ...panel, children: /* @__PURE__ */ a3(MeasurePanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "share", title: "Pictures and sharing", open: isOpen("share"), ...panel, children: /* @__PURE__ */ a3(SharePanel, { ...part }) }),
          /* @__PURE__ */ a3(Panel, { name: "settings", title: "Settings", open: isOpen("settings"), ...panel, children: /* @__PURE__ */ a3(SettingsPanel, { ...part, figures: app.figures, onFigures: app.onFigures }) })
        ] }),
        /* @__PURE__ */ a3("footer", { class: "bottom", children: [
          hasTimes && /* @__PURE__ */ a3(TimeBar, { ...part }),
          /* @__PURE__ */ a3(Status, { ...part, connection: app.connection, figures: app.figures })
        ] }),
        /* @__PURE__ */ a3("p", { class: "hidden", role: "status", "aria-live": "polite", children: app.said }),
        app.problem !== null && /* @__PURE__ */ a3(ProblemCard, { problem: app.problem, onClose: app.onProblemClosed }),
        app.help && /* @__PURE__ */ a3(Help, { onClose: () => app.onHelp(false) })
      ]
    }
  );
}

// src/hosts/page.ts
var KEY2 = "wavesplat-session";
function openPage(element) {
  const parts = new URLSearchParams(location.hash.slice(1));
  const [token, link] = [parts.get("token"), parts.get("state") ?? void 0];
  history.replaceState(null, "", location.pathname);
  document.documentElement.style.height = "100%";
  document.body.style.cssText = "margin:0;height:100%;background:#0d1014";
  element.style.cssText = "display:block;height:100vh";
  const channel = socketChannel(`ws://${location.host}/socket`);
  let unused = token;
  const engine = remoteEngine(channel, {
    hello: () => {
      const session = stored();
      const hello = { ...unused === null ? {} : { token: unused }, ...session === null ? {} : { session } };
      return hello;
    },
    onSession: (key) => {
      unused = null;
      sessionStorage.setItem(KEY2, key);
      localStorage.setItem(`${KEY2}:${location.host}`, key);
    }
  });
  window.addEventListener("storage", ({ key }) => {
    if (key === `${KEY2}:${location.host}`) engine.retry();
  });
  const close = mountApp(element, engine, { kind: "page", link });
  engine.welcome.then(
    ({ volumes }) => {
      document.title = `${volumes.map(({ name }) => name).join(", ")} – Wavesplat`;
    },
    () => void 0
  );
  return close;
}
function stored() {
  return localStorage.getItem(`${KEY2}:${location.host}`) ?? sessionStorage.getItem(KEY2);
}

// src/engine/channel_comm.ts
function bytesOf(buffer) {
  if (buffer instanceof ArrayBuffer) return new Uint8Array(buffer);
  if (ArrayBuffer.isView(buffer)) {
    return new Uint8Array(new Uint8Array(buffer.buffer, buffer.byteOffset, buffer.byteLength));
  }
  if (typeof buffer === "string") {
    const text = atob(buffer);
    return Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  }
  throw new TypeError("the host gave a buffer of an unknown kind");
}
function commChannel(model, page) {
  const listeners = /* @__PURE__ */ new Set();
  const states = /* @__PURE__ */ new Set();
  const open = () => states.forEach((listener) => listener({ kind: "open" }));
  const receive = (content, buffers) => {
    if (typeof content !== "object" || content === null) return;
    const header = content;
    if (header["page"] !== page) return;
    const first = buffers?.[0];
    const payload = first === void 0 ? new Uint8Array() : bytesOf(first);
    for (const listener of listeners) listener(header, payload);
  };
  model.on("msg:custom", receive);
  queueMicrotask(open);
  return {
    send(header, payload) {
      model.send({ ...header, page }, void 0, payload === void 0 ? [] : [payload]);
    },
    onMessage(listener) {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    onState(listener) {
      states.add(listener);
      return () => states.delete(listener);
    },
    retry: open,
    close() {
      model.send({ type: "bye", page }, void 0, []);
      model.off("msg:custom", receive);
      listeners.clear();
    }
  };
}

// src/hosts/widget.ts
var REPEAT_MS = 500;
var HEIGHT_PX2 = 520;
function render({ model, el }) {
  const page = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) => byte.toString(16)).join("");
  const box = document.createElement("div");
  box.style.cssText = `display:block;height:${HEIGHT_PX2}px;resize:vertical;overflow:hidden`;
  box.dataset["lmSuppressShortcuts"] = "true";
  box.addEventListener("keydown", (event) => {
    if (!event.ctrlKey && !event.metaKey) event.stopPropagation();
  });
  el.append(box);
  const engine = remoteEngine(commChannel(model, page), { hello: () => ({}), repeatHelloMs: REPEAT_MS });
  const close = mountApp(box, engine, { kind: "widget" });
  return () => {
    close();
    box.remove();
  };
}

// src/viewer.ts
var viewer_default = { render };
export {
  viewer_default as default,
  openPage
};
