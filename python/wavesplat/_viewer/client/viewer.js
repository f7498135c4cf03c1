// Built from web/ by `make web`; change that, not this.
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
function k(n2, t3, r3) {
  var u3, i3, f3, o3 = {}, e3 = arguments.length;
  for (f3 in t3) "key" == f3 ? u3 = t3[f3] : "ref" == f3 && "function" != typeof n2 ? i3 = t3[f3] : o3[f3] = t3[f3];
  return e3 > 2 && (o3.children = e3 > 3 ? d.call(arguments, 2) : r3), m(n2, o3, u3, i3, null);
}
function m(r3, u3, i3, f3, o3) {
  var e3 = { type: r3, props: u3, key: i3, ref: f3, __k: null, __: null, __b: 0, __e: null, __c: null, constructor: h, __v: o3 || ++t, __i: -1, __u: 0 };
  return !o3 && n.vnode && n.vnode(e3), e3;
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
  var r3, u3 = t3.__v, i3 = u3.__e, f3 = [], o3 = [], e3 = t3.__P;
  e3 && ((r3 = _({ constructor: h }, u3)).__v = u3.__v + 1, n.vnode && n.vnode(r3), z(e3, r3, u3, t3.__n, e3.namespaceURI, 32 & u3.__u ? [i3] : null, f3, i3 || S(u3), 32 & u3.__u, o3), r3.__v = u3.__v, r3.__.__k[r3.__i] = r3, E(f3, r3, o3), u3.__ = u3.__e = null, r3.__e != i3 && j(r3));
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
function I(n2, t3, r3, u3, i3, f3, o3, e3, l3, c3, a3) {
  var s3, h3, v3, w3, d3, _3, g3 = u3.__k || y, k3 = t3.length;
  for (l3 = q(r3, t3, g3, l3, k3), s3 = 0; s3 < k3; s3++) null != (v3 = r3.__k[s3]) && (h3 = ~v3.__i && g3[v3.__i] || p, v3.__i = s3, _3 = z(n2, v3, h3, i3, f3, o3, e3, l3, c3, a3), w3 = v3.__e, (h3.ref != v3.ref || 8 & h3.__u) && (h3.ref && G(h3.ref, null, v3, h3), v3.ref && a3.push(v3.ref, v3.__c || w3, v3)), d3 = d3 || w3, 4 & v3.__u ? (l3 = A(v3, l3, n2, !h3.__v), h3.__e && (h3.__e = null)) : "function" == typeof v3.type && void 0 !== _3 ? l3 = _3 : w3 && (l3 = w3.nextSibling), v3.__u &= -21);
  return r3.__e = d3, l3;
}
function q(n2, t3, r3, u3, i3) {
  var f3, o3, e3, l3, c3, a3, s3, p3, y3, v3 = r3.length, d3 = v3, _3 = 0, g3 = 0, k3 = n2.__k = Array(i3);
  for (f3 = 0; f3 < i3; f3++) null != (o3 = t3[f3]) && "boolean" != typeof o3 && "function" != typeof o3 ? ("object" != typeof o3 || o3.constructor === String ? o3 = k3[f3] = m(null, o3) : w(o3) ? o3 = k3[f3] = m($, { children: o3 }) : o3.constructor === h && o3.__b ? o3 = k3[f3] = m(o3.type, o3.props, o3.key, o3.ref, o3.__v) : k3[f3] = o3, l3 = f3 + _3, o3.__ = n2, o3.__b = n2.__b + 1, e3 = null, ~(c3 = o3.__i = P(o3, r3, l3, d3)) && (d3--, (e3 = r3[c3]) && (e3.__u |= 2)), e3 && e3.__v ? (o3.__u |= 16, c3 == l3 - 1 ? _3-- : c3 == l3 + 1 ? _3++ : c3 != l3 && (c3 > l3 ? _3-- : _3++, g3 = 1)) : (~c3 || (i3 > v3 ? _3-- : i3 < v3 && _3++), "function" != typeof o3.type && (o3.__u |= 4))) : k3[f3] = null;
  if (g3) {
    for (a3 = [], s3 = [], f3 = 0; f3 < i3; f3++) if ((o3 = k3[f3]) && 16 & o3.__u) {
      for (_3 = 0, p3 = a3.length; _3 < p3; ) a3[y3 = _3 + p3 >> 1] < o3.__i ? _3 = y3 + 1 : p3 = y3;
      a3[_3] = o3.__i, s3[f3] = _3 + 1;
    }
    for (_3 = a3.length; f3--; ) s3[f3] && (s3[f3] == _3 ? _3-- : k3[f3].__u |= 4);
  }
  if (d3) for (f3 = 0; f3 < v3; f3++) !(e3 = r3[f3]) || 2 & e3.__u || (e3.__e == u3 && (u3 = S(e3)), J(e3, e3));
  return u3;
}
function A(n2, t3, r3, u3) {
  var i3, f3, o3, e3;
  if ("function" == typeof n2.type) {
    if (n2.props.__P) return t3;
    if (i3 = n2.__k) for (f3 = 0; f3 < i3.length; f3++) i3[f3] && (i3[f3].__ = n2, t3 = A(i3[f3], t3, r3, false));
    return t3;
  }
  for (t3 && !t3.parentNode && (t3 = S(n2)) && !t3.parentNode && (t3 = null), o3 = n2.__e, e3 = t3; e3 && 8 == e3.nodeType; ) e3 = e3.nextSibling;
  for (o3 != e3 && (!u3 && r3.moveBefore && o3.parentNode ? r3.moveBefore(o3, t3) : r3.insertBefore(o3, t3 || null)), t3 = o3; (t3 = t3 && t3.nextSibling) && 8 == t3.nodeType && !t3.data.startsWith("$s"); ) ;
  return t3;
}
function P(n2, t3, r3, u3) {
  var i3, f3 = n2.key, o3 = n2.type, e3 = t3[r3], l3 = e3 && !(2 & e3.__u);
  if (null === e3 && null == f3 || l3 && f3 == e3.key && o3 == e3.type) return r3;
  if (u3 > (l3 ? 1 : 0)) {
    for (i3 = r3 - 1; i3 >= 0; i3--) if ((e3 = t3[i3]) && !(2 & e3.__u) && f3 == e3.key && o3 == e3.type) return i3;
    for (i3 = r3 + 1; i3 < t3.length; i3++) if ((e3 = t3[i3]) && !(2 & e3.__u) && f3 == e3.key && o3 == e3.type) return i3;
  }
  return -1;
}
function T(n2, t3, r3) {
  null == r3 && (r3 = ""), "-" == t3[0] ? n2.setProperty(t3, r3) : n2[t3] = r3;
}
function N(n2, t3, r3, u3, i3) {
  var f3, o3;
  if ("style" == t3) if ("string" == typeof r3) n2.style.cssText = r3;
  else {
    if ("string" == typeof u3 && (n2.style.cssText = u3 = ""), u3) for (t3 in u3) r3 && t3 in r3 || T(n2.style, t3);
    if (r3) for (t3 in r3) u3 && r3[t3] == u3[t3] || T(n2.style, t3, r3[t3]);
  }
  else if ("o" == t3[0] && "n" == t3[1]) "function" != typeof r3 && (r3 = null), "function" != typeof u3 && (u3 = null), (n2.__e || (n2.__e = {}))[t3] = r3, r3 && u3 || (o3 = a[t3] || (a[t3] = V(t3)), (n2.__a || (n2.__a = {}))[t3] = c, f3 = t3 != (t3 = t3.replace(l, "$1")), (t3 = t3.slice(2))[0] < "a" && (t3 = t3.toLowerCase()), r3 ? n2.addEventListener(t3, o3, f3) : n2.removeEventListener(t3, o3, f3));
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
function z(t3, r3, u3, i3, f3, o3, e3, l3, c3, a3) {
  var s3, p3, v3, d3, k3, b, m3, M, C3, j2, L2, H2, q2, A3, O, P3, T3, N2, V2 = r3.type;
  if (r3.constructor !== h) return null;
  128 & u3.__u && (c3 = 32 & u3.__u, s3 = u3.__c.__z) && (r3.__u |= c3, p3 = o3 = [], 8 == s3.nodeType ? l3 = B(s3, o3) : o3.push(s3), l3 = o3[0] || l3), (s3 = n.__b) && s3(r3);
  n: if ("function" == typeof V2) {
    v3 = e3.length;
    try {
      if (M = r3.props, C3 = (s3 = V2.prototype) && s3.render, j2 = (s3 = V2.contextType) && i3[s3.__c], L2 = s3 ? j2 ? j2.props.value : s3.__ : i3, (d3 = u3.__c) ? (r3.__c = d3, 2 & d3.__g && (d3.__g |= 1)) : (C3 ? r3.__c = d3 = new V2(M, L2) : (r3.__c = d3 = new x(M, L2), d3.constructor = V2, d3.render = K), j2 && j2.sub(d3), d3.state || (d3.state = {}), d3.__n = i3, d3.__g |= 8, d3.__h = [], d3.__k = []), C3 && (d3.__s || (d3.__s = d3.state), V2.getDerivedStateFromProps && (d3.__s == d3.state && (d3.__s = _({}, d3.__s)), _(d3.__s, V2.getDerivedStateFromProps(M, d3.__s)))), k3 = d3.props, b = d3.state, d3.__v = r3, u3.__c) {
        if (M !== k3 && C3 && !V2.getDerivedStateFromProps && d3.componentWillReceiveProps && d3.componentWillReceiveProps(M, L2), r3.__v == u3.__v && !(8 & d3.__g) || !(4 & d3.__g) && d3.shouldComponentUpdate && false === d3.shouldComponentUpdate(M, d3.__s, L2)) {
          r3.__v != u3.__v && (d3.props = M, d3.state = d3.__s, d3.__g &= -9), r3.__e = u3.__e, r3.__k = u3.__k, r3.__k.some(function(n2) {
            n2 && (n2.__ = r3);
          }), y.push.apply(d3.__h, d3.__k), d3.__k = [], d3.__h.length && e3.push(d3), l3 = S(u3);
          break n;
        }
        d3.componentWillUpdate && d3.componentWillUpdate(M, d3.__s, L2), C3 && d3.componentDidUpdate && d3.__h.push(function() {
          d3.componentDidUpdate(k3, b, m3);
        });
      } else C3 && !V2.getDerivedStateFromProps && d3.componentWillMount && d3.componentWillMount(), C3 && d3.componentDidMount && d3.__h.push(d3.componentDidMount);
      d3.context = L2, d3.props = M, d3.__P = t3, d3.__g &= -5, H2 = n.__r, q2 = C3 ? 25 : 0;
      do {
        d3.__g &= -9, H2 && H2(r3), s3 = d3.render(d3.props, d3.state = d3.__s, d3.context);
      } while (8 & d3.__g && ++q2 < 25);
      C3 && (y.push.apply(d3.__h, d3.__k), d3.__k = []), d3.state = d3.__s, d3.getChildContext && (i3 = _({}, i3, d3.getChildContext())), C3 && u3.__c && d3.getSnapshotBeforeUpdate && (m3 = d3.getSnapshotBeforeUpdate(k3, b)), A3 = s3 && s3.type === $ && null == s3.key ? s3.props.children : s3, M.__P && (s3 = l3, f3 = (t3 = M.__P).namespaceURI, c3 = o3 = null, u3.props && u3.props.__P != t3 && (u3.__k.some(function(n2) {
        n2 && J(n2, n2);
      }), u3.__k = null), l3 = u3.__k ? S(u3, 0) : null), l3 = I(t3, w(A3) ? A3 : [A3], r3, u3, i3, f3, o3, e3, l3, c3, a3), M.__P && (r3.__e = null, l3 = s3), r3.__u &= -161, p3 && p3.some(g), d3.__h.length && e3.push(d3), 1 & d3.__g && (d3.__g &= -4);
    } catch (t4) {
      if (e3.length = v3, r3.__v = null, c3 || o3) if (t4 && t4.then) {
        if (r3.__u |= 128 | c3, o3) {
          for (~(T3 = o3.indexOf(l3 || void 0)) || (T3 = o3.length); (N2 = o3[T3 - 1]) && 8 == N2.nodeType; ) T3--;
          for (; T3 < o3.length; T3++) if (N2 = o3[T3]) if (o3[T3] = null, O) {
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
      } else o3 && o3.some(g);
      else r3.__e = u3.__e;
      r3.__k || (r3.__k = u3.__k || []), t4 && t4.then || D(r3), n.__e(t4, r3, u3);
    }
  } else l3 = r3.__e = F(u3.__e, r3, u3, i3, f3, o3, e3, c3, a3, t3);
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
function F(t3, r3, u3, i3, f3, o3, e3, l3, c3, a3) {
  var s3, h3, y3, _3, k3, b, m3, M, $2 = u3.props || p, x2 = r3.props, C3 = r3.type;
  if ("svg" == C3 ? f3 = "http://www.w3.org/2000/svg" : "math" == C3 ? f3 = "http://www.w3.org/1998/Math/MathML" : f3 || (f3 = "http://www.w3.org/1999/xhtml"), o3) {
    for (s3 = 0; s3 < o3.length; s3++) if ((k3 = o3[s3]) && (C3 ? k3.localName == C3 : 3 == k3.nodeType)) {
      t3 = k3, o3[s3] = null;
      break;
    }
  }
  if (!t3) {
    if (M = a3.ownerDocument || document, !C3) return M.createTextNode(x2);
    t3 = M.createElementNS(f3, C3, x2.is ? x2 : a3), l3 && (n.__m && n.__m(r3, o3), l3 = false), o3 = null;
  }
  if (C3) {
    if (a3 = "template" == C3 && t3.content || t3, o3 = "textarea" == C3 && null != x2.defaultValue ? null : o3 && d.call(a3.childNodes), !l3 && o3) for ($2 = {}, s3 = 0; s3 < t3.attributes.length; s3++) $2[(k3 = t3.attributes[s3]).name] = k3.value;
    for (s3 in $2) k3 = $2[s3], "dangerouslySetInnerHTML" == s3 ? y3 = k3 : "children" == s3 || s3 in x2 || "value" == s3 && "defaultValue" in x2 || "checked" == s3 && "defaultChecked" in x2 || N(t3, s3, null, k3, f3);
    for (s3 in x2) k3 = x2[s3], "children" == s3 ? _3 = k3 : "dangerouslySetInnerHTML" == s3 ? h3 = k3 : "value" == s3 ? b = k3 : "checked" == s3 ? m3 = k3 : l3 && "function" != typeof k3 || $2[s3] === k3 || N(t3, s3, k3, $2[s3], f3);
    h3 ? (l3 || y3 && (h3.__html == y3.__html || h3.__html == t3.innerHTML) || (t3.innerHTML = h3.__html), r3.__k = []) : (y3 && (t3.textContent = ""), ("foreignObject" == C3 || "http://www.w3.org/1998/Math/MathML" == f3 && v.test(C3)) && (f3 = "http://www.w3.org/1999/xhtml"), I(a3, w(_3) ? _3 : [_3], r3, u3, i3, f3, o3, e3, o3 ? o3[0] : u3.__k && S(u3, 0), l3, c3), o3 && o3.some(g)), l3 && "textarea" != C3 || (s3 = "value", "progress" == C3 && null == b ? t3.removeAttribute(s3) : null == b || b === t3[s3] && ("progress" != C3 || b) || N(t3, s3, b, $2[s3], f3), s3 = "checked", null != m3 && m3 != t3[s3] && N(t3, s3, m3, $2[s3], f3));
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
  var i3, f3, o3, e3;
  if (n.unmount && n.unmount(t3), !(i3 = t3.ref) || i3.current && i3.current != t3.__e || G(i3, null, r3, t3), i3 = t3.__c) {
    if (i3.componentWillUnmount) try {
      i3.componentWillUnmount();
    } catch (t4) {
      n.__e(t4, r3);
    }
    i3.__P = i3.__n = null;
  }
  if (i3 = t3.__k) for (e3 = 0; e3 < i3.length; e3++) i3[e3] && J(i3[e3], r3, "function" != typeof t3.type || u3 && !t3.props.__P);
  !u3 && (i3 = t3.__c) && (i3 = i3.__z) && (f3 = B(i3, o3 = [])) && (i3 == t3.__e && o3.some(g), g(f3), g(i3)), u3 || g(t3.__e), t3.__e = t3.__c = t3.__ = null;
}
function K(n2, t3, r3) {
  return this.constructor(n2, r3);
}
function Q(t3, r3) {
  var u3, i3, f3, o3;
  n.__ && n.__(t3, r3), 9 == r3.nodeType && (r3 = r3.documentElement), i3 = (u3 = t3 && 32 & t3.__u) ? null : r3.__k, r3.__k = m($, { children: [t3] }), f3 = [], o3 = [], z(r3, r3.__k, i3 || p, p, r3.namespaceURI, i3 ? null : r3.firstChild ? d.call(r3.childNodes) : null, f3, i3 ? i3.__e : r3.firstChild, u3, o3), E(f3, r3.__k, o3), r3.__k.props.children = null;
}
n = { __e: function(n2, t3, r3, u3) {
  for (var i3, o3, e3; t3 = t3.__; ) if ((i3 = t3.__c) && !(1 & i3.__g)) {
    i3.__g |= 4;
    try {
      if ((e3 = (o3 = i3.constructor) && o3.getDerivedStateFromError) && i3.setState(o3.getDerivedStateFromError(n2)), i3.componentDidCatch && (i3.componentDidCatch(n2, u3 || {}), e3 = 1), e3 && 8 & i3.__g) return void (i3.__g |= 2);
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

// src/engine/framing.ts
function packed(header, payload = new Uint8Array()) {
  const text2 = new TextEncoder().encode(JSON.stringify(header));
  const message = new Uint8Array(4 + text2.length + payload.length);
  new DataView(message.buffer).setUint32(0, text2.length, true);
  message.set(text2, 4);
  message.set(payload, 4 + text2.length);
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
function patched(document2, operations) {
  let changed = document2;
  operations.forEach((operation, number2) => {
    const what = `patch: operations[${number2}]: '${operation.path}'`;
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
  return path.split("/").slice(1).map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));
}
function done(inside, op, steps, value, what) {
  const [step, ...rest] = steps;
  if (step === void 0) {
    if (op === "remove") throw new Error(`${what}: the whole document cannot be removed`);
    return value;
  }
  if (Array.isArray(inside)) return doneInList([...inside], op, step, rest, value, what);
  if (typeof inside !== "object" || inside === null) throw new Error(`${what}: before '${step}' stands no object`);
  const fields2 = inside;
  if ((rest.length > 0 || op !== "add") && !Object.hasOwn(fields2, step)) {
    throw new Error(`${what}: there is no field '${step}'`);
  }
  if (rest.length === 0 && op === "remove") {
    return Object.fromEntries(Object.entries(fields2).filter(([name]) => name !== step));
  }
  const inner = rest.length > 0 ? done(fields2[step], op, rest, value, what) : value;
  return Object.fromEntries([...Object.entries(fields2).filter(([name]) => name !== step), [step, inner]]);
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
var SHOWN_HERE = ["/view/slices/window"];
var LOST = { code: "lost", message: "the connection was lost" };
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
  let state2 = null;
  let fingerprint;
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
      tell({ kind: "busy", text: "No answer yet" });
    }, BUSY_MS);
  };
  const flush = () => {
    if (!isScheduled && outgoing.length === 0 || !isOpen) return;
    isScheduled = false;
    channel.send({ type: "patch", seq, operations: outgoing, moving: isMoving });
    if (outgoing.length > 0 && sizes.size > 0) expect();
    outgoing = [];
  };
  const sayHello = () => channel.send({ type: "hello", protocol: 1, ...options.hello() });
  const offer = (header) => {
    clearInterval(helloTimer);
    if (typeof header["session"] === "string") options.onSession?.(header["session"]);
    if (state2 !== null) options.onOtherData?.();
    isOpen = true;
    tell({ kind: "start", offered: header });
  };
  const start = (header) => {
    clearInterval(helloTimer);
    if (typeof header["session"] === "string") options.onSession?.(header["session"]);
    const isFirst = state2 === null;
    if (!isFirst && header["fingerprint"] !== fingerprint) options.onOtherData?.();
    fingerprint = header["fingerprint"];
    isOpen = true;
    if (isFirst) {
      state2 = header.state;
      welcomed(header);
    }
    if (!isFirst && state2 !== null) {
      outgoing = [{ op: "replace", path: "", value: state2 }];
      isMoving = false;
      isScheduled = true;
      flush();
    }
    for (const [view, { width, height }] of sizes) channel.send({ type: "view", view, size: [width, height] });
    tell({ kind: "open" });
  };
  const fail = (header) => {
    const problem = {
      code: String(header["code"] ?? "failed"),
      message: String(header["message"] ?? "it failed without a reason"),
      ...typeof header["field"] === "string" ? { field: header["field"] } : {},
      ...typeof header["remedy"] === "string" ? { remedy: header["remedy"] } : {}
    };
    const id2 = header["id"];
    if (typeof id2 === "number") {
      waiting.get(id2)?.reject(problem);
      waiting.delete(id2);
      return;
    }
    if (state2 === null) {
      failed(problem);
      tell({ kind: "lost", problem, retries: false });
      return;
    }
    problems.forEach((listener) => listener(problem));
  };
  const receive = (header, payload) => {
    heard();
    switch (header["type"]) {
      case "start":
        offer(header);
        return;
      case "welcome":
        start(header);
        return;
      case "progress": {
        const part = typeof header["part"] === "number" ? header["part"] : void 0;
        if (typeof header["id"] === "number") waiting.get(header["id"])?.progress?.(part ?? 0);
        else {
          const text2 = String(header["text"] ?? "");
          tell(part === void 0 ? { kind: "connecting", text: text2 } : { kind: "connecting", text: text2, part });
        }
        return;
      }
      case "patch": {
        const operations = header["operations"];
        if (state2 !== null) state2 = patched(state2, operations);
        states.forEach((listener) => listener(operations));
        return;
      }
      case "frame":
        frames.forEach((listener) => listener({ ...header, bytes: payload }));
        return;
      case "answer": {
        const one = waiting.get(Number(header["id"]));
        waiting.delete(Number(header["id"]));
        if (typeof header["fingerprint"] === "string") fingerprint = header["fingerprint"];
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
      if (state2 === null) tell({ kind: "connecting", text: "Opening" });
      sayHello();
      clearInterval(helloTimer);
      if (options.repeatHelloMs) helloTimer = setInterval(sayHello, options.repeatHelloMs);
      return;
    }
    isOpen = false;
    heard();
    clearInterval(helloTimer);
    for (const one of waiting.values()) one.reject(LOST);
    waiting.clear();
    const problem = next.retries ? {
      code: "lost",
      message: "The connection to the program that draws is lost",
      remedy: "If it was stopped, start it again with the same --port; what you changed here is kept."
    } : {
      code: "refused",
      message: next.reason || "The program that draws refused this page",
      remedy: "Open the link that the command printed."
    };
    if (!next.retries && state2 === null) failed(problem);
    tell({ kind: "lost", problem, retries: next.retries });
  });
  return {
    welcome,
    patch(operations, moving) {
      if (state2 !== null) state2 = patched(state2, operations);
      seq += 1;
      outgoing.push(...operations);
      isMoving = moving;
      const waits = moving && operations.length > 0 && operations.every(({ path }) => SHOWN_HERE.includes(path));
      if (!isScheduled && !waits) {
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
    ask(name, question, progress, signal, payload) {
      const id2 = nextId;
      nextId += 1;
      return new Promise((resolve, reject) => {
        waiting.set(id2, { resolve, reject, progress });
        signal?.addEventListener("abort", () => {
          if (waiting.has(id2)) channel.send({ type: "cancel", id: id2 });
        });
        if (!isOpen || signal?.aborted) {
          waiting.delete(id2);
          reject(isOpen ? { ...LOST, code: "cancelled" } : LOST);
          return;
        }
        flush();
        channel.send({ type: "ask", id: id2, question: name, arguments: question }, payload);
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
  { keys: ["0"], action: "first-view", shown: "0", text: "The view of the first picture" },
  { keys: ["f"], action: "fit", shown: "F", text: "Fit all into view" },
  { keys: ["l"], action: "level", shown: "L", text: "Level: upright again" },
  { keys: ["["], action: "slice-back", shown: "[", text: "Slice back" },
  { keys: ["]"], action: "slice-on", shown: "]", text: "Next slice" },
  { keys: ["Ctrl+z"], action: "undo", shown: "Ctrl Z", text: "Undo" },
  { keys: ["Ctrl+Shift+Z", "Ctrl+y"], action: "redo", shown: "Ctrl Shift Z", text: "Redo" },
  { keys: ["Ctrl+k"], action: "find", shown: "Ctrl K", text: "Find a command" },
  { keys: ["?"], action: "help", shown: "?", text: "Show this table" },
  { keys: ["Escape"], action: "leave", shown: "Esc", text: "Leave the tool, or close the sheet" }
];
var GESTURES = [
  ["Drag", "Turn; freely with the trackball of the settings"],
  ["Shift drag, middle button", "Move"],
  ["Wheel", "Magnify about the pointer"],
  ["Right button", "Magnify"],
  ["Ctrl drag", "Roll"],
  ["Alt drag", "Window and level: of slices, in space of the opacities and colours"],
  ["Ctrl click", "Crosshair to what is seen"],
  ["Wheel on a slice; with Ctrl", "Next slices; magnify about the pointer"],
  ["Double click on a slice", "It fills the page, or goes back"],
  ["Two fingers on a slice", "Up and down: next slices; sideways: move; apart: magnify"],
  ["One finger, two fingers", "Turn; move and magnify, with the trackball also roll"]
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
var MAX_CHARACTERS = 8e3;
async function linkPart(state2, fingerprint) {
  const text2 = JSON.stringify({ fingerprint, state: state2 });
  const packed2 = await through(new TextEncoder().encode(text2), new CompressionStream("deflate-raw"));
  const part = btoa(Array.from(packed2, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return part.length > MAX_CHARACTERS ? null : part;
}
async function fromLink(part) {
  const binary = atob(part.replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const text2 = new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw")));
  const found2 = JSON.parse(text2);
  if (typeof found2 !== "object" || found2 === null || !("fingerprint" in found2) || !("state" in found2)) {
    throw new Error("the link holds no state of the viewer");
  }
  return { fingerprint: String(found2.fingerprint), state: found2.state };
}
async function through(bytes, stream) {
  const piped = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(piped).arrayBuffer());
}

// src/state/composites.ts
var COMPOSITE_NAMES = {
  over: "Volume rendering (over)",
  maximum: "Maximum intensity (MIP)",
  "depth-shaded-maximum": "Maximum, dimmed by depth",
  "depth-colored-maximum": "Maximum, colour by depth",
  "attenuated-maximum": "Maximum, attenuated",
  "local-maximum": "First local maximum (LMIP)",
  minimum: "Minimum intensity (MinIP)",
  mean: "Mean",
  sum: "Sum",
  "x-ray": "X-ray",
  "first-hit": "Isosurface (first hit)"
};

// src/state/state.ts
var QUALITIES = ["draft", "normal", "fine", "high"];
var PANES = ["z", "y", "x"];
var SLICE_COLORS = ["gray", "gray_r", "hot", "viridis", "coolwarm"];
var TURNINGS = ["turntable", "trackball"];
var OVERLAYS = ["scale_bar", "letters", "cube", "color_bar", "crosshair", "crop_box", "legend"];
var MAX_REGION_POINTS = 200;

// src/state/parse.ts
function refuse(value, where, must) {
  throw new Error(`${where} is ${(JSON.stringify(value) ?? "missing").slice(0, 60)}; it must be ${must}`);
}
var number = (low = -Infinity, high = Infinity) => (value, where) => {
  if (typeof value !== "number" || !Number.isFinite(value) || value < low || value > high) {
    refuse(value, where, low === -Infinity ? "a number" : `a number from ${low} to ${high}`);
  }
};
var kind = (name) => (value, where) => {
  if (typeof value !== name) refuse(value, where, name === "string" ? "a text" : "true or false");
};
var oneOf = (...known2) => (value, where) => {
  if (!known2.includes(value)) refuse(value, where, `one of ${known2.join(", ")}`);
};
var either = (wanted, check) => (value, where) => {
  if (value !== wanted) check(value, where);
};
var list = (check, low = 0, high = Infinity) => (value, where) => {
  if (!Array.isArray(value) || value.length < low || value.length > high) {
    refuse(value, where, `a list${low === high ? ` of ${low}` : low > 0 ? ` of at least ${low}` : ""}`);
  }
  value.forEach((one, n2) => check(one, `${where}[${n2}]`));
};
var fields = (known2) => (value, where) => {
  if (typeof value !== "object" || value === null || Array.isArray(value)) refuse(value, where, "an object");
  const found2 = value;
  const inside = (name) => where === "" ? name : `${where}.${name}`;
  for (const [name, check] of Object.entries(known2)) {
    const plain = name.replace("?", "");
    if (name === "*") continue;
    if (Object.hasOwn(found2, plain)) check(found2[plain], inside(plain));
    else if (plain === name) throw new Error(`field '${inside(name)}' is missing`);
  }
  for (const name of Object.keys(found2)) {
    if (name in known2 || `${name}?` in known2) continue;
    const other = known2["*"];
    if (other === void 0) throw new Error(`${where || "state"}: unknown field '${name}'`);
    other(found2[name], inside(name));
  }
};
var share = number(0, 1);
var any = () => void 0;
var text = kind("string");
var flag = kind("boolean");
var point = list(number(), 3, 3);
var color = (value, where) => typeof value === "string" ? void 0 : list(share, 3, 4)(value, where);
var box = fields({ lower: point, upper: point, "space?": oneOf("world", "index") });
var nodes = (...columns) => list((node, where) => {
  list(any, columns.length, columns.length)(node, where);
  columns.forEach((check, n2) => check(node[n2], where));
}, 1);
var id = (value, where) => Number.isInteger(value) && Number(value) > 0 ? void 0 : refuse(value, where, "a whole number from 1");
var volume = fields({ path: oneOf(null), "name?": text, "id?": id });
var shading = fields({ ...Object.fromEntries(["ambient", "diffuse", "specular", "specular_power"].map((name) => [`${name}?`, number(0)])), "*": any });
var curves = (value, where) => {
  if (Object.hasOwn(Object(value), "rgba")) return;
  fields({
    "opacity_unit?": either(null, number(0)),
    opacity: nodes(number(), share),
    color: nodes(number(), share, share, share),
    "gradient_opacity?": nodes(number(0), share)
  })(value, where);
};
var COMPOSITES = Object.keys(COMPOSITE_NAMES);
var composite = (value, where) => {
  if (value === null || typeof value === "string") oneOf(null, ...COMPOSITES)(value, where);
  else fields(Object.fromEntries(COMPOSITES.map((name) => [`${name}?`, fields({ "*": either(null, any) })])))(value, where);
};
var clip = (value, where) => {
  fields({ "keep?": box, "cut_out?": box, "plane?": fields({ point, normal: point }) })(value, where);
  if (Object.keys(value).length !== 1) refuse(value, where, "an object of one field: keep, plane or cut_out");
};
var state = fields({
  wavesplat: oneOf("scene"),
  version: oneOf(1),
  layers: list(
    fields({
      volume,
      "name?": text,
      look: fields({ transfer_function: curves, "shading?": either(null, shading), "*": either(null, text) }),
      "visible?": flag,
      "opacity?": share,
      "time?": (value, where) => Number.isInteger(value) ? void 0 : refuse(value, where, "a whole number")
    }),
    1,
    8
  ),
  labels: either(null, fields({ volume, "labels?": fields({ "*": fields({ color, "name?": text, "*": share }) }), "smooth?": flag })),
  shading: either("look", either(null, shading)),
  clip: list(clip),
  background: either(null, color),
  geometry: list(fields({ kind: text, name: text, count: number(), visible: flag, "id?": id })),
  camera: fields({
    version: oneOf(1),
    position: point,
    focal_point: point,
    view_up: point,
    "parallel_scale?": number(Number.MIN_VALUE),
    "view_angle?": number(Number.MIN_VALUE, 180)
  }),
  render: fields({
    "size?": list(number(1), 2, 2),
    quality: (value, where) => typeof value === "string" ? oneOf(...QUALITIES)(value, where) : fields({ "*": either(null, any) })(value, where),
    "kernel?": text,
    "composite?": composite
  }),
  view: fields({
    "layout?": fields({ "name?": oneOf("3d", "one-and-three", "two-by-two", "single"), "main?": oneOf("3d", ...PANES) }),
    "slices?": fields({
      "crosshair?": point,
      "window?": (value, where) => {
        list(number(), 2, 2)(value, where);
        number(Number.MIN_VALUE)(value[1], where);
      },
      "thickness?": number(0),
      "slab?": oneOf("maximum", "minimum", "mean"),
      "zoom?": number(0.01, 1e3),
      "center?": point,
      "colors?": oneOf(...SLICE_COLORS),
      "normals?": fields(
        Object.fromEntries(
          PANES.map((pane) => [
            `${pane}?`,
            (value, where) => {
              point(value, where);
              if (!value.some((one) => one !== 0)) refuse(value, where, "a direction");
            }
          ])
        )
      )
    }),
    "measures?": list((value, where) => {
      fields({ kind: oneOf("distance", "angle", "area"), points: list(point) })(value, where);
      const { kind: what, points } = value;
      list(any, what === "distance" ? 2 : 3, { distance: 2, angle: 3 }[what] ?? MAX_REGION_POINTS)(points, `${where}.points`);
    }, 0, 1e3),
    "overlays?": fields(Object.fromEntries(OVERLAYS.map((name) => [`${name}?`, flag]))),
    "quality?": fields({ "moving?": oneOf("smooth", "balanced", "exact") }),
    "interface?": fields({ "theme?": oneOf("system", "dark", "light"), "panels?": list(text, 0, 100), "turning?": oneOf(...TURNINGS) })
  })
});
function parseViewerState(document2) {
  state(document2, "");
  return document2;
}

// src/state/store.ts
var MAX_STEPS = 200;
var INTERFACE = ["/view/interface", "/view/layout"];
function createStore(initial, engine) {
  let state2 = initial;
  let seq = 0;
  let gesture = null;
  let past = [];
  let future = [];
  const listeners = /* @__PURE__ */ new Set();
  const tell = () => listeners.forEach((listener) => listener());
  const remember = (before2) => {
    past = [...past.slice(1 - MAX_STEPS), before2];
    future = [];
  };
  const go = (target) => {
    const { layout, interface: shown } = state2.view;
    state2 = { ...target, view: { ...target.view, layout, interface: shown } };
    gesture = null;
    seq = engine.patch([{ op: "replace", path: "", value: state2 }], false);
    tell();
  };
  engine.onState((operations) => {
    state2 = patched(state2, operations);
    const also = (before2) => {
      try {
        return operations.some(({ path }) => path === "") ? before2 : patched(before2, operations);
      } catch {
        return before2;
      }
    };
    past = past.map(also);
    future = future.map(also);
    tell();
  });
  return {
    get state() {
      return state2;
    },
    get seq() {
      return seq;
    },
    change(operations, name) {
      const before2 = state2;
      state2 = patched(state2, operations);
      const isStep = operations.some(({ path }) => !INTERFACE.some((start) => path.startsWith(start)));
      if (isStep && (name === void 0 || name !== gesture)) remember(before2);
      if (isStep) gesture = name ?? null;
      seq = engine.patch(operations, name !== void 0);
      tell();
    },
    adjust(operations) {
      state2 = patched(state2, operations);
      seq = engine.patch(operations, false);
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
      future = [...future, state2];
      go(target);
    },
    redo() {
      const target = future.at(-1);
      if (target === void 0) return;
      future = future.slice(0, -1);
      past = [...past, state2];
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

// src/view/frame_statistics.ts
var MAX_RECORDS = 4e3;
var MAX_EVENTS = 1e3;
var FrameStatistics = class {
  records = [];
  /** Milliseconds that the page took to draw its interface, the latest ones. */
  draws = [];
  events = [];
  /** Records the time of the event that a change came from. */
  event(seq, at2) {
    this.events.push({ seq, at: at2 });
    if (this.events.length > MAX_EVENTS) this.events.shift();
  }
  /** Records that a frame is on the canvas. */
  drawn(frame, at2) {
    const shown = this.events.filter((event) => event.seq <= frame.seq).at(-1);
    if (shown !== void 0) this.events = this.events.filter((event) => event.seq > frame.seq);
    const { bytes, ...header } = frame;
    this.records.push({ at: at2, latency: shown === void 0 ? null : at2 - shown.at, bytes: bytes.length, frame: header });
    if (this.records.length > MAX_RECORDS) this.records.shift();
  }
  /** Records how long the interface took to draw, ms. */
  interfaceDrawn(ms) {
    this.draws.push(ms);
    if (this.draws.length > MAX_RECORDS) this.draws.shift();
  }
  /** Statistics of the moving frames of the last `span` milliseconds. */
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
  const sorted = [...values].sort((a3, b) => a3 - b);
  return sorted[Math.floor(sorted.length / 2)] ?? null;
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
  var f3 = y2(t2++, 2);
  if (f3.t = n2, !f3.__c && (f3.__ = [i3 ? i3(u3) : G2(void 0, u3), function(n3) {
    var t3 = (f3.__N || f3.__)[0], r3 = f3.t(t3, n3);
    o2(t3, r3) || (f3.__N = [r3, f3.__[1]], f3.__c.setState({}));
  }], f3.__c = r2, !r2.__f)) {
    r2.__f = true;
    var c3 = r2.shouldComponentUpdate;
    r2.shouldComponentUpdate = function(n3, t3, r3) {
      var u4 = this.__H;
      if (!u4) return true;
      var i4 = false, f4 = this.props != n3;
      if (u4.__.some(function(n4) {
        n4.__N && (i4 = true, o2(n4.__[0], n4.__N[0]) || (f4 = true));
      }), c3) {
        var e3 = c3.call(this, n3, t3, r3);
        return i4 ? e3 || f4 : e3;
      }
      return !i4 || f4;
    };
  }
  return f3.__;
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
var k2 = "function" == typeof requestAnimationFrame;
function z2(n2) {
  var t3, r3 = function() {
    clearTimeout(u3), k2 && cancelAnimationFrame(t3), setTimeout(n2);
  }, u3 = setTimeout(r3, 35);
  k2 && (t3 = requestAnimationFrame(r3));
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
function isEditable(curves2) {
  return !("rgba" in curves2);
}
function at(curve2, value) {
  const next = curve2.findIndex((point2) => valueAt(point2) > value);
  const right = next < 0 ? curve2.length - 1 : next;
  const [a3, b] = [curve2[next < 0 ? right : Math.max(0, right - 1)], curve2[right]];
  if (a3 === void 0 || b === void 0) return [];
  const width = valueAt(b) - valueAt(a3);
  const share2 = width > 0 ? clamped((value - valueAt(a3)) / width, 0, 1) : 0;
  return a3.slice(1).map((start, k3) => start + share2 * ((b[k3 + 1] ?? start) - start));
}
function withPoint(curve2, point2) {
  const next = curve2.findIndex((other) => valueAt(other) > valueAt(point2));
  const index = next < 0 ? curve2.length : next;
  return { curve: [...curve2.slice(0, index), point2, ...curve2.slice(index)], index };
}
function withPointOn(curve2, value) {
  return withPoint(curve2, [value, ...at(curve2, value)]);
}
function withPointBeside(curve2, index, span) {
  const here = valueAt(curve2[index] ?? [middle(span)]);
  const [next, before2] = [curve2[index + 1], curve2[index - 1]];
  if (next !== void 0 && valueAt(next) > here) return withPointOn(curve2, (here + valueAt(next)) / 2);
  if (before2 !== void 0 && valueAt(before2) < here) return withPointOn(curve2, (here + valueAt(before2)) / 2);
  return withPointOn(curve2, here + 0.1 * (span[1] - span[0]));
}
function withMoved(curve2, index, point2) {
  const least = index > 0 ? valueAt(curve2[index - 1] ?? []) : -Infinity;
  const most = index < curve2.length - 1 ? valueAt(curve2[index + 1] ?? []) : Infinity;
  const moved = [clamped(valueAt(point2), least, most), ...point2.slice(1).map((share2) => clamped(share2, 0, 1))];
  return curve2.map((other, k3) => k3 === index ? moved : other);
}
function without(curve2, index) {
  return curve2.length > 1 ? curve2.filter((_3, k3) => k3 !== index) : curve2;
}
function spanOf(...curves2) {
  const values = curves2.flat().map(valueAt);
  return [Math.min(...values), Math.max(...values)];
}
function spanOfFunction(curves2) {
  return spanOf(curves2.opacity, curves2.color);
}
function mapped(curve2, factor, centre, shift = 0) {
  const points = curve2.map((point2) => {
    const value = centre + factor * (valueAt(point2) - centre) + shift;
    return [value, ...point2.slice(1)];
  });
  return factor < 0 ? points.reverse() : points;
}
function shifted(curves2, shift) {
  return onValues(curves2, 1, 0, shift);
}
function widened(curves2, factor) {
  return onValues(curves2, factor, middle(spanOfFunction(curves2)), 0);
}
function withOpacities(curves2, factor) {
  const opacity = curves2.opacity.map(([value, alpha]) => [value, clamped(factor * alpha, 0, 1)]);
  return { ...curves2, opacity };
}
function mirrored(curve2) {
  return mapped(curve2, -1, middle(spanOf(curve2)));
}
function windowed(look, dx, dy, range) {
  const curves2 = look.transfer_function;
  if (!isEditable(curves2)) return look;
  const wide = widened(curves2, Math.exp(dx / WIDTH_PX));
  return { ...look, transfer_function: shifted(wide, -dy / LEVEL_PX * (range[1] - range[0])) };
}
function firstGradientCurve(scale) {
  return [
    [0, 0],
    [0.5 * scale, 1]
  ];
}
function surfaceValue(curves2, range) {
  if (!isEditable(curves2)) return middle(range);
  const half = Math.max(...curves2.opacity.map(([, alpha]) => alpha)) / 2;
  const next = curves2.opacity.findIndex(([, alpha]) => alpha >= half);
  const [a3, b] = [curves2.opacity[Math.max(0, next - 1)], curves2.opacity[next]];
  if (half <= 0 || a3 === void 0 || b === void 0) return middle(range);
  const rise = b[1] - a3[1];
  return rise > 0 ? a3[0] + (half - a3[1]) / rise * (b[0] - a3[0]) : b[0];
}
function outline(curve2, [low, high], pieces = 1) {
  const ends = [low, high].map((value) => [value, at(curve2, value)[0] ?? 0]);
  const inside = curve2.filter(([value]) => value > low && value < high);
  const [first, last] = ends;
  const corners2 = [first, ...inside, last];
  return corners2.flatMap((to, k3) => {
    const from = corners2[k3 - 1];
    if (from === void 0 || pieces === 1 || from[0] === to[0] || from[1] === to[1]) return [to];
    return Array.from({ length: pieces }, (_3, n2) => between(from, to, (n2 + 1) / pieces));
  });
}
function hexOf([, red, green, blue]) {
  const byte = (share2) => Math.round(255 * clamped(share2, 0, 1)).toString(16).padStart(2, "0");
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
function between(a3, b, share2) {
  return [a3[0] + share2 * (b[0] - a3[0]), a3[1] + share2 * (b[1] - a3[1])];
}
function onValues(curves2, factor, centre, shift) {
  return {
    ...curves2,
    opacity: mapped(curves2.opacity, factor, centre, shift),
    color: mapped(curves2.color, factor, centre, shift)
  };
}
function valueAt(point2) {
  return point2[0] ?? 0;
}

// src/view/look/axis.ts
var CLOSEST = 1e-4;
function wholeOf(data, points) {
  const [low, high] = [Math.min(data[0], points[0]), Math.max(data[1], points[1])];
  const room = 0.02 * (high > low ? high - low : Math.abs(low) || 1);
  return [low - room, high + room];
}
function zoomed(seen, factor, centre, whole) {
  const most = whole[1] - whole[0];
  const width = clamped((seen[1] - seen[0]) / factor, CLOSEST * most, most);
  const share2 = clamped((centre - seen[0]) / (seen[1] - seen[0]), 0, 1);
  return within([centre - share2 * width, centre + (1 - share2) * width], whole);
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
  return Array.from({ length: Math.max(0, Math.min(count, 50)) }, (_3, k3) => tidy((first + k3) * step, step));
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
var FIELD_LENGTH = 9;
function fieldText(value, decimals) {
  const whole = decimals === void 0 ? value : Number(value.toFixed(Math.min(decimals, 20)));
  const text2 = numberText(whole === 0 && value !== 0 ? value : whole);
  if (text2.length <= FIELD_LENGTH) return text2;
  for (let digits = 5; digits > 1; digits -= 1) {
    const shorter = [String(Number(value.toPrecision(digits))), value.toExponential(digits - 1)].find((one) => one.length <= FIELD_LENGTH);
    if (shorter !== void 0) return shorter;
  }
  return value.toExponential(0);
}
function decimalsOfStep(step) {
  return Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(step) + 1e-9)));
}
function outOfSight(curve2, [low, high]) {
  const values = curve2.map(([value]) => value ?? 0);
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

// src/view/look/point_keys.ts
function pointKey(key, isShifted, seen, rise) {
  const share2 = isShifted ? 0.2 : 1;
  const fine = share2 * keyStep(seen, true);
  const coarse = keyStep(seen, false);
  const steps = {
    ArrowLeft: [-fine, 0],
    ArrowRight: [fine, 0],
    ArrowUp: [0, share2 * rise],
    ArrowDown: [0, -share2 * rise],
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

// src/words.ts
var WORDS = {
  layouts: {
    title: "Layout",
    "3d": "3-D",
    "one-and-three": "3-D and three slices",
    "two-by-two": "Two by two",
    single: "One slice",
    slice: "Slice"
  },
  panels: {
    title: "Panels",
    presets: "Looks",
    function: "Colours",
    layers: "Layers",
    labels: "Labels",
    light: "Light",
    cut: "Cut",
    slices: "Slices",
    measure: "Measure",
    share: "Share",
    settings: "Settings",
    close: (name) => `Close ${name}`
  },
  knobs: {
    reveal: "Reveal",
    soften: "Soften",
    through: "See-through"
  },
  palette: {
    title: "Commands",
    find: "Find a command, look, window or label",
    open: "Find",
    none: "Nothing has these words.",
    layout: "Layout",
    panel: "Panel",
    look: "Look",
    window: "Window of slices",
    theme: "Theme",
    label: "Label",
    hide: (name) => `Hide ${name}`,
    show: (name) => `Show ${name}`
  },
  moods: {
    title: "Mood",
    soft: "Soft",
    studio: "Studio",
    dramatic: "Dramatic",
    all: "All of the light"
  },
  /** Names of presets for people. */
  looks: {
    auto: "Automatic",
    "ct-angio": "Angiography",
    "ct-bone": "Bone",
    "ct-heart": "Heart",
    "ct-lung": "Lungs",
    "ct-muscle": "Muscle",
    "ct-skin": "Skin",
    "ct-soft-tissue": "Soft tissue",
    "ct-vessels": "Vessels",
    "mr-angio": "Angiography",
    "mr-brain": "Brain",
    "mr-head": "Head",
    "mr-vessels": "Bright vessels",
    pet: "Uptake",
    "pet-hot-iron": "Hot iron",
    confocal: "Lit cells",
    em: "Stain",
    "fluorescence-cyan": "Cyan",
    "fluorescence-green": "Green",
    "fluorescence-grey": "Grey",
    "fluorescence-magenta": "Magenta",
    "fluorescence-red": "Red",
    heat: "Heat",
    log: "Decades",
    signed: "Two signs",
    grey: "Grey MIP"
  },
  legend: {
    title: "Legend",
    more: (n2) => `${n2} more`,
    hide: (name) => `${name}: hide`,
    show: (name) => `${name}: show`
  },
  about: {
    open: (names) => `${names}: about the data`,
    kind: "Kind",
    samples: "Samples",
    spacing: "Spacing",
    size: "Size",
    values: "Values",
    axes: "Axes",
    axesOf: (letters) => `${letters} (where x, y and z point)`,
    noAxes: "no directions of a patient",
    times: "Times",
    notes: "Known and guessed",
    picture: "Of this picture",
    kinds: {
      CT: "CT",
      MR: "MRI",
      PET: "PET",
      dose: "Dose",
      ultrasound: "Ultrasound",
      fluorescence: "Fluorescence",
      EM: "Electron microscopy",
      FA: "Anisotropy (FA)",
      probability: "Probability",
      map: "Map of measures",
      "p-values": "p-values",
      "signed field": "Field of both signs",
      field: "Field",
      mask: "Mask",
      labels: "Labels",
      scan: "Scan of no fixed scale"
    }
  },
  /** Headings of the sheets, longer than the names in the rail. */
  sheets: {
    looks: "All looks",
    about: "About the data",
    presets: "Looks",
    function: "Colours and opacity",
    layers: "Layers",
    labels: "Labels",
    light: "Light and projection",
    cut: "Cut",
    slices: "Slices",
    measure: "Measure",
    share: "Pictures and sharing",
    settings: "Settings"
  },
  toolbar: {
    tools: "Dragging",
    turn: "Turn",
    window: "Window and level",
    distance: "Measure a distance",
    angle: "Measure an angle",
    area: "Measure a region",
    history: "History",
    undo: "Undo",
    redo: "Redo",
    views: "Standard views",
    from: (view) => `From the ${view}`,
    lettered: (letter, view) => `${letter}, from the ${view}`,
    fit: "Fit all into view",
    light: "Light colours",
    dark: "Dark colours",
    help: "Keys and gestures",
    help_short: "Keys",
    theme_short: "Theme"
  },
  help: {
    close: "Close",
    where: "Keys act in the view that was used last; in slices arrows move the crosshair.",
    gestures: "Mouse and touch",
    keys: "Keys"
  },
  settings: {
    rest: "At rest",
    moving: "While moving",
    movings: { smooth: "Smooth: 30 frames/s", balanced: "Balanced: better", exact: "Exact: as at rest" },
    custom: "Custom",
    perspective: "Perspective",
    angle: "View angle",
    turning: "Turning",
    turnings: { turntable: "Turntable: stays upright", trackball: "Trackball: every way" },
    theme: "Theme",
    themes: { system: "As the system", dark: "Dark", light: "Light" },
    over: "Over the views",
    overlays: {
      scale_bar: "Scale bar",
      letters: "Letters of directions",
      cube: "Orientation cube",
      color_bar: "Colour bar",
      crosshair: "Crosshair",
      crop_box: "Crop box and clip planes",
      legend: "Legend"
    },
    figures: "Frame rate, latency, error"
  },
  cut: {
    handles: "Handles in the views",
    keep: "Crop box",
    cut_out: "Cut-out box",
    crop: "Crop",
    cut: "Cut a corner out",
    reset: "Reset",
    remove: "Remove",
    planes: "Clip planes",
    add: "Add a plane that faces you",
    from: (axis) => `${axis} from`,
    to: (axis) => `${axis} to`,
    plane: (n2) => `Plane ${n2} at`,
    normal: (axis) => `Normal ${axis}`,
    flip: "Flip"
  },
  colorStrip: {
    label: "Colours of the values",
    hidden: (n2) => `${n2} outside the shown range: show all points`
  },
  curvePlot: {
    below: (n2) => `${n2} below the shown range: show all points`,
    above: (n2) => `${n2} above the shown range: show all points`
  },
  functionPanel: {
    layer: "Layer",
    curve: "Opacity over the values",
    opacity: "opacity",
    log: "Logarithm",
    magnified: "Magnify low opacities",
    seen: "Shown range",
    from: "Shown from",
    to: "Shown to",
    nearer: "Nearer",
    farther: "Farther",
    all: "All values",
    points: "Fit to points",
    usual: "Fit to data",
    addOpacity: "Add opacity point",
    addColor: "Add colour",
    edit: "Edit curve",
    opacities: "Opacities ×",
    global: "Layer opacity",
    mirrorOpacity: "Mirror opacities",
    mirrorColor: "Mirror colours",
    reset: (name) => name === "" ? "Reset" : `Reset to ${name}`,
    gone: "The look as it was chosen is not known any more.",
    table: "This function is a table of value and gradient, which has no single curve to edit. Choose a preset to get one, or make another table in Python.",
    hint: "Double click adds a point. Wheel zooms while a point has the focus, and with Ctrl."
  },
  gradientEditor: {
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
  },
  opening: {
    open: "Open",
    openTitle: "Open a file, a folder or an example",
    drop: "Drop a scan here",
    dropNow: "Drop to open",
    kinds: "NIfTI, DICOM folders, NRRD, MetaImage, TIFF, OME-Zarr, HDF5, NumPy and more; segmentations, surfaces and points too.",
    limit: (bytes) => `Up to ${Math.round(bytes / 2 ** 30)} GB, read on this machine alone. Larger data open where they lie: wavesplat view FILE`,
    limitOfKernel: (bytes) => `Up to ${Math.round(bytes / 2 ** 30)} GB, sent to the kernel. What lies beside the kernel opens in Python: viewer.scene = ws.open_scene("FILE")`,
    files: "Choose files",
    folder: "Choose a folder",
    examples: "Examples",
    recent: "Recent",
    gone: "not there now",
    clear: "Clear list",
    cleared: "The list of recent files is empty",
    close: "Close",
    cancel: "Cancel",
    sending: (name) => `Sending ${name}`,
    reading: (name) => `Reading ${name}`,
    several: (name) => `${name} holds several`,
    whichOne: (option) => option === "series" ? "Series" : "Dataset",
    openIt: "Open",
    how: (name) => `How should ${name} be shown?`,
    replace: "Replace",
    replaceNote: "Close what is open; undo brings it back",
    overlay: "Overlay",
    overlayNote: "A further layer, placed by its world coordinates",
    labels: "Segmentation",
    labelsNote: (scan) => `Regions of ${scan}, each in a colour`,
    shown: (name) => `${name} is open`,
    tooLarge: (size, most) => `These files have ${(size / 2 ** 30).toFixed(1)} GB, and a page sends up to ${(most / 2 ** 30).toFixed(1)} GB`,
    tooLargeRemedy: "Open them where they lie: wavesplat view FILE.",
    nothing: "Nothing was dropped that is a file",
    stateAlone: "A saved state names its volumes, which a page may not open",
    stateRemedy: "Open it with: wavesplat view --state FILE."
  },
  labelsPanel: {
    none: "There is no segmentation. Drop its file here, open it with --labels FILE, or in Python with labels=.",
    remove: "Remove",
    removeAll: "Remove the segmentation",
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
  },
  layersPanel: {
    add: "Add a layer",
    remove: "Remove",
    removeThis: (name) => `Remove ${name}`,
    edit: "Edit the look",
    editThis: (name) => `Edit the look of ${name}`,
    name: (index) => `Name of layer ${index + 1}`,
    shown: (name) => `Show ${name}`,
    opacity: "Opacity",
    opacityOf: (name) => `Opacity of ${name}`,
    solo: "Solo",
    soloThis: (name) => `Solo: show ${name} alone, or all again`,
    look: (look) => `look: ${look || "of its own"}`
  },
  lightPad: {
    pad: "Direction of the light",
    keys: "Arrows turn the light, with Page up and down far",
    azimuth: "From right",
    elevation: "From above",
    degrees: "°",
    text: (azimuth, elevation) => `${Math.abs(Math.round(azimuth))}° from the ${azimuth < 0 ? "left" : "right"}, ${Math.abs(Math.round(elevation))}° from ${elevation < 0 ? "below" : "above"}`
  },
  lightPanel: {
    composite: "Projection",
    overOnly: "Several layers, and labels, are drawn by volume rendering alone.",
    iso: "Surface at",
    threshold: "Threshold",
    automatic: (what) => `${what}: automatic`,
    strength: "Dimming",
    clear: "Transparent below",
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
    radius: "Radius",
    reach: "Occlusion radius",
    shadow: "Shadow",
    smoothing: "Smoothing",
    smoothingOn: "Smooth surfaces",
    offset: "Gradient width",
    world: "The light stands still in the world.",
    reset: "Reset light to the look's"
  },
  ownPresetsFields: {
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
  },
  pointFields: {
    none: "Choose a point to type its numbers.",
    opacityPoint: (n2, of) => `Opacity point ${n2} of ${of}`,
    colorPoint: (n2, of) => `Colour ${n2} of ${of}`,
    value: "Value",
    opacity: "Opacity",
    color: "Colour",
    remove: "Delete",
    before: "Point before",
    after: "Next point"
  },
  presetTiles: {
    noPicture: "No picture"
  },
  presetsPanel: {
    search: "Search",
    fitting: "Presets that fit",
    own: "Your own",
    all: (n2) => `All presets (${n2} more)`,
    none: "No preset has this in its name or description.",
    auto: "By the kind of data, from its histogram.",
    allLooks: "All looks",
    chosen: (name) => `Look ${name}`,
    ownPreset: "Saved by you",
    alone: "This look is made for a layer alone: with others it is drawn as a volume, which may hide them."
  },
  timeBar: {
    title: "Time",
    of: (time, count) => `${time + 1} of ${count}`,
    before: "Time before",
    next: "Next time",
    play: "Play",
    pause: "Pause",
    rate: "Frames a second",
    perSecond: "a second",
    repeat: "Repeat"
  },
  windowDrag: {
    table: "The function of this layer is a table; it has no window"
  }
};

// src/view/look/curve_plot.tsx
var TEXT = WORDS.curvePlot;
var KEYS2 = "Arrows move, Page up and down move far, Delete removes, Insert adds, Enter goes to the number";
var MARGIN = { left: 34, right: 12, top: 12, bottom: 20 };
var DOT_PX = 6;
var REACH_PX = 13;
var ROOT = 1 / 3;
var PIECES = 16;
var WHEEL_ZOOM = 1.2;
var N_TICKS = 5;
function CurvePlot(props) {
  const { label, height, seen, whole, unit: unit2, curve: curve2, colors, histogram, isMagnified, selected } = props;
  const [svg, width] = useWidth();
  const drag = T2(null);
  const fill = P2();
  const inner = { width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
  const power = isMagnified ? ROOT : 1;
  const xOf = (value) => MARGIN.left + (value - seen[0]) / (seen[1] - seen[0]) * inner.width;
  const yOf = (alpha) => MARGIN.top + (1 - alpha ** power) * inner.height;
  const valueAt2 = (x2) => seen[0] + (x2 - MARGIN.left) / inner.width * (seen[1] - seen[0]);
  const alphaAt = (y3) => clamped(1 - (y3 - MARGIN.top) / inner.height, 0, 1) ** (1 / power);
  const inside = (event) => {
    const box2 = svg.current?.getBoundingClientRect();
    return { x: event.clientX - (box2?.left ?? 0), y: event.clientY - (box2?.top ?? 0) };
  };
  const tidy2 = (value, alpha) => [
    Math.max(props.least ?? -Infinity, rounded(value, seen[1] - seen[0])),
    Number(alpha.toPrecision(3))
  ];
  const move = (index, value, alpha) => props.onCurve(withMoved(curve2, index, tidy2(value, alpha)), index);
  const onPlotMove = (event) => {
    const begun = drag.current;
    if (begun === null) return;
    const { x: x2, y: y3 } = inside(event);
    if (begun.index !== null) {
      move(begun.index, valueAt2(x2 - begun.x), alphaAt(y3 - begun.y));
      return;
    }
    const shift = (begun.x - x2) / inner.width * (begun.seen[1] - begun.seen[0]);
    props.onSeen(within([begun.seen[0] + shift, begun.seen[1] + shift], whole));
  };
  const onPlotUp = () => {
    if (drag.current?.index != null) props.onSettle();
    drag.current = null;
  };
  const onHandleKey = (event, index) => {
    const latest = props.latest();
    const point2 = latest[index];
    if (point2 === void 0) return;
    const rise = isMagnified ? Math.max(5e-4, 0.1 * point2[1]) : 0.01;
    const key = pointKey(event.key, event.shiftKey, seen, rise);
    if (key === null || key.does === "remove" && latest.length === 1) return;
    if (key.does === "move") {
      const value = Math.max(props.least ?? -Infinity, point2[0] + key.value);
      props.onCurve(withMoved(latest, index, [value, Number((point2[1] + key.rise).toPrecision(6))]), index);
    } else if (key.does === "type") props.onType();
    else changePoints(props, key.does, index);
    event.preventDefault();
    event.stopPropagation();
  };
  const line = outline(curve2, seen, isMagnified ? PIECES : 1).map(
    ([value, alpha]) => `${px(xOf(value))},${px(yOf(alpha))}`
  );
  const hidden = outOfSight(curve2, seen);
  const marks = isMagnified ? [0, 0.01, 0.1, 0.5, 1] : [0, 0.25, 0.5, 0.75, 1];
  const marked = ticks(seen, N_TICKS).filter((value) => unit2 === "" || xOf(value) > MARGIN.left + 14);
  return /* @__PURE__ */ k(
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
        props.onSeen(zoomed(seen, event.deltaY < 0 ? WHEEL_ZOOM : 1 / WHEEL_ZOOM, valueAt2(inside(event).x), whole));
      },
      onDblClick: (event) => {
        const { x: x2, y: y3 } = inside(event);
        const added2 = withPoint(curve2, tidy2(valueAt2(x2), alphaAt(y3)));
        props.onCurve(added2.curve, added2.index);
        props.onSettle();
      },
      onPointerDown: (event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        drag.current = { index: null, x: inside(event).x, y: 0, seen };
      },
      onPointerMove: onPlotMove,
      onLostPointerCapture: onPlotUp
    },
    /* @__PURE__ */ k(Fill, { id: fill, colors, xOf }),
    /* @__PURE__ */ k("g", { "aria-hidden": "true" }, marks.map((alpha) => /* @__PURE__ */ k("g", { key: alpha }, /* @__PURE__ */ k("line", { class: "look-grid", x1: MARGIN.left, x2: width - MARGIN.right, y1: yOf(alpha), y2: yOf(alpha) }), /* @__PURE__ */ k("text", { class: "look-tick", x: MARGIN.left - 4, y: yOf(alpha) + 4, "text-anchor": "end" }, alpha))), marked.map((value) => /* @__PURE__ */ k("g", { key: value }, /* @__PURE__ */ k("line", { class: "look-grid", x1: xOf(value), x2: xOf(value), y1: MARGIN.top, y2: height - MARGIN.bottom + 3 }), /* @__PURE__ */ k("text", { class: "look-tick", x: Math.min(xOf(value), width - 20), y: height - 5, "text-anchor": "middle" }, numberText(value)))), /* @__PURE__ */ k("text", { class: "look-tick", x: MARGIN.left - 4, y: height - 5, "text-anchor": "end" }, unit2), /* @__PURE__ */ k(
      "polygon",
      {
        points: `${line.join(" ")} ${px(xOf(seen[1]))},${yOf(0)} ${px(xOf(seen[0]))},${yOf(0)}`,
        fill: colors === null ? "var(--accent)" : `url(#${fill})`,
        "fill-opacity": 0.7
      }
    ), histogram !== null && /* @__PURE__ */ k("path", { class: "look-counts", d: barsPath(histogram, xOf, inner.height, seen) }), /* @__PURE__ */ k("polyline", { class: "look-line-under", points: line.join(" ") }), /* @__PURE__ */ k("polyline", { class: "look-line", points: line.join(" ") })),
    hidden.below > 0 && /* @__PURE__ */ k(Mark, { side: "left", x: MARGIN.left, y: height / 2, text: TEXT.below(hidden.below), onClick: props.onShowPoints }),
    hidden.above > 0 && /* @__PURE__ */ k(
      Mark,
      {
        side: "right",
        x: width - MARGIN.right,
        y: height / 2,
        text: TEXT.above(hidden.above),
        onClick: props.onShowPoints
      }
    ),
    curve2.map(
      (point2, index) => point2[0] < seen[0] || point2[0] > seen[1] ? null : /* @__PURE__ */ k(
        Handle,
        {
          key: index,
          x: xOf(point2[0]),
          y: yOf(point2[1]),
          isSelected: index === selected,
          color: null,
          label: `Point ${index + 1} of ${curve2.length}`,
          value: point2[0],
          range: seen,
          text: `${props.what} ${numberText(point2[1])} at ${numberText(point2[0])}${unit2 && ` ${unit2}`}`,
          onSelect: () => props.onSelect(index),
          onKeyDown: (event) => onHandleKey(event, index),
          onKeyUp: () => props.onSettle(),
          onGrab: (event) => {
            const { x: x2, y: y3 } = inside(event);
            svg.current?.setPointerCapture(event.pointerId);
            drag.current = { index, x: x2 - xOf(point2[0]), y: y3 - yOf(point2[1]), seen };
          }
        }
      )
    ),
    props.children
  );
}
function changePoints({ latest, seen, onCurve, onSettle }, what, index) {
  const curve2 = latest();
  if (what === "remove") onCurve(without(curve2, index), Math.min(index, curve2.length - 2));
  else {
    const added2 = withPointBeside(curve2, index, seen);
    onCurve(added2.curve, added2.index);
  }
  onSettle();
}
function Handle(props) {
  const { x: x2, y: y3, isSelected, color: color2, range, value } = props;
  return /* @__PURE__ */ k(
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
      }
    },
    /* @__PURE__ */ k("title", null, props.text),
    /* @__PURE__ */ k("circle", { class: "look-reach", r: REACH_PX }),
    color2 === null ? /* @__PURE__ */ k("circle", { class: "look-dot", r: DOT_PX }) : /* @__PURE__ */ k("path", { class: "look-dot", d: "M0 -10 L7 -2 V9 H-7 V-2 Z", style: { fill: color2 } })
  );
}
function Mark(props) {
  const { side, x: x2, y: y3, text: text2, onClick } = props;
  const stop = (event) => event.stopPropagation();
  return /* @__PURE__ */ k(
    "g",
    {
      class: "look-mark",
      role: "button",
      tabindex: 0,
      "aria-label": text2,
      transform: `translate(${x2} ${y3})${side === "left" ? "" : " scale(-1 1)"}`,
      onPointerDown: stop,
      onDblClick: stop,
      onClick,
      onKeyDown: (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        event.stopPropagation();
        onClick();
      }
    },
    /* @__PURE__ */ k("title", null, text2),
    /* @__PURE__ */ k("rect", { class: "look-reach", x: -6, y: -14, width: 28, height: 28 }),
    /* @__PURE__ */ k("path", { d: "M1 0 L13 -8 V8 Z" })
  );
}
function Fill({
  id: id2,
  colors,
  xOf
}) {
  const [first, last] = [colors?.[0], colors?.at(-1)];
  if (colors === null || first === void 0 || last === void 0) return null;
  const width = last[0] - first[0] || 1;
  return /* @__PURE__ */ k("defs", null, /* @__PURE__ */ k(
    "linearGradient",
    {
      id: id2,
      gradientUnits: "userSpaceOnUse",
      x1: xOf(first[0]),
      x2: xOf(first[0] + width),
      y1: 0,
      y2: 0
    },
    colors.map((point2, index) => /* @__PURE__ */ k("stop", { key: index, offset: (point2[0] - first[0]) / width, "stop-color": hexOf(point2) }))
  ));
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
  const steps = heights2.flatMap((share2, k3) => {
    const [a3, b] = [xOf(range[0] + k3 * bin), xOf(range[0] + (k3 + 1) * bin)];
    if (b < left || a3 > right) return [];
    return [
      `L${px(Math.max(a3, left))} ${px(bottom - share2 * height)}`,
      `L${px(Math.min(b, right))} ${px(bottom - share2 * height)}`
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
var TEXT2 = WORDS.colorStrip;
var RAMP_PX = 16;
var HEIGHT_PX = 44;
function ColorStrip(props) {
  const { seen, unit: unit2, curve: curve2, selected } = props;
  const [svg, width] = useWidth();
  const drag = T2(null);
  const fill = P2();
  const inner = width - MARGIN.left - MARGIN.right;
  const xOf = (value) => MARGIN.left + (value - seen[0]) / (seen[1] - seen[0]) * inner;
  const valueAt2 = (x2) => seen[0] + (x2 - MARGIN.left) / inner * (seen[1] - seen[0]);
  const inside = (event) => event.clientX - (svg.current?.getBoundingClientRect().left ?? 0);
  const move = (index, value) => {
    const latest = props.latest();
    const point2 = latest[index];
    if (point2 !== void 0) props.onCurve(withMoved(latest, index, [value, point2[1], point2[2], point2[3]]), index);
  };
  const onUp = () => {
    if (drag.current !== null) props.onSettle();
    drag.current = null;
  };
  const onKeyDown = (event, index) => {
    const key = pointKey(event.key, event.shiftKey, seen, 0);
    if (key === null || key.does === "remove" && curve2.length === 1) return;
    if (key.does === "move") move(index, (props.latest()[index]?.[0] ?? 0) + key.value);
    else if (key.does === "type") props.onType();
    else changePoints(props, key.does, index);
    event.preventDefault();
    event.stopPropagation();
  };
  const { below, above } = outOfSight(curve2, seen);
  const only = curve2[0];
  const isPlain = curve2.length === 1 && only !== void 0;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    "svg",
    {
      ref: svg,
      class: "look-plot",
      height: HEIGHT_PX,
      role: "group",
      "aria-label": TEXT2.label,
      onDblClick: (event) => {
        const added2 = withPointOn(curve2, rounded(valueAt2(inside(event)), seen[1] - seen[0]));
        props.onCurve(added2.curve, added2.index);
        props.onSettle();
      },
      onPointerMove: (event) => {
        const begun = drag.current;
        if (begun !== null) move(begun.index, rounded(valueAt2(inside(event) - begun.x), seen[1] - seen[0]));
      },
      onLostPointerCapture: onUp
    },
    /* @__PURE__ */ k(Fill, { id: fill, colors: curve2, xOf }),
    /* @__PURE__ */ k(
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
    curve2.map(
      (point2, index) => point2[0] < seen[0] || point2[0] > seen[1] ? null : /* @__PURE__ */ k(
        Handle,
        {
          key: index,
          x: xOf(point2[0]),
          y: RAMP_PX + 13,
          isSelected: index === selected,
          color: hexOf(point2),
          label: `Colour ${index + 1} of ${curve2.length}`,
          value: point2[0],
          range: seen,
          text: `${hexOf(point2)} at ${numberText(point2[0])}${unit2 && ` ${unit2}`}`,
          onSelect: () => props.onSelect(index),
          onKeyDown: (event) => onKeyDown(event, index),
          onKeyUp: () => props.onSettle(),
          onGrab: (event) => {
            svg.current?.setPointerCapture(event.pointerId);
            drag.current = { index, x: inside(event) - xOf(point2[0]) };
          }
        }
      )
    )
  ), below + above > 0 && /* @__PURE__ */ k("button", { type: "button", class: "button", onClick: () => props.onShowPoints() }, TEXT2.hidden(below + above)));
}

// src/view/fields.tsx
function NumberBox(props) {
  const { label, value, min, max, step = "any", unit: unit2 = "", disabled = false, id: id2, decimals } = props;
  const [typed, setTyped] = d2(null);
  const done2 = () => {
    setTyped(null);
    props.onSettle();
  };
  return /* @__PURE__ */ k(
    "input",
    {
      type: "number",
      id: id2,
      "aria-label": unit2 === "" ? label : `${label}, ${unit2}`,
      value: typed ?? fieldText(value, decimals),
      min,
      max,
      step,
      disabled,
      onInput: (event) => {
        const field = event.currentTarget;
        setTyped(field.value);
        const number2 = field.valueAsNumber;
        if (Number.isFinite(number2)) props.onInput(clamped(number2, min ?? -Infinity, max ?? Infinity));
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
  return /* @__PURE__ */ k("span", { class: "look-named" }, /* @__PURE__ */ k("span", { class: "dim", "aria-hidden": "true" }, shown), /* @__PURE__ */ k(NumberBox, { ...props }), unit2 !== "" && /* @__PURE__ */ k("span", { class: "dim", "aria-hidden": "true" }, unit2));
}
function NumberField(props) {
  const {
    label,
    value,
    min,
    max,
    step = roundStep((max - min) / 500),
    unit: unit2 = "",
    disabled = false,
    isBounded = false,
    least = isBounded ? min : -Infinity,
    most = isBounded ? max : Infinity
  } = props;
  const { shown = label, decimals = step === "any" ? void 0 : decimalsOfStep(step) } = props;
  return /* @__PURE__ */ k("div", { class: "field look-slider" }, shown !== "" && /* @__PURE__ */ k("span", { "aria-hidden": "true" }, shown, unit2 !== "" && /* @__PURE__ */ k("small", null, unit2)), /* @__PURE__ */ k(
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
      onInput: (event) => props.onInput(event.currentTarget.valueAsNumber),
      onChange: () => props.onSettle()
    }
  ), /* @__PURE__ */ k(
    NumberBox,
    {
      ...props,
      ...decimals === void 0 ? {} : { decimals },
      min: least,
      max: most,
      step,
      label: `${label}, number`
    }
  ));
}
function RelativeSlider(props) {
  const { label, neutral, unit: unit2 = "", disabled = false } = props;
  const [amount, setAmount] = d2(null);
  const [typed, setTyped] = d2("");
  const done2 = () => {
    setAmount(null);
    props.onSettle();
  };
  const apply = () => {
    const number2 = Number(typed);
    setTyped("");
    if (typed.trim() === "" || !Number.isFinite(number2)) return;
    props.onAmount(number2);
    done2();
  };
  const shown = numberText(amount ?? neutral);
  return /* @__PURE__ */ k("div", { class: "field look-slider" }, /* @__PURE__ */ k("span", { "aria-hidden": "true" }, label, unit2 !== "" && /* @__PURE__ */ k("small", null, unit2)), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k(
    "input",
    {
      type: "number",
      step: "any",
      "aria-label": `${label}, number${unit2 && `, ${unit2}`}`,
      value: amount === null ? typed : fieldText(Number(amount.toPrecision(3))),
      placeholder: numberText(neutral),
      disabled,
      onInput: (event) => setTyped(event.currentTarget.value),
      onBlur: apply,
      onKeyDown: (event) => {
        if (event.key === "Enter") apply();
      }
    }
  ));
}
function Choice({ label, value, options, onChoose }) {
  return /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, label), /* @__PURE__ */ k("select", { class: "look-grow", value, onChange: (event) => onChoose(event.currentTarget.value) }, options.map(([name, text2, disabled = false]) => /* @__PURE__ */ k("option", { key: name, value: name, disabled }, text2))));
}
function Switch({ label, note, on, onToggle }) {
  return /* @__PURE__ */ k("label", { class: "row look-check" }, /* @__PURE__ */ k("input", { type: "checkbox", checked: on, onChange: (event) => onToggle(event.currentTarget.checked) }), /* @__PURE__ */ k("span", null, label), note && /* @__PURE__ */ k("span", { class: "dim" }, note));
}
function ColorField({ label, value, onColor, onSettle }) {
  const [picked, setPicked] = d2(null);
  A2(() => setPicked(null), [value]);
  return /* @__PURE__ */ k(
    "input",
    {
      type: "color",
      "aria-label": label,
      value: picked ?? value,
      onInput: (event) => {
        setPicked(event.currentTarget.value);
        onColor(event.currentTarget.value);
      },
      onChange: onSettle,
      onBlur: onSettle
    }
  );
}
function Button(props) {
  return /* @__PURE__ */ k(
    "button",
    {
      type: "button",
      class: "button",
      "aria-label": props.label,
      title: props.label,
      "aria-pressed": props.pressed,
      disabled: props.disabled ?? false,
      onClick: () => props.onClick()
    },
    props.children
  );
}

// src/view/look/gradient_editor.tsx
var TEXT3 = WORDS.gradientEditor;
var PLOT_PX = 130;
function GradientEditor({ store, ui, curves: curves2, volume: volume2, latest }) {
  const curve2 = curves2.gradient_opacity ?? [];
  const scale = strongGradient(volume2);
  const least = spanOf([[0], [scale]], curve2);
  const whole = [0, 1.1 * least[1]];
  const [zoom, setZoom] = d2(null);
  const [chosen2, setChosen] = d2(0);
  const path = ["layers", ui.layer, "look", "transfer_function", "gradient_opacity"];
  const index = Math.min(chosen2, curve2.length - 1);
  const point2 = curve2[index];
  const change = (next, at2) => {
    store.change([set(next, ...path)], "gradient opacity");
    if (at2 !== null) setChosen(at2);
  };
  const done2 = () => store.settle();
  const unit2 = [volume2.value_unit, volume2.unit].every((one) => one) ? `${volume2.value_unit}/${volume2.unit}` : "";
  if (point2 === void 0) {
    return /* @__PURE__ */ k("details", { class: "look-details" }, /* @__PURE__ */ k("summary", null, TEXT3.title), /* @__PURE__ */ k("p", { class: "dim" }, TEXT3.none), /* @__PURE__ */ k(Button, { onClick: () => store.change([set(firstGradientCurve(rounded(scale, 10 * scale)), ...path)]) }, TEXT3.add));
  }
  return /* @__PURE__ */ k("details", { class: "look-details", open: true }, /* @__PURE__ */ k("summary", null, TEXT3.title), /* @__PURE__ */ k(
    CurvePlot,
    {
      label: TEXT3.label,
      what: TEXT3.what,
      height: PLOT_PX,
      seen: within(zoom ?? whole, whole),
      whole,
      unit: unit2,
      least: 0,
      curve: curve2,
      latest,
      colors: null,
      histogram: null,
      isMagnified: false,
      selected: index,
      onSelect: setChosen,
      onCurve: change,
      onSettle: done2,
      onSeen: setZoom,
      onShowPoints: () => setZoom(around(spanOf(curve2), whole)),
      onType: () => {
      }
    }
  ), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    NamedNumber,
    {
      label: TEXT3.gradient,
      unit: unit2,
      min: 0,
      value: point2[0],
      onInput: (value) => change(withMoved(curve2, index, [value, point2[1]]), index),
      onSettle: done2
    }
  ), /* @__PURE__ */ k(
    NamedNumber,
    {
      label: TEXT3.factor,
      min: 0,
      max: 1,
      step: 0.01,
      value: point2[1],
      onInput: (factor) => change(withMoved(curve2, index, [point2[0], factor]), index),
      onSettle: done2
    }
  )), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    Button,
    {
      onClick: () => {
        const added2 = withPointBeside(curve2, index, whole);
        change(added2.curve, added2.index);
        done2();
      }
    },
    TEXT3.addPoint
  ), /* @__PURE__ */ k(
    Button,
    {
      disabled: curve2.length === 1,
      onClick: () => {
        change(without(curve2, index), Math.max(0, index - 1));
        done2();
      }
    },
    TEXT3.delete
  ), /* @__PURE__ */ k(Button, { onClick: () => store.change([{ op: "remove", path: `/${path.join("/")}` }]) }, TEXT3.remove)));
}
function strongGradient(volume2) {
  const [low, high] = volume2.robust_range;
  return 0.5 * (high - low || 1) / Math.min(...volume2.spacing);
}

// src/view/look/knobs.ts
var STILL = { reveal: 0, soften: 0, through: 0 };
var DECADES = 7;
var PIECES2 = 32;
var MAX_WIDTH = 4;
function turned(curves2, { reveal, soften, through: through2 }, usual) {
  const shift = -0.5 * reveal * Math.abs(reveal) * (usual[1] - usual[0]);
  const wide = soften === 0 ? curves2 : widened(curves2, MAX_WIDTH ** soften);
  return seenThrough(shift === 0 ? wide : shifted(wide, shift), through2);
}
function seenThrough(curves2, through2) {
  const [low, high] = spanOfFunction(curves2);
  if (through2 === 0 || low === high) return curves2;
  const between3 = Array.from({ length: PIECES2 + 1 }, (_3, k3) => low + k3 / PIECES2 * (high - low));
  const values = [...curves2.opacity.map(([value]) => value), ...between3].sort((a3, b) => a3 - b);
  const opacity = values.filter((value, k3) => value !== values[k3 - 1]).map((value) => {
    const place = clamped((value - low) / (high - low), 0, 1);
    const alpha = (at(curves2.opacity, value)[0] ?? 0) * 10 ** (-DECADES * through2 * (1 - place));
    return [value, alpha < 1e-6 ? 0 : Number(alpha.toPrecision(4))];
  });
  return { ...curves2, opacity };
}

// src/view/look/knob_fields.tsx
var TEXT4 = WORDS.knobs;
var NAMES = ["reveal", "soften", "through"];
function KnobFields({ store, ui, curves: curves2, usual }) {
  const [knobs, setKnobs] = d2(STILL);
  const [base, made] = [T2(curves2), T2(curves2)];
  const isOwn = curves2 === made.current;
  if (!isOwn) base.current = made.current = curves2;
  const now = isOwn ? knobs : STILL;
  const turn = (name, percent) => {
    const next = { ...now, [name]: percent / 100 };
    made.current = turned(base.current, next, usual);
    setKnobs(next);
    store.change([set(made.current, "layers", ui.layer, "look", "transfer_function")], `knob ${name}`);
  };
  return /* @__PURE__ */ k("div", { class: "look-knobs" }, NAMES.map((name) => /* @__PURE__ */ k(
    NumberField,
    {
      isBounded: true,
      key: name,
      label: TEXT4[name],
      unit: "%",
      min: name === "through" ? 0 : -100,
      max: 100,
      step: 1,
      decimals: 0,
      value: 100 * now[name],
      onInput: (percent) => turn(name, percent),
      onSettle: () => store.settle()
    }
  )));
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
    const found2 = JSON.parse(kept?.getItem(KEY) ?? "[]");
    return Array.isArray(found2) ? found2.filter(isPreset) : [];
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
function isPreset(found2) {
  if (typeof found2 !== "object" || found2 === null) return false;
  const { name, look, picture } = found2;
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
  even_cuts: 1,
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
function chosen(state2, layer, look, composite2) {
  const before2 = state2.layers[layer]?.look;
  const operations = [set(look, "layers", layer, "look")];
  if (state2.shading !== "look" && state2.layers.length === 1) operations.push(set("look", "shading"));
  const named = look.composite === "first-hit" ? "over" : look.composite;
  if (state2.layers.length === 1) operations.push(set(composite2 ?? named, "render", "composite"));
  const [old, now] = [before2?.background ?? DEFAULT_BACKGROUND, look.background ?? DEFAULT_BACKGROUND];
  if (layer === 0 && state2.background === old && old !== now) operations.push(set(now, "background"));
  return operations;
}
function shadingOf(state2, layer) {
  if (state2.shading !== "look") return { shading: state2.shading, path: ["shading"] };
  return { shading: state2.layers[layer]?.look.shading ?? null, path: ["layers", layer, "look", "shading"] };
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
function lookFromText(text2) {
  const found2 = JSON.parse(text2);
  if (typeof found2 !== "object" || found2 === null || !("transfer_function" in found2)) {
    throw new Error("it has no field 'transfer_function'; choose a file that was exported here or by Look.save");
  }
  const { version: _3, kind: __, ...look } = found2;
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
  const [a3, e3] = [azimuth * Math.PI / 180, elevation * Math.PI / 180];
  return [Math.sin(a3) * Math.cos(e3), Math.sin(e3), Math.cos(a3) * Math.cos(e3)];
}
function hexColor(color2, named) {
  if (color2 === null) return "#000000";
  if (typeof color2 !== "string") {
    const byte = (share2) => Math.round(255 * Math.min(1, Math.max(0, share2))).toString(16).padStart(2, "0");
    return `#${color2.slice(0, 3).map(byte).join("")}`;
  }
  const digits = /^#([0-9a-f]{3,8})$/i.exec(color2)?.[1];
  if (digits === void 0) return named(color2);
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
var TEXT5 = WORDS.pointFields;
function PointFields(props) {
  const { curves: curves2, selected, onSettle } = props;
  const index = selected?.index ?? -1;
  const [node, color2] = [curves2.opacity[index], curves2.color[index]];
  if (selected?.kind === "opacity" && node !== void 0) {
    return /* @__PURE__ */ k(Point, { ...props, title: TEXT5.opacityPoint, curve: curves2.opacity, index, onCurve: props.onOpacity }, (move) => /* @__PURE__ */ k(
      NamedNumber,
      {
        label: TEXT5.opacity,
        value: node[1],
        min: 0,
        max: 1,
        step: 0.01,
        onInput: (opacity) => move([node[0], opacity]),
        onSettle
      }
    ));
  }
  if (selected?.kind === "color" && color2 !== void 0) {
    return /* @__PURE__ */ k(Point, { ...props, title: TEXT5.colorPoint, curve: curves2.color, index, onCurve: props.onColor }, (move) => /* @__PURE__ */ k(
      ColorField,
      {
        label: TEXT5.color,
        value: hexOf(color2),
        onColor: (hex) => move([color2[0], ...rgbOf(hex)]),
        onSettle
      }
    ));
  }
  return /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT5.none);
}
function Point(props) {
  const { title, unit: unit2, selected, curve: curve2, index, onCurve, onSelect, onSettle, children } = props;
  const point2 = curve2[index];
  if (point2 === void 0) return null;
  const move = (moved) => onCurve(withMoved(curve2, index, moved), index);
  const go = (next) => {
    if (selected !== null) onSelect({ ...selected, index: next });
  };
  return /* @__PURE__ */ k("fieldset", { class: "look-point" }, /* @__PURE__ */ k("legend", null, title(index + 1, curve2.length)), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    NamedNumber,
    {
      label: TEXT5.value,
      unit: unit2,
      value: point2[0] ?? 0,
      onInput: (value) => move([value, ...point2.slice(1)]),
      onSettle
    }
  ), children(move)), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { label: TEXT5.before, disabled: index === 0, onClick: () => go(index - 1) }, "‹"), /* @__PURE__ */ k(Button, { label: TEXT5.after, disabled: index === curve2.length - 1, onClick: () => go(index + 1) }, "›"), /* @__PURE__ */ k(
    Button,
    {
      disabled: curve2.length === 1,
      onClick: () => {
        onCurve(without(curve2, index), Math.max(0, index - 1));
        onSettle();
      }
    },
    TEXT5.remove
  )));
}

// src/view/look/function_panel.tsx
var TEXT6 = WORDS.functionPanel;
var BINS = 256;
var PLOT_PX2 = 190;
var STILL_MS = 120;
var MAX_OPACITY = 10;
function FunctionPanel(props) {
  const { store, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const volume2 = welcome.volumes[ui.layer];
  if (layer === void 0 || volume2 === void 0) return null;
  const curves2 = layer.look.transfer_function;
  return /* @__PURE__ */ k("div", { class: "look-panel" }, /* @__PURE__ */ k(LayerChoice, { ...props }), isEditable(curves2) ? /* @__PURE__ */ k(Editor, { key: ui.layer, ...props, curves: curves2, look: layer.look, volume: volume2 }) : /* @__PURE__ */ k($, null, /* @__PURE__ */ k("p", null, TEXT6.table), /* @__PURE__ */ k(GlobalOpacity, { ...props })));
}
function LayerChoice({ store, ui }) {
  const { layers } = store.state;
  if (layers.length < 2) return null;
  return /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT6.layer,
      value: String(ui.layer),
      options: layers.map(({ name }, index) => [String(index), name]),
      onChoose: (value) => ui.setLayer(Number(value))
    }
  );
}
function Editor(props) {
  const { store, engine, ui, welcome, curves: curves2, look, volume: volume2 } = props;
  const [isOpen, setOpen] = d2(false);
  const reset = async () => {
    try {
      const first = await lookAsChosen(engine, welcome, ui.layer, look.name);
      if (first === null) ui.announce(TEXT6.gone);
      else store.change([set(first.transfer_function, "layers", ui.layer, "look", "transfer_function")]);
    } catch (problem) {
      ui.problem(problem);
    }
  };
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(KnobFields, { ...props, curves: curves2, usual: volume2.robust_range }), /* @__PURE__ */ k(GlobalOpacity, { ...props }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => void reset() }, TEXT6.reset(look.name))), /* @__PURE__ */ k("details", { class: "look-details", open: isOpen, onToggle: (event) => setOpen(event.currentTarget.open) }, /* @__PURE__ */ k("summary", null, TEXT6.edit), isOpen && /* @__PURE__ */ k(CurveEditor, { ...props })));
}
function CurveEditor(props) {
  const { store, ui, curves: curves2, volume: volume2 } = props;
  const span = spanOfFunction(curves2);
  const whole = wholeOf(volume2.range, span);
  const usual = wholeOf(volume2.robust_range, span);
  const [zoom, setZoom] = d2(usual);
  const [selected, setSelected] = d2(null);
  const [isLog, setLog] = d2(true);
  const [isMagnified, setMagnified] = d2(false);
  const base = T2(null);
  const value = T2(null);
  const seen = within(zoom, whole);
  const histogram = useHistogram(props, seen, isLog);
  const unit2 = volume2.value_unit;
  const path = ["layers", ui.layer, "look", "transfer_function"];
  const done2 = () => {
    base.current = null;
    store.settle();
  };
  const latest = () => {
    const now = store.state.layers[ui.layer]?.look.transfer_function;
    return now !== void 0 && isEditable(now) ? now : curves2;
  };
  const setOpacity = (curve2, index) => {
    store.change([set(curve2, ...path, "opacity")], "opacity curve");
    if (index !== null) setSelected({ kind: "opacity", index });
  };
  const setColor = (curve2, index) => {
    store.change([set(curve2, ...path, "color")], "colours");
    if (index !== null) setSelected({ kind: "color", index });
  };
  const setAll = (change, gesture) => {
    base.current ??= latest();
    store.change([set(change(base.current), ...path)], gesture);
  };
  const once = (change) => {
    store.change([set(change(latest()), ...path)]);
  };
  const showPoints = () => setZoom(around(spanOf(curves2.opacity, curves2.color), whole));
  const typeValue = () => value.current?.querySelector("input[type=number]")?.select();
  const chosenIndex = (kind2, length2) => selected?.kind === kind2 && selected.index < length2 ? selected.index : null;
  const opacityIndex = chosenIndex("opacity", curves2.opacity.length);
  const colorIndex = chosenIndex("color", curves2.color.length);
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    CurvePlot,
    {
      label: TEXT6.curve,
      what: TEXT6.opacity,
      height: PLOT_PX2,
      seen,
      whole,
      unit: unit2,
      curve: curves2.opacity,
      latest: () => latest().opacity,
      colors: curves2.color,
      histogram,
      isMagnified,
      selected: opacityIndex,
      onSelect: (index) => setSelected({ kind: "opacity", index }),
      onCurve: setOpacity,
      onSettle: done2,
      onSeen: setZoom,
      onShowPoints: showPoints,
      onType: typeValue
    }
  ), /* @__PURE__ */ k(
    ColorStrip,
    {
      seen,
      unit: unit2,
      curve: curves2.color,
      latest: () => latest().color,
      selected: colorIndex,
      onSelect: (index) => setSelected({ kind: "color", index }),
      onCurve: setColor,
      onSettle: done2,
      onType: typeValue,
      onShowPoints: showPoints
    }
  ), /* @__PURE__ */ k("div", { ref: value }, /* @__PURE__ */ k(
    PointFields,
    {
      curves: curves2,
      selected,
      unit: unit2,
      onOpacity: setOpacity,
      onColor: setColor,
      onSettle: done2,
      onSelect: setSelected
    }
  )), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    Button,
    {
      onClick: () => {
        const added2 = withPointBeside(curves2.opacity, opacityIndex ?? widestGap(curves2.opacity), seen);
        setOpacity(added2.curve, added2.index);
        done2();
      }
    },
    TEXT6.addOpacity
  ), /* @__PURE__ */ k(
    Button,
    {
      onClick: () => {
        const added2 = withPointBeside(curves2.color, colorIndex ?? widestGap(curves2.color), seen);
        setColor(added2.curve, added2.index);
        done2();
      }
    },
    TEXT6.addColor
  )), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    NamedNumber,
    {
      shown: TEXT6.seen,
      label: TEXT6.from,
      value: rounded(seen[0], seen[1] - seen[0]),
      onInput: (low) => low < seen[1] && setZoom([low, seen[1]]),
      onSettle: () => {
      }
    }
  ), /* @__PURE__ */ k(
    NamedNumber,
    {
      shown: "–",
      label: TEXT6.to,
      unit: unit2,
      value: rounded(seen[1], seen[1] - seen[0]),
      onInput: (high) => high > seen[0] && setZoom([seen[0], high]),
      onSettle: () => {
      }
    }
  ), /* @__PURE__ */ k(Button, { label: TEXT6.nearer, onClick: () => setZoom(zoomed(seen, 1.5, middle(seen), whole)) }, "+"), /* @__PURE__ */ k(Button, { label: TEXT6.farther, onClick: () => setZoom(zoomed(seen, 1 / 1.5, middle(seen), whole)) }, "−")), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => setZoom(usual) }, TEXT6.usual), /* @__PURE__ */ k(Button, { onClick: () => setZoom(whole) }, TEXT6.all), /* @__PURE__ */ k(Button, { onClick: showPoints }, TEXT6.points)), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Switch, { label: TEXT6.log, on: isLog, onToggle: setLog }), /* @__PURE__ */ k(Switch, { label: TEXT6.magnified, on: isMagnified, onToggle: setMagnified })), /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT6.hint), /* @__PURE__ */ k(
    RelativeSlider,
    {
      label: TEXT6.opacities,
      neutral: 1,
      amount: (position) => MAX_OPACITY ** position,
      position: (amount) => Math.log(amount) / Math.log(MAX_OPACITY),
      onAmount: (amount) => amount >= 0 && setAll((before2) => withOpacities(before2, amount), "opacities"),
      onSettle: done2
    }
  ), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => once((before2) => ({ ...before2, opacity: mirrored(before2.opacity) })) }, TEXT6.mirrorOpacity), /* @__PURE__ */ k(Button, { onClick: () => once((before2) => ({ ...before2, color: mirrored(before2.color) })) }, TEXT6.mirrorColor)), /* @__PURE__ */ k(GradientEditor, { ...props, latest: () => latest().gradient_opacity ?? [] }));
}
function GlobalOpacity({ store, ui }) {
  const opacity = store.state.layers[ui.layer]?.opacity ?? 1;
  return /* @__PURE__ */ k(
    NumberField,
    {
      isBounded: true,
      label: TEXT6.global,
      min: 0,
      max: 1,
      step: 0.01,
      value: opacity,
      onInput: (value) => store.change([set(value, "layers", ui.layer, "opacity")], "layer opacity"),
      onSettle: () => store.settle()
    }
  );
}
function useHistogram({ engine, store, ui }, seen, isLog) {
  const [found2, setFound] = d2(null);
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
  return found2 === null ? null : { heights: heights(found2.counts, isLog), range: found2.range };
}
function widestGap(curve2) {
  const gaps = curve2.slice(1).map((point2, k3) => (point2[0] ?? 0) - (curve2[k3]?.[0] ?? 0));
  return gaps.length === 0 ? 0 : gaps.indexOf(Math.max(...gaps));
}

// src/view/open/data_follower.ts
var namesOf = (state2) => state2.layers.map(({ volume: volume2 }) => volume2.id ?? "").join();
var DataFollower = class {
  constructor(engine, state2, take3) {
    this.engine = engine;
    this.state = state2;
    this.take = take3;
    this.known = namesOf(state2());
  }
  engine;
  state;
  take;
  known;
  isAsking = false;
  /** Asks if the state names other volumes than before. */
  check() {
    const names = namesOf(this.state());
    if (this.isAsking || names === this.known) return;
    this.isAsking = true;
    this.engine.ask("data", {}).then(
      (data) => {
        this.isAsking = false;
        this.known = names;
        this.take(data);
        this.check();
      },
      () => {
        this.isAsking = false;
      }
    );
  }
};

// src/view/open/dropped.ts
var PIECE = 1 << 19;
var MAX_ON_THEIR_WAY = 4;
function droppedIn(transfer) {
  const items = [...transfer.items].filter(({ kind: kind2 }) => kind2 === "file");
  const found2 = items.map((item) => {
    const entry = item.webkitGetAsEntry();
    const file = item.getAsFile();
    if (entry !== null) return inEntry(entry, "");
    return Promise.resolve(file === null ? [] : [{ path: file.name, file }]);
  });
  return Promise.all(found2).then((lists) => lists.flat());
}
function chosenIn(files) {
  return [...files ?? []].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
}
async function inEntry(entry, folder) {
  const path = `${folder}${entry.name}`;
  if (entry.isFile) {
    const file = await new Promise((resolve, reject) => entry.file(resolve, reject));
    return [{ path, file }];
  }
  const reader = entry.createReader();
  const found2 = [];
  for (; ; ) {
    const entries = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (entries.length === 0) return found2;
    found2.push(...(await Promise.all(entries.map((one) => inEntry(one, `${path}/`)))).flat());
  }
}
function nameOf(files) {
  const [first] = files;
  if (first === void 0) return "";
  if (files.length === 1) return first.file.name;
  const folder = first.path.split("/")[0] ?? "";
  return files.every(({ path }) => path.startsWith(`${folder}/`)) ? folder : `${first.file.name} and ${files.length - 1} more`;
}
var sizeOf = (files) => files.reduce((sum, { file }) => sum + file.size, 0);
async function send(engine, files, progress, signal) {
  const total = sizeOf(files);
  const { upload } = await engine.ask("upload_begin", { files: files.length, bytes: total });
  const waiting = /* @__PURE__ */ new Set();
  try {
    for (const { path, file } of files) {
      for (let offset = 0; offset === 0 || offset < file.size; offset += PIECE) {
        const piece = new Uint8Array(await file.slice(offset, offset + PIECE).arrayBuffer());
        signal.throwIfAborted();
        const answer = engine.ask("upload", { upload, path, offset }, void 0, void 0, piece);
        const told = answer.then(({ received }) => progress(total === 0 ? 1 : received / total)).finally(() => waiting.delete(told));
        told.catch(() => void 0);
        waiting.add(told);
        if (waiting.size >= MAX_ON_THEIR_WAY) await Promise.race(waiting);
      }
    }
    await Promise.all(waiting);
    signal.throwIfAborted();
  } catch (problem) {
    engine.ask("upload_discard", { upload }).catch(() => void 0);
    throw problem;
  }
  return upload;
}

// src/view/open/page_opener.ts
var TEXT7 = WORDS.opening;
var PageOpener = class {
  constructor(page) {
    this.page = page;
  }
  page;
  step = { kind: "idle" };
  /** Whether the dialog that offers files is shown, and whether files are being dragged over the page. */
  isShown = false;
  isOver = false;
  /** Examples and recent files; null until it is known. */
  offered = null;
  /** The last problem, for the start page. */
  failure = null;
  abort = null;
  /** Listens to drops on an element; returns what ends that. */
  listen(element) {
    const hasFiles = (event) => event.dataTransfer?.types.includes("Files") ?? false;
    const over = (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      this.setOver(true);
    };
    const leave = (event) => {
      if (event.relatedTarget === null || !element.contains(event.relatedTarget)) this.setOver(false);
    };
    const drop = (event) => {
      if (!hasFiles(event) || event.dataTransfer === null) return;
      event.preventDefault();
      this.setOver(false);
      const found2 = droppedIn(event.dataTransfer);
      void found2.then((files) => this.files(files), (problem) => this.fail(problem));
    };
    element.addEventListener("dragover", over);
    element.addEventListener("dragleave", leave);
    element.addEventListener("drop", drop);
    return () => {
      element.removeEventListener("dragover", over);
      element.removeEventListener("dragleave", leave);
      element.removeEventListener("drop", drop);
    };
  }
  /** Shows or hides the dialog that offers files. */
  show(on) {
    this.isShown = on;
    this.failure = null;
    this.page.changed();
    if (on) this.ask("offered");
  }
  clearRecent() {
    this.ask("clear_recent");
    this.page.announce(TEXT7.cleared);
  }
  setOffered(offered) {
    this.offered = offered;
    this.page.changed();
  }
  /** Opens files that were dropped or chosen. */
  async files(files) {
    const [first] = files;
    if (this.step.kind === "sending" || this.step.kind === "reading") return;
    if (first === void 0) return this.fail({ code: "open", message: TEXT7.nothing });
    if (files.length === 1 && first.file.name.toLowerCase().endsWith(".json")) return this.stateFile(first.file);
    const [size, most] = [sizeOf(files), this.offered?.max_bytes ?? Infinity];
    if (size > most) return this.fail({ code: "open", message: TEXT7.tooLarge(size, most), remedy: TEXT7.tooLargeRemedy });
    const name = nameOf(files);
    const abort = this.begin({ kind: "sending", name, part: 0 });
    try {
      const told = (part) => {
        if (!abort.signal.aborted) this.go({ kind: "sending", name, part });
      };
      const upload = await send(this.page.engine, files, told, abort.signal);
      await this.read({ upload }, name, abort.signal);
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }
  /** Opens an example, or a file of the list. */
  async source(source, name) {
    const abort = this.begin({ kind: "reading", name });
    try {
      await this.read(source, name, abort.signal);
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }
  /** Takes one of several series or datasets. */
  async pick(value) {
    if (this.step.kind !== "several") return;
    const { source, name, option } = this.step;
    const abort = this.begin({ kind: "reading", name });
    try {
      await this.read(source, name, abort.signal, { option, value });
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }
  /** Shows what was read. */
  async choose(how) {
    if (this.step.kind !== "choosing") return;
    const { opened, name } = this.step;
    const abort = this.begin({ kind: "reading", name });
    try {
      await this.place(opened, how, name, abort.signal);
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }
  /** Gives up what is under way; what was sent is removed. */
  cancel() {
    this.abort?.abort();
    const { step } = this;
    if ((step.kind === "several" || step.kind === "choosing") && "upload" in step.source) {
      const { upload } = step.source;
      this.page.engine.ask("upload_discard", { upload }).catch(() => void 0);
    }
    this.go({ kind: "idle" });
  }
  async read(source, name, signal, choice) {
    this.go({ kind: "reading", name });
    const told = await this.page.engine.ask("open", { ...source, ...choice === void 0 ? {} : { choice } });
    if (signal.aborted) {
      if ("upload" in source) this.page.engine.ask("upload_discard", { upload: source.upload }).catch(() => void 0);
      return;
    }
    if (told.several !== void 0) {
      this.isShown = false;
      return this.go({ kind: "several", name, source, ...told.several });
    }
    if (told.shown === true || told.opened === void 0) return this.done(name);
    const { found: found2 = [], notes = [], opened } = told;
    if (found2.every(({ kind: kind2 }) => kind2 === "shape")) return this.place(opened, "overlay", name, signal);
    this.isShown = false;
    this.go({ kind: "choosing", name, source, found: found2, notes, opened });
  }
  async place(opened, how, name, signal) {
    const aspect = this.page.aspect();
    const { operations } = await this.page.engine.ask("show", { opened, how, ...aspect === null ? {} : { aspect } });
    if (signal.aborted) return;
    this.page.change(operations);
    this.done(name);
  }
  stateFile(file) {
    if (this.page.hasData()) this.page.openState(file);
    else this.fail({ code: "open", message: TEXT7.stateAlone, remedy: TEXT7.stateRemedy });
  }
  done(name) {
    this.isShown = false;
    this.go({ kind: "idle" });
    this.page.announce(TEXT7.shown(name));
  }
  begin(step) {
    this.abort?.abort();
    this.abort = new AbortController();
    this.failure = null;
    this.go(step);
    return this.abort;
  }
  fail(problem) {
    const found2 = problem;
    const told = { ...found2, code: "open", message: String(found2.message ?? problem) };
    this.failure = told;
    this.go({ kind: "idle" });
    if (this.page.hasData()) {
      this.isShown = false;
      this.page.problem(told);
    }
  }
  go(step) {
    this.step = step;
    this.page.changed();
  }
  setOver(on) {
    if (on === this.isOver) return;
    this.isOver = on;
    this.page.changed();
  }
  ask(question) {
    this.page.engine.ask(question, {}).then((offered) => this.setOffered(offered), () => void 0);
  }
};

// src/view/open/remove.ts
function withoutLayer(state2, index) {
  const operations = [{ op: "remove", path: `/layers/${index}` }];
  if (index > 0) return operations;
  const inWorld = state2.clip.filter((clip2) => {
    const box2 = "keep" in clip2 ? clip2.keep : "cut_out" in clip2 ? clip2.cut_out : null;
    return box2?.space !== "index";
  });
  return [
    ...state2.labels === null ? [] : [set(null, "labels")],
    ...inWorld.length === state2.clip.length ? [] : [set(inWorld, "clip")],
    ...operations
  ];
}
var withoutShape = (index) => [{ op: "remove", path: `/geometry/${index}` }];
var withoutLabels = () => [set(null, "labels")];

// src/view/open/offer.tsx
var TEXT8 = WORDS.opening;
function Offer({ opener, engine, host }) {
  const { offered } = opener;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("div", { class: "open-drop", "data-over": opener.isOver }, /* @__PURE__ */ k("svg", { viewBox: "0 0 48 48", "aria-hidden": "true" }, /* @__PURE__ */ k("path", { d: "M24 6v24M14 20l10 10 10-10M8 34v8h32v-8" })), /* @__PURE__ */ k("p", { class: "open-big" }, TEXT8.drop), /* @__PURE__ */ k("div", { class: "row open-middle" }, /* @__PURE__ */ k(FileField, { opener, label: TEXT8.files }), /* @__PURE__ */ k(FileField, { opener, label: TEXT8.folder, folder: true })), /* @__PURE__ */ k("p", { class: "dim" }, TEXT8.kinds), offered !== null && /* @__PURE__ */ k("p", { class: "dim" }, host === "page" ? TEXT8.limit(offered.max_bytes) : TEXT8.limitOfKernel(offered.max_bytes))), offered !== null && /* @__PURE__ */ k("section", { "aria-labelledby": "open-examples" }, /* @__PURE__ */ k("h2", { id: "open-examples" }, TEXT8.examples), /* @__PURE__ */ k("ul", { class: "open-examples" }, offered.examples.map(({ name, title }) => /* @__PURE__ */ k("li", { key: name }, /* @__PURE__ */ k("button", { class: "open-tile", onClick: () => void opener.source({ example: name }, title) }, /* @__PURE__ */ k(ExamplePicture, { engine, name }), /* @__PURE__ */ k("span", null, title)))))), offered?.recent && offered.recent.length > 0 && /* @__PURE__ */ k(RecentFiles, { opener, recent: offered.recent }));
}
function RecentFiles({ opener, recent }) {
  return /* @__PURE__ */ k("section", { "aria-labelledby": "open-recent" }, /* @__PURE__ */ k("div", { class: "row open-apart" }, /* @__PURE__ */ k("h2", { id: "open-recent" }, TEXT8.recent), /* @__PURE__ */ k("button", { class: "button", onClick: () => opener.clearRecent() }, TEXT8.clear)), /* @__PURE__ */ k("ul", { class: "open-recent" }, recent.map(({ name, folder, is_there }, index) => /* @__PURE__ */ k("li", { key: `${folder}/${name}` }, /* @__PURE__ */ k("button", { class: "open-file", disabled: !is_there, onClick: () => void opener.source({ recent: index, name }, name) }, /* @__PURE__ */ k("span", null, name), /* @__PURE__ */ k("span", { class: "dim" }, is_there ? folder : `${folder} (${TEXT8.gone})`))))));
}
function FileField({ opener, label, folder = false }) {
  return /* @__PURE__ */ k("label", { class: "button open-field" }, label, /* @__PURE__ */ k(
    "input",
    {
      class: "hidden",
      type: "file",
      multiple: true,
      ...folder ? { webkitdirectory: true } : {},
      onChange: (event) => {
        const files = chosenIn(event.currentTarget.files);
        event.currentTarget.value = "";
        if (files.length > 0) void opener.files(files);
      }
    }
  ));
}
function ExamplePicture({ engine, name }) {
  const [url, setUrl] = d2(null);
  A2(() => {
    let made = null;
    let isGone = false;
    engine.ask("example_picture", { name }).then(
      ({ bytes }) => {
        if (isGone) return;
        made = URL.createObjectURL(new Blob([bytes], { type: "image/jpeg" }));
        setUrl(made);
      },
      () => void 0
    );
    return () => {
      isGone = true;
      if (made !== null) URL.revokeObjectURL(made);
    };
  }, [engine, name]);
  return url === null ? /* @__PURE__ */ k("span", { class: "open-picture" }) : /* @__PURE__ */ k("img", { class: "open-picture", src: url, alt: "" });
}

// src/view/open/steps.tsx
var TEXT9 = WORDS.opening;
function Openings(props) {
  const { ui, store } = props;
  const { opener } = ui;
  return /* @__PURE__ */ k($, null, opener.isOver && !opener.isShown && /* @__PURE__ */ k("div", { class: "open-over", "aria-hidden": "true" }, /* @__PURE__ */ k("p", null, TEXT9.dropNow)), opener.isShown && /* @__PURE__ */ k(Dialog, { title: TEXT9.openTitle, onClose: () => opener.show(false), wide: true }, /* @__PURE__ */ k(Offer, { opener, engine: props.engine, host: ui.host }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => opener.show(false) }, TEXT9.close))), /* @__PURE__ */ k(Progress, { opener }), /* @__PURE__ */ k(SeveralDialog, { opener }), /* @__PURE__ */ k(HowDialog, { opener, scan: store.state.layers[0]?.name ?? "" }));
}
function Progress({ opener }) {
  const { step } = opener;
  if (step.kind !== "sending" && step.kind !== "reading") return null;
  const text2 = step.kind === "sending" ? TEXT9.sending(step.name) : TEXT9.reading(step.name);
  return /* @__PURE__ */ k("div", { class: "open-progress", role: "status" }, /* @__PURE__ */ k("span", null, text2), step.kind === "sending" ? /* @__PURE__ */ k("progress", { "aria-label": text2, max: 1, value: step.part }) : /* @__PURE__ */ k("progress", { "aria-label": text2 }), /* @__PURE__ */ k("button", { class: "button", onClick: () => opener.cancel() }, TEXT9.cancel));
}
function SeveralDialog({ opener }) {
  const { step } = opener;
  const [chosen2, setChosen] = d2(0);
  if (step.kind !== "several") return null;
  const { names, described } = step;
  return /* @__PURE__ */ k(Dialog, { title: TEXT9.several(step.name), onClose: () => opener.cancel() }, /* @__PURE__ */ k("fieldset", { class: "open-choices" }, /* @__PURE__ */ k("legend", null, TEXT9.whichOne(step.option)), names.map((name, index) => /* @__PURE__ */ k("label", { key: name, class: "row" }, /* @__PURE__ */ k("input", { type: "radio", name: "open-several", checked: index === chosen2, onChange: () => setChosen(index) }), /* @__PURE__ */ k("span", null, described[index] ?? String(name))))), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      "data-first": true,
      onClick: () => {
        const name = names[chosen2] ?? names[0];
        if (name !== void 0) void opener.pick(name);
      }
    },
    TEXT9.openIt
  ), /* @__PURE__ */ k("button", { class: "button", onClick: () => opener.cancel() }, TEXT9.cancel)));
}
function HowDialog({ opener, scan }) {
  const { step } = opener;
  if (step.kind !== "choosing") return null;
  const hasLabels = step.found.some(({ kind: kind2 }) => kind2 === "labels");
  const choices = [
    ...hasLabels ? [["labels", TEXT9.labels, TEXT9.labelsNote(scan)]] : [],
    ["overlay", TEXT9.overlay, TEXT9.overlayNote],
    ["replace", TEXT9.replace, TEXT9.replaceNote]
  ];
  return /* @__PURE__ */ k(Dialog, { title: TEXT9.how(step.name), onClose: () => opener.cancel() }, /* @__PURE__ */ k("div", { class: "open-hows" }, choices.map(([how, name, note], index) => /* @__PURE__ */ k("button", { key: how, class: "open-how", "data-first": index === 0, onClick: () => void opener.choose(how) }, /* @__PURE__ */ k("strong", null, name), /* @__PURE__ */ k("span", { class: "dim" }, note)))), step.notes.map((note) => /* @__PURE__ */ k("p", { key: note, class: "dim", role: "note" }, note)), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => opener.cancel() }, TEXT9.cancel)));
}
function Dialog(props) {
  const dialog = T2(null);
  A2(() => {
    dialog.current?.showModal();
    dialog.current?.querySelector("[data-first=true], [data-first='']")?.focus();
  }, []);
  return /* @__PURE__ */ k(
    "dialog",
    {
      ref: dialog,
      class: props.wide === true ? "open-dialog open-wide" : "open-dialog",
      "aria-label": props.title,
      onCancel: (event) => {
        event.preventDefault();
        props.onClose();
      },
      onKeyDown: (event) => event.stopPropagation()
    },
    /* @__PURE__ */ k("h2", null, props.title),
    props.children
  );
}

// src/view/open/start_page.tsx
function StartPage({ opener, engine, host }) {
  const { failure } = opener;
  return /* @__PURE__ */ k("main", { class: "open-start" }, /* @__PURE__ */ k("div", { class: "open-column" }, /* @__PURE__ */ k("h1", { class: "open-title" }, "Wavesplat"), failure !== null && /* @__PURE__ */ k("div", { class: "open-failure", role: "alert" }, /* @__PURE__ */ k("strong", null, failure.message), failure.remedy !== void 0 && /* @__PURE__ */ k("span", { class: "dim" }, failure.remedy)), /* @__PURE__ */ k(Offer, { opener, engine, host })), /* @__PURE__ */ k(Progress, { opener }), /* @__PURE__ */ k(SeveralDialog, { opener }));
}

// src/view/open/open.css
var open_default = '.open-start { grid-area: 1 / 1 / -1 / -1; overflow: auto; display: grid; justify-items: center; padding: 32px 16px }\n.open-column { width: min(720px, 100%); display: grid; gap: 24px; align-content: start }\n.wavesplat .open-title { margin: 0; font-size: 22px; font-weight: 600; letter-spacing: .01em }\n.open-column h2, .open-dialog h2 { font-size: 14px }\n.open-drop { display: grid; justify-items: center; gap: 10px; padding: 28px 20px; text-align: center; border: 2px dashed var(--line); border-radius: 12px; background: var(--panel) }\n.open-drop[data-over="true"] { border-color: var(--accent); background: var(--raised) }\n.open-drop svg { width: 44px; height: 44px; fill: none; stroke: var(--accent); stroke-width: 2.5; stroke-linecap: round; stroke-linejoin: round }\n.open-drop p { max-width: 60ch; font-size: 13px }\n.wavesplat .open-drop .open-big { font-size: 18px; font-weight: 600 }\n.open-middle { justify-content: center }\n.open-apart { justify-content: space-between }\n.open-field { display: inline-grid; place-items: center; position: relative }\n.open-field:focus-within { outline: 2px solid var(--focus); outline-offset: 1px }\n.wavesplat .open-examples, .wavesplat .open-recent { list-style: none; padding: 0; margin: 8px 0 0; display: grid; gap: 12px }\n.wavesplat .open-examples { grid-template-columns: repeat(3, minmax(0, 1fr)) }\n.wavesplat .open-recent { gap: 2px }\n.open-tile { display: grid; gap: 6px; width: 100%; padding: 0 0 8px; border: 1px solid var(--line); border-radius: 8px; background: var(--panel); overflow: hidden; cursor: pointer; text-align: center; font-size: 13px }\n.open-tile:hover, .open-how:hover { border-color: var(--accent) }\n.open-picture { display: block; width: 100%; aspect-ratio: 4 / 3; background: #000; object-fit: cover }\n.open-file { display: grid; grid-template-columns: minmax(0, auto) minmax(0, 1fr); gap: 12px; width: 100%; min-height: 30px; padding: 4px 8px; border: 0; border-radius: 4px; background: none; text-align: left; cursor: pointer }\n.open-file:hover:enabled { background: var(--raised) }\n.open-file:disabled { opacity: .6; cursor: default }\n.open-file span { overflow: hidden; text-overflow: ellipsis; white-space: nowrap }\n.open-failure { display: grid; gap: 4px; padding: 10px 14px; border: 1px solid var(--danger); border-radius: var(--radius); background: var(--panel); overflow-wrap: anywhere }\n.open-progress { position: absolute; left: 50%; bottom: 48px; transform: translateX(-50%); z-index: 6; display: flex; flex-wrap: wrap; align-items: center; gap: 6px 12px; max-width: 92%; padding: 8px 14px; border: 1px solid var(--line); border-radius: 8px; background: var(--panel); box-shadow: 0 4px 20px #0006 }\n.open-progress progress { width: 180px; accent-color: var(--accent) }\n.open-progress span { overflow-wrap: anywhere }\n.open-over { position: absolute; inset: 0; z-index: 6; display: grid; place-content: center; border: 3px dashed var(--accent); background: #000a; color: #fff; pointer-events: none }\n.wavesplat .open-over p { font-size: 20px; font-weight: 600 }\n.wavesplat .open-dialog[open] { display: grid; gap: 14px; width: min(440px, 94vw) }\n.wavesplat .open-dialog.open-wide[open] { width: min(720px, 94vw) }\n.open-hows { display: grid; gap: 8px }\n.open-how { display: grid; gap: 2px; padding: 10px 14px; text-align: left; border: 1px solid var(--line); border-radius: 8px; background: var(--raised); cursor: pointer }\n.open-choices { max-height: 40vh; overflow: auto }\n@container (max-width: 480px) {\n  .open-start { padding: 16px 12px }\n  .open-examples { gap: 6px }\n}\n';

// src/view/look/layers.ts
var LABEL_OPACITY = 0.8;
function isSolo(layers, index) {
  return layers.every((layer, k3) => layer.visible === (k3 === index));
}
function soloLayer(layers, index) {
  const all = isSolo(layers, index);
  return layers.map((_3, k3) => set(all || k3 === index, "layers", k3, "visible"));
}
function labelRows(labels, filter = "") {
  const wanted = filter.trim().toLowerCase();
  return Object.entries(labels).sort(([a3], [b]) => Number(a3) - Number(b)).map(([number2, look]) => {
    const opacity = look.opacity ?? LABEL_OPACITY;
    return {
      number: number2,
      look,
      name: look.name || `Label ${number2}`,
      opacity,
      isShown: opacity > 0 || (look.tint ?? 0) > 0
    };
  }).filter(({ number: number2, name }) => wanted === "" || number2 === wanted || name.toLowerCase().includes(wanted));
}
var hiddenOfStores = /* @__PURE__ */ new WeakMap();
function hiddenOf(store) {
  const known2 = hiddenOfStores.get(store) ?? /* @__PURE__ */ new Map();
  hiddenOfStores.set(store, known2);
  return known2;
}
var NOTHING = { opacity: 0, tint: 0, scan: 1 };
var USUAL = { opacity: LABEL_OPACITY, tint: 0, scan: 0 };
function shownLabels(labels, isShown, hidden) {
  return labelRows(labels).flatMap(({ number: number2, look, opacity, isShown: before2 }) => {
    if (before2 === isShown(number2)) return [];
    const now = { opacity, tint: look.tint ?? 0, scan: look.scan ?? (opacity > 0 ? 0 : 1) };
    const next = before2 ? NOTHING : hidden.get(number2) ?? USUAL;
    if (before2) hidden.set(number2, now);
    const fields2 = ["opacity", "tint", "scan"];
    return fields2.flatMap(
      (field) => now[field] === next[field] ? [] : [set(next[field], "labels", "labels", number2, field)]
    );
  });
}
function isSoloLabel(rows, number2) {
  return rows.every((row) => row.isShown === (row.number === number2));
}

// src/view/look/labels_panel.tsx
var TEXT10 = WORDS.labelsPanel;
var MAX_ROWS = 150;
var FILTERED_FROM = 9;
function LabelsPanel({ store }) {
  const [filter, setFilter] = d2("");
  const labels = store.state.labels;
  if (labels === null) return /* @__PURE__ */ k("p", { class: "dim" }, TEXT10.none);
  const all = labelRows(labels.labels);
  const rows = labelRows(labels.labels, filter);
  const show = (isShown) => store.change(shownLabels(store.state.labels?.labels ?? {}, isShown, hiddenOf(store)));
  const inRows = new Set(rows.map(({ number: number2 }) => number2));
  const isOnShown = new Map(all.map(({ number: number2, isShown }) => [number2, isShown]));
  const others = (number2) => isOnShown.get(number2) ?? false;
  return /* @__PURE__ */ k("div", { class: "look-panel" }, all.length >= FILTERED_FROM && /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, TEXT10.filter), /* @__PURE__ */ k(
    "input",
    {
      type: "search",
      class: "look-grow",
      value: filter,
      onInput: (event) => setFilter(event.currentTarget.value)
    }
  )), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => show((number2) => inRows.has(number2) || others(number2)) }, TEXT10.showAll), /* @__PURE__ */ k(Button, { onClick: () => show((number2) => !inRows.has(number2) && others(number2)) }, TEXT10.hideAll), /* @__PURE__ */ k(Button, { label: TEXT10.removeAll, onClick: () => store.change(withoutLabels()) }, TEXT10.remove), /* @__PURE__ */ k("span", { class: "dim" }, TEXT10.count(all.filter(({ isShown }) => isShown).length, all.length))), rows.length === 0 && /* @__PURE__ */ k("p", { class: "dim" }, TEXT10.empty), /* @__PURE__ */ k("ul", { class: "look-list", "aria-label": "Labels" }, rows.slice(0, MAX_ROWS).map(({ number: number2, name, look, opacity, isShown }) => /* @__PURE__ */ k("li", { key: number2, class: "look-label" }, /* @__PURE__ */ k(
    "input",
    {
      type: "checkbox",
      "aria-label": TEXT10.shown(name),
      checked: isShown,
      onChange: (event) => {
        const on = event.currentTarget.checked;
        show((other) => other === number2 ? on : others(other));
      }
    }
  ), /* @__PURE__ */ k(
    ColorField,
    {
      label: TEXT10.color(name),
      value: hexColor(look.color, namedColor),
      onColor: (hex) => store.change([set(hex, "labels", "labels", number2, "color")], `colour of label ${number2}`),
      onSettle: () => store.settle()
    }
  ), /* @__PURE__ */ k("span", { class: "look-grow look-name", title: `${name} (${number2})` }, name), /* @__PURE__ */ k(
    Button,
    {
      label: TEXT10.soloThis(name),
      pressed: all.length > 1 && isSoloLabel(all, number2),
      onClick: () => show((other) => isSoloLabel(all, number2) || other === number2)
    },
    TEXT10.solo
  ), /* @__PURE__ */ k(
    NumberField,
    {
      isBounded: true,
      label: TEXT10.opacity(name),
      shown: "",
      min: 0,
      max: 1,
      step: 0.01,
      value: opacity,
      onInput: (value) => store.change([set(value, "labels", "labels", number2, "opacity")], `opacity of label ${number2}`),
      onSettle: () => store.settle()
    }
  )))), rows.length > MAX_ROWS && /* @__PURE__ */ k("p", { class: "dim" }, TEXT10.more(rows.length - MAX_ROWS)), /* @__PURE__ */ k(
    Switch,
    {
      label: TEXT10.smooth,
      on: labels.smooth,
      onToggle: (on) => store.change([set(on, "labels", "smooth")])
    }
  ));
}

// src/view/look/ramp.tsx
function Ramp({ layer }) {
  const curves2 = layer.look.transfer_function;
  if (!isEditable(curves2)) return /* @__PURE__ */ k("span", { class: "chip" });
  const [low, high] = spanOf(curves2.color);
  const stops = curves2.color.map((point2) => `${hexOf(point2)} ${100 * (point2[0] - low) / (high - low || 1)}%`);
  const first = curves2.color[0];
  const background = stops.length > 1 ? `linear-gradient(90deg, ${stops.join(", ")})` : first && hexOf(first);
  return /* @__PURE__ */ k("span", { class: "chip look-chip", style: { background } });
}

// src/view/look/layers_panel.tsx
var TEXT11 = WORDS.layersPanel;
function LayersPanel({ store, ui }) {
  const { layers, geometry } = store.state;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("ul", { class: "look-list", "aria-label": "Layers" }, layers.map((layer, index) => /* @__PURE__ */ k("li", { key: index, class: "look-layer", "data-chosen": index === ui.layer && layers.length > 1 }, /* @__PURE__ */ k("div", { class: "row look-nowrap" }, /* @__PURE__ */ k(
    "input",
    {
      type: "checkbox",
      "aria-label": TEXT11.shown(layer.name),
      title: TEXT11.shown(layer.name),
      checked: layer.visible,
      onChange: (event) => store.change([set(event.currentTarget.checked, "layers", index, "visible")])
    }
  ), /* @__PURE__ */ k(Ramp, { layer }), /* @__PURE__ */ k(
    "input",
    {
      type: "text",
      class: "look-grow",
      "aria-label": TEXT11.name(index),
      value: layer.name,
      maxLength: 200,
      onChange: (event) => {
        const name = event.currentTarget.value.trim();
        if (name === "") event.currentTarget.value = layer.name;
        else store.change([set(name, "layers", index, "name")]);
      }
    }
  ), layers.length > 1 && /* @__PURE__ */ k(
    Button,
    {
      label: TEXT11.soloThis(layer.name),
      pressed: isSolo(layers, index),
      onClick: () => store.change(soloLayer(layers, index))
    },
    TEXT11.solo
  )), /* @__PURE__ */ k(
    NumberField,
    {
      isBounded: true,
      label: layers.length > 1 ? TEXT11.opacityOf(layer.name) : TEXT11.opacity,
      shown: TEXT11.opacity,
      min: 0,
      max: 1,
      step: 0.01,
      value: layer.opacity,
      onInput: (value) => store.change([set(value, "layers", index, "opacity")], `opacity of layer ${index}`),
      onSettle: () => store.settle()
    }
  ), layers.length > 1 && /* @__PURE__ */ k("div", { class: "row open-apart" }, /* @__PURE__ */ k("label", { class: "row look-check" }, /* @__PURE__ */ k(
    "input",
    {
      type: "radio",
      name: "look-layer",
      "aria-label": TEXT11.editThis(layer.name),
      checked: index === ui.layer,
      onChange: () => ui.setLayer(index)
    }
  ), /* @__PURE__ */ k("span", null, TEXT11.edit), /* @__PURE__ */ k("span", { class: "dim" }, TEXT11.look(layer.look.name))), /* @__PURE__ */ k(Button, { label: TEXT11.removeThis(layer.name), onClick: () => store.change(withoutLayer(store.state, index)) }, TEXT11.remove))))), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => ui.opener.show(true) }, TEXT11.add)), geometry.length > 0 && /* @__PURE__ */ k("ul", { class: "look-list", "aria-label": "Geometry" }, geometry.map(({ kind: kind2, name, count, visible }, index) => /* @__PURE__ */ k("li", { key: index, class: "row open-apart" }, /* @__PURE__ */ k(
    Switch,
    {
      label: name,
      note: `${kind2} · ${count}`,
      on: visible,
      onToggle: (on) => store.change([set(on, "geometry", index, "visible")])
    }
  ), /* @__PURE__ */ k(Button, { label: TEXT11.removeThis(name), onClick: () => store.change(withoutShape(index)) }, TEXT11.remove)))));
}

// src/view/look/composites.ts
var KERNEL_NAMES = {
  linear: "Linear",
  "catmull-rom": "Catmull-Rom (sharp)",
  bspline2: "Quadratic B-spline (smooth)",
  bspline3: "Cubic B-spline (smoother)",
  gaussian: "Gaussian"
};
var DIMMING = 0.6;
var SHADED = ["over", "first-hit"];
function nameOf2(composite2) {
  return typeof composite2 === "string" ? composite2 : Object.keys(composite2)[0] ?? "over";
}
function numberOf(composite2, field) {
  return typeof composite2 === "string" ? null : composite2[nameOf2(composite2)]?.[field] ?? null;
}
function withNumber(composite2, field, value) {
  const name = nameOf2(composite2);
  const before2 = typeof composite2 === "string" ? {} : composite2[name] ?? {};
  return { [name]: { ...before2, [field]: value } };
}
function compositeNamed(name, isoValue) {
  return name === "first-hit" ? { "first-hit": { iso_value: isoValue } } : name;
}

// src/view/look/light_pad.tsx
var TEXT12 = WORDS.lightPad;
var SIZE_PX = 132;
var RADIUS_PX = 60;
function LightPad({ direction, latest, onDirection, onSettle }) {
  const isDragging = T2(false);
  const shade = P2();
  const [azimuth, elevation] = anglesOf(direction);
  const length2 = Math.hypot(...direction) || 1;
  const spot = { x: direction[0] / length2 * RADIUS_PX, y: -direction[1] / length2 * RADIUS_PX };
  const set2 = (direction2) => onDirection(direction2.map((part) => Number(part.toFixed(4))));
  const turn = (by, up) => {
    const [a3, e3] = anglesOf(latest());
    set2(directionOf([wrapped(a3 + by), Math.max(-90, Math.min(90, e3 + up))]));
  };
  const point2 = (event) => {
    const box2 = event.currentTarget.getBoundingClientRect();
    const x2 = (event.clientX - box2.left - SIZE_PX / 2) / RADIUS_PX;
    const y3 = -(event.clientY - box2.top - SIZE_PX / 2) / RADIUS_PX;
    const share2 = Math.max(1, Math.hypot(x2, y3));
    const [a3, b] = [x2 / share2, y3 / share2];
    const front = Math.sqrt(Math.max(0, 1 - a3 * a3 - b * b));
    set2([a3, b, front]);
  };
  const stop = () => {
    if (isDragging.current) onSettle();
    isDragging.current = false;
  };
  return /* @__PURE__ */ k("div", { class: "row look-nowrap" }, /* @__PURE__ */ k(
    "svg",
    {
      class: "look-pad",
      width: SIZE_PX,
      height: SIZE_PX,
      viewBox: `${-SIZE_PX / 2} ${-SIZE_PX / 2} ${SIZE_PX} ${SIZE_PX}`,
      role: "slider",
      tabindex: 0,
      "aria-label": TEXT12.pad,
      "aria-valuemin": -180,
      "aria-valuemax": 180,
      "aria-valuenow": Math.round(azimuth),
      "aria-valuetext": TEXT12.text(azimuth, elevation),
      "aria-description": TEXT12.keys,
      onPointerDown: (event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        isDragging.current = true;
        point2(event);
      },
      onPointerMove: (event) => {
        if (isDragging.current) point2(event);
      },
      onLostPointerCapture: stop,
      onKeyUp: onSettle,
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
      }
    },
    /* @__PURE__ */ k("defs", null, /* @__PURE__ */ k("radialGradient", { id: shade, cx: spot.x, cy: spot.y, r: 1.5 * RADIUS_PX, gradientUnits: "userSpaceOnUse" }, /* @__PURE__ */ k("stop", { offset: "0", class: direction[2] < 0 ? "look-shade-behind" : "look-shade-lit" }), /* @__PURE__ */ k("stop", { offset: "0.55", class: "look-shade-half" }), /* @__PURE__ */ k("stop", { offset: "1", class: "look-shade-dark" }))),
    /* @__PURE__ */ k("circle", { class: "look-ball", r: RADIUS_PX, fill: `url(#${shade})` }),
    /* @__PURE__ */ k("circle", { class: "look-spot", cx: spot.x, cy: spot.y, r: 6, "data-behind": direction[2] < 0 })
  ), /* @__PURE__ */ k("div", { class: "look-grow look-angles" }, /* @__PURE__ */ k(
    Angle,
    {
      label: TEXT12.azimuth,
      value: azimuth,
      most: 180,
      onInput: (angle) => set2(directionOf([angle, elevation])),
      onSettle
    }
  ), /* @__PURE__ */ k(
    Angle,
    {
      label: TEXT12.elevation,
      value: elevation,
      most: 90,
      onInput: (angle) => set2(directionOf([azimuth, angle])),
      onSettle
    }
  )));
}
function Angle(props) {
  const { label, value, most, onInput, onSettle } = props;
  return /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("span", { "aria-hidden": "true" }, label), /* @__PURE__ */ k(
    NumberBox,
    {
      label,
      unit: "degrees",
      min: -most,
      max: most,
      step: 1,
      value: Math.round(10 * value) / 10,
      onInput,
      onSettle
    }
  ), /* @__PURE__ */ k("span", { "aria-hidden": "true" }, TEXT12.degrees));
}
function wrapped(degrees) {
  return ((degrees + 180) % 360 + 360) % 360 - 180;
}

// src/view/look/moods.ts
var MOODS = {
  soft: {
    shading: { ambient: 0.5, diffuse: 0.7, specular: 0.06, specular_power: 10, ambient_occlusion: 0.75, shadow: 0 },
    direction: [-0.2, 0.6, 1]
  },
  studio: {
    shading: { ambient: 0.22, diffuse: 1, specular: 0.25, specular_power: 16, ambient_occlusion: 0.35, shadow: 0 },
    direction: [-0.55, 0.65, 1]
  },
  dramatic: {
    shading: { ambient: 0.08, diffuse: 1.15, specular: 0.4, specular_power: 30, ambient_occlusion: 0.6, shadow: 0.85 },
    direction: [-1, 0.55, 0.45]
  }
};
function inMood(shading2, name) {
  const { shading: fields2, direction } = MOODS[name];
  const before2 = shading2 ?? DEFAULT_SHADING;
  const [first, ...others] = before2.lights.length > 0 ? before2.lights : DEFAULT_LIGHTS;
  return { ...before2, ...fields2, lights: [{ ...first, direction }, ...others] };
}
function moodOf(shading2) {
  if (shading2 === null) return null;
  const first = (shading2.lights.length > 0 ? shading2.lights : DEFAULT_LIGHTS)[0];
  const names = Object.keys(MOODS);
  return names.find((name) => {
    const { shading: fields2, direction } = MOODS[name];
    const isLit = direction.every((part, axis) => Math.abs(part - (first?.direction[axis] ?? NaN)) < 1e-6);
    return isLit && Object.entries(fields2).every(([field, value]) => shading2[field] === value);
  }) ?? null;
}

// src/view/look/light_panel.tsx
var TEXT13 = WORDS.lightPanel;
var SMOOTHING = [0.5, 1.25];
var SMOOTH = 0.8;
var WATER = 2059e-8;
function LightPanel(props) {
  return /* @__PURE__ */ k("div", { class: "look-panel" }, /* @__PURE__ */ k(LayerChoice, { ...props }), /* @__PURE__ */ k(LightFields, { ...props }), /* @__PURE__ */ k(Operator, { ...props }), /* @__PURE__ */ k(Rest, { ...props }));
}
function Operator({ store, ui, welcome }) {
  const { render: render2, layers, labels } = store.state;
  const volume2 = welcome.volumes[ui.layer];
  const name = nameOf2(render2.composite);
  const isOverOnly = layers.filter((layer) => layer.visible).length > 1 || labels !== null;
  const look = layers[ui.layer]?.look;
  const [low, high] = volume2?.range ?? [0, 1];
  const surface = () => {
    const usual = volume2?.robust_range ?? [0, 1];
    return look === void 0 ? (low + high) / 2 : rounded(surfaceValue(look.transfer_function, usual), high - low);
  };
  const number2 = (field, value, gesture) => store.change([set(withNumber(render2.composite, field, value), "render", "composite")], gesture);
  const slider = (label, field, value, min, max, unit3 = "", beyond = {}) => /* @__PURE__ */ k(
    NumberField,
    {
      isBounded: true,
      label,
      unit: unit3,
      min,
      max,
      value,
      ...beyond,
      onInput: (next) => number2(field, next, `${name} ${field}`),
      onSettle: () => store.settle()
    }
  );
  const optional = (label, field, first, min, max, unit3 = "") => {
    const value = numberOf(render2.composite, field);
    return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
      Switch,
      {
        label: TEXT13.automatic(label),
        on: value === null,
        onToggle: (on) => number2(field, on ? null : first)
      }
    ), value !== null && slider(label, field, value, min, max, unit3, { least: -Infinity, most: Infinity }));
  };
  const unit2 = volume2?.value_unit ?? "";
  const attenuation = unit2 === "HU" ? WATER : 3 / ((high - low || 1) * longestSide(volume2?.bounds));
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT13.composite,
      value: name,
      options: welcome.composites.map(
        (value) => [value, COMPOSITE_NAMES[value] ?? value, isOverOnly && value !== "over" && value !== name]
      ),
      onChoose: (value) => store.change([set(compositeNamed(value, surface()), "render", "composite")])
    }
  ), isOverOnly && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT13.overOnly), name === "first-hit" && slider(TEXT13.iso, "iso_value", numberOf(render2.composite, "iso_value") ?? surface(), low, high, unit2), name === "local-maximum" && optional(TEXT13.threshold, "threshold", surface(), low, high, unit2), name === "depth-shaded-maximum" && slider(TEXT13.strength, "strength", numberOf(render2.composite, "strength") ?? DIMMING, 0, 1), name === "x-ray" && optional(TEXT13.clear, "clear", low, low, high, unit2), name === "x-ray" && optional(TEXT13.attenuation, "attenuation", attenuation, attenuation / 100, 5 * attenuation));
}
function LightFields({ store, engine, ui, welcome }) {
  const { state: state2 } = store;
  const { shading: shading2, path } = shadingOf(state2, ui.layer);
  const look = state2.layers[ui.layer]?.look;
  const kept = T2(null);
  if (shading2 !== null) kept.current = shading2;
  const name = nameOf2(state2.render.composite);
  const isShaded = SHADED.includes(name);
  const reset = async () => {
    try {
      const first2 = look === void 0 ? null : await lookAsChosen(engine, welcome, ui.layer, look.name);
      const operations = state2.shading === "look" ? [] : [set("look", "shading")];
      if (first2 !== null) store.change([...operations, set(first2.shading, "layers", ui.layer, "look", "shading")]);
    } catch (problem) {
      ui.problem(problem);
    }
  };
  const toggle = (on) => store.change([set(on ? kept.current ?? DEFAULT_SHADING : null, ...path)]);
  const resetButton = /* @__PURE__ */ k(Button, { onClick: () => void reset() }, TEXT13.reset);
  const mood = moodOf(shading2);
  const head = /* @__PURE__ */ k($, null, /* @__PURE__ */ k("div", { class: "row look-moods", role: "group", "aria-label": WORDS.moods.title }, Object.keys(MOODS).map((one) => /* @__PURE__ */ k(Button, { key: one, pressed: one === mood, onClick: () => store.change([set(inMood(shading2, one), ...path)]) }, WORDS.moods[one]))), /* @__PURE__ */ k(Switch, { label: TEXT13.shading, on: shading2 !== null, onToggle: toggle }), !isShaded && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT13.unshaded), state2.shading !== "look" && state2.layers.length > 1 && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT13.all));
  if (shading2 === null) {
    return /* @__PURE__ */ k($, null, head, resetButton);
  }
  const change = (field, value) => store.change([set(value, ...path, field)], `light ${field}`);
  const done2 = () => store.settle();
  const slider = (label, field, min, max, more = {}) => /* @__PURE__ */ k(
    NumberField,
    {
      isBounded: true,
      key: field,
      label,
      min,
      max,
      value: shading2[field] ?? min,
      ...more,
      onInput: (value) => change(field, value),
      onSettle: done2
    }
  );
  const lights = lightsOf(shading2);
  const first = lights[0];
  const latest = () => (lightsOf(shadingOf(store.state, ui.layer).shading ?? shading2)[0] ?? first).direction;
  const setDirection = (direction) => change("lights", [{ ...first, direction }, ...lights.slice(1)]);
  const isSmooth = shading2.gradient_smoothing > 0;
  const side = longestSide(welcome.volumes[ui.layer]?.bounds);
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(LightPad, { direction: first.direction, latest, onDirection: setDirection, onSettle: done2 }), first["frame"] === "world" && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT13.world), head, /* @__PURE__ */ k("details", { class: "look-details" }, /* @__PURE__ */ k("summary", null, WORDS.moods.all), slider(TEXT13.exposure, "exposure", 0, 3, { most: 100, step: 0.01 }), slider(TEXT13.ambient, "ambient", 0, 1, { most: 10, step: 0.01 }), slider(TEXT13.diffuse, "diffuse", 0, 2, { most: 10, step: 0.01 }), slider(TEXT13.specular, "specular", 0, 1, { most: 10, step: 0.01 }), slider(TEXT13.power, "specular_power", 1, 100, { most: 1e3, step: 1 }), slider(TEXT13.shoulder, "shoulder", 0, 1, { step: 0.01 }), slider(TEXT13.occlusion, "ambient_occlusion", 0, 1, { step: 0.01 }), shading2.ambient_occlusion > 0 && /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    Switch,
    {
      label: TEXT13.automatic(TEXT13.reach),
      on: shading2.occlusion_radius === null,
      onToggle: (on) => store.change([set(on ? null : side / 10, ...path, "occlusion_radius")])
    }
  ), shading2.occlusion_radius !== null && slider(TEXT13.radius, "occlusion_radius", side / 500, side / 2, {
    unit: welcome.volumes[ui.layer]?.unit ?? ""
  })), slider(TEXT13.shadow, "shadow", 0, 1, { step: 0.01 }), /* @__PURE__ */ k(
    Switch,
    {
      label: TEXT13.smoothingOn,
      on: isSmooth,
      onToggle: (on) => store.change([set(on ? SMOOTH : 0, ...path, "gradient_smoothing")])
    }
  ), isSmooth ? slider(TEXT13.smoothing, "gradient_smoothing", ...SMOOTHING, { unit: "voxels", step: 0.01 }) : slider(TEXT13.offset, "gradient_offset", 0.01, 4, { unit: "voxels", step: 0.01 }), resetButton));
}
function Rest({ store, welcome }) {
  const { render: render2, background } = store.state;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT13.kernel,
      value: render2.kernel,
      options: welcome.kernels.map((value) => [value, KERNEL_NAMES[value] ?? value]),
      onChoose: (value) => store.change([set(value, "render", "kernel")])
    }
  ), /* @__PURE__ */ k("div", { class: "field" }, /* @__PURE__ */ k("span", { "aria-hidden": "true" }, TEXT13.background), /* @__PURE__ */ k(
    ColorField,
    {
      label: TEXT13.background,
      value: hexColor(background, namedColor),
      onColor: (hex) => store.change([set(hex, "background")], "background"),
      onSettle: () => store.settle()
    }
  )));
}
function lightsOf({ lights }) {
  return lights.length > 0 ? lights : DEFAULT_LIGHTS;
}
function longestSide(bounds) {
  if (bounds === void 0) return 1;
  const [lower, upper] = bounds;
  return Math.max(...upper.map((end, axis) => end - (lower[axis] ?? 0)));
}

// src/view/look/look_preview.ts
var REST_MS = 150;
var LookPreview = class {
  constructor(store, engine, layer, onProblem) {
    this.store = store;
    this.engine = engine;
    this.layer = layer;
    this.onProblem = onProblem;
  }
  store;
  engine;
  layer;
  onProblem;
  looks = /* @__PURE__ */ new Map();
  timer;
  asked = 0;
  shown = null;
  /** The name of the look that was chosen, whatever is shown in its place. */
  get chosenName() {
    return this.shown?.name ?? this.store.state.layers[this.layer]?.look.name ?? "";
  }
  /** Shows a look after a moment, unless the pointer goes on before. */
  rest(name) {
    clearTimeout(this.timer);
    this.asked += 1;
    this.timer = setTimeout(() => void this.show(name), REST_MS);
  }
  /** Takes back what is shown. */
  leave() {
    clearTimeout(this.timer);
    this.asked += 1;
    const { shown } = this;
    this.shown = null;
    if (shown === null || JSON.stringify(lookIn(this.store.state, this.layer)) !== JSON.stringify(shown.look)) return;
    this.store.adjust(shown.before);
  }
  /** Chooses a look for good: one step of undo from what was there before the preview. */
  keep(look, composite2) {
    this.leave();
    this.store.change(chosen(this.store.state, this.layer, look, composite2));
  }
  /** The look of a preset; each is asked for once. */
  async lookOf(name) {
    const known2 = this.looks.get(name);
    if (known2 !== void 0) return known2;
    const { look } = await this.engine.ask("preset", { layer: this.layer, name });
    this.looks.set(name, look);
    return look;
  }
  async show(name) {
    const number2 = this.asked;
    try {
      const look = await this.lookOf(name);
      if (number2 !== this.asked) return;
      this.leave();
      const { state: state2 } = this.store;
      const before2 = restored(state2, this.layer);
      this.shown = { look, before: before2, name: lookIn(state2, this.layer)?.name ?? "" };
      this.store.adjust(chosen(state2, this.layer, look));
    } catch (problem) {
      this.onProblem(problem);
    }
  }
};
function lookIn(state2, layer) {
  return state2.layers[layer]?.look;
}
function restored(state2, layer) {
  return [
    set(lookIn(state2, layer), "layers", layer, "look"),
    set(state2.shading, "shading"),
    set(state2.render.composite, "render", "composite"),
    set(state2.background, "background")
  ];
}

// src/view/look/preset_kinds.ts
var GROUPS = {
  CT: ["ct", "any"],
  MR: ["mr", "any"],
  PET: ["pet", "any"],
  fluorescence: ["microscopy", "any"],
  EM: ["microscopy", "any"],
  field: ["simulation", "any"],
  "signed field": ["simulation", "any"],
  dose: ["simulation", "any"]
};
function isOffered(preset, layer, volume2) {
  const groups = GROUPS[volume2?.kind ?? ""];
  return preset.layers.includes(layer) && (groups === void 0 || groups.includes(preset.kind));
}
function titleOf(name) {
  const known2 = WORDS.looks[name];
  if (known2 !== void 0) return known2;
  return /^(slicer-)?(CT|MR|DTI|US|uCT)-/.test(name) ? name.replace(/^slicer-/, "").replaceAll("-", " ") : name;
}

// src/view/look/preset_tiles.tsx
var TEXT14 = WORDS.presetTiles;
function PresetTiles({ label, tiles, selected, pictures, onChoose, onRest, onLeave }) {
  const list2 = T2(null);
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
    list2.current?.querySelectorAll("[data-drawn]").forEach((tile) => seen.observe(tile));
    return () => seen.disconnect();
  }, [pictures, names]);
  const onKeyDown = (event, index) => {
    const all = [...list2.current?.querySelectorAll("[role=option]") ?? []];
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
  return /* @__PURE__ */ k("div", { class: "look-tiles", role: "listbox", "aria-label": label, ref: list2, onPointerLeave: onLeave }, tiles.map(({ name, title, description, picture }, index) => {
    const address = picture ?? pictures.get(name);
    const reason = pictures.reason(name);
    const about = reason === void 0 ? description : `${description} ${TEXT14.noPicture}: ${reason}`;
    return /* @__PURE__ */ k(
      "div",
      {
        key: name,
        class: "look-tile",
        role: "option",
        "aria-selected": name === selected,
        "aria-label": `${title}: ${about}`,
        title: about,
        tabIndex: name === entry ? 0 : -1,
        "data-name": name,
        "data-drawn": picture === void 0 ? true : void 0,
        onPointerEnter: (event) => event.pointerType === "mouse" && onRest?.(name),
        onClick: () => onChoose(name),
        onFocus: () => setFocused(name),
        onKeyDown: (event) => onKeyDown(event, index)
      },
      address ? /* @__PURE__ */ k("img", { src: address, alt: "", width: 96, height: 96 }) : /* @__PURE__ */ k("span", { class: "look-blank" }, reason !== void 0 && TEXT14.noPicture),
      /* @__PURE__ */ k("span", { class: "look-name" }, title)
    );
  }));
}

// src/input/camera.ts
var TURN_DEG = 180;
var MIN_ANGLE_DEG = 0.01;
var MAX_ANGLE_DEG = 170;
var add = (a3, b) => [a3[0] + b[0], a3[1] + b[1], a3[2] + b[2]];
var sub = (a3, b) => [a3[0] - b[0], a3[1] - b[1], a3[2] - b[2]];
var scaled = (a3, factor) => [a3[0] * factor, a3[1] * factor, a3[2] * factor];
var dot = (a3, b) => a3[0] * b[0] + a3[1] * b[1] + a3[2] * b[2];
var cross = (a3, b) => [
  a3[1] * b[2] - a3[2] * b[1],
  a3[2] * b[0] - a3[0] * b[2],
  a3[0] * b[1] - a3[1] * b[0]
];
var length = (a3) => Math.hypot(a3[0], a3[1], a3[2]);
var unit = (a3) => scaled(a3, 1 / length(a3));
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
function turned2(camera, dx, dy, height) {
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
function zoomed2(camera, factor) {
  if (camera.parallel_scale !== void 0) return { ...camera, parallel_scale: camera.parallel_scale / factor };
  const away = sub(camera.position, camera.focal_point);
  return { ...camera, position: add(camera.focal_point, scaled(away, 1 / factor)) };
}
function zoomedAt(camera, size, factor, x2, y3) {
  const { right, up } = axesOf(camera);
  const pixel = unitsPerPixel(camera, size.height);
  const aside = add(scaled(right, (x2 - size.width / 2) * pixel), scaled(up, (size.height / 2 - y3) * pixel));
  const way = scaled(aside, 1 - 1 / factor);
  const { position, focal_point, ...lens } = zoomed2(camera, factor);
  return { ...lens, position: add(position, way), focal_point: add(focal_point, way) };
}
function withLens(camera, angle) {
  const { parallel_scale: _scale, view_angle: _angle, ...place } = camera;
  const { back } = axesOf(camera);
  const half = unitsPerPixel(camera, 2);
  if (angle === void 0) return { ...place, parallel_scale: half };
  const bounded = Math.min(Math.max(angle, MIN_ANGLE_DEG), MAX_ANGLE_DEG);
  const away = half / Math.tan(bounded / 2 * Math.PI / 180);
  return { ...place, position: add(camera.focal_point, scaled(back, away)), view_angle: bounded };
}
function project(camera, size, point2) {
  const { right, up, back } = axesOf(camera);
  const away = sub(point2, camera.position);
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
function seenFrom(camera, direction, viewUp) {
  const away = length(sub(camera.position, camera.focal_point));
  return { ...camera, position: add(camera.focal_point, scaled(direction, away)), view_up: viewUp };
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
  /** Names of pictures that show another camera or time than the one now. */
  stale = /* @__PURE__ */ new Set();
  wanted = [];
  isBusy = false;
  drawing = null;
  lastChange = -Infinity;
  isClosed = false;
  /** Address of a picture; undefined where it is not drawn. */
  get(name) {
    return this.urls.get(name);
  }
  /** The reason why a picture is missing. */
  reason(name) {
    return this.reasons.get(name);
  }
  /** Requests a picture, unless it is drawn. */
  want(name) {
    const isKnown = this.urls.has(name) && !this.stale.has(name);
    if (isKnown || this.reasons.has(name) || this.wanted.includes(name) || name === this.drawing) return;
    this.wanted.push(name);
    void this.next();
  }
  /** Cancels a request whose tile has left the screen. */
  leave(name) {
    this.wanted = this.wanted.filter((other) => other !== name);
  }
  /** Pauses for a moment, as something in the picture is being changed. */
  pause() {
    this.lastChange = performance.now();
  }
  /** Draws all pictures anew; the old ones stay until then. */
  refresh() {
    const known2 = [...this.urls.keys(), ...this.reasons.keys()];
    this.reasons.clear();
    known2.forEach((name) => this.stale.add(name));
    known2.forEach((name) => this.want(name));
  }
  close() {
    this.isClosed = true;
    this.wanted = [];
    this.urls.forEach((url) => URL.revokeObjectURL(url));
    this.urls.clear();
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
      if (!this.isClosed) this.take(name, bytes);
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
  take(name, bytes) {
    const old = this.urls.get(name);
    if (old !== void 0) URL.revokeObjectURL(old);
    this.stale.delete(name);
    this.urls.set(name, URL.createObjectURL(new Blob([bytes], { type: "image/png" })));
  }
};

// src/view/look/use_pictures.ts
var ALIKE = 0.996;
var IDLE_MS = 3e3;
function usePictures({ engine, store, ui }, onChange) {
  const pictures = w2(() => new PresetPictures(engine, ui.layer, onChange), [engine, ui.layer]);
  A2(() => () => pictures.close(), [pictures]);
  A2(() => store.subscribe(() => pictures.pause()), [store, pictures]);
  const camera = store.state.camera;
  const time = store.state.layers[ui.layer]?.time;
  const drawn2 = T2({ camera, time });
  w2(() => drawn2.current = { camera, time }, [pictures]);
  A2(() => {
    if (drawn2.current.time === time && looksAlike(drawn2.current.camera, camera)) return void 0;
    const timer = setTimeout(() => {
      drawn2.current = { camera, time };
      pictures.refresh();
    }, IDLE_MS);
    return () => clearTimeout(timer);
  }, [pictures, camera, time]);
  return pictures;
}
function looksAlike(a3, b) {
  const [one, other] = [axesOf(a3), axesOf(b)];
  return Math.min(dot(one.back, other.back), dot(one.up, other.up)) > ALIKE;
}

// src/view/look/looks_strip.tsx
var TEXT15 = WORDS.presetsPanel;
function LooksStrip(props) {
  const { store, engine, ui, welcome, onAll } = props;
  const layer = store.state.layers[ui.layer];
  const [, redraw] = _2((count) => count + 1, 0);
  const pictures = usePictures(props, () => redraw(null));
  const preview = w2(() => new LookPreview(store, engine, ui.layer, ui.problem), [store, engine, ui.layer]);
  A2(() => () => preview.leave(), [preview]);
  if (layer === void 0) return null;
  const volume2 = welcome.volumes[ui.layer];
  const tiles = [
    { name: "auto", title: titleOf("auto"), description: TEXT15.auto },
    ...welcome.presets.filter((preset) => isOffered(preset, ui.layer, volume2)).map(({ name, description }) => ({ name, title: titleOf(name), description }))
  ];
  const keep = async (name) => {
    try {
      preview.keep(await preview.lookOf(name));
      ui.announce(TEXT15.chosen(titleOf(name)));
    } catch (problem) {
      ui.problem(problem);
    }
  };
  return /* @__PURE__ */ k("section", { class: "looks float", "data-panel": "presets", "aria-label": WORDS.sheets.presets }, /* @__PURE__ */ k("div", { class: "body" }, /* @__PURE__ */ k(LayerChoice, { ...props }), /* @__PURE__ */ k(
    PresetTiles,
    {
      label: TEXT15.fitting,
      tiles,
      selected: preview.chosenName,
      pictures,
      onChoose: (name) => void keep(name),
      onRest: (name) => preview.rest(name),
      onLeave: () => preview.leave()
    }
  ), /* @__PURE__ */ k("button", { class: "button looks-all", "data-opens": "looks", onClick: onAll }, TEXT15.allLooks)));
}

// src/view/look/own_presets_fields.tsx
var TEXT16 = WORDS.ownPresetsFields;
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
      ui.problem({ code: "not_kept", message: `${TEXT16.notKept}: ${problem.message}`, remedy: TEXT16.remedy });
      return false;
    }
  };
  const checked = () => {
    const wanted = name.trim();
    const found2 = nameProblem(wanted, taken);
    setWhy(found2 ?? "");
    return found2 === null ? wanted : null;
  };
  const save = async () => {
    const wanted = checked();
    if (wanted === null) return;
    const composite2 = store.state.render.composite;
    const look = {
      ...layer.look,
      name: wanted,
      composite: typeof composite2 === "string" && store.state.layers.length === 1 ? composite2 : layer.look.composite,
      background: typeof store.state.background === "string" ? store.state.background : layer.look.background
    };
    const operator = store.state.layers.length === 1 && typeof composite2 !== "string" ? { composite: composite2 } : {};
    const picture = await pictureOf(ui.frames["3d"]);
    if (!attempt(() => keepPreset({ name: wanted, look, picture, ...operator }))) return;
    setName("");
    store.change([{ op: "replace", path: `/layers/${ui.layer}/look`, value: look }]);
    ui.announce(TEXT16.saved(wanted));
  };
  const open = async (input) => {
    const file = input.files?.[0];
    if (file === void 0) return;
    try {
      onTake(lookFromText(await file.text()));
    } catch (problem) {
      ui.problem({ code: "no_look", message: `${TEXT16.notRead}: ${file.name}: ${problem.message}` });
    }
    input.value = "";
  };
  return /* @__PURE__ */ k("details", { class: "look-details" }, /* @__PURE__ */ k("summary", null, TEXT16.title), /* @__PURE__ */ k(
    "form",
    {
      class: "look-panel",
      onSubmit: (event) => {
        event.preventDefault();
        void save();
      }
    },
    /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, TEXT16.name), /* @__PURE__ */ k(
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
    )),
    why !== "" && /* @__PURE__ */ k("p", { role: "alert", class: "look-why" }, why),
    /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { type: "submit", class: "button" }, TEXT16.save), chosen2 !== void 0 && /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
      Button,
      {
        label: `${TEXT16.rename} ${chosen2.name}`,
        onClick: () => {
          const wanted = checked();
          if (wanted === null || !attempt(() => renamePreset(chosen2.name, wanted))) return;
          setName("");
          rename(wanted);
        }
      },
      TEXT16.rename
    ), /* @__PURE__ */ k(
      Button,
      {
        label: `${TEXT16.remove} ${chosen2.name}`,
        onClick: () => attempt(() => dropPreset(chosen2.name)) && ui.announce(TEXT16.removed(chosen2.name))
      },
      TEXT16.remove
    ))),
    /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
      Button,
      {
        onClick: () => ui.download(`${layer.look.name || "look"}.json`, lookText(layer.look), "application/json")
      },
      TEXT16.export
    ), /* @__PURE__ */ k("label", { class: "button look-file" }, TEXT16.import, /* @__PURE__ */ k(
      "input",
      {
        type: "file",
        class: "hidden",
        accept: ".json,application/json",
        onChange: (event) => void open(event.currentTarget)
      }
    )))
  ));
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

// src/view/look/preset_search.ts
function matching(presets, search) {
  const words = search.toLowerCase().split(/[\s_-]+/).filter((word) => word !== "");
  const has = (text2) => words.every((word) => text2.toLowerCase().includes(word));
  const isNamed = ({ name, title = "" }) => has(`${name} ${title}`);
  const found2 = presets.filter(({ name, title = "", description }) => has(`${name} ${title} ${description}`));
  return words.length === 0 ? found2 : [...found2.filter(isNamed), ...found2.filter((one) => !isNamed(one))];
}

// src/view/look/presets_panel.tsx
var TEXT17 = WORDS.presetsPanel;
function PresetsPanel(props) {
  const { store, engine, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const [search, setSearch] = d2("");
  const [showsAll, setShowsAll] = d2(false);
  const [own, setOwn] = d2(() => ownPresets());
  const [, redraw] = _2((count) => count + 1, 0);
  const pictures = usePictures(props, () => redraw(null));
  if (layer === void 0) return null;
  const take3 = (look, composite2) => {
    store.change(chosen(store.state, ui.layer, look, composite2));
    ui.announce(TEXT17.chosen(titleOf(look.name)));
  };
  const choose = async (name) => {
    try {
      take3((await engine.ask("preset", { layer: ui.layer, name })).look);
    } catch (found3) {
      ui.problem(found3);
    }
  };
  const tiles = [
    { name: "auto", title: titleOf("auto"), description: TEXT17.auto, fits: true },
    ...welcome.presets.map((preset) => {
      const { name, description } = preset;
      return { name, title: titleOf(name), description, fits: isOffered(preset, ui.layer, welcome.volumes[ui.layer]) };
    })
  ];
  const found2 = matching(tiles, search);
  const fitting = found2.filter(({ fits }) => fits);
  const rest = found2.filter(({ fits }) => !fits);
  const ownTiles = matching(
    own.map(({ name, look, picture }) => ({ name, title: name, description: look.description || TEXT17.ownPreset, picture })),
    search
  );
  const grid = { selected: layer.look.name, pictures, onChoose: (name) => void choose(name) };
  return /* @__PURE__ */ k("div", { class: "look-panel" }, /* @__PURE__ */ k(LayerChoice, { ...props }), /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, TEXT17.search), /* @__PURE__ */ k(
    "input",
    {
      type: "search",
      class: "look-grow",
      value: search,
      onInput: (event) => setSearch(event.currentTarget.value)
    }
  )), ownTiles.length > 0 && /* @__PURE__ */ k($, null, /* @__PURE__ */ k("h3", null, TEXT17.own), /* @__PURE__ */ k(
    PresetTiles,
    {
      ...grid,
      label: TEXT17.own,
      tiles: ownTiles,
      onChoose: (name) => {
        const preset = own.find((one) => one.name === name);
        if (preset !== void 0) take3(preset.look, preset.composite);
      }
    }
  )), fitting.length > 0 && /* @__PURE__ */ k(PresetTiles, { ...grid, label: TEXT17.fitting, tiles: fitting }), rest.length > 0 && /* @__PURE__ */ k(
    "details",
    {
      class: "look-details",
      open: showsAll || search !== "",
      onToggle: (event) => search === "" && setShowsAll(event.currentTarget.open)
    },
    /* @__PURE__ */ k("summary", null, TEXT17.all(rest.length)),
    (showsAll || search !== "") && /* @__PURE__ */ k(PresetTiles, { ...grid, label: TEXT17.all(rest.length), tiles: rest })
  ), found2.length + ownTiles.length === 0 && /* @__PURE__ */ k("p", { class: "dim" }, TEXT17.none), store.state.layers.length > 1 && layer.look.composite !== "over" && /* @__PURE__ */ k("p", { class: "look-small" }, TEXT17.alone), /* @__PURE__ */ k(OwnPresets, { ...props, own, onOwn: setOwn, onTake: take3 }));
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
var TEXT18 = WORDS.timeBar;
var MAX_RATE = 60;
var GESTURE = "time";
function TimeBar({ store, ui, welcome }) {
  const count = Math.max(1, ...welcome.volumes.map((volume2) => volume2.n_times));
  const series = welcome.volumes.flatMap((volume2, index) => volume2.n_times > 1 ? [index] : []);
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
  return /* @__PURE__ */ k("div", { class: "look-time", role: "group", "aria-label": TEXT18.title }, /* @__PURE__ */ k(Button, { label: TEXT18.before, onClick: () => step(-1) }, "‹"), /* @__PURE__ */ k(Button, { pressed: isPlaying, onClick: toggle }, isPlaying ? TEXT18.pause : TEXT18.play), /* @__PURE__ */ k(Button, { label: TEXT18.next, onClick: () => step(1) }, "›"), /* @__PURE__ */ k(
    "input",
    {
      type: "range",
      "aria-label": TEXT18.title,
      "aria-valuetext": TEXT18.of(time, count),
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
  ), /* @__PURE__ */ k("output", { class: "look-count" }, TEXT18.of(time, count)), /* @__PURE__ */ k("label", { class: "row" }, /* @__PURE__ */ k(
    NumberBox,
    {
      label: TEXT18.rate,
      min: 0.2,
      max: MAX_RATE,
      step: 1,
      value: rate,
      onInput: setRate,
      onSettle: () => {
      }
    }
  ), /* @__PURE__ */ k("span", { class: "dim", "aria-hidden": "true" }, TEXT18.perSecond)), /* @__PURE__ */ k(Switch, { label: TEXT18.repeat, on: repeats, onToggle: setRepeats }));
}

// src/view/look/window_drag.ts
var TEXT19 = WORDS.windowDrag;
function windowDrag({ store, ui, welcome }, dx, dy) {
  const layer = store.state.layers[ui.layer];
  const range = welcome.volumes[ui.layer]?.robust_range;
  if (layer === void 0 || range === void 0 || dx === 0 && dy === 0) return;
  if (!isEditable(layer.look.transfer_function)) {
    ui.announce(TEXT19.table);
    return;
  }
  const { transfer_function } = windowed(layer.look, dx, dy, range);
  store.change([set(transfer_function, "layers", ui.layer, "look", "transfer_function")], "window of the function");
}

// src/view/look/look.css
var look_default = '.look-panel { display: grid; gap: 8px; min-width: 0 }\n.look-panel > *, .look-details > *, .look-list > * { min-width: 0 }\n.look-grow { flex: 1 1 0; min-width: 0 }\n.look-nowrap { flex-wrap: nowrap }\n.look-small { font-size: 12px }\n.look-check { min-height: 24px; flex-wrap: nowrap }\n.look-check > span { min-width: 0 }\n.look-panel .field > span:first-child, .field.look-slider > span:first-child { flex: 0 0 96px }\n.look-slider input[type="number"] { flex: 0 0 96px; width: 96px }\n.field small { margin-left: 4px; font-size: 11px }\n.look-plot { display: block; width: 100%; touch-action: pan-y; user-select: none; overflow: visible }\n.look-grid { stroke: var(--line); stroke-width: 1; opacity: .55 }\n.look-tick { fill: var(--dim); font-size: 11px }\n.look-counts { fill: var(--text); fill-opacity: .22 }\n.look-line { fill: none; stroke: var(--text); stroke-width: 1.5 }\n.look-line-under { fill: none; stroke: var(--panel); stroke-width: 4 }\n.look-handle { cursor: grab; touch-action: none }\n.wavesplat .look-handle:focus, .wavesplat .look-mark:focus, .look-pad:focus:not(:focus-visible) { outline: none }\n.look-handle:active { cursor: grabbing }\n.look-reach { fill: transparent; stroke: none }\n.look-dot { fill: var(--panel); stroke: var(--text); stroke-width: 2 }\n.look-handle[data-selected="true"] .look-dot { fill: var(--accent); stroke-width: 2.5 }\n.look-handle:focus-visible .look-reach { stroke: var(--focus); stroke-width: 2 }\n.look-mark { cursor: pointer }\n.look-mark path { fill: var(--accent); stroke: var(--panel) }\n.look-mark:focus-visible .look-reach { stroke: var(--focus); stroke-width: 2 }\n.look-ramp { stroke: var(--line) }\n.look-point { border: 1px solid var(--line); border-radius: var(--radius); display: grid; gap: 6px; margin: 0; padding: 4px 8px 8px; min-width: 0 }\n.look-point legend { color: var(--dim); font-size: 12px; padding: 0 4px }\n.look-details { border-top: 1px solid var(--line); padding-top: 6px }\n.look-details > summary { cursor: pointer; min-height: 24px; margin-bottom: 6px }\n.look-details > * + * { margin-top: 6px }\n.look-tiles { display: grid; grid-template-columns: repeat(auto-fill, 98px); gap: 6px; justify-content: space-between }\n.look-tile { display: grid; gap: 2px; border: 1px solid var(--line); border-radius: 4px; cursor: pointer; overflow: hidden; align-content: start }\n.look-tile:hover { border-color: var(--accent) }\n.look-tile[aria-selected="true"] { border-color: var(--accent); box-shadow: 0 0 0 2px var(--accent) }\n.look-tile[aria-selected="true"] .look-name { background: var(--accent); color: var(--accent-text) }\n.look-tile img, .look-blank { display: block; width: 96px; height: 96px; background: #000 }\n.look-blank { background: var(--raised); color: var(--dim); font-size: 12px; padding: 36px 0; text-align: center }\n.look-tile .look-name { padding: 1px 4px 3px; font-size: 12px; line-height: 1.25; overflow-wrap: anywhere }\n.look-name { min-width: 0; overflow: hidden; text-overflow: ellipsis }\n.wavesplat ul.look-list { list-style: none; margin: 0; padding: 0; display: grid; gap: 6px; max-height: 420px; overflow-y: auto }\n.look-layer { display: grid; gap: 4px; padding: 6px; border: 1px solid var(--line); border-radius: var(--radius) }\n.look-layer[data-chosen="true"] { border-color: var(--accent) }\n.look-chip { width: 30px }\n.look-label { display: flex; flex-wrap: wrap; align-items: center; gap: 2px 6px }\n.look-label > .look-name { white-space: nowrap }\n.look-label > .look-slider { flex: 1 0 100%; padding-left: 30px }\n.look-pad { flex: none; cursor: crosshair; touch-action: none; border-radius: var(--radius) }\n.look-ball { stroke: var(--line) }\n.look-shade-lit { stop-color: #fff5e0 }\n.look-shade-half { stop-color: #8d8478 }\n.look-shade-dark { stop-color: #1d1c1f }\n.look-shade-behind { stop-color: #4a4742 }\n.look-moods > .button { flex: 1 }\n.look-knobs { display: grid; gap: 8px }\n.look-spot { fill: #fff; stroke: #222; stroke-width: 2 }\n.look-spot[data-behind="true"] { fill: none; stroke: #fff }\n.look-angles { display: grid; gap: 6px }\n.look-angles .row > span:first-child { flex: 0 0 92px; color: var(--dim) }\n.look-time { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 8px; width: 100%; padding: 5px 10px; background: var(--glass); box-shadow: var(--lift); border-radius: var(--radius) }\n.look-time input[type="range"] { flex: 1 1 120px }\n.look-time input[type="number"] { width: 56px }\n.look-count { font-variant-numeric: tabular-nums; min-width: 62px }\n.look-file { position: relative; display: inline-flex; align-items: center }\n.look-file:focus-within { outline: 2px solid var(--focus); outline-offset: 1px }\n.look-why { color: var(--danger) }\n@media (pointer: coarse) { circle.look-reach { r: 22px } }\n@media (forced-colors: active) { .look-ramp, .look-dot, .look-spot { forced-color-adjust: none } }\n.look-named { display: inline-flex; align-items: center; gap: 4px }\n\n';

// src/view/overlay3d/cube.css
var cube_default = ".viewport .cube path { fill: color-mix(in srgb, #dfe8f5 calc(var(--light) * 100%), #1b222c); stroke: #10151c; stroke-width: .75; stroke-linejoin: round }\n.viewport svg.over .cube [data-handle] { cursor: pointer; pointer-events: auto }\n.viewport .cube [data-handle]:hover path { fill: #6cb2ff }\n.viewport svg.over .cube text { fill: #10151c; stroke: none; font-weight: 700; font-size: 14px; text-anchor: middle }\n.viewport .cube [data-handle]:focus-visible { outline: none }\n.viewport .cube [data-handle]:focus-visible path { stroke: #ffd166; stroke-width: 2 }\n@media (forced-colors: active) { .viewport .cube path { fill: Canvas; stroke: CanvasText } .viewport svg.over .cube text { fill: CanvasText } }\n";

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
function sceneLabel(state2) {
  const shown = state2.layers.filter((layer) => layer.visible);
  const what = shown.map((layer) => `${layer.name} as ${layer.look.name}`).join(", ") || "nothing";
  const { back } = axesOf(state2.camera);
  const sides = SIDES.map(([name, way]) => [name, dot(back, way)]).filter(([, share2]) => share2 > NAMED).sort((a3, b) => b[1] - a3[1]).map(([name]) => name === "above" || name === "below" ? name : `the ${name}`);
  const cut = state2.clip.length > 0 ? ", cut open" : "";
  return `${what}, seen from ${sides.join(" and ")}${cut}`;
}
function compositeName(composite2) {
  return typeof composite2 === "string" ? composite2 : Object.keys(composite2)[0] ?? "over";
}
function shortNumber(value, digits = 3) {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 7) return value.toExponential(digits - 1);
  const places = Math.max(0, digits - 1 - size);
  return String(Number(value.toFixed(Math.min(places, 8))));
}
function decimalsOf(spacing) {
  return spacing > 0 ? Math.min(9, Math.max(0, Math.floor(1.5 - Math.log10(spacing)))) : 3;
}
function placeText(point2, { volumes, axis_ends }) {
  const volume2 = volumes[0];
  const decimals = decimalsOf(Math.min(...volume2?.spacing ?? [1]));
  const parts = point2.map((value, axis) => {
    const rounded2 = value.toFixed(decimals);
    if (!volume2?.is_anatomical) return `${"xyz"[axis]} ${rounded2}`;
    return `${axis_ends[2 * axis + (value < 0 ? 0 : 1)]} ${rounded2.replace("-", "")}`;
  });
  return [...parts, volume2?.unit ?? ""].join(" ").trim();
}

// src/view/about_panel.tsx
var TEXT20 = WORDS.about;
function AboutPanel({ welcome, store, ui }) {
  const notes = [...new Set(Object.values(ui.frames).flatMap((frame) => frame.notes))];
  return /* @__PURE__ */ k($, null, welcome.volumes.map((volume2, n2) => /* @__PURE__ */ k("section", { key: n2, class: "about" }, /* @__PURE__ */ k("h3", null, store.state.layers[n2]?.name ?? volume2.name), /* @__PURE__ */ k("dl", null, facts(volume2).map(([name, text2]) => [/* @__PURE__ */ k("dt", { key: name }, name), /* @__PURE__ */ k("dd", { key: text2 }, text2)])), /* @__PURE__ */ k("h4", null, TEXT20.notes), /* @__PURE__ */ k(Notes, { of: volume2.notes }))), notes.length > 0 && /* @__PURE__ */ k("section", { class: "about" }, /* @__PURE__ */ k("h3", null, TEXT20.picture), /* @__PURE__ */ k(Notes, { of: notes })));
}
function Notes({ of }) {
  return /* @__PURE__ */ k("ul", null, of.map((note) => /* @__PURE__ */ k("li", { key: note }, note)));
}
function facts(volume2) {
  const { shape, spacing, bounds, range, unit: unit2, value_unit, orientation } = volume2;
  const size = [0, 1, 2].map((a3) => (bounds[1][a3] ?? 0) - (bounds[0][a3] ?? 0));
  const length2 = (all, decimals2) => `${all.map((one) => String(Number(one.toFixed(decimals2)))).join(" × ")} ${unit2 ?? ""}`.trim();
  const decimals = decimalsOf(Math.min(...spacing));
  const isEven = spacing.every((one) => Math.abs(one - spacing[0]) < 1e-6 * spacing[0]);
  return [
    [TEXT20.kind, TEXT20.kinds[volume2.kind] ?? volume2.kind],
    [TEXT20.samples, `${shape.join(" × ")}, ${volume2.dtype}`],
    [TEXT20.spacing, isEven ? `${shortNumber(spacing[0], 4)} ${unit2 ?? ""}`.trim() : length2(spacing, decimals + 2)],
    [TEXT20.size, length2(size, decimals)],
    [TEXT20.values, `${numberText(range[0])} to ${numberText(range[1])} ${value_unit}`.trim()],
    [TEXT20.axes, orientation === null ? TEXT20.noAxes : TEXT20.axesOf(orientation)],
    ...volume2.n_times > 1 ? [[TEXT20.times, String(volume2.n_times)]] : []
  ];
}

// src/view/overlay3d/box.ts
var FACES = [0, 1, 2].flatMap((axis) => [
  { axis, side: "lower" },
  { axis, side: "upper" }
]);
function corners(box2) {
  return [...Array(8).keys()].map(
    (bits) => [0, 1, 2].map((axis) => (bits >> axis & 1 ? box2.upper : box2.lower)[axis])
  );
}
var EDGES = [0, 1, 2].flatMap(
  (axis) => [...Array(8).keys()].filter((bits) => !(bits >> axis & 1)).map((bits) => ({ a: bits, b: bits | 1 << axis, axis }))
);
function faceCenter(box2, { axis, side }) {
  const middle2 = center(box2);
  return middle2.map((value, a3) => a3 === axis ? box2[side][axis] : value);
}
var center = (box2) => scaled(add(box2.lower, box2.upper), 0.5);
function isSeen(box2, face, camera) {
  const outward = [0, 0, 0].map((_3, a3) => a3 === face.axis ? face.side === "upper" ? 1 : -1 : 0);
  const toEye = camera.parallel_scale === void 0 ? sub(camera.position, faceCenter(box2, face)) : axesOf(camera).back;
  return dot(outward, toEye) > 0;
}
function isHidden(box2, edge, camera) {
  return [0, 1, 2].filter((axis) => axis !== edge.axis).every((axis) => {
    const side = edge.a >> axis & 1 ? "upper" : "lower";
    return !isSeen(box2, { axis, side }, camera);
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
function withFace(box2, face, to, bounds, least) {
  const { axis, side } = face;
  const [low, high] = [bounds[0][axis], bounds[1][axis]];
  const inside = side === "lower" ? Math.max(low, Math.min(to, box2.upper[axis] - least)) : Math.min(high, Math.max(to, box2.lower[axis] + least));
  const moved = box2[side].map((value, a3) => a3 === axis ? inside : value);
  return { ...box2, [side]: moved };
}
function movedBy(box2, by, bounds) {
  const clamped2 = by.map((way, a3) => {
    const [room, back] = [(bounds[1][a3] ?? 0) - (box2.upper[a3] ?? 0), (bounds[0][a3] ?? 0) - (box2.lower[a3] ?? 0)];
    return Math.min(Math.max(way, back), room);
  });
  return { ...box2, lower: add(box2.lower, clamped2), upper: add(box2.upper, clamped2) };
}
function inPicture(camera, size, from, dx, dy) {
  const here = project(camera, size, from);
  if (here === null) return [0, 0, 0];
  const moved = ray(camera, size, here.x + dx, here.y + dy);
  const { back } = axesOf(camera);
  const depth = -dot(sub(from, moved.origin), back) / -dot(moved.direction, back);
  return sub(add(moved.origin, scaled(moved.direction, depth)), from);
}
var UPWARD = 0.3;
var RIGHTWARD = 0.2;
function cornerTowards(box2, camera) {
  const { right, up, back } = axesOf(camera);
  const way = add(back, add(scaled(up, UPWARD), scaled(right, RIGHTWARD)));
  const middle2 = center(box2);
  const pick2 = (isLower) => middle2.map((value, axis) => (way[axis] ?? 0) > 0 === isLower ? value : (isLower ? box2.lower : box2.upper)[axis]);
  return { ...box2, lower: pick2(true), upper: pick2(false) };
}
var placeOfBox = (clips, kind2) => clips.findIndex((clip2) => kind2 in clip2 && !isIndexed(boxOf(clip2)));
function boxOf(clip2) {
  return "keep" in clip2 ? clip2.keep : "cut_out" in clip2 ? clip2.cut_out : null;
}
var isIndexed = (box2) => box2?.space === "index";

// src/view/cut_panel.tsx
var TEXT21 = WORDS.cut;
var AXES = ["x", "y", "z"];
function CutPanel(props) {
  const { store, welcome } = props;
  const { clip: clip2, view } = store.state;
  const whole = { lower: welcome.bounds[0], upper: welcome.bounds[1], space: "world" };
  const add2 = (one) => store.change([set(one, "clip", "-"), set(true, "view", "overlays", "crop_box")]);
  const remove = (place) => store.change([{ op: "remove", path: `/clip/${place}` }]);
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    Switch,
    {
      label: TEXT21.handles,
      on: view.overlays.crop_box,
      onToggle: (on) => store.change([set(on, "view", "overlays", "crop_box")])
    }
  ), ["keep", "cut_out"].map((kind2) => {
    const place = placeOfBox(clip2, kind2);
    const found2 = clip2[place];
    const box2 = found2 === void 0 ? null : boxOf(found2);
    return /* @__PURE__ */ k("fieldset", { key: kind2 }, /* @__PURE__ */ k("legend", null, TEXT21[kind2]), box2 === null ? /* @__PURE__ */ k(
      "button",
      {
        class: "button",
        onClick: () => add2({ [kind2]: kind2 === "keep" ? whole : cornerTowards(whole, store.state.camera) })
      },
      kind2 === "keep" ? TEXT21.crop : TEXT21.cut
    ) : /* @__PURE__ */ k($, null, /* @__PURE__ */ k(BoxNumbers, { ...props, kind: kind2, place, box: box2 }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => store.change([set({ [kind2]: whole }, "clip", place)]) }, TEXT21.reset), /* @__PURE__ */ k("button", { class: "button", onClick: () => remove(place) }, TEXT21.remove))));
  }), /* @__PURE__ */ k("fieldset", null, /* @__PURE__ */ k("legend", null, TEXT21.planes), clip2.map(
    (one, place) => "plane" in one ? /* @__PURE__ */ k(PlaneNumbers, { key: place, ...props, place, plane: one.plane, onRemove: () => remove(place) }) : null
  ), /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      onClick: () => {
        const { back } = axesOf(store.state.camera);
        add2({ plane: { point: store.state.view.slices.crosshair, normal: scaled(back, -1) } });
      }
    },
    TEXT21.add
  )));
}
function BoxNumbers(props) {
  const { store, welcome, kind: kind2, place, box: box2 } = props;
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const unitName = welcome.volumes[0]?.unit ?? "units";
  return /* @__PURE__ */ k($, null, AXES.flatMap(
    (name, a3) => ["lower", "upper"].map((side) => {
      const face = { axis: a3, side };
      const [low, high] = [welcome.bounds[0][a3] ?? 0, welcome.bounds[1][a3] ?? 1];
      return /* @__PURE__ */ k(
        NumberField,
        {
          key: `${name}${side}`,
          decimals: decimalsOf(spacing[a3] ?? 1),
          label: side === "lower" ? TEXT21.from(name) : TEXT21.to(name),
          unit: unitName,
          value: box2[side][a3] ?? 0,
          min: low,
          max: high,
          onInput: (value) => store.change(
            [set({ [kind2]: withFace(box2, face, value, welcome.bounds, spacing[a3] ?? 1) }, "clip", place)],
            `${kind2} ${name} ${side}`
          ),
          onSettle: () => store.settle()
        }
      );
    })
  ));
}
function PlaneNumbers(props) {
  const { store, welcome, place, plane, onRemove } = props;
  const normal = unit(plane.normal);
  const [lower, upper] = welcome.bounds;
  const ends = [0, 1, 2].map((a3) => [(lower[a3] ?? 0) * (normal[a3] ?? 0), (upper[a3] ?? 0) * (normal[a3] ?? 0)]);
  const low = ends.reduce((sum, end) => sum + Math.min(...end), 0);
  const high = ends.reduce((sum, end) => sum + Math.max(...end), 0);
  const along = dot(plane.point, normal);
  const change = (next, gesture) => store.change([set({ plane: next }, "clip", place)], gesture);
  const number2 = store.state.clip.slice(0, place + 1).filter((clip2) => "plane" in clip2).length;
  return /* @__PURE__ */ k("div", { class: "plane" }, /* @__PURE__ */ k(
    NumberField,
    {
      decimals: decimalsOf(Math.min(...welcome.volumes[0]?.spacing ?? [1])),
      label: TEXT21.plane(number2),
      unit: welcome.volumes[0]?.unit ?? "units",
      value: along,
      min: low,
      max: high,
      onInput: (value) => {
        const point2 = plane.point.map((x2, a3) => x2 + (value - along) * (normal[a3] ?? 0));
        change({ ...plane, point: point2 }, "plane at");
      },
      onSettle: () => store.settle()
    }
  ), /* @__PURE__ */ k("div", { class: "row" }, AXES.map((name, a3) => /* @__PURE__ */ k("label", { key: name, class: "row" }, TEXT21.normal(name), /* @__PURE__ */ k(
    "input",
    {
      type: "number",
      step: "any",
      value: Number((normal[a3] ?? 0).toFixed(4)),
      onChange: (event) => {
        const value = event.currentTarget.valueAsNumber;
        const next = normal.map((x2, b) => b === a3 ? value : x2);
        if (Number.isFinite(value) && next.some((x2) => x2 !== 0)) change({ ...plane, normal: unit(next) });
      }
    }
  )))), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => change({ ...plane, normal: scaled(plane.normal, -1) }) }, TEXT21.flip), /* @__PURE__ */ k("button", { class: "button", onClick: onRemove }, TEXT21.remove)));
}

// src/view/help.tsx
var TEXT22 = WORDS.help;
function Help({ onClose }) {
  const dialog = T2(null);
  A2(() => {
    dialog.current?.showModal();
  }, []);
  return /* @__PURE__ */ k("dialog", { ref: dialog, class: "help", "aria-labelledby": "help-title", onClose }, /* @__PURE__ */ k("form", { method: "dialog", class: "row" }, /* @__PURE__ */ k("h2", { id: "help-title" }, WORDS.toolbar.help), /* @__PURE__ */ k("span", { class: "spring" }), /* @__PURE__ */ k("button", { class: "button" }, TEXT22.close)), /* @__PURE__ */ k("p", { class: "dim" }, TEXT22.where), /* @__PURE__ */ k("div", { class: "columns" }, /* @__PURE__ */ k("table", null, /* @__PURE__ */ k("caption", null, TEXT22.gestures), /* @__PURE__ */ k("tbody", null, GESTURES.map(([gesture, what]) => /* @__PURE__ */ k("tr", { key: gesture }, /* @__PURE__ */ k("th", { scope: "row" }, gesture), /* @__PURE__ */ k("td", null, what))))), /* @__PURE__ */ k("table", null, /* @__PURE__ */ k("caption", null, TEXT22.keys), /* @__PURE__ */ k("tbody", null, KEYS.map(({ shown, text: text2 }) => /* @__PURE__ */ k("tr", { key: shown }, /* @__PURE__ */ k("th", { scope: "row" }, /* @__PURE__ */ k("kbd", null, shown)), /* @__PURE__ */ k("td", null, text2)))))));
}

// src/view/icons.tsx
var PATHS = {
  open: "M2 16V4h6l2 3h8v9zM2 16l3-6h15l-3 6",
  undo: "M8 5 4 9l4 4M4 9h8a4 4 0 0 1 0 8H9",
  redo: "M12 5l4 4-4 4M16 9H8a4 4 0 0 0 0 8h3",
  fit: "M4 8V4h4M16 8V4h-4M4 12v4h4M16 12v4h-4M8 8h4v4H8z",
  turn: "M15 6a7 3 0 1 0 1 4M16 3v4h-4M10 10v7",
  window: "M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14",
  distance: "M3 17 17 3M3 13v4h4M17 7V3h-4",
  angle: "M16 16H4L14 4M9 16a6 6 0 0 0-1.5-4",
  area: "M5 6c3-4 9-3 11 0s1 8-3 10-9 0-10-3 0-5 2-7z",
  help: "M7.5 7.5a2.5 2.5 0 1 1 3.5 2.3c-.8.4-1 .9-1 1.7M10 14.6v.1M10 18a8 8 0 1 0 0-16 8 8 0 0 0 0 16z",
  dark: "M16 12A7 7 0 0 1 8 4a7 7 0 1 0 8 8z",
  close: "M5 5l10 10M15 5 5 15",
  search: "M8.5 14a5.5 5.5 0 1 0 0-11 5.5 5.5 0 0 0 0 11zM12.5 12.5 17 17",
  info: "M10 18a8 8 0 1 0 0-16 8 8 0 0 0 0 16zM10 9v5M10 6.2v.1",
  "3d": "M10 2.5l6.5 3.7v7.6L10 17.5l-6.5-3.7V6.2zM3.5 6.2 10 10l6.5-3.8M10 10v7.5",
  "one-and-three": "M3 3.5h14v13H3zM11.5 3.5v13M11.5 7.8H17M11.5 12.2H17",
  "two-by-two": "M3 3.5h14v13H3zM10 3.5v13M3 10h14",
  single: "M3 3.5h14v13H3zM10 7v6M7 10h6",
  presets: "M10 2.5l1.7 4.6 4.8.2-3.8 3 1.3 4.7-4-2.7-4 2.7 1.3-4.7-3.8-3 4.8-.2z",
  function: "M3 3v14h14M5 14c3 0 3-8 5.5-8S13 11 17 11",
  layers: "M10 3l7.5 4L10 11 2.5 7zM2.5 10.5 10 14.5l7.5-4M2.5 14 10 18l7.5-4",
  labels: "M3 3.5h6.5L17 11l-6 6-8-7.5zM6.5 6.8v.1",
  light: "M10 2v2M10 16v2M2 10h2M16 10h2M4.5 4.5l1.4 1.4M14.1 14.1l1.4 1.4M15.5 4.5l-1.4 1.4M5.9 14.1l-1.4 1.4M10 6.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7z",
  cut: "M5.5 8a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5zM5.5 17a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5zM7.6 6.9 17 15M7.6 13.1 17 5",
  slices: "M6 3.5h11v8M4.5 6H14v8.5M3 8.5h8.5v8H3z",
  measure: "M13.5 2.5l4 4-11 11-4-4zM6 10l2 2M8.5 7.5 10 9M11 5l2 2",
  share: "M10 12V3M6 7l4-4 4 4M4 11v6h12v-6",
  settings: "M3 6h8M15 6h2M3 14h2M9 14h8M13 8a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM7 16a2 2 0 1 0 0-4 2 2 0 0 0 0 4z"
};
function Icon({ name }) {
  return /* @__PURE__ */ k("svg", { viewBox: "0 0 20 20", "aria-hidden": "true" }, /* @__PURE__ */ k("path", { d: PATHS[name] }));
}

// src/view/slices/geometry.ts
var AXES2 = { z: [0, 0, 1], y: [0, 1, 0], x: [1, 0, 0] };
function normalOf(state2, pane) {
  const tilted2 = state2.view.slices.normals?.[pane];
  return tilted2 === void 0 ? AXES2[pane] : unit(tilted2);
}
function worldAt({ geometry, size, width, height }, x2, y3) {
  const [column, row] = [x2 / size.width * width - 0.5, y3 / size.height * height - 0.5];
  const across = scaled(geometry.right, column * geometry.pixel);
  return add(geometry.origin, add(across, scaled(geometry.down, row * geometry.pixel)));
}
function placeOf(frame, point2) {
  const { geometry, size, width, height } = frame;
  const from = sub(point2, geometry.origin);
  const column = dot(from, geometry.right) / geometry.pixel;
  const row = dot(from, geometry.down) / geometry.pixel;
  return {
    x: (column + 0.5) / width * size.width,
    y: (row + 0.5) / height * size.height,
    away: Math.abs(dot(from, unit(geometry.normal)))
  };
}
function newest(frame, state2, pane, middle2) {
  const { geometry, width, height } = frame;
  const { right, down, range } = geometry;
  const normal = unit(geometry.normal);
  if (dot(normal, normalOf(state2, pane)) < 1 - 1e-9) return frame;
  const pixel = geometry.pixel * geometry.zoom / state2.view.slices.zoom;
  const along = Math.min(Math.max(dot(state2.view.slices.crosshair, normal), range[0]), range[1]);
  const column = dot(middle2, right) - (width - 1) / 2 * pixel;
  const row = dot(middle2, down) - (height - 1) / 2 * pixel;
  const origin = add(add(scaled(right, column), scaled(down, row)), scaled(normal, along));
  return { ...frame, geometry: { ...geometry, origin, pixel, zoom: state2.view.slices.zoom, position: along } };
}
function transformOf(from, to) {
  const scale = from.geometry.pixel / to.geometry.pixel;
  const { x: x2, y: y3 } = placeOf(to, worldAt(from, 0, 0));
  const isSame = Math.abs(scale - 1) < 1e-6 && Math.hypot(x2, y3) < 0.01;
  return isSame ? "" : `matrix(${scale}, 0, 0, ${scale}, ${x2}, ${y3})`;
}
function lineOf(frame, other) {
  const along = cross(frame.geometry.normal, other);
  if (length(along) < 1e-6) return null;
  const [dx, dy] = [dot(along, frame.geometry.right), dot(along, frame.geometry.down)];
  const norm = Math.hypot(dx, dy);
  return norm < 1e-9 ? null : { dx: dx / norm, dy: dy / norm };
}
function tilted(frame, other, dx, dy) {
  const before2 = lineOf(frame, other);
  if (before2 === null || dx === 0 && dy === 0) return other;
  const { right, down, normal } = frame.geometry;
  let angle = Math.atan2(dy, dx) - Math.atan2(before2.dy, before2.dx);
  if (angle > Math.PI / 2) angle -= Math.PI;
  if (angle < -Math.PI / 2) angle += Math.PI;
  const axis = unit(cross(right, down));
  const sign = Math.sign(dot(axis, normal)) || 1;
  return unit(turnedAbout(other, scaled(normal, sign), angle * (Math.sign(dot(axis, scaled(normal, sign))) || 1)));
}
function stepped(state2, pane, distance2, range) {
  const normal = normalOf(state2, pane);
  const { crosshair } = state2.view.slices;
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
  const best = shares.reduce((a3, b) => b.share > a3.share ? b : a3);
  return best.size * best.share;
}
function barLength(longest) {
  const power = 10 ** Math.floor(Math.log10(longest));
  const lead = longest / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}
var othersOf = (pane) => PANES.filter((one) => one !== pane);
function angleDeg(points) {
  const [a3, b, c3] = points;
  const [from, to] = [sub(a3, b), sub(c3, b)];
  const cos = dot(from, to) / (length(from) * length(to));
  return Math.acos(Math.min(1, Math.max(-1, cos))) * 180 / Math.PI;
}
var distance = (points) => length(sub(points[1], points[0]));
function areaOf(points) {
  const first = points[0];
  const sum = points.reduce(
    (total, point2, n2) => add(total, cross(sub(point2, first), sub(points[(n2 + 1) % points.length], first))),
    [0, 0, 0]
  );
  return length(sum) / 2;
}

// src/view/slices/measure_csv.ts
function measuresCsv(measures, facts2, unit2, valueUnit) {
  const rows = measures.map((measure, n2) => {
    const { kind: kind2, points } = measure;
    const [value, of] = kind2 === "area" ? [areaOf(points), `${unit2}²`] : kind2 === "angle" ? [angleDeg(points), "degree"] : [distance(points), unit2];
    const region = facts2[n2] ?? null;
    const values = region === null ? ["", "", "", "", ""] : [region.mean, region.sd, region.min, region.max, valueUnit];
    return [n2 + 1, kind2, value, of, ...values, points.map((point2) => point2.join(" ")).join("; ")];
  });
  return csv(["number", "kind", "value", "unit", "mean", "sd", "min", "max", "value unit", "points (x y z)"], rows);
}
function labelsCsv(labels, unit2, valueUnit) {
  const header = ["number", "name", "voxels", `volume (${unit2}³)`, ...["mean", "sd", "min", "max"].map((name) => `${name} (${valueUnit || "value"})`)];
  return csv(header, labels.map(({ number: number2, name, n_voxels, volume: volume2, mean, sd, min, max }) => [number2, name, n_voxels, volume2, mean, sd, min, max]));
}
function csv(header, rows) {
  return [header, ...rows].map((row) => row.map(cell).join(",")).join("\r\n");
}
function cell(value) {
  if (value === null) return "";
  if (typeof value === "number") return String(value);
  const text2 = /^[=+\-@]/.test(value) ? `'${value}` : value;
  return /[",\r\n]/.test(text2) ? `"${text2.replaceAll('"', '""')}"` : text2;
}

// src/view/label_statistics.tsx
var MM3_PER_ML = 1e3;
function LabelStatistics({ engine, ui, welcome }) {
  const [labels, setLabels] = d2(null);
  const [isAsked, setAsked] = d2(false);
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const valueUnit = welcome.volumes[0]?.value_unit ?? "";
  const ask = async () => {
    setAsked(true);
    try {
      setLabels((await engine.ask("label_statistics", {})).labels);
    } catch (problem) {
      ui.problem(problem);
    }
    setAsked(false);
  };
  const volumeOf = (volume2) => unit2 === "mm" ? `${shortNumber(volume2 / MM3_PER_ML, 4)} ml` : `${shortNumber(volume2, 4)} ${unit2}³`;
  const textOf = (value) => value === null ? "–" : shortNumber(value, 4);
  return /* @__PURE__ */ k("section", { class: "label-statistics" }, /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", disabled: isAsked, onClick: () => void ask() }, "Measure the labels"), labels !== null && /* @__PURE__ */ k("button", { class: "button", onClick: () => ui.download("labels.csv", labelsCsv(labels, unit2, valueUnit), "text/csv") }, "Save labels as CSV")), labels !== null && /* @__PURE__ */ k("table", null, /* @__PURE__ */ k("thead", null, /* @__PURE__ */ k("tr", null, ["Label", "Volume", `Mean ${valueUnit}`, "Min", "Max"].map((name) => /* @__PURE__ */ k("th", { key: name, scope: "col" }, name)))), /* @__PURE__ */ k("tbody", null, labels.map(({ number: number2, name, volume: volume2, mean, min, max }) => /* @__PURE__ */ k("tr", { key: number2 }, /* @__PURE__ */ k("th", { scope: "row" }, name), /* @__PURE__ */ k("td", null, volumeOf(volume2)), /* @__PURE__ */ k("td", null, textOf(mean)), /* @__PURE__ */ k("td", null, textOf(min)), /* @__PURE__ */ k("td", null, textOf(max)))))));
}

// src/view/slices/drawing.ts
var POINT_PX = 3;
function useDrawing(props) {
  const { ui, store } = props;
  const [to, setTo] = d2(null);
  const [outline2, setOutline] = d2([]);
  const line = T2({ points: [], x: 0, y: 0 });
  const drawRegion = (on, { phase, x: x2, y: y3 }) => {
    const now = line.current;
    if (phase === "start") now.points = [];
    if (phase === "start" || Math.hypot(x2 - now.x, y3 - now.y) >= POINT_PX) {
      now.points.push(worldAt(on, x2, y3));
      [now.x, now.y] = [x2, y3];
      setOutline([...now.points]);
    }
    if (phase !== "end") return;
    addRegion(props, now.points);
    now.points = [];
    setOutline([]);
  };
  return {
    drawing: { to: ui.points.length > 0 ? to : null, outline: outline2 },
    // Read when it is asked for: the tool may have been chosen since this was drawn.
    get isOn() {
      return ui.tool === "distance" || ui.tool === "angle" || ui.tool === "area";
    },
    onTap(on, x2, y3, isDouble) {
      if (ui.tool === "area" && isDouble) {
        closeRegion(props);
        return;
      }
      ui.addPoint(worldAt(on, x2, y3));
      setTo(null);
    },
    onDrag(on, gesture) {
      if (ui.tool === "area") {
        drawRegion(on, gesture);
        return;
      }
      const point2 = worldAt(on, gesture.x, gesture.y);
      if (gesture.phase === "start" ? ui.points.length === 0 : gesture.phase === "end") ui.addPoint(point2);
      setTo(gesture.phase === "end" ? null : point2);
      if (gesture.phase === "end") store.settle();
    },
    onHover(on, place) {
      if (ui.points.length > 0 || to !== null) setTo(on === null || place === null ? null : worldAt(on, place.x, place.y));
    }
  };
}
function closeRegion(props) {
  const { ui } = props;
  addRegion(props, ui.points);
  ui.setTool(ui.tool);
}
function addRegion({ store, ui }, points) {
  const kept = thinned(points, MAX_REGION_POINTS);
  if (kept.length < 3) {
    ui.announce("A region needs three points or more");
    return;
  }
  store.change([set({ kind: "area", points: kept }, "view", "measures", "-")]);
}
function thinned(points, most) {
  if (points.length <= most) return points;
  return Array.from({ length: most }, (_3, n2) => points[Math.floor(n2 * points.length / most)]);
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
var holders = /* @__PURE__ */ new WeakMap();
function holding(onGesture) {
  return (element) => {
    if (element !== null) holders.set(element, { element, onGesture });
  };
}
function heldAt(event) {
  return event.composedPath().flatMap((one) => holders.get(one) ?? [])[0];
}
function Handle2(props) {
  const { label, text: text2, value, range, x: x2, y: y3, color: color2, round, onDrag, onKey, onEnd, onDouble } = props;
  const onGesture = (gesture) => {
    if (gesture.kind === "tap") {
      if (gesture.double) onDouble?.();
    } else if (gesture.phase === "end") onEnd();
    else if (gesture.kind === "drag" && gesture.phase === "move") onDrag(gesture.x, gesture.y, gesture.dx, gesture.dy);
    return true;
  };
  return /* @__PURE__ */ k(
    "g",
    {
      ref: holding(onGesture),
      "data-handle": true,
      role: "slider",
      tabindex: 0,
      "aria-label": label,
      "aria-valuenow": Number(value.toFixed(3)),
      "aria-valuemin": Number(range[0].toFixed(3)),
      "aria-valuemax": Number(range[1].toFixed(3)),
      "aria-valuetext": text2,
      transform: `translate(${x2} ${y3})`,
      onKeyDown: onKey,
      onKeyUp: onEnd
    },
    /* @__PURE__ */ k("circle", { r: "13", fill: "transparent", stroke: "none" }),
    round ? /* @__PURE__ */ k("circle", { r: "5", fill: "#000", stroke: color2, "stroke-width": "2" }) : /* @__PURE__ */ k("rect", { x: "-5", y: "-5", width: "10", height: "10", fill: color2, stroke: "#000", "stroke-width": "1" })
  );
}

// src/view/slices/region_text.tsx
var known = /* @__PURE__ */ new WeakMap();
function regionFacts({ engine, store }, { points }) {
  const time = store.state.layers[0]?.time ?? 0;
  const times = known.get(points) ?? /* @__PURE__ */ new Map();
  known.set(points, times);
  const found2 = times.get(time) ?? engine.ask("region", { points }).then(({ layers }) => layers[0] ?? null, () => null);
  times.set(time, found2);
  return found2;
}
function textOfRegion({ mean, sd }, unit2) {
  return `mean ${shortNumber(mean, 4)} ± ${shortNumber(sd, 3)} ${unit2}`.trim();
}
var SETTLED_MS = 150;
function useRegionFacts(props, measure) {
  const { points } = measure;
  const time = props.store.state.layers[0]?.time ?? 0;
  const [facts2, setFacts] = d2(null);
  A2(() => {
    let isGone = false;
    const timer = setTimeout(() => {
      void regionFacts(props, measure).then((found2) => !isGone && setFacts({ points, time, facts: found2 }));
    }, SETTLED_MS);
    return () => {
      isGone = true;
      clearTimeout(timer);
    };
  }, [points, time]);
  return facts2?.points === points && facts2.time === time ? facts2.facts : null;
}
function RegionText(props) {
  const facts2 = useRegionFacts(props, props.measure);
  if (facts2 === null) return null;
  return /* @__PURE__ */ k("text", { x: props.x, y: props.y }, textOfRegion(facts2, props.welcome.volumes[0]?.value_unit ?? ""));
}

// src/view/slices/measures.tsx
var COLOR = "#7df0ff";
var FILL = "#7df0ff22";
function measured(measure, unit2) {
  if (measure.kind === "area") return `${shortNumber(areaOf(measure.points), 4)} ${unit2}²`;
  return measure.kind === "distance" ? `${shortNumber(distance(measure.points), 4)} ${unit2}` : `${angleDeg(measure.points).toFixed(1)}°`;
}
function Drawn(props) {
  const { store, welcome, placed: placed2, moved, isNear } = props;
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  return /* @__PURE__ */ k("g", null, store.state.view.measures.map((measure, n2) => {
    const places = measure.points.map(placed2);
    if (!isNear(measure.points) || places.some((place) => place === null)) return null;
    const points = places;
    const middle2 = points[measure.kind === "angle" ? 1 : 0];
    const text2 = measured(measure, unit2);
    const isRegion = measure.kind === "area";
    return /* @__PURE__ */ k("g", { key: n2 }, /* @__PURE__ */ k("path", { d: pathOf2(points, isRegion), fill: isRegion ? FILL : "none", stroke: COLOR, "stroke-width": "1.5" }), /* @__PURE__ */ k("text", { x: middle2.x + 10, y: middle2.y - 8 }, text2), isRegion && /* @__PURE__ */ k(RegionText, { ...props, measure, x: middle2.x + 10, y: middle2.y + 8 }), points.slice(0, isRegion ? 1 : void 0).map(({ x: x2, y: y3 }, k3) => {
      const pointsNow = () => store.state.view.measures[n2]?.points ?? measure.points;
      const now = () => pointsNow()[k3];
      const change = (to, gesture) => {
        const way = sub(to, now());
        const next = pointsNow().map((point2, p3) => isRegion || p3 === k3 ? add(point2, way) : point2);
        store.change([set(next, "view", "measures", n2, "points")], gesture);
      };
      return /* @__PURE__ */ k(
        Handle2,
        {
          key: k3,
          round: true,
          label: `Measure ${n2 + 1}, point ${k3 + 1}`,
          text: text2,
          value: k3,
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
        }
      );
    }));
  }), /* @__PURE__ */ k(Pending, { ...props }));
}
var pathOf2 = (places, isClosed) => `M${places.map(({ x: x2, y: y3 }) => `${x2} ${y3}`).join("L")}${isClosed ? "Z" : ""}`;
function Pending(props) {
  const { ui, welcome, placed: placed2, drawing } = props;
  const points = [...ui.points, ...drawing?.to ? [drawing.to] : []];
  const places = (drawing !== void 0 && drawing.outline.length > 0 ? drawing.outline : points).map(placed2);
  if (places.length === 0 || places.some((place) => place === null)) return null;
  const known2 = places;
  const last = known2.at(-1);
  const kind2 = ui.tool === "angle" && points.length > 2 ? "angle" : "distance";
  const text2 = ui.tool !== "area" && points.length > 1 ? measured({ kind: kind2, points }, welcome.volumes[0]?.unit ?? "units") : "";
  return /* @__PURE__ */ k("g", { class: "pending" }, /* @__PURE__ */ k("path", { d: pathOf2(known2, false), fill: "none", stroke: COLOR, "stroke-width": "1.5", "stroke-dasharray": "5 3" }), known2.slice(0, ui.points.length).map(({ x: x2, y: y3 }, k3) => /* @__PURE__ */ k("circle", { key: k3, cx: x2, cy: y3, r: "4", fill: COLOR, stroke: "#000" })), text2 !== "" && /* @__PURE__ */ k("text", { x: last.x + 12, y: last.y - 10 }, text2));
}
function MeasuresOnSlice(props) {
  const { on, store } = props;
  const thickness = Math.max(store.state.view.slices.thickness / 2, on.geometry.pixel * 1.5);
  return /* @__PURE__ */ k(
    Drawn,
    {
      ...props,
      placed: (point2) => placeOf(on, point2),
      moved: (point2, dx, dy) => {
        const { x: x2, y: y3 } = placeOf(on, point2);
        return add(point2, sub(worldAt(on, x2 + dx, y3 + dy), worldAt(on, x2, y3)));
      },
      isNear: (points) => points.every((point2) => placeOf(on, point2).away <= thickness)
    }
  );
}
function Measures3d(props) {
  const { camera, size } = props;
  return /* @__PURE__ */ k(
    Drawn,
    {
      ...props,
      placed: (point2) => project(camera, size, point2),
      moved: (point2, dx, dy) => add(point2, inPicture(camera, size, point2, dx, dy)),
      isNear: () => true
    }
  );
}
var isMeasure = (points) => points.every((point2, n2) => n2 === 0 || length(sub(point2, scaled(points[n2 - 1], 1))) > 0);

// src/view/measure_panel.tsx
var TOOLS = [
  ["distance", "Distance", "Drag from one end to the other, or click both."],
  ["angle", "Angle", "Click a point on each leg and the corner between them, in their order."],
  ["area", "Region", "Draw around it on a slice, or click its corners and close it by a double click."]
];
function MeasurePanel(props) {
  const { store, welcome, ui } = props;
  const { measures } = store.state.view;
  const tool = TOOLS.find(([name]) => name === ui.tool);
  const save = async () => {
    const facts2 = await Promise.all(measures.map((one) => one.kind === "area" ? regionFacts(props, one) : null));
    const { unit: unit2, value_unit } = welcome.volumes[0] ?? { unit: null, value_unit: "" };
    ui.download("measures.csv", measuresCsv(measures, facts2, unit2 ?? "units", value_unit), "text/csv");
  };
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("div", { class: "row" }, TOOLS.map(([name, text2]) => /* @__PURE__ */ k("button", { key: name, class: "button", "aria-pressed": ui.tool === name, onClick: () => ui.setTool(ui.tool === name ? "turn" : name) }, text2)), /* @__PURE__ */ k("button", { class: "button", onClick: () => ui.addPoint(store.state.view.slices.crosshair), disabled: tool === void 0 }, "Point at the crosshair"), ui.tool === "area" && ui.points.length > 2 && /* @__PURE__ */ k("button", { class: "button", onClick: () => closeRegion(props) }, "Close the region")), ui.points.length > 0 && /* @__PURE__ */ k("p", { class: "dim" }, pointsSoFar(ui.tool, ui.points.length)), (tool !== void 0 || measures.length === 0) && /* @__PURE__ */ k("p", { class: "dim" }, tool?.[2] ?? "Choose one, then draw it in a view."), measures.length > 0 && /* @__PURE__ */ k("ol", null, measures.map((one, n2) => /* @__PURE__ */ k(Row, { key: n2, ...props, measure: one, number: n2 }))), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", disabled: measures.length === 0, onClick: () => store.change([set([], "view", "measures")]) }, "Delete all"), /* @__PURE__ */ k("button", { class: "button", disabled: measures.length === 0, onClick: () => void save() }, "Save as CSV")), store.state.labels !== null && /* @__PURE__ */ k(LabelStatistics, { ...props }));
}
function pointsSoFar(tool, n2) {
  return tool === "area" ? `${n2} corners` : `${n2} of ${tool === "angle" ? 3 : 2} points`;
}
function Row(props) {
  const { store, welcome, measure, number: number2 } = props;
  const { unit: unit2, value_unit } = welcome.volumes[0] ?? { unit: null, value_unit: "" };
  return /* @__PURE__ */ k("li", null, /* @__PURE__ */ k("span", { class: "row" }, measured(measure, unit2 ?? "units"), /* @__PURE__ */ k(
    "button",
    {
      class: "icon-button",
      "aria-label": `Delete measure ${number2 + 1}`,
      onClick: () => store.change([{ op: "remove", path: `/view/measures/${number2}` }])
    },
    "×"
  )), measure.kind === "area" ? /* @__PURE__ */ k(RegionValues, { ...props, valueUnit: value_unit }) : /* @__PURE__ */ k("span", { class: "dim" }, measure.points.map((point2) => placeText(point2, welcome)).join(" – ")));
}
function RegionValues(props) {
  const facts2 = useRegionFacts(props, props.measure);
  if (facts2 === null) return null;
  return /* @__PURE__ */ k("span", { class: "dim" }, `${textOfRegion(facts2, props.valueUnit)}, ${facts2.min.toPrecision(4)} to ${facts2.max.toPrecision(4)}`);
}

// src/view/memo.tsx
var Memo = class extends x {
  shouldComponentUpdate(next) {
    return next.of.length !== this.props.of.length || next.of.some((value, n2) => !Object.is(value, this.props.of[n2]));
  }
  render() {
    return this.props.children();
  }
};
function shownByPanels({ store, ui, welcome }) {
  const { layers, labels, shading: shading2, clip: clip2, background, geometry, render: render2, view, camera } = store.state;
  const windows = PANES.map((pane) => ui.frames[pane]?.slice?.window?.join());
  const lens = camera.view_angle;
  return [layers, labels, shading2, clip2, background, geometry, render2, view, lens, ui.restCamera, ...windows, ui.layer, ui.tool, ui.points, welcome];
}
function shownBySlices({ store, ui, welcome }) {
  const { layers, labels, clip: clip2, view } = store.state;
  return [layers, labels, clip2, view, ...PANES.map((pane) => ui.frames[pane]), ui.layer, ui.tool, ui.points, welcome];
}
function shownByToolbar({ store, ui, welcome }) {
  const { layers, view } = store.state;
  return [layers, view.layout, view.interface, ui.tool, store.canUndo, store.canRedo, welcome];
}

// src/view/share.tsx
var SIZES = [
  ["view", "As in the window"],
  ["2", "Twice as large"],
  ["1920x1080", "1920 x 1080"],
  ["3840x2160", "3840 x 2160"],
  ["own", "Own size"]
];
var MAX_SIDE = 8192;
function SharePanel(props) {
  const { store, engine, welcome, ui } = props;
  const [size, setSize] = d2("view");
  const [own, setOwn] = d2([1600, 1200]);
  const [quality, setQuality] = d2("high");
  const [transparent, setTransparent] = d2(false);
  const [annotated, setAnnotated] = d2(false);
  const [part, setPart] = d2(null);
  const [abort, setAbort] = d2(null);
  const [text2, setText] = d2("");
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
    return { width: Math.min(factor * w3, MAX_SIDE), height: Math.min(factor * h3, MAX_SIDE) };
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
      const found2 = await engine.ask("code", { as, ...pixels() });
      await use(found2.text, found2.name);
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
      ui.announce(`${name} is in the field below`);
    }
  };
  const link = async () => {
    const found2 = await linkPart(store.state, welcome.fingerprint);
    if (found2 === null) {
      ui.problem({ code: "link", message: "The state is too long for a link", remedy: "Save it as a file instead." });
      return;
    }
    await copy(`${location.origin}${location.pathname}#state=${found2}`, "The link");
  };
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(Choice, { label: "Size", value: size, options: SIZES, onChoose: setSize }), size === "own" && /* @__PURE__ */ k("div", { class: "row" }, ["Width", "Height"].map((name, n2) => /* @__PURE__ */ k("label", { key: name, class: "row" }, name, /* @__PURE__ */ k(
    "input",
    {
      type: "number",
      min: 1,
      max: MAX_SIDE,
      value: own[n2],
      onChange: (event) => {
        const value = Math.min(Math.max(Math.round(event.currentTarget.valueAsNumber || 1), 1), MAX_SIDE);
        setOwn(n2 === 0 ? [value, own[1]] : [own[0], value]);
      }
    }
  )))), /* @__PURE__ */ k(Choice, { label: "Quality", value: quality, options: QUALITIES.slice(1).map((name) => [name, name]), onChoose: setQuality }), /* @__PURE__ */ k(Switch, { label: "Transparent background", on: transparent, onToggle: setTransparent }), /* @__PURE__ */ k(Switch, { label: "With scale bar and legend", on: annotated, onToggle: setAnnotated }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", disabled: part !== null, onClick: () => void picture((bytes) => ui.download("picture.png", bytes, "image/png")) }, "Save picture"), /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      disabled: part !== null,
      onClick: () => void picture(async (bytes) => {
        if (typeof ClipboardItem === "undefined") throw new Error("This browser cannot copy pictures; save it instead");
        await navigator.clipboard.write([new ClipboardItem({ "image/png": new Blob([bytes], { type: "image/png" }) })]);
        ui.announce("The picture is copied");
      })
    },
    "Copy picture"
  ), abort !== null && /* @__PURE__ */ k("button", { class: "button", onClick: () => abort.abort() }, "Cancel")), part !== null && /* @__PURE__ */ k("progress", { "aria-label": "Drawing the picture", max: 1, value: part }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("python", (found2) => copy(found2, "The Python program")) }, "Copy as Python"), /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("command", (found2) => copy(found2, "The command")) }, "Copy as command"), ui.host === "page" && /* @__PURE__ */ k("button", { class: "button", onClick: () => void link() }, "Copy link")), text2 !== "" && /* @__PURE__ */ k("textarea", { "aria-label": "What was copied", readOnly: true, rows: 5, value: text2, onFocus: (event) => event.currentTarget.select() }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("state", (found2, name) => ui.download(name, found2, "application/json")) }, "Save state"), /* @__PURE__ */ k("label", { class: "button" }, "Open state", /* @__PURE__ */ k(
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
  )), /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("html", (found2, name) => ui.download(name, found2, "text/html")) }, "Save page (HTML)")));
}
async function openState({ engine, store, ui }, file) {
  try {
    const { state: state2 } = await engine.ask("open_state", { text: await file.text() });
    store.change([{ op: "replace", path: "", value: state2 }]);
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

// src/view/sheet.tsx
var TEXT23 = WORDS.panels;
var PANELS = ["presets", "function", "layers", "labels", "light", "cut", "slices", "measure", "share", "settings"];
var OTHERS = ["about", "looks"];
function openSheet(panels) {
  const last = panels.filter((name) => name !== "presets").at(-1);
  return [...PANELS, ...OTHERS].filter((name) => name !== "presets").find((name) => name === last) ?? null;
}
function toggled(panels, name) {
  const isStrip = panels.includes("presets");
  const sheet = openSheet(panels);
  if (name === "presets") return [...isStrip ? [] : ["presets"], ...sheet === null ? [] : [sheet]];
  return [...isStrip ? ["presets"] : [], ...sheet === name ? [] : [name]];
}
function Rail({ panels, open, onPanel, children }) {
  return /* @__PURE__ */ k("nav", { class: "rail float", "aria-label": TEXT23.title }, panels.map((name) => /* @__PURE__ */ k(
    "button",
    {
      key: name,
      class: "rail-button",
      "data-opens": name,
      "aria-expanded": open.includes(name),
      title: WORDS.sheets[name],
      onClick: () => onPanel(name)
    },
    /* @__PURE__ */ k(Icon, { name }),
    /* @__PURE__ */ k("span", null, TEXT23[name])
  )), /* @__PURE__ */ k("span", { class: "spring" }), children);
}
function Sheet({ name, onClose, children }) {
  const title = WORDS.sheets[name];
  const close = (event) => {
    const root = event.currentTarget.getRootNode();
    onClose();
    root.querySelector(`[data-opens="${name}"]`)?.focus();
  };
  return /* @__PURE__ */ k(
    "section",
    {
      class: "sheet float",
      "data-panel": name,
      "aria-label": title,
      onKeyDown: (event) => {
        if (event.key !== "Escape" || event.defaultPrevented) return;
        event.preventDefault();
        event.stopPropagation();
        close(event);
      }
    },
    /* @__PURE__ */ k("header", { class: "sheet-head" }, /* @__PURE__ */ k("h2", null, title), /* @__PURE__ */ k("button", { class: "icon-button", "aria-label": TEXT23.close(title), onClick: close }, /* @__PURE__ */ k(Icon, { name: "close" }))),
    /* @__PURE__ */ k("div", { class: "body", tabIndex: -1 }, children)
  );
}

// src/view/commands.ts
var TEXT24 = WORDS.palette;
var LAYOUTS = ["3d", "one-and-three", "two-by-two", "single"];
var THEMES = ["dark", "light", "system"];
function commandsOf(part) {
  const { store, ui, welcome } = part;
  const view = store.state.view;
  return [
    ...KEYS.map((key) => ({ text: key.text, hint: key.shown, run: () => press(ui.root, key) })),
    ...LAYOUTS.map((name) => ({
      text: WORDS.layouts[name],
      hint: TEXT24.layout,
      run: () => store.change([set({ name, main: name === "single" ? view.layout.main === "3d" ? "z" : view.layout.main : "3d" }, "view", "layout")])
    })),
    ...PANELS.map((name) => ({
      text: WORDS.sheets[name],
      hint: TEXT24.panel,
      run: () => store.change([set(toggled(view.interface.panels.filter((one) => one !== name), name), "view", "interface", "panels")])
    })),
    ...["auto", ...welcome.presets.map(({ name }) => name)].map((name) => ({
      text: titleOf(name) === name ? name : `${titleOf(name)} (${name})`,
      hint: TEXT24.look,
      run: () => void take2(part, name)
    })),
    ...Object.entries(welcome.window_names).map(([name, window2]) => ({
      text: name,
      hint: TEXT24.window,
      run: () => store.change([set(window2, "view", "slices", "window")])
    })),
    ...THEMES.map((name) => ({ text: WORDS.settings.themes[name], hint: TEXT24.theme, run: () => store.change([set(name, "view", "interface", "theme")]) })),
    ...labelCommands(part)
  ];
}
function found(commands, text2) {
  const words = text2.toLowerCase().split(/\s+/).filter((word) => word !== "");
  const start = text2.trim().toLowerCase();
  const hits = commands.filter(({ text: name, hint }) => words.every((word) => `${name} ${hint}`.toLowerCase().includes(word)));
  const begins = ({ text: name }) => name.toLowerCase().startsWith(start);
  return [...hits.filter(begins), ...hits.filter((one) => !begins(one))];
}
function labelCommands({ store }) {
  const rows = labelRows(store.state.labels?.labels ?? {});
  return rows.map(({ number: number2, name, isShown }) => ({
    text: isShown ? TEXT24.hide(name) : TEXT24.show(name),
    hint: TEXT24.label,
    run: () => {
      const now = new Map(rows.map((row) => [row.number, row.isShown]));
      const isOn = (other) => other === number2 ? !isShown : now.get(other) ?? false;
      store.change(shownLabels(store.state.labels?.labels ?? {}, isOn, hiddenOf(store)));
    }
  }));
}
async function take2({ store, engine, ui }, name) {
  try {
    const { look } = await engine.ask("preset", { layer: ui.layer, name });
    store.change(chosen(store.state, ui.layer, look));
  } catch (problem) {
    ui.problem(problemOf(problem));
  }
}
function press(root, { keys }) {
  const view = root.querySelector("[data-view]");
  const parts = (keys[0] ?? "").split("+");
  const key = parts.at(-1) === "" ? "+" : parts.at(-1) ?? "";
  const how = { key, ctrlKey: parts.includes("Ctrl"), shiftKey: parts.includes("Shift"), bubbles: true, composed: true, cancelable: true };
  view?.focus();
  view?.dispatchEvent(new KeyboardEvent("keydown", how));
  view?.dispatchEvent(new KeyboardEvent("keyup", how));
}

// src/view/palette.tsx
var TEXT25 = WORDS.palette;
var MAX_ROWS2 = 40;
function Palette({ onClose, ...part }) {
  const dialog = T2(null);
  const list2 = T2(null);
  const [text2, setText] = d2("");
  const [at2, setAt] = d2(0);
  A2(() => dialog.current?.showModal(), []);
  A2(() => {
    list2.current?.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
  }, [at2, text2]);
  const rows = found(commandsOf(part), text2).slice(0, MAX_ROWS2);
  const run = (index) => {
    const command = rows[index];
    if (command === void 0) return;
    dialog.current?.close();
    command.run();
  };
  const onKeyDown = (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step !== void 0) setAt((rows.length + at2 + step) % Math.max(1, rows.length));
    else if (event.key === "Enter") run(at2);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return /* @__PURE__ */ k("dialog", { ref: dialog, class: "palette", "aria-label": TEXT25.title, onClose, onClick: (event) => event.target === dialog.current && dialog.current?.close() }, /* @__PURE__ */ k(
    "input",
    {
      type: "text",
      role: "combobox",
      "aria-label": TEXT25.find,
      "aria-expanded": "true",
      "aria-controls": "palette-list",
      "aria-activedescendant": rows.length > 0 ? `palette-${at2}` : void 0,
      placeholder: TEXT25.find,
      autocomplete: "off",
      spellcheck: false,
      value: text2,
      onInput: (event) => {
        setText(event.currentTarget.value);
        setAt(0);
      },
      onKeyDown
    }
  ), /* @__PURE__ */ k("ul", { id: "palette-list", role: "listbox", "aria-label": TEXT25.title, ref: list2 }, rows.map(({ text: name, hint }, index) => /* @__PURE__ */ k("li", { key: `${name} ${hint}`, id: `palette-${index}`, role: "option", "aria-selected": index === at2, onClick: () => run(index) }, /* @__PURE__ */ k("span", null, name), /* @__PURE__ */ k("span", { class: "dim" }, hint)))), rows.length === 0 && /* @__PURE__ */ k("p", { class: "dim" }, TEXT25.none));
}

// src/input/turntable.ts
var END_ON = 1e-3;
var WORLD_AXES = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
function turnedUpright(camera, dx, dy, height, upright) {
  const radians = TURN_DEG * Math.PI / 180 / height;
  const { right, up, back } = axesOf(camera);
  const across = dot(up, upright);
  const azimuth = -dx * radians * (across < -END_ON ? -1 : 1);
  const elevation = Math.atan2(dot(back, upright), across);
  const most = Math.PI / 2;
  const wanted = elevation + dy * radians;
  const next = Math.abs(elevation) > most + END_ON ? wanted : Math.min(Math.max(wanted, -most), most);
  const about = (vector2) => turnedAbout(turnedAbout(vector2, right, elevation - next), upright, azimuth);
  return {
    ...camera,
    position: add(camera.focal_point, about(sub(camera.position, camera.focal_point))),
    view_up: about(up)
  };
}
function leveled(camera, upright) {
  const { up, back } = axesOf(camera);
  if (length(cross(upright, back)) > END_ON) return { ...camera, view_up: inPicture2(upright, back) };
  const flat = WORLD_AXES.filter((axis) => length(cross(axis, back)) > 0.5).map((axis) => inPicture2(axis, back));
  return { ...camera, view_up: flat.reduce((best, axis) => dot(axis, up) > dot(best, up) ? axis : best, flat[0]) };
}
var inPicture2 = (direction, back) => unit(sub(direction, scaled(back, dot(direction, back))));

// src/view/legend.tsx
var TEXT26 = WORDS.legend;
var MAX_ROWS3 = 12;
var ROW_PX = 24;
var ABOVE_PX = 112;
var ENDINGS = /\.(nii|nii\.gz|nrrd|nhdr|mha|mhd|tiff?|h5|hdf5|zarr|ome\.zarr|ome\.tiff?|vti|vtk|dcm)$/i;
function Legend(props) {
  const { store, height } = props;
  const rows = [...labelsOf(props), ...layersOf(props)];
  if (rows.length === 0) return null;
  const most = Math.max(1, Math.min(MAX_ROWS3, Math.floor((height / 2 - ABOVE_PX) / ROW_PX)));
  const shown = rows.slice(0, most);
  const more = rows.length - shown.length;
  return /* @__PURE__ */ k("ul", { class: "corner legend", "aria-label": TEXT26.title, onPointerDown: (event) => event.stopPropagation() }, shown.map(({ key, name, isShown, chip, toggle }) => /* @__PURE__ */ k("li", { key }, /* @__PURE__ */ k("button", { class: "legend-row", "aria-pressed": isShown, title: isShown ? TEXT26.hide(name) : TEXT26.show(name), onClick: toggle }, chip, /* @__PURE__ */ k("span", null, name)))), more > 0 && /* @__PURE__ */ k("li", null, /* @__PURE__ */ k("button", { class: "legend-row", onClick: () => store.change([set(["labels"], "view", "interface", "panels")]) }, /* @__PURE__ */ k("span", null, TEXT26.more(more)))));
}
function labelsOf({ store }) {
  const labels = store.state.labels?.labels ?? {};
  return labelRows(labels).map(({ number: number2, name, look, isShown }) => ({
    key: `label ${number2}`,
    name,
    isShown,
    chip: /* @__PURE__ */ k("span", { class: "chip", style: { background: hexColor(look.color, namedColor) } }),
    toggle: () => {
      const shownNow = new Map(labelRows(store.state.labels?.labels ?? {}).map((row) => [row.number, row.isShown]));
      store.change(shownLabels(store.state.labels?.labels ?? {}, (other) => other === number2 ? !isShown : shownNow.get(other) ?? false, hiddenOf(store)));
    }
  }));
}
function layersOf({ store }) {
  const { layers, render: render2 } = store.state;
  if (layers.length < 2 || compositeName(render2.composite) === "first-hit") return [];
  return layers.map((layer, index) => ({
    key: `layer ${index}`,
    name: layer.name.replace(ENDINGS, ""),
    isShown: layer.visible,
    chip: /* @__PURE__ */ k(Ramp, { layer }),
    toggle: () => store.change([set(!layer.visible, "layers", index, "visible")])
  }));
}

// src/view/overlay3d/box_handles.tsx
var NAMES2 = ["x", "y", "z"];
var UNITS = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
function BoxHandles(props) {
  const { store, welcome, kind: kind2, place, box: box2, camera, size } = props;
  const color2 = kind2 === "keep" ? "#ffd166" : "#ff8fb1";
  const what = kind2 === "keep" ? "Crop" : "Cut-out";
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const change = (next, gesture) => store.change([set({ [kind2]: next }, "clip", place)], gesture);
  const now = () => {
    const clip2 = store.state.clip[place];
    return clip2?.[kind2] ?? box2;
  };
  const points = corners(box2).map((corner) => project(camera, size, corner));
  const middle2 = project(camera, size, center(box2));
  const moveFace = (face, to, gesture) => change(withFace(now(), face, to, welcome.bounds, spacing[face.axis]), gesture);
  return /* @__PURE__ */ k("g", null, EDGES.map((edge) => {
    const [a3, b] = [points[edge.a], points[edge.b]];
    if (!a3 || !b) return null;
    const hidden = isHidden(box2, edge, camera);
    const line = `M${a3.x} ${a3.y}L${b.x} ${b.y}`;
    return /* @__PURE__ */ k("path", { key: `${edge.a}${edge.b}`, d: line, stroke: color2, "stroke-width": "1.3", opacity: hidden ? 0.3 : 0.95 });
  }), FACES.map((face) => {
    const at2 = project(camera, size, faceCenter(box2, face));
    if (at2 === null) return null;
    const value = box2[face.side][face.axis];
    const bounds = [welcome.bounds[0][face.axis], welcome.bounds[1][face.axis]];
    const name = `${what}, ${NAMES2[face.axis]} ${face.side === "lower" ? "from" : "to"}`;
    const keys = (event) => {
      const n2 = stepOf(event);
      const end = { Home: bounds[0], End: bounds[1] }[event.key];
      if (n2 === void 0 && end === void 0) return;
      take(event);
      moveFace(face, end ?? now()[face.side][face.axis] + (n2 ?? 0) * spacing[face.axis], "key face");
    };
    return /* @__PURE__ */ k("g", { key: name, opacity: isSeen(box2, face, camera) ? 1 : 0.5 }, /* @__PURE__ */ k(
      Handle2,
      {
        label: name,
        text: `${name} ${shortNumber(value, 4)}`,
        value,
        range: bounds,
        x: at2.x,
        y: at2.y,
        color: color2,
        onDrag: (_x, _y, dx, dy) => {
          const before2 = now();
          const axis = UNITS[face.axis];
          const way = alongAxis(camera, size, faceCenter(before2, face), axis, dx, dy);
          moveFace(face, before2[face.side][face.axis] + way, "face");
        },
        onKey: keys,
        onEnd: () => store.settle(),
        onDouble: () => moveFace(face, bounds[face.side === "lower" ? 0 : 1], "face")
      }
    ));
  }), middle2 !== null && /* @__PURE__ */ k(
    Handle2,
    {
      label: `${what} box`,
      text: `${what} box, middle`,
      value: 0,
      range: [0, 0],
      x: middle2.x,
      y: middle2.y,
      color: color2,
      round: true,
      onDrag: (_x, _y, dx, dy) => {
        const before2 = now();
        change(movedBy(before2, inPicture(camera, size, center(before2), dx, dy), welcome.bounds), "box");
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
  ));
}

// src/view/overlay3d/cube_places.ts
var BEVEL = 0.3;
var CUBE_PLACES = [-1, 0, 1].flatMap((x2) => [-1, 0, 1].flatMap((y3) => [-1, 0, 1].map((z3) => [x2, y3, z3]))).filter((direction) => direction.some((part) => part !== 0)).map((direction) => ({
  outward: unit(direction),
  ends: direction.flatMap((part, axis) => part === 0 ? [] : [2 * axis + (part > 0 ? 1 : 0)]),
  outline: outlineOf(direction)
}));
function outlineOf(direction) {
  const inner = 1 - BEVEL;
  const used = [0, 1, 2].filter((axis) => direction[axis] !== 0);
  const free = [0, 1, 2].filter((axis) => direction[axis] === 0);
  const point2 = (on, signs) => [0, 1, 2].map((axis) => {
    if (axis === on) return direction[axis] ?? 0;
    return inner * (direction[axis] || (signs[free.indexOf(axis)] ?? 0));
  });
  const [a3 = 0, b = 0] = used;
  if (used.length === 3) return used.map((axis) => point2(axis, []));
  if (used.length === 2) return [point2(a3, [1]), point2(b, [1]), point2(b, [-1]), point2(a3, [-1])];
  return [point2(a3, [1, 1]), point2(a3, [1, -1]), point2(a3, [-1, -1]), point2(a3, [-1, 1])];
}

// src/view/overlay3d/cube.tsx
var HALF = 27;
var MARGIN2 = 56;
var UNDER_TOOLBAR = 960;
var TOOLBAR = 44;
var LIGHT = unit([-0.35, 0.6, 0.8]);
var AMBIENT = 0.3;
var SEEN = 0.02;
var READABLE = 0.35;
var VIEWS = ["left", "right", "back", "front", "bottom", "top"];
function Cube(props) {
  const { camera, width, welcome } = props;
  const { right, up, back } = axesOf(camera);
  const flat = (point2) => `${(dot(point2, right) * HALF).toFixed(2)} ${(-dot(point2, up) * HALF).toFixed(2)}`;
  const top = MARGIN2 + (width < UNDER_TOOLBAR ? TOOLBAR : 0);
  return /* @__PURE__ */ k("g", { class: "cube", role: "group", "aria-label": "Orientation cube", transform: `translate(${width - MARGIN2} ${top})` }, CUBE_PLACES.map((place) => {
    const towards = dot(place.outward, back);
    if (towards < SEEN) return null;
    const lit = Math.max(0, dot(place.outward, right) * LIGHT[0] + dot(place.outward, up) * LIGHT[1] + towards * LIGHT[2]);
    const name = place.ends.map((end) => welcome.axis_ends[end] ?? "").join("");
    return /* @__PURE__ */ k(
      "g",
      {
        key: place.ends.join(),
        ref: holding((gesture) => {
          if (gesture.kind !== "tap") return void 0;
          lookFrom(props, place);
          return true;
        }),
        "data-handle": true,
        role: "button",
        tabindex: -1,
        "aria-label": `${name}, from the ${place.ends.map((end) => VIEWS[end]).join(", ")}`
      },
      /* @__PURE__ */ k("path", { d: `M${place.outline.map(flat).join("L")}Z`, style: { "--light": (AMBIENT + (1 - AMBIENT) * lit).toFixed(3) } }),
      place.ends.length === 1 && towards > READABLE && /* @__PURE__ */ k("text", { x: dot(place.outward, right) * HALF, y: -dot(place.outward, up) * HALF + 5, opacity: Math.min(1, (towards - READABLE) * 4) }, name)
    );
  }));
}
function lookFrom(props, { ends, outward }) {
  const { store, welcome } = props;
  const [end] = ends;
  const standard = ends.length === 1 && end !== void 0 ? welcome.standard_views[VIEWS[end] ?? ""] : void 0;
  const now = store.state.camera;
  const { up } = axesOf(now);
  const across = Math.abs(dot(up, outward)) < 0.9 ? up : axesOf(now).right;
  showFrom(props, standard ?? leveled(seenFrom(now, outward, across), welcome.upright));
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
  const number2 = store.state.clip.slice(0, place + 1).filter((clip2) => "plane" in clip2).length;
  const extent = length(sub(welcome.bounds[1], welcome.bounds[0]));
  const arm = ARM_PX * unitsPerPixel(camera, size.height, at2.depth);
  const now = () => store.state.clip[place]?.plane ?? plane;
  const change = (next, gesture) => store.change([set({ plane: next }, "clip", place)], gesture);
  const { right, up } = axesOf(camera);
  const first = unit(Math.abs(dot(up, normal)) < 0.99 ? sub(up, scaled(normal, dot(up, normal))) : sub(right, scaled(normal, dot(right, normal))));
  const second = cross(normal, first);
  const ends = [add(plane.point, scaled(first, arm)), add(plane.point, scaled(second, arm))];
  const square = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(
    ([a3, b]) => project(camera, size, add(plane.point, add(scaled(first, (a3 ?? 0) * arm), scaled(second, (b ?? 0) * arm))))
  );
  const tip = project(camera, size, add(plane.point, scaled(normal, arm * 0.6)));
  const slide = (way, gesture) => {
    const before2 = now();
    change({ ...before2, point: add(before2.point, scaled(unit(before2.normal), way)) }, gesture);
  };
  const tilt = (axis, angle, gesture) => {
    const before2 = now();
    change({ ...before2, normal: turnedAbout(unit(before2.normal), axis, angle) }, gesture);
  };
  return /* @__PURE__ */ k("g", { stroke: COLOR2, fill: "none" }, square.every((corner) => corner !== null) && /* @__PURE__ */ k("path", { d: `M${square.map((corner) => `${corner?.x} ${corner?.y}`).join("L")}Z`, "stroke-width": "1.3", fill: COLOR2, "fill-opacity": "0.08" }), tip !== null && /* @__PURE__ */ k("path", { d: `M${at2.x} ${at2.y}L${tip.x} ${tip.y}`, "stroke-width": "2" }), /* @__PURE__ */ k(
    Handle2,
    {
      label: `Clip plane ${number2}`,
      text: `Clip plane ${number2}, ${shortNumber(dot(plane.point, normal), 4)} along its normal`,
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
  ), ends.map((end, k3) => {
    const shown = project(camera, size, end);
    if (shown === null) return null;
    const axis = k3 === 0 ? second : first;
    return /* @__PURE__ */ k(
      Handle2,
      {
        key: k3,
        round: true,
        label: `Tilt clip plane ${number2}, ${k3 === 0 ? "forwards" : "sideways"}`,
        text: `Normal ${normal.map((one) => shortNumber(one, 2)).join(", ")}`,
        value: 0,
        range: [-180, 180],
        x: shown.x,
        y: shown.y,
        color: COLOR2,
        onDrag: (_x, _y, dx, dy) => {
          const way = alongAxis(camera, size, end, normal, dx, dy);
          tilt(axis, (k3 === 0 ? -1 : 1) * Math.atan2(way, arm), "tilt plane");
        },
        onKey: (event) => {
          const n2 = stepOf(event);
          if (n2 !== void 0) tilt(axis, n2 * STEP_DEG * Math.PI / 180, "key tilt plane");
        },
        onEnd: () => store.settle()
      }
    );
  }));
}

// src/view/overlay3d/scene_overlay.tsx
var DIRECTIONS = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
var NAMED2 = 0.5;
function SceneOverlay(props) {
  const { frame, size, store } = props;
  const { overlays } = store.state.view;
  const camera = frame.camera ?? store.state.camera;
  const clips = store.state.clip;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("svg", { class: "over" }, overlays.crosshair && /* @__PURE__ */ k(Crosshair, { ...props, camera }), overlays.crop_box && ["keep", "cut_out"].map((kind2) => {
    const place = placeOfBox(clips, kind2);
    const clip2 = clips[place];
    const box2 = clip2 === void 0 ? null : boxOf(clip2);
    return box2 === null ? null : /* @__PURE__ */ k(BoxHandles, { key: kind2, ...props, ...{ kind: kind2, place, box: box2, camera, size } });
  }), overlays.crop_box && clips.map(
    (clip2, place) => "plane" in clip2 ? /* @__PURE__ */ k(PlaneHandles, { key: place, ...props, ...{ place, plane: clip2.plane, camera, size } }) : null
  ), /* @__PURE__ */ k(Measures3d, { ...props, camera }), overlays.letters && /* @__PURE__ */ k(EdgeLetters, { ...props, camera }), overlays.scale_bar && /* @__PURE__ */ k(ScaleBar, { ...props, camera }), overlays.cube && /* @__PURE__ */ k("g", { class: "at-cube" }, /* @__PURE__ */ k(Cube, { ...props, camera, width: size.width }))), overlays.color_bar && /* @__PURE__ */ k(ColorBar, { ...props }), overlays.legend && /* @__PURE__ */ k(Legend, { ...props, height: size.height }));
}
function Crosshair({ store, welcome, camera, size }) {
  const { crosshair } = store.state.view.slices;
  if (store.state.view.layout.name === "3d") return null;
  const [lower, upper] = welcome.bounds;
  const colors = ["#6ba8ff", "#6bd46b", "#ff6b6b"];
  return /* @__PURE__ */ k("g", { "aria-hidden": "true", "stroke-width": "1.2", opacity: "0.8" }, [0, 1, 2].map((axis) => {
    const end = (from) => crosshair.map((value, a4) => a4 === axis ? from[a4] : value);
    const [a3, b] = [project(camera, size, end(lower)), project(camera, size, end(upper))];
    return a3 && b ? /* @__PURE__ */ k("path", { key: axis, d: `M${a3.x} ${a3.y}L${b.x} ${b.y}`, stroke: colors[axis] }) : null;
  }));
}
function edgeNames(camera, names) {
  const { right, up } = axesOf(camera);
  const name = (way) => {
    const shares = DIRECTIONS.map((direction, n2) => ({ n: n2, share: dot(direction, way) }));
    return shares.filter(({ share: share2 }) => share2 > NAMED2).sort((a3, b) => b.share - a3.share).map(({ n: n2 }) => names[n2] ?? "").slice(0, 2).join("");
  };
  return { left: name(scaled(right, -1)), right: name(right), top: name(up), bottom: name(scaled(up, -1)) };
}
function EdgeLetters({ welcome, camera, size }) {
  if (!welcome.volumes[0]?.is_anatomical) return null;
  const names = edgeNames(camera, welcome.axis_ends);
  return /* @__PURE__ */ k("g", { "aria-hidden": "true", "text-anchor": "middle" }, /* @__PURE__ */ k("text", { class: "at-left", x: 16, y: size.height / 2 }, names.left), /* @__PURE__ */ k("text", { x: size.width - 16, y: size.height / 2 }, names.right), /* @__PURE__ */ k("text", { class: "at-top", x: size.width / 2, y: 18 }, names.top), /* @__PURE__ */ k("text", { class: "at-bottom", x: size.width / 2, y: size.height - 8 }, names.bottom));
}
function ScaleBar({ welcome, camera, size }) {
  const perPixel = unitsPerPixel(camera, size.height);
  const bar = barLength(perPixel * size.width * 0.25);
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const where = camera.parallel_scale === void 0 ? " at the middle" : "";
  const [x2, y3] = [12, size.height - 14];
  return /* @__PURE__ */ k("g", { "aria-hidden": "true", class: "at-corner" }, /* @__PURE__ */ k("path", { d: `M${x2} ${y3}h${bar / perPixel}`, stroke: "#000", "stroke-width": "5" }), /* @__PURE__ */ k("path", { d: `M${x2} ${y3}h${bar / perPixel}`, stroke: "#fff", "stroke-width": "2.5" }), /* @__PURE__ */ k("text", { x: x2, y: y3 - 6 }, `${shortNumber(bar)} ${unit2}${where}`));
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
  return /* @__PURE__ */ k("div", { class: "corner right low color-bar", role: "img", "aria-label": `Colours from ${shortNumber(first[0])} to ${shortNumber(last[0])} ${info.value_unit}` }, /* @__PURE__ */ k("span", null, `${shortNumber(last[0])} ${info.value_unit}`), /* @__PURE__ */ k("span", { class: "ramp", style: { background: `linear-gradient(to top, ${stops.join(", ")})` } }), /* @__PURE__ */ k("span", null, shortNumber(first[0])));
}

// src/view/scene_ruler.tsx
function useRuler(props) {
  const { ui } = props;
  const [line, setLine] = d2(null);
  const now = T2(null);
  const show = (next) => {
    now.current = next;
    setLine(next);
  };
  const measure = async ({ x0, y0, x1, y1 }, size) => {
    const isBegun = ui.points.length > 0 || await pick(props, x0 / size.width, y0 / size.height, size);
    if (isBegun) await pick(props, x1 / size.width, y1 / size.height, size);
  };
  return {
    line,
    onDrag({ phase, x: x2, y: y3 }, size) {
      if (phase === "start") show({ x0: x2, y0: y3, x1: x2, y1: y3 });
      else if (now.current !== null && phase === "move") show({ ...now.current, x1: x2, y1: y3 });
      else if (now.current !== null) {
        const drawn2 = now.current;
        show(null);
        void measure(drawn2, size);
      }
    }
  };
}
function RulerLine({ line: { x0, y0, x1, y1 } }) {
  return /* @__PURE__ */ k("svg", { class: "over", "aria-hidden": "true" }, /* @__PURE__ */ k("path", { d: `M${x0} ${y0}L${x1} ${y1}`, stroke: "#000", "stroke-width": "3.5", opacity: "0.6" }), /* @__PURE__ */ k("path", { d: `M${x0} ${y0}L${x1} ${y1}`, stroke: "#7df0ff", "stroke-width": "1.5" }));
}

// src/view/slices/moves.ts
var MIN_ZOOM = 0.1;
var MAX_ZOOM = 100;
function centerOf(state2, welcome) {
  const { center: center2 } = state2.view.slices;
  if (center2 !== void 0) return center2;
  const [lower, upper] = welcome.volumes[0]?.bounds ?? welcome.bounds;
  return scaled(add(lower, upper), 0.5);
}
function zoomedAbout(state2, welcome, point2, factor) {
  const { zoom } = state2.view.slices;
  const next = Math.min(Math.max(zoom * factor, MIN_ZOOM), MAX_ZOOM);
  if (next === zoom) return [];
  const center2 = add(point2, scaled(sub(centerOf(state2, welcome), point2), zoom / next));
  return [set(next, "view", "slices", "zoom"), set(center2, "view", "slices", "center")];
}
function panned2(on, center2, dx, dy, welcome) {
  const [lower, upper] = welcome.volumes[0]?.bounds ?? welcome.bounds;
  const way = sub(worldAt(on, dx, dy), worldAt(on, 0, 0));
  const next = vec3((a3) => Math.min(Math.max(center2[a3] - way[a3], lower[a3]), upper[a3]));
  return [set(next, "view", "slices", "center")];
}
var vec3 = (of) => [of(0), of(1), of(2)];
function fitted(state2) {
  const ops = state2.view.slices.center === void 0 ? [] : [{ op: "remove", path: "/view/slices/center" }];
  return [set(1, "view", "slices", "zoom"), ...ops];
}
function crosshairAt(state2, point2) {
  const follows = state2.view.slices.zoom > 1 || state2.view.slices.center !== void 0;
  return [set(point2, "view", "slices", "crosshair"), ...follows ? [set(point2, "view", "slices", "center")] : []];
}
var TOLD_PX = 12;
var PINCHED = 0.12;
var TOUCH_STEP_PX = 14;
var TwoFingers = class {
  mode = "undecided";
  dx = 0;
  dy = 0;
  log = 0;
  steps = 0;
  /** Takes a movement; returns the number of slices to scroll by, or what to move and magnify by, or null for neither yet. */
  moved(dx, dy, factor) {
    this.dx += dx;
    this.dy += dy;
    this.log += Math.log(factor);
    if (this.mode === "move") return { dx, dy, factor };
    if (this.mode === "undecided") {
      const isPinch = Math.abs(this.log) > PINCHED;
      if (!isPinch && Math.hypot(this.dx, this.dy) < TOLD_PX) return null;
      this.mode = !isPinch && Math.abs(this.dy) > 2 * Math.abs(this.dx) ? "scroll" : "move";
      if (this.mode === "move") return { dx: this.dx, dy: this.dy, factor: Math.exp(this.log) };
    }
    const steps = Math.trunc(this.dy / TOUCH_STEP_PX);
    const more = steps - this.steps;
    this.steps = steps;
    return more === 0 ? null : { steps: more };
  }
  end() {
    this.mode = "undecided";
    this.dx = this.dy = this.log = this.steps = 0;
  }
};

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
  /** Whether a button or finger is down. */
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
    const before2 = this.pointers.get(event.pointerId);
    if (before2 === void 0) return;
    if (this.isPinching) {
      this.pinch(event, before2, { x: x2, y: y3 });
      return;
    }
    if (!this.isDragging && Math.hypot(x2 - this.begun.x, y3 - this.begun.y) < TAP_PX) return;
    const [dx, dy] = this.isDragging ? [x2 - before2.x, y3 - before2.y] : [x2 - this.begun.x, y3 - this.begun.y];
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
        this.emit({ kind: "pinch", phase: "end", x: 0, y: 0, dx: 0, dy: 0, factor: 1, angle: 0 }, event.timeStamp);
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
  pinch(event, before2, after) {
    const other = [...this.pointers].find(([id2]) => id2 !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, after);
    if (other === void 0) return;
    const [from, to] = [vector(other, before2), vector(other, after)];
    const lengths = [Math.hypot(from.x, from.y), Math.hypot(to.x, to.y)];
    const turn = Math.atan2(to.y, to.x) - Math.atan2(from.y, from.x);
    this.emit(
      {
        kind: "pinch",
        phase: "move",
        x: (after.x + other.x) / 2,
        y: (after.y + other.y) / 2,
        dx: (after.x - before2.x) / 2,
        dy: (after.y - before2.y) / 2,
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
  const box2 = T2(null);
  const canvas = T2(null);
  const [size, setSize] = d2({ width: 0, height: 0 });
  const [hint, setHint] = d2(false);
  const latest = T2(props);
  latest.current = props;
  const sizeNow = T2(size);
  sizeNow.current = size;
  const frame = ui.frames[view];
  useSize(box2, latest, setSize);
  useFrames(canvas, latest);
  F2(() => {
    const element = box2.current;
    if (element === null) return void 0;
    const noted2 = (at2, act) => {
      const before2 = store.seq;
      act();
      if (store.seq !== before2) ui.statistics.event(store.seq, at2);
    };
    let held;
    const gestures = new Gestures(
      (gesture, at2) => noted2(at2, () => held?.onGesture(gesture) ?? latest.current.onGesture(gesture, sizeNow.current))
    );
    const place = (event) => {
      const { left, top } = element.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    const down = (event) => {
      if (!gestures.isActive) held = event.button === 0 ? heldAt(event) : void 0;
      const focused = held !== void 0 && held.element.tabIndex >= 0 ? held.element : element;
      focused.focus({ preventScroll: true });
      ui.views.use(view);
      element.setPointerCapture(event.pointerId);
      gestures.down(event, ...place(event));
    };
    const move = (event) => {
      if (gestures.isActive) gestures.move(event, ...place(event));
      else if (heldAt(event) === void 0) {
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
      const [x2, y3] = place(event);
      const what = { factor: wheelFactor(deltaY, deltaMode), steps: wheelSteps(deltaY, deltaMode), ctrl: event.ctrlKey, x: x2, y: y3 };
      noted2(event.timeStamp, () => latest.current.onWheel(what, sizeNow.current));
    };
    const key = (event) => {
      const action = actionOf(keyName(event));
      if (action === void 0 || event.defaultPrevented) return;
      noted2(event.timeStamp, () => {
        if (latest.current.onAction(action, event.shiftKey, sizeNow.current)) {
          event.preventDefault();
          event.stopPropagation();
        }
      });
    };
    const focus = () => ui.views.use(view);
    const keyUp = () => store.settle();
    const menu = (event) => event.preventDefault();
    const stop = new AbortController();
    const listeners = {
      pointerdown: down,
      pointermove: move,
      pointerup: up,
      pointercancel: cancel,
      pointerleave: leave,
      wheel,
      keydown: key,
      focusin: focus,
      keyup: keyUp,
      contextmenu: menu
    };
    for (const [name, listener] of Object.entries(listeners)) {
      element.addEventListener(name, listener, { passive: false, signal: stop.signal });
    }
    const remove = ui.views.add(view, key);
    return () => {
      stop.abort();
      remove();
    };
  }, []);
  const moved = frame !== void 0 && transform !== void 0 && size.width > 0 ? transform(frame, size) : "";
  return /* @__PURE__ */ k(
    "div",
    {
      class: "viewport",
      ref: box2,
      tabIndex: 0,
      role: "group",
      "aria-label": view === "3d" ? "3-D picture" : `Slice, ${view}`,
      "data-view": view,
      "data-tool": ui.tool,
      onPointerDown: () => setHint(false)
    },
    /* @__PURE__ */ k("canvas", { ref: canvas, role: "img", "aria-label": label, style: { transform: moved } }),
    frame !== void 0 && size.width > 0 && children?.(frame, size),
    hint && /* @__PURE__ */ k("p", { class: "hint" }, "Click first, or hold Ctrl, to magnify with the wheel")
  );
}
function useSize(box2, latest, setSize) {
  F2(() => {
    const element = box2.current;
    if (element === null) return void 0;
    const { engine, view } = latest.current;
    let timer;
    let pixels = null;
    let isSeen2 = true;
    const ask = () => {
      const shown = isSeen2 && !document.hidden ? pixels : null;
      engine.show(view, shown);
      if (shown !== null) latest.current.onResize?.(shown);
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
  F2(() => {
    const { engine, view } = latest.current;
    let newest2 = null;
    let isDecoding = false;
    let isGone = false;
    const next = async () => {
      if (isDecoding) return;
      isDecoding = true;
      while (newest2 !== null && !isGone) {
        const frame = newest2;
        newest2 = null;
        try {
          if (frame.format === "values") {
            if (canvas.current !== null) await latest.current.onValues?.(frame, canvas.current);
            if (canvas.current !== null) noted(canvas.current, frame);
          } else {
            const picture = await decoded(frame);
            if (!isGone && canvas.current !== null) drawn(canvas.current, picture, frame);
            picture.close();
          }
          latest.current.ui.frameShown(frame);
        } catch (problem) {
          latest.current.ui.problem(problem);
        } finally {
          engine.shown(frame);
        }
      }
      isDecoding = false;
    };
    const stop = engine.onFrame((frame) => {
      if (frame.view !== view) return;
      if (newest2 !== null) engine.shown(newest2);
      newest2 = frame;
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
  noted(canvas, frame);
}
function noted(canvas, frame) {
  canvas.dataset["seq"] = String(frame.seq);
  canvas.dataset["atRest"] = String(frame.at_rest);
}

// src/view/scene_view.tsx
var KEY_PX = 24;
var KEY_ZOOM = 1.1;
var KEY_ROLL = Math.PI / 36;
var WHEEL_MS = 150;
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
  const move = (next, gesture) => {
    ui.camera.stop();
    store.change([set(next, "camera")], gesture);
  };
  const isFree = () => store.state.view.interface.turning === "trackball";
  const turned3 = (dx, dy, { height }) => isFree() ? turned2(camera(), dx, dy, height) : turnedUpright(camera(), dx, dy, height, welcome.upright);
  const ruler = useRuler(props);
  const onGesture = (gesture, size) => {
    if (gesture.kind === "drag" && gesture.what === "main" && isMeasuring(ui.tool)) {
      ruler.onDrag(gesture, size);
      return;
    }
    if (gesture.kind === "tap") {
      if (gesture.ctrl || ui.tool !== "turn") void pick(props, gesture.x / size.width, gesture.y / size.height, size);
      return;
    }
    if (gesture.phase === "end") {
      store.settle();
      return;
    }
    if (gesture.kind === "pinch") {
      const { x: x2, y: y3, dx: dx2, dy: dy2, factor, angle } = gesture;
      const moved = zoomedAt(panned(camera(), dx2, dy2, size.height), size, factor, x2, y3);
      move(isFree() ? rolled(moved, angle) : moved, "pinch");
      return;
    }
    if (gesture.phase === "start") return;
    const { what, dx, dy } = gesture;
    if (what === "window" || what === "main" && ui.tool === "window") windowDrag(props, dx, dy);
    else if (what === "pan") move(panned(camera(), dx, dy, size.height), "pan");
    else if (what === "zoom") move(zoomed2(camera(), Math.exp(-2 * dy / size.height)), "zoom");
    else if (what === "roll") move(rolled(camera(), Math.PI * dx / size.width), "roll");
    else move(turned3(dx, dy, size), "turn");
  };
  const onAction = (action, _shift, size) => {
    const pan = (dx, dy) => move(panned(camera(), dx, dy, size.height), "key pan");
    const turn = (dx, dy) => move(turned3(dx, dy, size), "key turn");
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
        move(zoomed2(camera(), KEY_ZOOM), "key zoom");
        return true;
      case "zoom-out":
        move(zoomed2(camera(), 1 / KEY_ZOOM), "key zoom");
        return true;
      case "roll-left":
        move(rolled(camera(), -KEY_ROLL), "key roll");
        return true;
      case "roll-right":
        move(rolled(camera(), KEY_ROLL), "key roll");
        return true;
      case "level":
        ui.camera.to(leveled(camera(), welcome.upright));
        return true;
      case "fit":
        fit(props);
        return true;
      case "first-view":
        void ui.camera.showFirst();
        return true;
      default:
        return false;
    }
  };
  return /* @__PURE__ */ k(
    Viewport,
    {
      ...props,
      view: "3d",
      label: sceneLabel(store.state),
      onGesture,
      onAction,
      onWheel: ({ factor, x: x2, y: y3 }, size) => {
        move(zoomedAt(camera(), size, factor, x2, y3), "wheel");
        settleSoon(store);
      },
      onResize: (size) => void ui.camera.resized(size),
      onHover: (place, size) => ui.probe(place && store.state.geometry.length > 0 ? () => shapeAt(props, place, size) : null),
      transform: (frame, size) => instant(frame, camera(), size)
    },
    (frame, size) => /* @__PURE__ */ k($, null, /* @__PURE__ */ k(SceneOverlay, { ...props, frame, size }), ruler.line !== null && /* @__PURE__ */ k(RulerLine, { line: ruler.line }))
  );
}
function fit({ store, ui }) {
  void ui.camera.show(store.state.camera);
}
function showFrom({ store, ui }, target) {
  void ui.camera.show(withLens(target, store.state.camera.view_angle));
}
var wheelTimers = /* @__PURE__ */ new WeakMap();
function settleSoon(store) {
  clearTimeout(wheelTimers.get(store));
  wheelTimers.set(store, setTimeout(() => store.settle(), WHEEL_MS));
}
var placed = (x2, y3, { width, height }) => ({ x: x2, y: y3, width: Math.round(width), height: Math.round(height) });
async function shapeAt({ engine, welcome }, { x: x2, y: y3 }, size) {
  const { shape } = await engine.ask("shape", placed(x2 / size.width, y3 / size.height, size));
  return shape === null ? "" : `${shape.text} at ${placeText(shape.point, welcome)}`;
}
var isMeasuring = (tool) => tool === "distance" || tool === "angle";
async function pick(props, x2, y3, size) {
  const { engine, store, ui } = props;
  try {
    const { point: point2 } = await engine.ask("pick", placed(x2, y3, size));
    if (point2 === null) ui.announce("Nothing is seen there");
    else if (isMeasuring(ui.tool)) ui.addPoint(point2);
    else store.change(crosshairAt(store.state, point2));
    return point2 !== null;
  } catch (problem) {
    ui.problem(problem);
    return false;
  }
}
function instant(frame, camera, size) {
  const before2 = frame.camera;
  if (before2 === void 0 || before2 === camera) return "";
  const [old, now] = [axesOf(before2), axesOf(camera)];
  if (dot(old.back, now.back) < 1 - 1e-9 || before2.view_angle !== camera.view_angle) return "";
  const at2 = (seen, point2) => project(seen, size, point2);
  const beside = add(before2.focal_point, old.right);
  const [a3, b] = [at2(before2, before2.focal_point), at2(before2, beside)];
  const [A3, B3] = [at2(camera, before2.focal_point), at2(camera, beside)];
  if (a3 === null || b === null || A3 === null || B3 === null) return "";
  const [dx, dy, DX, DY] = [b.x - a3.x, b.y - a3.y, B3.x - A3.x, B3.y - A3.y];
  const square = dx * dx + dy * dy;
  const [p3, q2] = [(DX * dx + DY * dy) / square, (DY * dx - DX * dy) / square];
  const [tx, ty] = [A3.x - p3 * a3.x + q2 * a3.y, A3.y - q2 * a3.x - p3 * a3.y];
  const numbers = [p3, q2, -q2, p3, tx, ty].map((value) => value.toFixed(6));
  return numbers.join() === IDENTITY ? "" : `matrix(${numbers.join()})`;
}
var IDENTITY = "1.000000,0.000000,-0.000000,1.000000,0.000000,0.000000";

// src/view/settings_panel.tsx
var TEXT27 = WORDS.settings;
var FIRST_ANGLE = 30;
function SettingsPanel(props) {
  const { store, figures, onFigures } = props;
  const { view, render: render2, camera } = store.state;
  const isNamed = typeof render2.quality === "string";
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT27.rest,
      value: isNamed ? render2.quality : "own",
      options: [...QUALITIES.map((name) => [name, name]), ...isNamed ? [] : [["own", TEXT27.custom]]],
      onChoose: (value) => value !== "own" && store.change([set(value, "render", "quality")])
    }
  ), /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT27.moving,
      value: view.quality.moving,
      options: Object.entries(TEXT27.movings),
      onChoose: (value) => store.change([set(value, "view", "quality", "moving")])
    }
  ), /* @__PURE__ */ k(
    Switch,
    {
      label: TEXT27.perspective,
      on: camera.view_angle !== void 0,
      onToggle: (on) => store.change([set(withLens(camera, on ? FIRST_ANGLE : void 0), "camera")])
    }
  ), camera.view_angle !== void 0 && /* @__PURE__ */ k(
    NumberField,
    {
      label: TEXT27.angle,
      unit: "°",
      value: camera.view_angle,
      min: 5,
      max: 100,
      onInput: (value) => store.change([set(withLens(camera, value), "camera")], "view angle"),
      onSettle: () => store.settle()
    }
  ), /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT27.turning,
      value: view.interface.turning,
      options: Object.entries(TEXT27.turnings),
      onChoose: (value) => store.change([set(value, "view", "interface", "turning")])
    }
  ), /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT27.theme,
      value: view.interface.theme,
      options: Object.entries(TEXT27.themes),
      onChoose: (value) => store.change([set(value, "view", "interface", "theme")])
    }
  ), /* @__PURE__ */ k("fieldset", null, /* @__PURE__ */ k("legend", null, TEXT27.over), OVERLAYS.map((name) => /* @__PURE__ */ k(
    Switch,
    {
      key: name,
      label: TEXT27.overlays[name],
      on: view.overlays[name],
      onToggle: (on) => store.change([set(on, "view", "overlays", name)])
    }
  )), /* @__PURE__ */ k(Switch, { label: TEXT27.figures, on: figures, onToggle: onFigures })));
}

// src/view/slices/maximise.ts
var before = /* @__PURE__ */ new WeakMap();
function toggleMaximised(store, view) {
  const { layout } = store.state.view;
  if (layout.name === "single") {
    const back = before.get(store) ?? { name: "two-by-two", main: "3d" };
    store.change([set(back, "view", "layout")]);
    return;
  }
  before.set(store, layout);
  store.change([set({ name: "single", main: view }, "view", "layout")]);
}

// src/view/slices/panes.ts
var PANE_COLORS = { z: "#ff6b6b", y: "#6bd46b", x: "#6ba8ff" };
var BODY = { z: "Axial", y: "Coronal", x: "Sagittal" };
var nameOf3 = ({ welcome }, pane) => welcome.volumes[0]?.is_anatomical ? BODY[pane] : pane;

// src/view/slices/probe.ts
var PARTS = 64;
function probe({ ui, welcome }, painter, on, place) {
  const shown = painter.frame;
  const slice = shown?.slice;
  if (on === null || place === null || shown === null || slice === void 0 || shown !== ui.frames[shown.view]) {
    ui.tell("");
    return;
  }
  const point2 = worldAt(on, place.x, place.y);
  const along = (way) => Math.round(point2.reduce((sum, value, a3) => sum + (value - (slice.origin[a3] ?? 0)) * (way[a3] ?? 0), 0) / slice.pixel);
  const found2 = painter.at(along(slice.right), along(slice.down));
  if (found2 === null) {
    ui.tell("");
    return;
  }
  const values = welcome.volumes.flatMap(({ robust_range: [low, high], value_unit }, n2) => {
    const value = found2.values.get(n2);
    if (value === void 0) return [];
    return [value === null ? "outside" : `${value.toFixed(decimalsOf((high - low) / PARTS))} ${value_unit}`.trim()];
  });
  ui.tell(`${values.join(", ")}${found2.label === null ? "" : ` · ${found2.label}`} at ${placeText(point2, welcome)}`);
}

// src/engine/slice_values.ts
var NOTHING2 = 65535;
async function decodedValues(header, width, height, payload) {
  const stream = new Blob([payload]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const n2 = width * height;
  const nPlanes = header.layers.length + (header.labels === null ? 0 : 1);
  if (bytes.length !== 2 * n2 * nPlanes) {
    throw new Error(`a slice of ${width} x ${height} pixels and ${nPlanes} planes has ${bytes.length} bytes`);
  }
  const planes = Array.from({ length: nPlanes }, (_3, plane) => summed(bytes.subarray(2 * n2 * plane, 2 * n2 * (plane + 1)), width));
  return {
    header,
    width,
    height,
    layers: planes.slice(0, header.layers.length),
    labels: header.labels === null ? null : planes.at(-1) ?? null
  };
}
function summed(bytes, width) {
  const n2 = bytes.length / 2;
  const codes = new Uint16Array(n2);
  for (let start = 0; start < n2; start += width) {
    let code = 0;
    for (let k3 = start; k3 < start + width; k3 += 1) {
      code = code + bytes[k3] + (bytes[n2 + k3] << 8) & 65535;
      codes[k3] = code;
    }
  }
  return codes;
}

// src/view/slices/slice_colors.ts
var FILL2 = 0.4;
function colored(values, { window: window2, opacities }, out) {
  const tables = values.header.layers.map((layer, n3) => tableOf(layer, codesOf(values.layers[n3]), window2));
  if (values.layers.length === 1 && values.labels === null && values.header.layers[0]?.kind === "window" && opacities[0] === 1) {
    coloredAlone(values, tables[0], out);
    return;
  }
  const [red, green, blue] = values.header.background.map((share2) => 255 * share2);
  const n2 = values.width * values.height;
  const mixed = new Float32Array(3 * n2);
  for (let k3 = 0; k3 < n2; k3 += 1) {
    mixed[3 * k3] = red;
    mixed[3 * k3 + 1] = green;
    mixed[3 * k3 + 2] = blue;
  }
  addLights(values, tables, opacities, mixed);
  values.header.layers.forEach((layer, place) => {
    if (layer.kind !== "light") layOver(values.layers[place], tables[place], opacities[place] ?? 0, mixed);
  });
  if (values.labels !== null) layLabels(values, mixed);
  for (let k3 = 0; k3 < n2; k3 += 1) {
    out[4 * k3] = mixed[3 * k3];
    out[4 * k3 + 1] = mixed[3 * k3 + 1];
    out[4 * k3 + 2] = mixed[3 * k3 + 2];
    out[4 * k3 + 3] = 255;
  }
}
function codesOf(codes) {
  let most = 0;
  for (const code of codes) if (code > most && code !== NOTHING2) most = code;
  return most + 1;
}
function tableOf(layer, n2, [level, width]) {
  const table = new Float32Array(4 * n2);
  const [origin, scale] = layer.kind === "window" ? [level - width / 2, 1 / width] : [0, 1];
  const colors = curve(layer.color);
  const opacity = layer.opacity === void 0 ? null : curve(layer.opacity);
  const most = Math.max(...(layer.opacity ?? [[0, 1]]).map((node) => node[1]));
  const lowest = layer.lowest ?? -Infinity;
  for (let code = 0; code < n2; code += 1) {
    const value = layer.low + code * layer.step;
    const at2 = (value - origin) * scale;
    for (let channel = 0; channel < 3; channel += 1) table[4 * code + channel] = 255 * colors(at2, channel + 1);
    table[4 * code + 3] = opacity === null ? 1 : value < lowest || most === 0 ? 0 : opacity(value, 1) / most;
  }
  return table;
}
function curve(nodes2) {
  let place = 0;
  return (value, column) => {
    while (place + 1 < nodes2.length && (nodes2[place + 1]?.[0] ?? Infinity) <= value) place += 1;
    const [from, to] = [nodes2[place], nodes2[place + 1]];
    const [x0, y0] = [from[0], from[column]];
    if (to === void 0 || value <= x0) return y0;
    return y0 + (value - x0) / (to[0] - x0) * (to[column] - y0);
  };
}
function coloredAlone({ layers, header }, table, out) {
  const codes = layers[0];
  const rounded2 = new Uint8ClampedArray(table);
  const pixels = new Uint32Array(65536);
  const pixel = (red2, green2, blue2) => (4278190080 | blue2 << 16 | green2 << 8 | red2) >>> 0;
  for (let code = 0; 4 * code < rounded2.length; code += 1) {
    pixels[code] = pixel(rounded2[4 * code], rounded2[4 * code + 1], rounded2[4 * code + 2]);
  }
  const [red, green, blue] = header.background.map((share2) => Math.round(255 * share2));
  pixels[NOTHING2] = pixel(red, green, blue);
  const words = new Uint32Array(out.buffer, out.byteOffset, codes.length);
  for (let k3 = 0; k3 < codes.length; k3 += 1) words[k3] = pixels[codes[k3]];
}
function addLights({ header, layers }, tables, opacities, mixed) {
  const lights = header.layers.map((layer, place) => ({ layer, place })).filter(({ layer, place }) => layer.kind === "light" && (opacities[place] ?? 0) > 0);
  if (lights.length === 0) return;
  for (let k3 = 0; k3 < mixed.length / 3; k3 += 1) {
    let [red, green, blue, isKnown] = [0, 0, 0, false];
    for (const { place } of lights) {
      const code = layers[place][k3];
      if (code === NOTHING2) continue;
      const [table, opacity] = [tables[place], opacities[place]];
      red += opacity * table[4 * code];
      green += opacity * table[4 * code + 1];
      blue += opacity * table[4 * code + 2];
      isKnown = true;
    }
    if (!isKnown) continue;
    mixed[3 * k3] = Math.min(red, 255);
    mixed[3 * k3 + 1] = Math.min(green, 255);
    mixed[3 * k3 + 2] = Math.min(blue, 255);
  }
}
function layOver(codes, table, opacity, mixed) {
  if (opacity === 0) return;
  for (let k3 = 0; k3 < codes.length; k3 += 1) {
    const code = codes[k3];
    if (code === NOTHING2) continue;
    const alpha = opacity * table[4 * code + 3];
    if (alpha === 0) continue;
    mix(mixed, 3 * k3, table, 4 * code, alpha);
  }
}
function layLabels({ header, labels, width, height }, mixed) {
  const codes = labels;
  const colors = new Float32Array((header.labels?.colors ?? []).flatMap(([share2, ...rgb]) => [share2, ...rgb.map((one) => 255 * one)]));
  for (let row = 0; row < height; row += 1) {
    for (let column = 0; column < width; column += 1) {
      const k3 = row * width + column;
      const code = codes[k3];
      const share2 = colors[4 * code];
      if (share2 === 0) continue;
      const isEdge = column > 0 && codes[k3 - 1] !== code || column + 1 < width && codes[k3 + 1] !== code || row > 0 && codes[k3 - width] !== code || row + 1 < height && codes[k3 + width] !== code;
      mix(mixed, 3 * k3, colors, 4 * code + 1, isEdge ? share2 : FILL2 * share2);
    }
  }
}
function mix(mixed, pixel, table, place, alpha) {
  for (let channel = 0; channel < 3; channel += 1) {
    const below = mixed[pixel + channel];
    mixed[pixel + channel] = below + alpha * (table[place + channel] - below);
  }
}

// src/view/slices/slice_painter.ts
var SlicePainter = class {
  /** The frame whose values these are, and the canvas they are in. */
  frame = null;
  values = null;
  canvas = null;
  image = null;
  coloring = "";
  /** Takes a frame of values and draws it. */
  async take(frame, canvas, state2) {
    if (frame.values === void 0) return;
    this.values = await decodedValues(frame.values, frame.width, frame.height, frame.bytes);
    this.frame = frame;
    this.canvas = canvas;
    this.coloring = "";
    if (canvas.width !== frame.width) canvas.width = frame.width;
    if (canvas.height !== frame.height) canvas.height = frame.height;
    this.image = new ImageData(frame.width, frame.height);
    this.draw(state2);
  }
  /** Draws the values again, if the state gives them other colours than are in the canvas. */
  draw(state2) {
    const { values, canvas, image, frame } = this;
    if (values === null || canvas === null || image === null || frame === null) return;
    const coloring = coloringOf(values, frame, state2);
    const key = JSON.stringify(coloring);
    if (key === this.coloring) return;
    this.coloring = key;
    colored(values, coloring, image.data);
    canvas.getContext("2d")?.putImageData(image, 0, 0);
    canvas.dataset["painted"] = String(Number(canvas.dataset["painted"] ?? 0) + 1);
  }
  /** Values of each layer, by its number in the state, and name of the label, at a pixel; null outside of them. */
  at(column, row) {
    const { values } = this;
    if (values === null || column < 0 || row < 0 || column >= values.width || row >= values.height) return null;
    const k3 = row * values.width + column;
    const found2 = values.header.layers.map(({ layer, low, step }, n2) => {
      const code = values.layers[n2]?.[k3] ?? NOTHING2;
      return [layer, code === NOTHING2 ? null : low + code * step];
    });
    return { values: new Map(found2), label: values.header.labels?.names[values.labels?.[k3] ?? NOTHING2] ?? null };
  }
};
function coloringOf({ header }, frame, state2) {
  return {
    window: state2.view.slices.window ?? frame.slice?.window ?? [0, 1],
    opacities: header.layers.map(({ layer }) => {
      const { visible, opacity } = state2.layers[layer] ?? { visible: false, opacity: 0 };
      return visible ? opacity : 0;
    })
  };
}

// src/view/overlay3d/crop_on_slice.tsx
var COLOR3 = "#ffd166";
var ALONG = 0.999;
function CropOnSlice(props) {
  const { store, welcome, on } = props;
  const place = placeOfBox(store.state.clip, "keep");
  const clip2 = store.state.clip[place];
  const box2 = clip2 === void 0 ? null : boxOf(clip2);
  const normalAxis = on.geometry.normal.findIndex((one) => Math.abs(one) > ALONG);
  if (box2 === null || normalAxis < 0) return null;
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const { crosshair } = store.state.view.slices;
  const inPlane = (point2) => point2.map((value, a3) => a3 === normalAxis ? crosshair[a3] : value);
  const [from, to] = [placeOf(on, inPlane(box2.lower)), placeOf(on, inPlane(box2.upper))];
  const [left, top] = [Math.min(from.x, to.x), Math.min(from.y, to.y)];
  const now = () => {
    const found2 = store.state.clip[place];
    return (found2 === void 0 ? null : boxOf(found2)) ?? box2;
  };
  const faces = [0, 1, 2].filter((axis) => axis !== normalAxis).flatMap((axis) => [{ axis, side: "lower" }, { axis, side: "upper" }]);
  return /* @__PURE__ */ k("g", null, /* @__PURE__ */ k("rect", { x: left, y: top, width: Math.abs(to.x - from.x), height: Math.abs(to.y - from.y), stroke: COLOR3, fill: "none", "stroke-width": "1.3" }), faces.map((face) => {
    const middle2 = scaled(add(box2.lower, box2.upper), 0.5);
    const at2 = placeOf(on, inPlane(middle2.map((value2, a3) => a3 === face.axis ? box2[face.side][face.axis] : value2)));
    const value = box2[face.side][face.axis];
    const bounds = [welcome.bounds[0][face.axis], welcome.bounds[1][face.axis]];
    const name = `Crop, ${"xyz"[face.axis]} ${face.side === "lower" ? "from" : "to"}`;
    const move = (target, gesture) => store.change([set({ keep: withFace(now(), face, target, welcome.bounds, spacing[face.axis]) }, "clip", place)], gesture);
    return /* @__PURE__ */ k(
      Handle2,
      {
        key: name,
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
      }
    );
  }));
}

// src/view/slices/crosshair.tsx
var GAP = 12;
var TILT_AT = 0.36;
var MOVE_AT = 0.22;
function CrosshairLine(props) {
  const { store, on, other, welcome } = props;
  const { size } = on;
  const normal = normalOf(store.state, other);
  const line = lineOf(on, normal);
  if (line === null) return null;
  const at2 = placeOf(on, store.state.view.slices.crosshair);
  const reach = size.width + size.height;
  const color2 = PANE_COLORS[other];
  const side = Math.min(size.width, size.height);
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
  const along = (far) => `${at2.x + line.dx * far} ${at2.y + line.dy * far}`;
  return /* @__PURE__ */ k("g", { class: "quiet", stroke: color2, fill: "none" }, /* @__PURE__ */ k("path", { d: `M${along(-reach)}L${along(-GAP)}M${along(GAP)}L${along(reach)}`, "stroke-width": "1.2", opacity: "0.85" }), /* @__PURE__ */ k(
    Handle2,
    {
      label: `${nameOf3(props, other)} plane`,
      text: `${nameOf3(props, other)} plane at ${shortNumber(position, 4)}`,
      value: position,
      range,
      x: at2.x - line.dx * side * MOVE_AT,
      y: at2.y - line.dy * side * MOVE_AT,
      color: color2,
      onDrag: (_x, _y, dx, dy) => {
        const { geometry } = on;
        const per = geometry.pixel * on.width / size.width;
        const way = add(scaled(geometry.right, dx * per), scaled(geometry.down, dy * per));
        move(dot(way, normal), "drag plane");
      },
      onKey: keys,
      onEnd: () => store.settle()
    }
  ), /* @__PURE__ */ k(
    Handle2,
    {
      label: `Tilt the ${nameOf3(props, other)} plane`,
      text: `Tilt of the ${nameOf3(props, other)} plane`,
      value: Math.atan2(line.dy, line.dx) * 180 / Math.PI,
      range: [-180, 180],
      x: at2.x + line.dx * side * TILT_AT,
      y: at2.y + line.dy * side * TILT_AT,
      color: color2,
      round: true,
      onDrag: (x2, y3) => tilt(x2, y3),
      onKey: tiltKeys,
      onEnd: () => store.settle()
    }
  ));
}
function tiltTo(store, pane, normal) {
  return set({ ...store.state.view.slices.normals, [pane]: normal }, "view", "slices", "normals");
}
function rangeOf([lower, upper], normal) {
  const ends = [0, 1, 2].map((a3) => [(lower[a3] ?? 0) * (normal[a3] ?? 0), (upper[a3] ?? 0) * (normal[a3] ?? 0)]);
  const sum = (pick2) => ends.reduce((total, end) => total + pick2(...end), 0);
  return [sum(Math.min), sum(Math.max)];
}

// src/view/slices/fitting.ts
var LINE = 17;
var PADDING = 8;
var APART = 6;
var LETTER = 7;
var widthOf = (lines) => Math.max(0, ...lines.map((line) => line.length)) * LETTER + 2 * PADDING;
var heightOf = (lines) => lines.length * LINE + PADDING;
function textsThatFit({ width, height }, name, window2) {
  const isLow = height < 120;
  const lines = height < LINE + PADDING + 4 ? [] : isLow ? name.slice(0, 1) : name;
  const [left, right] = [widthOf(lines) + APART, window2 === null ? 0 : widthOf([window2]) + 14 + APART];
  const shown = left + right + APART <= width ? window2 : null;
  const half = width / 2 - 1.5 * LETTER - APART;
  const top = heightOf(lines) + APART;
  const bar = 2 * LINE + PADDING;
  const scaleBar = height >= top + bar;
  const barWidth = Math.max(0.3 * width, 10 * LETTER) + 12;
  return {
    name: lines,
    window: shown,
    sideLetters: height / 2 - LINE >= Math.max(top, bar) + APART,
    endLetters: !isLow && half >= Math.max(left, shown === null ? 0 : right, barWidth),
    scaleBar
  };
}

// src/view/slices/window_menu.tsx
var COLOR_NAMES = {
  gray: "Grey",
  gray_r: "Inverted grey",
  hot: "Hot",
  viridis: "Viridis",
  coolwarm: "Cool to warm"
};
function windowText({ store }, frame) {
  const window2 = frame.slice?.window && (store.state.view.slices.window ?? frame.slice.window);
  return window2 ? `L ${shortNumber(window2[0], 4)} W ${shortNumber(window2[1], 4)}` : null;
}
function namedWindows({ welcome }) {
  return welcome.volumes[0]?.value_unit === "HU" ? Object.entries(welcome.window_names) : [];
}
function chooseWindow({ store, welcome }, name) {
  const { slices } = store.state.view;
  const window2 = welcome.window_names[name];
  if (window2 !== void 0) store.change([set(window2, "view", "slices", "window")]);
  else if (name in COLOR_NAMES) store.change([set(name, "view", "slices", "colors")]);
  else if (name === "automatic") {
    const fields2 = ["window", "colors"].filter((field) => slices[field] !== void 0);
    if (fields2.length > 0) store.change(fields2.map((field) => ({ op: "remove", path: `/view/slices/${field}` })));
  }
}
function WindowMenu(props) {
  const { text: text2 } = props;
  return /* @__PURE__ */ k("label", { class: "corner right pill menu", "data-handle": true }, /* @__PURE__ */ k("span", { class: "hidden" }, "Window"), /* @__PURE__ */ k(
    "select",
    {
      value: "",
      onChange: (event) => {
        const select = event.currentTarget;
        chooseWindow(props, select.value);
        select.value = "";
      }
    },
    /* @__PURE__ */ k("option", { value: "", selected: true, hidden: true }, text2),
    /* @__PURE__ */ k("option", { value: "automatic" }, "Automatic"),
    namedWindows(props).map(([name, [level, width]]) => /* @__PURE__ */ k("option", { key: name, value: name }, `${name} (${level}, ${width})`)),
    /* @__PURE__ */ k("optgroup", { label: "Colours" }, SLICE_COLORS.map((name) => /* @__PURE__ */ k("option", { key: name, value: name }, COLOR_NAMES[name])))
  ));
}

// src/view/slices/slice_overlay.tsx
function SliceOverlay(props) {
  const { pane, on, store, welcome } = props;
  const { slices, overlays } = store.state.view;
  const { geometry } = on;
  const { letters } = geometry;
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const isTilted = slices.normals?.[pane] !== void 0;
  const name = [
    `${nameOf3(props, pane)}${isTilted ? ", tilted" : ""}`,
    `${shortNumber(geometry.position, 4)} ${unit2}`,
    ...slices.thickness > 0 ? [`${slices.slab} of ${shortNumber(slices.thickness)} ${unit2}`] : []
  ];
  const room = T2(null);
  const texts = textsThatFit(useRoom(room), name, windowText(props, props.frame));
  const showsLetters = overlays.letters && letters !== null;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("svg", { class: "over", "aria-hidden": false }, overlays.crosshair && othersOf(pane).map((other) => /* @__PURE__ */ k(CrosshairLine, { key: other, ...props, on, other })), overlays.crop_box && /* @__PURE__ */ k(CropOnSlice, { ...props, on }), /* @__PURE__ */ k(MeasuresOnSlice, { ...props, on, drawing: props.drawing })), /* @__PURE__ */ k("div", { class: "texts", ref: room }, texts.name.length > 0 && /* @__PURE__ */ k("div", { class: "corner pill", style: { color: PANE_COLORS[pane] } }, texts.name.join("\n")), texts.window !== null && /* @__PURE__ */ k(WindowMenu, { ...props, text: texts.window }), showsLetters && texts.sideLetters && /* @__PURE__ */ k($, null, /* @__PURE__ */ k(Letter, { x: "4px", y: "50%", from: "0 -50%" }, letters.left), /* @__PURE__ */ k(Letter, { x: "calc(100% - 4px)", y: "50%", from: "-100% -50%" }, letters.right)), showsLetters && texts.endLetters && /* @__PURE__ */ k($, null, /* @__PURE__ */ k(Letter, { x: "50%", y: "6px", from: "-50% 0" }, letters.top), /* @__PURE__ */ k(Letter, { x: "50%", y: "calc(100% - 6px)", from: "-50% -100%" }, letters.bottom)), overlays.scale_bar && texts.scaleBar && /* @__PURE__ */ k(ScaleBar2, { on, unit: unit2 })));
}
function Letter(props) {
  return /* @__PURE__ */ k("span", { class: "pill letter", "aria-hidden": "true", style: { left: props.x, top: props.y, translate: props.from } }, props.children);
}
function useRoom(element) {
  const [size, setSize] = d2({ width: 0, height: 0 });
  F2(() => {
    if (element.current === null) return void 0;
    const observer = new ResizeObserver(([entry]) => entry && setSize(entry.contentRect));
    observer.observe(element.current);
    return () => observer.disconnect();
  }, []);
  return size;
}
function ScaleBar2({ on, unit: unit2 }) {
  const { geometry, size, width } = on;
  const perCss = geometry.pixel * width / size.width;
  const bar = barLength(perCss * size.width * 0.3);
  return /* @__PURE__ */ k("div", { class: "corner low pill scale", "aria-hidden": "true" }, `${bar} ${unit2}`, /* @__PURE__ */ k("span", { style: { width: `${bar / perCss}px` } }));
}

// src/view/slices/slice_pane.tsx
var COARSE2 = 10;
var KEY_PX2 = 24;
var KEY_ZOOM2 = 1.1;
function SlicePane(props) {
  const { pane, store, ui, welcome } = props;
  const press2 = T2(null);
  const fingers = T2(new TwoFingers());
  const drawing = useDrawing(props);
  const painter = T2(new SlicePainter());
  F2(() => {
    if (ui.frames[pane] === painter.current.frame) painter.current.draw(store.state);
  });
  const slices = () => store.state.view.slices;
  const change = (operations, gesture) => {
    if (operations.length > 0) store.change(operations, gesture);
  };
  const now = (size) => {
    const frame = sliceFrame(ui.frames[pane], size);
    return frame === null ? null : newest(frame, store.state, pane, centerOf(store.state, welcome));
  };
  const step = () => sampleStep(welcome.volumes[0]?.affine ?? [], normalOf(store.state, pane));
  const scroll = (n2, gesture) => {
    const range = ui.frames[pane]?.slice?.range;
    if (range === void 0) return;
    change([set(stepped(store.state, pane, n2 * step(), range), "view", "slices", "crosshair")], gesture);
  };
  const window2 = (dx, dy, size) => {
    const volume2 = welcome.volumes[0];
    const automatic = ui.frames[pane]?.slice?.window;
    if (automatic === null) windowDrag(props, dx, dy);
    const before2 = automatic && (slices().window ?? automatic);
    if (volume2 === void 0 || !before2) return;
    const span = volume2.robust_range[1] - volume2.robust_range[0] || 1;
    const width = Math.max(before2[1] + dx / size.width * span, span * 1e-4);
    change([set([before2[0] - dy / size.height * span, width], "view", "slices", "window")], "window");
  };
  const zoomAt = (size, factor, x2, y3) => {
    const on = now(size);
    if (on !== null) change(zoomedAbout(store.state, welcome, worldAt(on, x2, y3), factor), "slice zoom");
  };
  const panBy = (size, dx, dy, gesture) => {
    const on = now(size);
    if (on !== null) change(panned2(on, centerOf(store.state, welcome), dx, dy, welcome), gesture);
  };
  const onTap = (gesture, size) => {
    const on = now(size);
    if (on === null) return;
    if (drawing.isOn) drawing.onTap(on, gesture.x, gesture.y, gesture.double);
    else if (gesture.double) toggleMaximised(store, pane);
    else change([set(worldAt(on, gesture.x, gesture.y), "view", "slices", "crosshair")]);
  };
  const onDrag = (gesture, size) => {
    const { phase, what, x: x2, y: y3 } = gesture;
    if (phase === "start") {
      const on = now(size);
      press2.current = on === null ? null : { on, center: centerOf(store.state, welcome), x: x2, y: y3 };
    }
    const from = press2.current;
    if (from === null) return;
    const isMain = what === "main" || what === "roll";
    if (isMain && drawing.isOn) drawing.onDrag(from.on, gesture);
    else if (phase === "end") store.settle();
    else if (what === "pan") change(panned2(from.on, from.center, x2 - from.x, y3 - from.y, welcome), "slice pan");
    else if (phase === "start") return;
    else if (what === "window" || isMain && ui.tool === "window") window2(gesture.dx, gesture.dy, size);
    else if (what === "zoom") zoomAt(size, Math.exp(-2 * gesture.dy / size.height), from.x, from.y);
    else if (isMain) change([set(worldAt(from.on, x2, y3), "view", "slices", "crosshair")], "crosshair");
    if (phase === "end") press2.current = null;
  };
  const onPinch = (gesture, size) => {
    if (gesture.phase === "end") {
      fingers.current.end();
      store.settle();
      return;
    }
    const told = fingers.current.moved(gesture.dx, gesture.dy, gesture.factor);
    if (told === null) return;
    if ("steps" in told) scroll(-told.steps, "touch slice");
    else {
      panBy(size, told.dx, told.dy, "slice pinch");
      zoomAt(size, told.factor, gesture.x, gesture.y);
    }
  };
  const onGesture = (gesture, size) => {
    if (gesture.kind === "tap") onTap(gesture, size);
    else if (gesture.kind === "pinch") onPinch(gesture, size);
    else onDrag(gesture, size);
  };
  const onWheel = ({ factor, steps, ctrl, x: x2, y: y3 }, size) => {
    if (ctrl) zoomAt(size, factor, x2, y3);
    else scroll(-steps, "wheel slice");
    settleSoon(store);
  };
  const onAction = (action, shift, size) => {
    const nudge = (right, down) => {
      const on = now(size);
      if (on === null) return true;
      const moved = add(scaled(on.geometry.right, right * step()), scaled(on.geometry.down, down * step()));
      change([set(add(slices().crosshair, moved), "view", "slices", "crosshair")], "key crosshair");
      return true;
    };
    const magnify = (factor) => {
      change(zoomedAbout(store.state, welcome, slices().crosshair, factor), "slice zoom");
      return true;
    };
    const pan = (dx, dy) => {
      panBy(size, dx, dy, "key pan");
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
      case "pan-left":
        return pan(-KEY_PX2, 0);
      case "pan-right":
        return pan(KEY_PX2, 0);
      case "pan-up":
        return pan(0, -KEY_PX2);
      case "pan-down":
        return pan(0, KEY_PX2);
      case "zoom-in":
        return magnify(KEY_ZOOM2);
      case "zoom-out":
        return magnify(1 / KEY_ZOOM2);
      case "first-view":
      case "fit":
        change(fitted(store.state));
        return true;
      default:
        return false;
    }
  };
  const cutAt = ui.frames[pane]?.slice;
  return /* @__PURE__ */ k(
    Viewport,
    {
      ...props,
      view: pane,
      label: `${nameOf3(props, pane)} slice at ${cutAt === void 0 ? "" : shortNumber(cutAt.position, 4)}`,
      onGesture,
      onAction,
      onWheel,
      onHover: (place, size) => {
        const on = place === null ? null : now(size);
        drawing.onHover(on, place);
        probe(props, painter.current, on, place);
      },
      onValues: (frame, canvas) => painter.current.take(frame, canvas, store.state),
      transform: (frame, size) => {
        const [from, to] = [sliceFrame(frame, size), now(size)];
        return from === null || to === null ? "" : transformOf(from, to);
      }
    },
    (frame, size) => {
      const on = now(size);
      return on !== null && /* @__PURE__ */ k(SliceOverlay, { ...props, frame, on, drawing: drawing.drawing });
    }
  );
}
function sliceFrame(frame, size) {
  if (frame?.slice === void 0 || size.width === 0) return null;
  return { geometry: frame.slice, size, width: frame.width, height: frame.height };
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
  const automatic = PANES.map((pane) => ui.frames[pane]?.slice?.window).find(Boolean);
  const robust = info?.robust_range ?? [0, 1];
  const [level, width] = slices.window ?? automatic ?? [(robust[0] + robust[1]) / 2, robust[1] - robust[0]];
  const span = (info?.range[1] ?? 1) - (info?.range[0] ?? 0) || 1;
  const setWindow = (next, gesture) => store.change([set(next, "view", "slices", "window")], gesture);
  const names = namedWindows(props);
  const colors = PANES.map((pane) => ui.frames[pane]?.slice?.colors).find(Boolean);
  const named = names.find(([, [l3, w3]]) => slices.window?.[0] === l3 && slices.window[1] === w3)?.[0];
  return /* @__PURE__ */ k($, null, AXES3.map((name, axis) => /* @__PURE__ */ k(
    NumberField,
    {
      key: name,
      decimals: decimalsOf(info?.spacing[axis] ?? 1),
      label: `Crosshair ${name}`,
      unit: unit2,
      value: slices.crosshair[axis] ?? 0,
      min: lower[axis] ?? 0,
      max: upper[axis] ?? 1,
      onInput: (value) => {
        const next = slices.crosshair.map((one, a3) => a3 === axis ? value : one);
        store.change([set(next, "view", "slices", "crosshair")], `crosshair ${name}`);
      },
      onSettle: settle
    }
  )), /* @__PURE__ */ k(
    NumberField,
    {
      label: "Thickness",
      unit: unit2,
      value: slices.thickness,
      min: 0,
      max: Math.max(...AXES3.map((_3, a3) => (upper[a3] ?? 0) - (lower[a3] ?? 0))) / 4,
      onInput: (value) => store.change([set(Math.max(0, value), "view", "slices", "thickness")], "thickness"),
      onSettle: settle
    }
  ), /* @__PURE__ */ k(
    Choice,
    {
      label: "Slab",
      value: slices.slab,
      options: [["maximum", "Maximum"], ["minimum", "Minimum"], ["mean", "Mean"]],
      onChoose: (value) => store.change([set(value, "view", "slices", "slab")])
    }
  ), names.length > 0 && /* @__PURE__ */ k(
    Choice,
    {
      label: "Window",
      value: named ?? (slices.window === void 0 ? "automatic" : "own"),
      options: [
        ["automatic", "Automatic"],
        ...names.map(([name, [l3, w3]]) => [name, `${name} (${l3}, ${w3})`]),
        ...named === void 0 && slices.window !== void 0 ? [["own", "Own"]] : []
      ],
      onChoose: (value) => chooseWindow(props, value)
    }
  ), /* @__PURE__ */ k(
    Choice,
    {
      label: "Colours",
      value: slices.colors ?? colors ?? "gray",
      options: SLICE_COLORS.map((name) => [name, COLOR_NAMES[name]]),
      onChoose: (value) => chooseWindow(props, value)
    }
  ), /* @__PURE__ */ k(
    NumberField,
    {
      label: "Level",
      unit: info?.value_unit ?? "",
      value: level,
      min: info?.range[0] ?? 0,
      max: info?.range[1] ?? 1,
      onInput: (value) => setWindow([value, width], "level"),
      onSettle: settle
    }
  ), /* @__PURE__ */ k(
    NumberField,
    {
      label: "Width",
      unit: info?.value_unit ?? "",
      value: width,
      min: span * 1e-4,
      max: span,
      onInput: (value) => setWindow([level, Math.max(value, span * 1e-6)], "width"),
      onSettle: settle
    }
  ), /* @__PURE__ */ k(
    NumberField,
    {
      label: "Zoom",
      value: slices.zoom,
      min: 0.2,
      max: 20,
      onInput: (value) => store.change(zoomedAbout(store.state, welcome, slices.crosshair, value / slices.zoom), "zoom"),
      onSettle: settle
    }
  ), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      onClick: () => {
        const middle2 = [0, 1, 2].map((a3) => ((lower[a3] ?? 0) + (upper[a3] ?? 0)) / 2);
        store.change(crosshairAt(store.state, middle2));
      }
    },
    "Crosshair to the middle"
  ), /* @__PURE__ */ k("button", { class: "button", onClick: () => void pick(props, 0.5, 0.5, ui.frames["3d"] ?? { width: 512, height: 512 }) }, "Crosshair to what is seen"), /* @__PURE__ */ k("button", { class: "button", disabled: slices.center === void 0 && slices.zoom === 1, onClick: () => store.change(fitted(store.state)) }, "Whole slice"), /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      disabled: slices.window === void 0 && slices.colors === void 0,
      onClick: () => chooseWindow(props, "automatic")
    },
    "Automatic window"
  ), /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      disabled: slices.normals === void 0,
      onClick: () => store.change([{ op: "remove", path: "/view/slices/normals" }])
    },
    "Reset tilt"
  )));
}

// src/view/status.tsx
function Opening({ connection, problem }) {
  if (problem !== null) {
    return /* @__PURE__ */ k("div", { class: "opening", role: "alert" }, /* @__PURE__ */ k("h2", null, "It could not be opened"), /* @__PURE__ */ k("p", null, problem.message), problem.remedy !== void 0 && /* @__PURE__ */ k("p", { class: "dim" }, problem.remedy));
  }
  const isOpening = connection.kind === "connecting";
  return /* @__PURE__ */ k("div", { class: "opening", role: "status" }, /* @__PURE__ */ k("p", null, isOpening ? connection.text || "Opening" : "Opening"), isOpening && connection.part !== void 0 ? /* @__PURE__ */ k("progress", { max: 1, value: connection.part }) : /* @__PURE__ */ k("progress", null));
}
function ProblemCard({ problem, onClose }) {
  return /* @__PURE__ */ k("div", { class: "alert", role: "alert" }, /* @__PURE__ */ k("strong", null, problem.message), problem.field !== void 0 && /* @__PURE__ */ k("span", null, `Field: ${problem.field}`), problem.remedy !== void 0 && /* @__PURE__ */ k("span", { class: "dim" }, problem.remedy), /* @__PURE__ */ k("button", { class: "button", onClick: onClose }, "Close"));
}
function Status(props) {
  const { ui, engine, connection, figures } = props;
  const frame = ui.frames["3d"] ?? Object.values(ui.frames)[0];
  const notes = frame?.notes ?? [];
  return /* @__PURE__ */ k("div", { class: "status" }, connection.kind === "lost" && /* @__PURE__ */ k("span", { class: "row", role: "alert" }, connection.problem.message, ". ", /* @__PURE__ */ k("span", { class: "dim" }, connection.problem.remedy), connection.retries && /* @__PURE__ */ k("button", { class: "button", onClick: () => engine.retry() }, "Try again")), connection.kind === "busy" && /* @__PURE__ */ k("span", { role: "status" }, connection.text), notes.map((note) => /* @__PURE__ */ k("span", { key: note, role: "note" }, note)), ui.probed && /* @__PURE__ */ k("span", null, ui.probed), figures && /* @__PURE__ */ k(Figures, { ...props }));
}
function Figures({ ui }) {
  const recent = ui.statistics.recent(performance.now());
  const frame = ui.frames["3d"];
  if (frame === void 0) return null;
  const { sheets_per_slice, oversampling, scale } = frame.settings;
  const parts = [
    recent === null ? null : `${recent.framesPerSecond.toFixed(0)} frames/s`,
    recent?.latency == null ? null : `${recent.latency.toFixed(0)} ms latency`,
    `drawn in ${frame.ms.render.toFixed(0)} + ${frame.ms.encode.toFixed(0)} ms`,
    `${(frame.bytes.length / 1e3).toFixed(0)} kB ${frame.format}`,
    `${frame.width} x ${frame.height}`,
    `sampling ${Number(sheets_per_slice ?? 0).toFixed(1)} in depth, ${(Number(oversampling ?? 0) * Number(scale ?? 1)).toFixed(2)} across`,
    frame.expected_psnr_db === null ? null : `expected error ${frame.expected_psnr_db.toFixed(0)} dB`
  ];
  return /* @__PURE__ */ k("span", { class: "figures" }, parts.filter((part) => part !== null).join(" · "));
}

// src/view/theme.ts
function themeOf(state2) {
  const { theme } = state2.view.interface;
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

// src/view/toolbar.tsx
var TEXT28 = WORDS.toolbar;
var LAYOUTS2 = ["3d", "one-and-three", "two-by-two", "single"];
var VIEWS2 = ["front", "back", "left", "right", "top", "bottom"];
var TOOLS2 = ["turn", "window", "distance", "angle", "area"];
function Toolbar(props) {
  const { store, welcome, ui, isAbout, onAbout, onFit } = props;
  const { layout } = store.state.view;
  const names = store.state.layers.map(({ name }) => name).join(", ");
  const setLayout = (name) => {
    const main = name === "single" ? layout.main === "3d" ? "z" : layout.main : "3d";
    store.change([set({ name, main }, "view", "layout")]);
  };
  const hasScene = layout.name !== "single" || layout.main === "3d";
  return /* @__PURE__ */ k("header", { class: "toolbar" }, /* @__PURE__ */ k("div", { class: "group float" }, /* @__PURE__ */ k(IconButton, { icon: "open", label: WORDS.opening.open, onClick: () => ui.opener.show(true) })), /* @__PURE__ */ k("h1", { class: "group float title-group" }, /* @__PURE__ */ k("button", { class: "title", "data-opens": "about", "aria-expanded": isAbout, "aria-label": WORDS.about.open(names), title: names, onClick: onAbout }, names)), /* @__PURE__ */ k("div", { class: "group float" }, /* @__PURE__ */ k(Radios, { label: WORDS.layouts.title, names: LAYOUTS2, value: layout.name, textOf: (name) => WORDS.layouts[name], iconOf: (name) => name, onChoice: setLayout }), layout.name === "single" && /* @__PURE__ */ k("label", null, /* @__PURE__ */ k("span", { class: "hidden" }, WORDS.layouts.slice), /* @__PURE__ */ k("select", { value: layout.main, onChange: (event) => store.change([set(event.currentTarget.value, "view", "layout", "main")]) }, PANES.map((pane) => /* @__PURE__ */ k("option", { key: pane, value: pane, selected: pane === layout.main }, nameOf3({ welcome }, pane)))))), /* @__PURE__ */ k(Group, { label: TEXT28.history }, /* @__PURE__ */ k(IconButton, { icon: "undo", label: TEXT28.undo, shortcut: "Ctrl Z", disabled: !store.canUndo, onClick: () => store.undo() }), /* @__PURE__ */ k(IconButton, { icon: "redo", label: TEXT28.redo, shortcut: "Ctrl Shift Z", disabled: !store.canRedo, onClick: () => store.redo() })), /* @__PURE__ */ k("div", { class: "group float" }, /* @__PURE__ */ k(Radios, { label: TEXT28.tools, names: TOOLS2, value: ui.tool, textOf: (tool) => TEXT28[tool], iconOf: (tool) => tool, onChoice: (tool) => ui.setTool(tool) })), hasScene && /* @__PURE__ */ k(Group, { label: TEXT28.views, more: "standard-views" }, VIEWS2.map((view, n2) => /* @__PURE__ */ k(
    "button",
    {
      key: view,
      class: "icon-button",
      title: `${TEXT28.from(view)} (${n2 + 1})`,
      "aria-label": TEXT28.lettered(letterOf(view, welcome.axis_ends), view),
      onClick: () => {
        const camera = welcome.standard_views[view];
        if (camera !== void 0) showFrom(props, camera);
      }
    },
    letterOf(view, welcome.axis_ends)
  )), /* @__PURE__ */ k(IconButton, { icon: "fit", label: TEXT28.fit, shortcut: "F", onClick: onFit })));
}
function Group({ label, more = "", children }) {
  return /* @__PURE__ */ k("div", { class: `group float ${more}`, role: "group", "aria-label": label }, children);
}
function IconButton({ icon, label, shortcut, disabled = false, onClick }) {
  const title = shortcut === void 0 ? label : `${label} (${shortcut})`;
  return /* @__PURE__ */ k("button", { class: "icon-button", title, "aria-label": label, "aria-disabled": disabled, onClick: () => onClick() }, /* @__PURE__ */ k(Icon, { name: icon }));
}
function Radios({ label, names, value, textOf, iconOf, onChoice }) {
  const onKeyDown = (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (step === void 0) return;
    event.preventDefault();
    event.stopPropagation();
    const next = names[(names.indexOf(value) + step + names.length) % names.length];
    if (next === void 0) return;
    onChoice(next);
    event.currentTarget.querySelector(`[data-name="${next}"]`)?.focus();
  };
  return /* @__PURE__ */ k("div", { class: "radios", role: "radiogroup", "aria-label": label, onKeyDown }, names.map((name) => /* @__PURE__ */ k(
    "button",
    {
      key: name,
      class: "icon-button",
      role: "radio",
      "data-name": name,
      tabIndex: name === value ? 0 : -1,
      "aria-checked": name === value,
      "aria-label": textOf(name),
      title: textOf(name),
      onClick: () => onChoice(name)
    },
    /* @__PURE__ */ k(Icon, { name: iconOf(name) })
  )));
}
function letterOf(view, ends) {
  const place = { left: 0, right: 1, back: 2, front: 3, bottom: 4, top: 5 }[view];
  return ends[place] ?? view;
}

// src/view/page.tsx
var BODIES = {
  about: AboutPanel,
  looks: PresetsPanel,
  function: FunctionPanel,
  layers: LayersPanel,
  labels: LabelsPanel,
  light: LightPanel,
  cut: CutPanel,
  slices: SlicesPanel,
  measure: MeasurePanel,
  share: SharePanel
};
function Page({ page, onKey, onPage, ...part }) {
  const { store, ui, welcome } = part;
  const { layout, interface: shown } = store.state.view;
  const panels = PANELS.filter((name) => name !== "labels" || store.state.labels !== null);
  const opened = openSheet(shown.panels);
  const open = opened === "labels" && store.state.labels === null ? null : opened;
  const hasStrip = shown.panels.includes("presets");
  const onPanel = (name) => store.change([set(toggled(shown.panels, name), "view", "interface", "panels")]);
  const [isFinding, setFinding] = d2(false);
  useFindKey(ui, () => setFinding(true));
  const theme = themeOf(store.state);
  const slice = (pane) => /* @__PURE__ */ k(Memo, { key: pane, of: shownBySlices(part) }, () => /* @__PURE__ */ k(SlicePane, { ...part, pane }));
  const hasTimes = welcome.volumes.some((volume2) => volume2.n_times > 1);
  return /* @__PURE__ */ k(
    "div",
    {
      class: "wavesplat",
      "data-theme": theme,
      "data-sheet": open !== null,
      "data-strip": hasStrip,
      "data-times": hasTimes,
      onKeyDown: onKey
    },
    /* @__PURE__ */ k(Memo, { of: [...shownByToolbar(part), open] }, () => /* @__PURE__ */ k(Toolbar, { ...part, isAbout: open === "about", onAbout: () => onPanel("about"), onFit: () => fit(part) })),
    /* @__PURE__ */ k("main", { class: "views", "data-layout": layout.name }, (layout.name !== "single" || layout.main === "3d") && /* @__PURE__ */ k(SceneView, { ...part }), (layout.name === "one-and-three" || layout.name === "two-by-two") && PANES.map(slice), layout.name === "single" && layout.main !== "3d" && slice(layout.main)),
    /* @__PURE__ */ k(Rail, { panels, open: [open ?? "", hasStrip ? "presets" : ""], onPanel }, /* @__PURE__ */ k("button", { class: "rail-button", title: `${WORDS.palette.find} (Ctrl K)`, onClick: () => setFinding(true) }, /* @__PURE__ */ k(Icon, { name: "search" }), /* @__PURE__ */ k("span", null, WORDS.palette.open)), /* @__PURE__ */ k("button", { class: "rail-button", title: theme === "dark" ? WORDS.toolbar.light : WORDS.toolbar.dark, onClick: () => store.change([set(theme === "dark" ? "light" : "dark", "view", "interface", "theme")]) }, /* @__PURE__ */ k(Icon, { name: "dark" }), /* @__PURE__ */ k("span", null, WORDS.toolbar.theme_short)), /* @__PURE__ */ k("button", { class: "rail-button", title: `${WORDS.toolbar.help} (?)`, onClick: () => onPage({ help: true }) }, /* @__PURE__ */ k(Icon, { name: "help" }), /* @__PURE__ */ k("span", null, WORDS.toolbar.help_short))),
    open !== null && /* @__PURE__ */ k(Sheet, { key: open, name: open, onClose: () => onPanel(open) }, /* @__PURE__ */ k(Memo, { of: [...shownByPanels(part), page.figures] }, () => /* @__PURE__ */ k(Body, { key: welcome.fingerprint, ...part, name: open, figures: page.figures, onFigures: (figures) => onPage({ figures }) }))),
    /* @__PURE__ */ k("footer", { class: "bottom" }, hasStrip && /* @__PURE__ */ k(Memo, { of: shownByPanels(part) }, () => /* @__PURE__ */ k(LooksStrip, { key: welcome.fingerprint, ...part, onAll: () => onPanel("looks") })), hasTimes && /* @__PURE__ */ k(TimeBar, { ...part }), /* @__PURE__ */ k(Status, { ...part, connection: page.connection, figures: page.figures })),
    /* @__PURE__ */ k("p", { class: "hidden", role: "status", "aria-live": "polite" }, page.said),
    page.problem !== null && /* @__PURE__ */ k(ProblemCard, { problem: page.problem, onClose: () => onPage({ problem: null }) }),
    /* @__PURE__ */ k(Openings, { ...part }),
    isFinding && /* @__PURE__ */ k(Palette, { ...part, onClose: () => setFinding(false) }),
    page.help && /* @__PURE__ */ k(Help, { onClose: () => onPage({ help: false }) })
  );
}
function Body({ name, figures, onFigures, ...part }) {
  if (name === "settings") return /* @__PURE__ */ k(SettingsPanel, { ...part, figures, onFigures });
  const Panel = BODIES[name];
  return /* @__PURE__ */ k(Panel, { ...part });
}
function useFindKey({ root, host }, onFind) {
  A2(() => {
    const target = host === "page" ? document : root;
    const onKey = (event) => {
      if (actionOf(keyName(event)) !== "find") return;
      event.preventDefault();
      onFind();
    };
    target.addEventListener("keydown", onKey);
    return () => target.removeEventListener("keydown", onKey);
  }, [root, host]);
}

// src/view/page_state.ts
var FIRST = {
  connection: { kind: "connecting", text: "" },
  problem: null,
  failure: null,
  tool: "turn",
  points: [],
  layer: 0,
  probed: "",
  help: false,
  figures: false,
  said: ""
};
var ANNOUNCED_MS = 1e3;
var PROBE_MS = 40;
var PageState = class {
  now = FIRST;
  listeners = /* @__PURE__ */ new Set();
  probeTimer;
  sayTimer;
  lastSaid = 0;
  get fields() {
    return this.now;
  }
  change(next) {
    const isSame = Object.keys(next).every((name) => next[name] === this.now[name]);
    if (isSame) return;
    this.now = { ...this.now, ...next };
    this.listeners.forEach((listener) => listener());
  }
  subscribe(listener) {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }
  /** Asks for what is under the pointer, at most every 40 ms, and for its newest place alone; null where it has left. */
  probe(ask) {
    clearTimeout(this.probeTimer);
    const timer = setTimeout(() => {
      ask?.().then((probed) => this.probeTimer === timer && this.change({ probed }), () => void 0);
    }, PROBE_MS);
    this.probeTimer = timer;
    if (ask === null) this.change({ probed: "" });
  }
  /** Shows what is under the pointer, where it is known at once. */
  tell(probed) {
    clearTimeout(this.probeTimer);
    this.change({ probed });
  }
  /** Announces a text to screen readers, at most once a second: the newest one. */
  announce(text2) {
    clearTimeout(this.sayTimer);
    const wait = Math.max(0, this.lastSaid + ANNOUNCED_MS - performance.now());
    this.sayTimer = setTimeout(() => {
      this.lastSaid = performance.now();
      this.change({ said: text2 });
    }, wait);
  }
  close() {
    clearTimeout(this.probeTimer);
    clearTimeout(this.sayTimer);
    this.listeners.clear();
  }
};

// src/view/style.css
var style_default = '/* Sizes: --rail, --bar and --foot are what the rail, the tools above and the bar of times below take from the picture. */\n:host { display: block; contain: content }\n.mount { height: 100%; container-type: size }\n.wavesplat {\n  --bg: #0b0d10; --panel: #15191f; --raised: #232a33; --line: #39424e; --text: #e8ebf0; --dim: #a9b3c0;\n  --accent: #6cb2ff; --accent-text: #08131f; --focus: #ffd166; --danger: #ff8f8f;\n  --gap: 8px; --radius: 8px; --rail: 72px; --bar: 52px; --sheet: 344px;\n  --glass: #161a21eb; --lift: 0 0 0 1px #ffffff14, 0 6px 24px #0009;\n  box-sizing: border-box; position: relative; width: 100%; height: 100%; overflow: hidden; background: var(--bg); color: var(--text);\n  font: 13px/1.4 system-ui, "Segoe UI", Roboto, sans-serif; font-variant-numeric: tabular-nums; color-scheme: dark;\n}\n.wavesplat[data-theme="light"] {\n  --bg: #e7eaee; --panel: #fff; --raised: #eceff3; --line: #8a93a0; --text: #161a20; --dim: #4b5563;\n  --accent: #0a5cb8; --accent-text: #fff; --focus: #b45309; --danger: #b42318;\n  --glass: #fcfdfef2; --lift: 0 0 0 1px #0000001f, 0 6px 24px #0005; color-scheme: light;\n}\n.wavesplat { --strip: 0px; --times: 0px; --foot: calc(var(--strip) + var(--times)) }\n.wavesplat[data-times="true"] { --times: 56px }\n.wavesplat[data-strip="true"] { --strip: 146px }\n.wavesplat *, .wavesplat *::before { box-sizing: border-box }\n.wavesplat :focus-visible { outline: 2px solid var(--focus); outline-offset: 1px }\n.wavesplat h2, .wavesplat h3, .wavesplat p { margin: 0; font-size: inherit; font-weight: 600 }\n.wavesplat p { font-weight: 400 }\n.wavesplat button, .wavesplat select, .wavesplat input, .wavesplat textarea { font: inherit; color: inherit }\n.wavesplat input[type="range"] { accent-color: var(--accent); min-width: 0; flex: 1; height: 24px; margin: 0 }\n.wavesplat input[type="checkbox"], .wavesplat input[type="radio"] { accent-color: var(--accent); width: 18px; height: 18px; margin: 3px }\n.wavesplat input[type="color"] { width: 34px; height: 26px; padding: 1px; border: 1px solid var(--line); border-radius: 6px; background: none }\n.wavesplat input[type="number"], .wavesplat input[type="text"], .wavesplat input[type="search"], .wavesplat select, .wavesplat textarea {\n  background: var(--raised); border: 1px solid var(--line); border-radius: 6px; padding: 2px 7px; min-height: 28px; min-width: 0;\n}\n.wavesplat input[type="number"] { width: 96px; appearance: textfield; text-align: right }\n.wavesplat input[type="number"]::-webkit-inner-spin-button { display: none }\n.button {\n  background: var(--raised); border: 1px solid var(--line); border-radius: 6px; padding: 3px 10px; min-height: 28px; cursor: pointer;\n}\n.button:hover { border-color: var(--accent) }\n.icon-button:hover, .rail-button:hover, .title:hover, .title[aria-expanded="true"] { background: var(--raised) }\n.button:disabled, .icon-button:disabled, .icon-button[aria-disabled="true"] { opacity: .45; cursor: default }\n.button[aria-pressed="true"], .icon-button[aria-pressed="true"], .icon-button[aria-checked="true"], .rail-button[aria-expanded="true"] {\n  background: var(--accent); color: var(--accent-text); border-color: var(--accent);\n}\n.icon-button {\n  display: inline-grid; place-items: center; min-width: 32px; height: 32px; padding: 0 6px; border: 0; border-radius: 6px;\n  background: none; cursor: pointer; flex: none;\n}\n.icon-button svg, .rail-button svg { width: 18px; height: 18px; fill: none; stroke: currentColor; stroke-width: 1.5; stroke-linecap: round; stroke-linejoin: round }\n.row { display: flex; flex-wrap: wrap; align-items: center; gap: 6px }\n.field { display: flex; align-items: center; gap: 6px; min-width: 0 }\n.field > span:first-child { flex: 0 0 112px; color: var(--dim) }\n.spring { flex: 1 }\n.float { background: var(--glass); box-shadow: var(--lift); border-radius: var(--radius) }\n.toolbar { position: absolute; z-index: 3; left: calc(var(--rail) + 8px); right: 104px; top: 8px; display: flex; align-items: center; gap: var(--gap); pointer-events: none }\n.toolbar > * { pointer-events: auto }\n.toolbar .group { display: flex; align-items: center; gap: 1px; padding: 3px; min-height: 38px }\n.toolbar .title-group { min-width: 0; margin: 0; flex: 0 1 auto }\n.radios { display: flex; gap: 1px }\n.wavesplat .title { border: 0; border-radius: 6px; background: none; height: 32px; padding: 0 10px; cursor: pointer; font-size: 13px; font-weight: 600; max-width: 220px; overflow: hidden; text-overflow: ellipsis; white-space: nowrap }\n.rail { position: absolute; z-index: 3; left: 8px; top: 8px; bottom: 8px; width: 64px; padding: 4px; display: flex; flex-direction: column; gap: 1px; overflow: auto; scrollbar-width: none }\n.rail-button {\n  display: grid; justify-items: center; align-content: center; gap: 2px; width: 100%; min-height: 46px; padding: 3px 0; border: 0; border-radius: 6px;\n  background: none; cursor: pointer; flex: none;\n}\n.wavesplat .rail-button { font-size: 11px; line-height: 1.1 }\n.sheet { position: absolute; z-index: 3; left: calc(var(--rail) + 8px); top: 54px; max-height: calc(100% - 62px - var(--foot)); width: var(--sheet); display: flex; flex-direction: column; overflow: hidden }\n.sheet-head { display: flex; align-items: center; justify-content: space-between; padding: 5px 6px 5px 14px; flex: none }\n.wavesplat .sheet-head h2 { font-size: 13px }\n.sheet > .body { display: grid; gap: 8px; padding: 4px 14px 14px; overflow-y: auto; overflow-x: hidden; min-height: 0; align-content: start }\n.sheet > .body:focus-visible { outline-offset: -2px }\n.views { position: absolute; inset: 0 0 var(--strip); display: grid; gap: 2px; background: var(--line) }\n.views[data-layout="3d"], .views[data-layout="single"] { grid-template: 1fr / 1fr }\n.views[data-layout="one-and-three"] { grid-template: repeat(3, minmax(0, 1fr)) / minmax(0, 2fr) minmax(0, 1fr) }\n.views[data-layout="one-and-three"] > :first-child { grid-row: 1 / 4 }\n.views[data-layout="two-by-two"] { grid-template: repeat(2, minmax(0, 1fr)) / repeat(2, minmax(0, 1fr)) }\n/* Several views make room for the sheet where they can; it lies over the picture where there is but one. */\n@container (min-width: 901px) {\n  .wavesplat[data-sheet="true"] .views:not([data-layout="3d"], [data-layout="single"]) { left: calc(var(--rail) + var(--sheet) + 12px) }\n}\n.wavesplat[data-sheet="false"] .views > :first-child, .wavesplat[data-sheet="false"] .views[data-layout="two-by-two"] > :nth-child(3),\n.views[data-layout="3d"] > *, .views[data-layout="single"] > * { --left: var(--rail) }\n.wavesplat[data-sheet="true"] .views:is([data-layout="3d"], [data-layout="single"]) > * { --left: calc(var(--rail) + var(--sheet) + 8px) }\n.views > :first-child, .views > :nth-child(2) { --top: var(--bar) }\n.views[data-layout="two-by-two"] > :first-child, .wavesplat[data-sheet="true"] .views[data-layout="one-and-three"] > :first-child { --cube: var(--bar) }\n.views > :last-child, .views[data-layout="one-and-three"] > :first-child, .views[data-layout="two-by-two"] > :nth-child(3) { --bottom: var(--times) }\n.viewport { --left: 0px; --top: 0px; --bottom: 0px; --cube: 0px; position: relative; overflow: hidden; background: #000; min-width: 0; min-height: 0; touch-action: none; user-select: none; color: #fff }\n.viewport:focus-visible { outline-offset: -2px }\n.viewport canvas { position: absolute; inset: 0; width: 100%; height: 100%; display: block; transform-origin: 0 0 }\n.viewport svg.over { position: absolute; inset: 0; width: 100%; height: 100%; overflow: hidden; pointer-events: none }\n.viewport svg.over [data-handle] { pointer-events: auto; cursor: grab }\n.viewport svg.over text { fill: #fff; paint-order: stroke; stroke: #000; stroke-width: 3px; stroke-linejoin: round; font-size: 13px }\n.viewport .corner { position: absolute; left: calc(8px + var(--left)); top: calc(6px + var(--top)); font-size: 12px; text-shadow: 0 0 3px #000; pointer-events: none; white-space: pre-line }\n.viewport .corner.right { left: auto; right: 8px; text-align: right }\n.viewport .corner.low { top: auto; bottom: calc(6px + var(--bottom)) }\n.over .at-left { transform: translateX(var(--left)) }\n.over .at-top { transform: translateY(var(--top)) }\n.over .at-bottom { transform: translateY(calc(-1 * var(--bottom))) }\n.over .at-cube { transform: translateY(var(--cube)) }\n.over .at-corner { transform: translate(var(--left), calc(-1 * var(--bottom))) }\n.viewport[data-view="3d"] { cursor: grab }\n.viewport[data-view="3d"]:active { cursor: grabbing }\n.viewport[data-tool="turn"]:not([data-view="3d"]) { cursor: move }\n.viewport[data-tool="window"] { cursor: ns-resize }\n.viewport[data-tool="distance"], .viewport[data-tool="area"] { cursor: crosshair }\n.viewport[data-tool="angle"] { cursor: cell }\n.viewport:not([data-tool="turn"]) svg.over [data-handle] { pointer-events: none }\n.viewport svg.over .quiet [data-handle] { opacity: 0 }\n.viewport:hover svg.over .quiet [data-handle], .viewport svg.over .quiet [data-handle]:focus { opacity: 1 }\n@media (hover: none) { .viewport svg.over .quiet [data-handle] { opacity: .7 } }\n.viewport .pill { background: #000b; border-radius: 5px; padding: 2px 7px; line-height: 17px; text-shadow: none }\n.viewport .texts { position: absolute; inset: var(--top) 0 var(--bottom) var(--left); pointer-events: none }\n.viewport .texts > * { --left: 0px; --top: 0px; --bottom: 0px }\n.viewport .letter { position: absolute; translate: 0 -50%; font-size: 12px; pointer-events: none }\n.viewport .menu { pointer-events: auto; cursor: pointer }\n.viewport .menu select { background: none; border: 0; padding: 0; font-size: 12px; color: inherit; cursor: pointer; min-height: 17px; height: 17px; field-sizing: content }\n.viewport .menu option { color: var(--text); background: var(--panel) }\n.viewport .scale { display: grid; gap: 3px }\n.viewport .scale span { height: 3px; background: #fff; border-radius: 1px }\n.hint { position: absolute; left: 50%; bottom: 12%; transform: translateX(-50%); background: #000c; padding: 6px 12px; border-radius: var(--radius) }\n.bottom { position: absolute; z-index: 2; left: calc(var(--rail) + 8px); right: 8px; bottom: 8px; display: flex; flex-direction: column; align-items: flex-end; gap: 6px; pointer-events: none }\n.bottom > * { pointer-events: auto }\n.status { display: flex; flex-wrap: wrap; justify-content: flex-end; gap: 4px 6px; order: -1 }\n.status > * { background: var(--glass); box-shadow: var(--lift); border-radius: var(--radius); padding: 3px 10px; font-size: 12px }\n.status > [role="note"] { animation: noted 1s 9s forwards }\n@keyframes noted { to { opacity: 0; visibility: hidden } }\n.looks { align-self: flex-start; max-width: 100%; padding: 6px }\n.looks > .body { display: flex; align-items: stretch; gap: 8px }\n.looks .field { flex-direction: column; align-items: stretch; justify-content: center; width: 130px; flex: none }\n.wavesplat .looks .field > span:first-child { flex: none }\n.looks .look-tiles { display: flex; gap: 6px; overflow-x: auto; scrollbar-width: thin; padding: 2px; min-width: 0; justify-content: flex-start }\n.looks .look-tile { flex: none; width: 98px }\n.looks .look-name { white-space: nowrap; overflow: hidden; text-overflow: ellipsis }\n.looks-all { flex: none; max-width: 76px }\n.alert { position: absolute; left: 50%; top: 60px; transform: translateX(-50%); max-width: min(560px, 92%); z-index: 5; background: var(--panel); border: 1px solid var(--danger); border-radius: var(--radius); padding: 10px 14px; display: grid; gap: 6px }\n.opening { position: absolute; inset: 0; display: grid; place-content: center; gap: 10px; padding: 24px; text-align: center }\n.opening progress { width: 260px; accent-color: var(--accent) }\n.dim { color: var(--dim) }\n.hidden { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap }\n.wavesplat dialog { background: var(--panel); color: var(--text); border: 1px solid var(--line); border-radius: var(--radius); padding: 16px 20px; max-width: min(640px, 94vw); max-height: 86vh; overflow: auto }\n.wavesplat dialog.help { width: min(960px, 94vw); max-width: none; max-height: 94vh; font-size: 13px }\n.wavesplat .help th, .wavesplat .help td { padding: 1px 12px 1px 0 }\n.help .spring { flex: 1 }\n.help .columns { display: grid; margin-top: 8px; grid-template-columns: repeat(auto-fit, minmax(min(360px, 100%), 1fr)); gap: 12px 32px; align-items: start }\n.help caption { text-align: left; font-weight: 600; padding-bottom: 4px }\n.wavesplat dialog::backdrop { background: #0008 }\n.wavesplat .palette { width: min(560px, 94vw); padding: 8px; margin-top: 12vh; overflow: hidden; box-shadow: var(--lift); border-radius: 12px }\n.wavesplat .palette[open] { display: flex; flex-direction: column; gap: 6px }\n.wavesplat .palette input { width: 100%; min-height: 40px; font-size: 15px; padding: 4px 12px }\n.wavesplat .palette ul { list-style: none; margin: 0; padding: 0; overflow-y: auto; max-height: 46vh }\n.palette li { display: flex; justify-content: space-between; gap: 16px; padding: 5px 12px; border-radius: 6px; cursor: pointer }\n.palette li[aria-selected="true"] { background: var(--accent); color: var(--accent-text) }\n.palette li[aria-selected="true"] .dim { color: inherit }\n.palette li:hover:not([aria-selected="true"]) { background: var(--raised) }\n.wavesplat table { border-collapse: collapse; width: 100% }\n.wavesplat th, .wavesplat td { text-align: left; padding: 3px 12px 3px 0; vertical-align: top; font-weight: 400 }\n.wavesplat kbd { background: var(--raised); border-radius: 3px; padding: 0 6px; font: inherit }\n.chip { width: 18px; height: 18px; border-radius: 3px; border: 1px solid var(--line); flex: none }\n@container (max-width: 1000px) {\n  .standard-views { display: none !important }\n}\n@container (max-height: 620px) {\n  .status > [role="note"] { display: none }\n  .wavesplat[data-strip="true"] { --strip: 100px }\n  .looks { padding: 3px }\n  .looks .look-tile { width: 64px }\n  .looks .look-tile img, .looks .look-blank { width: 62px; height: 62px }\n  .looks .look-blank { padding: 18px 0 }\n  .wavesplat { --rail: 52px }\n  .rail { width: 40px; padding: 2px; left: 6px }\n  .rail-button { min-height: 28px }\n  .rail-button > span { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap }\n}\n/* A phone: tools in one row above, the rail below, and a sheet from below that leaves the picture 60 % of the height. */\n@container (max-width: 600px) {\n  .status > [role="note"] { display: none }\n  .views[data-layout="one-and-three"] > :nth-child(2) { --top: 0px }\n  .views > :first-child { --cube: var(--bar) !important; --left: 0px !important }\n  .wavesplat { --rail: 0px; display: grid; grid-template: minmax(0, 1fr) auto auto auto / minmax(0, 1fr) }\n  .views { position: relative; grid-area: 1 / 1 }\n  .views[data-layout="one-and-three"] { grid-template: minmax(0, 2fr) minmax(0, 1fr) / repeat(3, minmax(0, 1fr)) }\n  .views[data-layout="one-and-three"] > :first-child { grid-row: auto; grid-column: 1 / 4 }\n  .toolbar { left: 6px; right: 6px; top: 6px; gap: 4px; overflow-x: auto; scrollbar-width: none }\n  .title-group { display: none !important }\n  .sheet { position: relative; left: 0; top: 0; width: auto; grid-area: 3 / 1; max-height: 31cqh; border-radius: 12px 12px 0 0 }\n  .rail { position: relative; left: 0; top: 0; bottom: 0; width: auto; grid-area: 4 / 1; flex-direction: row; border-radius: 0; padding: 2px 4px }\n  .rail .spring { display: none }\n  .rail-button { width: auto; min-width: 52px }\n  .wavesplat[data-strip="true"] { --strip: 0px }\n  .bottom { position: relative; left: 0; right: 0; bottom: 0; grid-area: 2 / 1; padding: 4px 6px }\n  .status { position: absolute; right: 6px; bottom: calc(100% + 4px); left: 6px }\n  .looks { align-self: stretch }\n  .wavesplat[data-sheet="true"] .looks { display: none }\n}\n@media (pointer: coarse) {\n  .icon-button, .button { min-width: 44px; min-height: 44px }\n}\n@media (forced-colors: active) {\n  .icon-button[aria-pressed="true"], .icon-button[aria-checked="true"], .button[aria-pressed="true"] { forced-color-adjust: none; background: Highlight; color: HighlightText }\n}\n.wavesplat fieldset { border: 1px solid var(--line); border-radius: var(--radius); margin: 0; padding: 6px 10px 10px; display: grid; gap: 6px; min-width: 0 }\n.wavesplat legend { padding: 0 4px; color: var(--dim) }\n.wavesplat ol, .wavesplat ul { margin: 0; padding-left: 20px }\n.viewport .legend { top: calc(8px + var(--top)); left: calc(8px + var(--left)); max-width: min(240px, 42%); list-style: none; padding: 4px; display: grid; gap: 0; pointer-events: auto; text-shadow: none; background: var(--glass); color: var(--text); box-shadow: var(--lift); border-radius: var(--radius) }\n.legend-row { display: flex; gap: 8px; align-items: center; width: 100%; min-height: 24px; padding: 1px 6px; border: 0; border-radius: 5px; background: none; cursor: pointer; text-align: left; font-size: 12px }\n.legend-row:hover { background: var(--raised) }\n.legend-row > span:last-child { min-width: 0; overflow: hidden; text-overflow: ellipsis; white-space: nowrap }\n.legend-row .chip { width: 14px; height: 14px }\n.legend-row .look-chip { width: 34px }\n.legend-row[aria-pressed="false"] { color: var(--dim) }\n.legend-row[aria-pressed="false"] > .chip { background: none !important }\n.viewport .color-bar { display: grid; justify-items: end; gap: 3px; bottom: calc(44px + var(--bottom)) }\n.viewport .color-bar .ramp { width: 14px; height: 150px; border: 1px solid #fff8 }\n.about { display: grid; gap: 6px }\n.about dl { display: grid; grid-template-columns: auto 1fr; gap: 3px 14px; margin: 0 }\n.about dt { color: var(--dim) }\n.about dd { margin: 0; overflow-wrap: anywhere }\n.about h4 { margin: 4px 0 0; font-weight: 600; font-size: 12px; color: var(--dim) }\n.wavesplat .about ul { padding-left: 16px; display: grid; gap: 4px }\n';

// src/input/camera_path.ts
function between2(from, to, t3) {
  if (t3 >= 1 || from.parallel_scale === void 0 !== (to.parallel_scale === void 0)) return to;
  const { axis, angle } = rotation(from, to);
  const { up, back } = axesOf(from);
  const focal = add(from.focal_point, scaled(sub(to.focal_point, from.focal_point), t3));
  const away = byFactors(length(sub(from.position, from.focal_point)), length(sub(to.position, to.focal_point)), t3);
  const place = {
    version: 1,
    position: add(focal, scaled(turnedAbout(back, axis, angle * t3), away)),
    focal_point: focal,
    view_up: turnedAbout(up, axis, angle * t3)
  };
  if (from.parallel_scale !== void 0 && to.parallel_scale !== void 0) {
    return { ...place, parallel_scale: byFactors(from.parallel_scale, to.parallel_scale, t3) };
  }
  return { ...place, view_angle: byFactors(from.view_angle ?? 30, to.view_angle ?? 30, t3) };
}
var byFactors = (a3, b, t3) => a3 * (b / a3) ** t3;
function rotation(from, to) {
  const [a3, b] = [axesOf(from), axesOf(to)];
  const pairs = [[a3.up, b.up], [a3.right, b.right], [a3.back, b.back]];
  const sines = pairs.reduce((sum, [one, other]) => add(sum, cross(one, other)), [0, 0, 0]);
  const cosines = pairs.reduce((sum, [one, other]) => sum + dot(one, other), 0);
  const angle = Math.atan2(length(sines), cosines - 1);
  if (length(sines) > 1e-6) return { axis: unit(sines), angle };
  if (cosines > 0) return { axis: a3.up, angle: 0 };
  const sums = pairs.map(([one, other]) => add(one, other));
  return { axis: unit(sums.reduce((best, sum) => length(sum) > length(best) ? sum : best)), angle: Math.PI };
}

// src/view/camera_mover.ts
var EASE_MS = 200;
var SAME_ASPECT = 1e-3;
var CameraMover = class {
  constructor(engine, store, fail) {
    this.engine = engine;
    this.store = store;
    this.fail = fail;
  }
  engine;
  store;
  fail;
  number = 0;
  frame = 0;
  aspect = 0;
  size = { width: 4, height: 3 };
  seen = null;
  /** Shows what is seen from the direction of a camera, with its lens: all of it, with the margin of first pictures. */
  async show(camera) {
    await this.ask(() => this.engine.ask("framed", { camera, ...this.size }));
  }
  /** Goes back to the view of the first picture. */
  async showFirst() {
    await this.ask(() => this.engine.ask("first_view", this.size));
  }
  /** Moves to a camera: in 200 ms, or at once for those who want less motion, and in windows that are not seen. */
  to(target) {
    this.stop();
    const from = this.store.state.camera;
    const isAtOnce = document.hidden || matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (isAtOnce) {
      this.store.change([set(target, "camera")]);
      return;
    }
    const begun = performance.now();
    let last = from;
    const step = () => {
      if (this.store.state.camera !== last) return;
      const t3 = Math.min(1, (performance.now() - begun) / EASE_MS);
      this.store.change([set(between2(from, target, t3 * t3 * (3 - 2 * t3)), "camera")], "ease");
      last = this.store.state.camera;
      if (t3 < 1) this.frame = requestAnimationFrame(step);
      else this.store.settle();
    };
    this.frame = requestAnimationFrame(step);
  }
  /** Ends a move where it is, as a gesture begins. */
  stop() {
    this.number += 1;
    cancelAnimationFrame(this.frame);
  }
  /** Keeps in view what was in view, as the 3-D view gets another size. */
  async resized(size) {
    const before2 = this.aspect;
    this.size = size;
    this.aspect = size.width / size.height;
    if (before2 === 0 || Math.abs(this.aspect / before2 - 1) < SAME_ASPECT) return;
    const { camera } = this.store.state;
    if (this.seen?.kept !== camera) this.seen = { camera, aspect: before2, kept: camera };
    const { seen, aspect } = this;
    try {
      const asked = { camera: seen.camera, aspect: seen.aspect, ...size };
      const answer = await this.engine.ask("kept_in_view", asked);
      if (this.store.state.camera !== camera || this.aspect !== aspect) return;
      this.store.adjust([set(answer.camera, "camera")]);
      this.seen = { ...seen, kept: this.store.state.camera };
    } catch (problem) {
      this.fail(problem);
    }
  }
  async ask(question) {
    this.stop();
    const { number: number2 } = this;
    try {
      const { camera } = await question();
      if (number2 === this.number) this.to(camera);
    } catch (problem) {
      this.fail(problem);
    }
  }
};

// src/view/views.ts
var Views = class {
  shown = /* @__PURE__ */ new Map();
  last = "3d";
  /** Adds a view that is shown; returns a function that removes it. */
  add(view, receive) {
    this.shown.set(view, receive);
    return () => this.shown.delete(view);
  }
  /** Notes that something was done in a view. */
  use(view) {
    this.last = view;
  }
  /** Passes a key on to the view that was used last or, where that is gone, to the first one. */
  receive(event) {
    const receive = this.shown.get(this.last) ?? [...this.shown.values()][0];
    receive?.(event);
  }
};

// src/view/ui.ts
var DOWNLOADED_MS = 1e4;
function createUi(engine, store, page, around2) {
  const { root, host, statistics, opener, frames, schedule } = around2;
  let restCamera = null;
  return {
    root,
    host,
    statistics,
    opener,
    frames,
    camera: new CameraMover(engine, store, (problem) => page.change({ problem: problemOf(problem) })),
    views: new Views(),
    frameShown(frame) {
      frames[frame.view] = frame;
      if (frame.at_rest && frame.camera !== void 0) restCamera = frame.camera;
      statistics.drawn(frame, performance.now());
      schedule();
    },
    get restCamera() {
      return restCamera;
    },
    get tool() {
      return page.fields.tool;
    },
    setTool: (tool) => page.change({ tool, points: [] }),
    get points() {
      return page.fields.points;
    },
    addPoint(point2) {
      const kind2 = page.fields.tool === "angle" ? "angle" : "distance";
      const points = [...page.fields.points, point2];
      const isWhole = page.fields.tool !== "area" && points.length >= (kind2 === "angle" ? 3 : 2);
      page.change({ points: isWhole ? [] : points });
      if (isWhole && isMeasure(points)) store.change([set({ kind: kind2, points }, "view", "measures", "-")]);
    },
    get layer() {
      return Math.min(page.fields.layer, store.state.layers.length - 1);
    },
    setLayer: (layer) => page.change({ layer }),
    get probed() {
      return page.fields.probed;
    },
    probe: (ask) => page.probe(ask),
    tell: (text2) => page.tell(text2),
    announce: (text2) => page.announce(text2),
    problem: (problem) => page.change({ problem: problemOf(problem) }),
    download(name, content, type) {
      const url = URL.createObjectURL(new Blob([content], { type }));
      const link = document.createElement("a");
      link.href = url;
      link.download = name;
      link.click();
      setTimeout(() => URL.revokeObjectURL(url), DOWNLOADED_MS);
    }
  };
}

// src/view/app.tsx
function mountApp(parent, engine, host) {
  const root = parent.shadowRoot ?? parent.attachShadow({ mode: "open" });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync([style_default, look_default, cube_default, open_default].join("\n"));
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
    this.opener = new PageOpener({
      engine,
      hasData: () => this.store !== null,
      aspect: () => {
        const frame = this.frames["3d"];
        return frame === void 0 ? null : frame.width / frame.height;
      },
      change: (operations) => this.store?.change(operations),
      openState: (file) => this.openState(file),
      announce: (text2) => this.page.announce(text2),
      problem: (problem) => this.page.change({ problem }),
      changed: () => this.schedule()
    });
    this.stops.push(
      this.opener.listen(mount),
      this.page.subscribe(() => this.schedule()),
      engine.onConnection((connection) => {
        this.page.change({ connection });
        if (connection.kind === "start") this.opener.setOffered(connection.offered);
      }),
      engine.onProblem((problem) => this.page.change({ problem })),
      onThemeChange(() => this.schedule())
    );
    engine.welcome.then(
      (welcome) => void this.begin(welcome),
      (problem) => this.page.change({ failure: problemOf(problem) })
    );
    this.draw();
  }
  engine;
  host;
  root;
  mount;
  store = null;
  welcome = null;
  ui = null;
  page = new PageState();
  frames = {};
  statistics = new FrameStatistics();
  isScheduled = false;
  stops = [];
  opener;
  close() {
    this.page.close();
    this.stops.forEach((stop) => stop());
  }
  async begin(welcome) {
    const store = createStore(welcome.state, this.engine);
    [this.welcome, this.store] = [welcome, store];
    this.ui = createUi(this.engine, store, this.page, {
      root: this.root,
      host: this.host.kind,
      frames: this.frames,
      statistics: this.statistics,
      opener: this.opener,
      schedule: () => this.schedule()
    });
    const follower = new DataFollower(this.engine, () => store.state, (data) => {
      this.welcome = { ...welcome, ...data };
      this.host.onVolumes?.(data.volumes.map(({ name }) => name));
      this.expose();
      this.schedule();
    });
    this.stops.push(
      store.subscribe(() => {
        follower.check();
        this.schedule();
      })
    );
    this.host.onVolumes?.(welcome.volumes.map(({ name }) => name));
    if (this.host.kind === "page") {
      document.addEventListener("keydown", this.onKey);
      this.stops.push(() => document.removeEventListener("keydown", this.onKey));
    }
    this.expose();
    this.schedule();
    if (this.host.link === void 0) return;
    try {
      const { fingerprint, state: state2 } = await fromLink(this.host.link);
      if (fingerprint !== welcome.fingerprint) throw new Error("The link is of other data than is open here");
      const text2 = JSON.stringify(parseViewerState(state2));
      const { state: checked } = await this.engine.ask("open_state", { text: text2 });
      store.change([{ op: "replace", path: "", value: checked }]);
    } catch (problem) {
      this.page.change({ problem: problemOf(problem) });
    }
  }
  openState(file) {
    const { store, welcome, ui } = this;
    if (store !== null && welcome !== null && ui !== null) void openState({ store, welcome, engine: this.engine, ui }, file);
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
      const begun = performance.now();
      this.draw();
      this.statistics.interfaceDrawn(performance.now() - begun);
    });
  }
  onKey = (event) => {
    const target = event.composedPath()[0];
    const isField = target instanceof HTMLElement && target.matches("input, select, textarea, [contenteditable]");
    const action = actionOf(keyName(event));
    const { store, ui, page } = this;
    if (event.defaultPrevented || store === null || ui === null || isField && action !== "leave") return;
    if (action === "undo") store.undo();
    else if (action === "redo") store.redo();
    else if (action === "help") page.change({ help: true });
    else if (action === "leave" && (ui.tool !== "turn" || ui.points.length > 0)) ui.setTool("turn");
    else if (event.currentTarget === document && !page.fields.help && !isOfControl(target, event.key)) {
      ui.views.receive(event);
      return;
    } else return;
    event.preventDefault();
    event.stopPropagation();
    this.schedule();
  };
  draw() {
    const { store, welcome, ui, page } = this;
    if (store === null || welcome === null || ui === null) {
      Q(
        /* @__PURE__ */ k("div", { class: "wavesplat", "data-theme": surrounding() }, page.fields.connection.kind === "start" ? /* @__PURE__ */ k(StartPage, { opener: this.opener, engine: this.engine, host: this.host.kind }) : /* @__PURE__ */ k(Opening, { connection: page.fields.connection, problem: page.fields.failure })),
        this.mount
      );
      return;
    }
    const part = { store, engine: this.engine, welcome, ui };
    Q(/* @__PURE__ */ k(Page, { ...part, page: page.fields, onKey: this.onKey, onPage: (next) => page.change(next) }), this.mount);
  }
};
function isOfControl(target, key) {
  return target instanceof Element && target.matches("a, button, summary, [tabindex], dialog *") && /^(Arrow|Page|Home|End|Enter$| $)/.test(key);
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
    onOtherData: () => location.reload(),
    onSession: (key) => {
      unused = null;
      sessionStorage.setItem(KEY2, key);
      localStorage.setItem(`${KEY2}:${location.host}`, key);
    }
  });
  window.addEventListener("storage", ({ key }) => {
    if (key === `${KEY2}:${location.host}`) engine.retry();
  });
  const onVolumes = (names) => {
    document.title = `${names.join(", ")} – Wavesplat`;
  };
  return mountApp(element, engine, { kind: "page", link, onVolumes });
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
    const text2 = atob(buffer);
    return Uint8Array.from(text2, (letter) => letter.charCodeAt(0));
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
  const box2 = document.createElement("div");
  box2.style.cssText = `display:block;height:${HEIGHT_PX2}px;resize:vertical;overflow:hidden`;
  box2.dataset["lmSuppressShortcuts"] = "true";
  box2.addEventListener("keydown", (event) => {
    if (!event.ctrlKey && !event.metaKey) event.stopPropagation();
  });
  el.append(box2);
  const engine = remoteEngine(commChannel(model, page), { hello: () => ({}), repeatHelloMs: REPEAT_MS });
  const close = mountApp(box2, engine, { kind: "widget" });
  return () => {
    close();
    box2.remove();
  };
}

// src/viewer.ts
var viewer_default = { render };
export {
  viewer_default as default,
  openPage
};
