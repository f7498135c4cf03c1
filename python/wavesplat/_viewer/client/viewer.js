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
    if (!isScheduled || !isOpen) return;
    isScheduled = false;
    channel.send({ type: "patch", seq, operations: outgoing, moving: isMoving });
    if (outgoing.length > 0 && sizes.size > 0) expect();
    outgoing = [];
  };
  const sayHello = () => channel.send({ type: "hello", protocol: 1, ...options.hello() });
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
    for (const [view, { width, height }] of sizes) channel.send({ type: "view", view, size: [width, height] });
    if (!isFirst && state2 !== null) {
      outgoing = [{ op: "replace", path: "", value: state2 }];
      isMoving = false;
      isScheduled = true;
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
          if (waiting.has(id)) channel.send({ type: "cancel", id });
        });
        if (!isOpen || signal?.aborted) {
          waiting.delete(id);
          reject(isOpen ? { ...LOST, code: "cancelled" } : LOST);
          return;
        }
        flush();
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
  { keys: ["["], action: "slice-back", shown: "[", text: "Slice back" },
  { keys: ["]"], action: "slice-on", shown: "]", text: "Next slice" },
  { keys: ["Ctrl+z"], action: "undo", shown: "Ctrl Z", text: "Undo" },
  { keys: ["Ctrl+Shift+Z", "Ctrl+y"], action: "redo", shown: "Ctrl Shift Z", text: "Redo" },
  { keys: ["?"], action: "help", shown: "?", text: "Show this table" },
  { keys: ["Escape"], action: "leave", shown: "Esc", text: "Leave the tool, or close the sheet" }
];
var GESTURES = [
  ["Drag", "Turn"],
  ["Shift drag, middle button", "Move"],
  ["Wheel, right button", "Magnify"],
  ["Ctrl drag", "Roll"],
  ["Alt drag", "Window and level: of slices, in space of the opacities and colours"],
  ["Ctrl click", "Crosshair to what is seen"],
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
  const found = JSON.parse(text2);
  if (typeof found !== "object" || found === null || !("fingerprint" in found) || !("state" in found)) {
    throw new Error("the link holds no state of the viewer");
  }
  return { fingerprint: String(found.fingerprint), state: found.state };
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
var OVERLAYS = ["scale_bar", "letters", "cube", "color_bar", "crosshair", "crop_box", "legend"];

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
var oneOf = (...known) => (value, where) => {
  if (!known.includes(value)) refuse(value, where, `one of ${known.join(", ")}`);
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
var fields = (known) => (value, where) => {
  if (typeof value !== "object" || value === null || Array.isArray(value)) refuse(value, where, "an object");
  const found = value;
  const inside = (name) => where === "" ? name : `${where}.${name}`;
  for (const [name, check] of Object.entries(known)) {
    const plain = name.replace("?", "");
    if (name === "*") continue;
    if (Object.hasOwn(found, plain)) check(found[plain], inside(plain));
    else if (plain === name) throw new Error(`field '${inside(name)}' is missing`);
  }
  for (const name of Object.keys(found)) {
    if (name in known || `${name}?` in known) continue;
    const other = known["*"];
    if (other === void 0) throw new Error(`${where || "state"}: unknown field '${name}'`);
    other(found[name], inside(name));
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
var volume = fields({ path: oneOf(null), "name?": text });
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
  geometry: list(fields({ kind: text, name: text, count: number(), visible: flag })),
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
      fields({ kind: oneOf("distance", "angle"), points: list(point) })(value, where);
      const { kind: what, points } = value;
      list(any, what === "angle" ? 3 : 2, what === "angle" ? 3 : 2)(points, `${where}.points`);
    }, 0, 1e3),
    "overlays?": fields(Object.fromEntries(OVERLAYS.map((name) => [`${name}?`, flag]))),
    "quality?": fields({ "moving?": oneOf("smooth", "balanced", "exact") }),
    "interface?": fields({ "theme?": oneOf("system", "dark", "light"), "panels?": list(text, 0, 100) })
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
  const remember = (before) => {
    past = [...past.slice(1 - MAX_STEPS), before];
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
    const also = (before) => {
      try {
        return operations.some(({ path }) => path === "") ? before : patched(before, operations);
      } catch {
        return before;
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
      const before = state2;
      state2 = patched(state2, operations);
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
function at(curve, value) {
  const next = curve.findIndex((point2) => valueOf(point2) > value);
  const right = next < 0 ? curve.length - 1 : next;
  const [a3, b] = [curve[next < 0 ? right : Math.max(0, right - 1)], curve[right]];
  if (a3 === void 0 || b === void 0) return [];
  const width = valueOf(b) - valueOf(a3);
  const share2 = width > 0 ? clamped((value - valueOf(a3)) / width, 0, 1) : 0;
  return a3.slice(1).map((start, k3) => start + share2 * ((b[k3 + 1] ?? start) - start));
}
function withPoint(curve, point2) {
  const next = curve.findIndex((other) => valueOf(other) > valueOf(point2));
  const index = next < 0 ? curve.length : next;
  return { curve: [...curve.slice(0, index), point2, ...curve.slice(index)], index };
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
function withMoved(curve, index, point2) {
  const least = index > 0 ? valueOf(curve[index - 1] ?? []) : -Infinity;
  const most = index < curve.length - 1 ? valueOf(curve[index + 1] ?? []) : Infinity;
  const moved = [clamped(valueOf(point2), least, most), ...point2.slice(1).map((share2) => clamped(share2, 0, 1))];
  return curve.map((other, k3) => k3 === index ? moved : other);
}
function without(curve, index) {
  return curve.length > 1 ? curve.filter((_3, k3) => k3 !== index) : curve;
}
function spanOf(...curves2) {
  const values = curves2.flat().map(valueOf);
  return [Math.min(...values), Math.max(...values)];
}
function spanOfFunction(curves2) {
  return spanOf(curves2.opacity, curves2.color);
}
function mapped(curve, factor, centre, shift = 0) {
  const points = curve.map((point2) => {
    const value = centre + factor * (valueOf(point2) - centre) + shift;
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
function mirrored(curve) {
  return mapped(curve, -1, middle(spanOf(curve)));
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
function outline(curve, [low, high], pieces = 1) {
  const ends = [low, high].map((value) => [value, at(curve, value)[0] ?? 0]);
  const inside = curve.filter(([value]) => value > low && value < high);
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
function valueOf(point2) {
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
  settings: {
    rest: "At rest",
    moving: "While moving",
    movings: { smooth: "Smooth: 30 frames/s", balanced: "Balanced: better", exact: "Exact: as at rest" },
    custom: "Custom",
    perspective: "Perspective",
    angle: "View angle",
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
  labelsPanel: {
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
  },
  layersPanel: {
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
    redraw: "Draw the pictures anew",
    old: "The camera or the time is another one than in these pictures.",
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
    const box2 = svg.current?.getBoundingClientRect();
    return { x: event.clientX - (box2?.left ?? 0), y: event.clientY - (box2?.top ?? 0) };
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
  const line = outline(curve, seen, isMagnified ? PIECES : 1).map(
    ([value, alpha]) => `${px(xOf(value))},${px(yOf(alpha))}`
  );
  const hidden = outOfSight(curve, seen);
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
        props.onSeen(zoomed(seen, event.deltaY < 0 ? WHEEL_ZOOM : 1 / WHEEL_ZOOM, valueAt(inside(event).x), whole));
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
    curve.map(
      (point2, index) => point2[0] < seen[0] || point2[0] > seen[1] ? null : /* @__PURE__ */ k(
        Handle,
        {
          key: index,
          x: xOf(point2[0]),
          y: yOf(point2[1]),
          isSelected: index === selected,
          color: null,
          label: `Point ${index + 1} of ${curve.length}`,
          value: point2[0],
          range: seen,
          text: `${props.what} ${numberText(point2[1])} at ${numberText(point2[0])}${unit2 && ` ${unit2}`}`,
          onSelect: () => props.onSelect(index),
          onKeyDown: (event) => onHandleKey(event, index),
          onKeyUp: () => props.onDone(),
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
  id,
  colors,
  xOf
}) {
  const [first, last] = [colors?.[0], colors?.at(-1)];
  if (colors === null || first === void 0 || last === void 0) return null;
  const width = last[0] - first[0] || 1;
  return /* @__PURE__ */ k("defs", null, /* @__PURE__ */ k(
    "linearGradient",
    {
      id,
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
    const point2 = latest[index];
    if (point2 !== void 0) props.onCurve(withMoved(latest, index, [value, point2[1], point2[2], point2[3]]), index);
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
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
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
      onLostPointerCapture: onUp
    },
    /* @__PURE__ */ k(Fill, { id: fill, colors: curve, xOf }),
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
    curve.map(
      (point2, index) => point2[0] < seen[0] || point2[0] > seen[1] ? null : /* @__PURE__ */ k(
        Handle,
        {
          key: index,
          x: xOf(point2[0]),
          y: RAMP_PX + 13,
          isSelected: index === selected,
          color: hexOf(point2),
          label: `Colour ${index + 1} of ${curve.length}`,
          value: point2[0],
          range: seen,
          text: `${hexOf(point2)} at ${numberText(point2[0])}${unit2 && ` ${unit2}`}`,
          onSelect: () => props.onSelect(index),
          onKeyDown: (event) => onKeyDown(event, index),
          onKeyUp: () => props.onDone(),
          onGrab: (event) => {
            svg.current?.setPointerCapture(event.pointerId);
            drag.current = { index, x: inside(event) - xOf(point2[0]) };
          }
        }
      )
    )
  ), below + above > 0 && /* @__PURE__ */ k("button", { type: "button", class: "button", onClick: () => props.onShowPoints() }, TEXT2.hidden(below + above)));
}

// src/view/look/fields.tsx
function NumberField(props) {
  const { label, value, min, max, step = "any", unit: unit2 = "", disabled = false, id, decimals } = props;
  const [typed, setTyped] = d2(null);
  const done2 = () => {
    setTyped(null);
    props.onDone();
  };
  return /* @__PURE__ */ k(
    "input",
    {
      type: "number",
      id,
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
        if (Number.isFinite(number2)) props.onValue(clamped(number2, min ?? -Infinity, max ?? Infinity));
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
  return /* @__PURE__ */ k("span", { class: "look-named" }, /* @__PURE__ */ k("span", { class: "dim", "aria-hidden": "true" }, shown), /* @__PURE__ */ k(NumberField, { ...props }), unit2 !== "" && /* @__PURE__ */ k("span", { class: "dim", "aria-hidden": "true" }, unit2));
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
      onInput: (event) => props.onValue(event.currentTarget.valueAsNumber),
      onChange: () => props.onDone()
    }
  ), /* @__PURE__ */ k(
    NumberField,
    {
      ...props,
      ...decimals === void 0 ? {} : { decimals },
      min: least ?? min,
      max: most ?? max,
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
    props.onDone();
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
function SelectField({ label, value, options, onChoice }) {
  return /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, label), /* @__PURE__ */ k("select", { class: "look-grow", value, onChange: (event) => onChoice(event.currentTarget.value) }, options.map((option) => /* @__PURE__ */ k("option", { key: option.value, value: option.value, disabled: option.disabled ?? false }, option.text))));
}
function CheckField({
  label,
  note,
  checked,
  onCheck
}) {
  return /* @__PURE__ */ k("label", { class: "row look-check" }, /* @__PURE__ */ k("input", { type: "checkbox", checked, onChange: (event) => onCheck(event.currentTarget.checked) }), /* @__PURE__ */ k("span", null, label), note && /* @__PURE__ */ k("span", { class: "dim" }, note));
}
function ColorField({ label, value, onColor, onDone }) {
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
      onChange: onDone,
      onBlur: onDone
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
  const curve = curves2.gradient_opacity ?? [];
  const scale = strongGradient(volume2);
  const least = spanOf([[0], [scale]], curve);
  const whole = [0, 1.1 * least[1]];
  const [zoom, setZoom] = d2(null);
  const [chosen2, setChosen] = d2(0);
  const path = ["layers", ui.layer, "look", "transfer_function", "gradient_opacity"];
  const index = Math.min(chosen2, curve.length - 1);
  const point2 = curve[index];
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
  ), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    NamedNumber,
    {
      label: TEXT3.gradient,
      unit: unit2,
      min: 0,
      value: point2[0],
      onValue: (value) => change(withMoved(curve, index, [value, point2[1]]), index),
      onDone: done2
    }
  ), /* @__PURE__ */ k(
    NamedNumber,
    {
      label: TEXT3.factor,
      min: 0,
      max: 1,
      step: 0.01,
      value: point2[1],
      onValue: (factor) => change(withMoved(curve, index, [point2[0], factor]), index),
      onDone: done2
    }
  )), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    Button,
    {
      onClick: () => {
        const added2 = withPointBeside(curve, index, whole);
        change(added2.curve, added2.index);
        done2();
      }
    },
    TEXT3.addPoint
  ), /* @__PURE__ */ k(
    Button,
    {
      disabled: curve.length === 1,
      onClick: () => {
        change(without(curve, index), Math.max(0, index - 1));
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
  const before = state2.layers[layer]?.look;
  const operations = [set(look, "layers", layer, "look")];
  if (state2.shading !== "look" && state2.layers.length === 1) operations.push(set("look", "shading"));
  const named = look.composite === "first-hit" ? "over" : look.composite;
  if (state2.layers.length === 1) operations.push(set(composite2 ?? named, "render", "composite"));
  const [old, now] = [before?.background ?? DEFAULT_BACKGROUND, look.background ?? DEFAULT_BACKGROUND];
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
  const found = JSON.parse(text2);
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
var TEXT4 = WORDS.pointFields;
function PointFields(props) {
  const { curves: curves2, selected, onDone } = props;
  const index = selected?.index ?? -1;
  const [node, color2] = [curves2.opacity[index], curves2.color[index]];
  if (selected?.kind === "opacity" && node !== void 0) {
    return /* @__PURE__ */ k(Point, { ...props, title: TEXT4.opacityPoint, curve: curves2.opacity, index, onCurve: props.onOpacity }, (move) => /* @__PURE__ */ k(
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
    ));
  }
  if (selected?.kind === "color" && color2 !== void 0) {
    return /* @__PURE__ */ k(Point, { ...props, title: TEXT4.colorPoint, curve: curves2.color, index, onCurve: props.onColor }, (move) => /* @__PURE__ */ k(
      ColorField,
      {
        label: TEXT4.color,
        value: hexOf(color2),
        onColor: (hex) => move([color2[0], ...rgbOf(hex)]),
        onDone
      }
    ));
  }
  return /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT4.none);
}
function Point(props) {
  const { title, unit: unit2, selected, curve, index, onCurve, onSelect, onDone, children } = props;
  const point2 = curve[index];
  if (point2 === void 0) return null;
  const move = (moved) => onCurve(withMoved(curve, index, moved), index);
  const go = (next) => {
    if (selected !== null) onSelect({ ...selected, index: next });
  };
  return /* @__PURE__ */ k("fieldset", { class: "look-point" }, /* @__PURE__ */ k("legend", null, title(index + 1, curve.length)), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    NamedNumber,
    {
      label: TEXT4.value,
      unit: unit2,
      value: point2[0] ?? 0,
      onValue: (value) => move([value, ...point2.slice(1)]),
      onDone
    }
  ), children(move)), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { label: TEXT4.before, disabled: index === 0, onClick: () => go(index - 1) }, "‹"), /* @__PURE__ */ k(Button, { label: TEXT4.after, disabled: index === curve.length - 1, onClick: () => go(index + 1) }, "›"), /* @__PURE__ */ k(
    Button,
    {
      disabled: curve.length === 1,
      onClick: () => {
        onCurve(without(curve, index), Math.max(0, index - 1));
        onDone();
      }
    },
    TEXT4.remove
  )));
}

// src/view/look/function_panel.tsx
var TEXT5 = WORDS.functionPanel;
var BINS = 256;
var PLOT_PX2 = 190;
var STILL_MS = 120;
var MAX_OPACITY = 10;
var MAX_WIDTH = 4;
function FunctionPanel(props) {
  const { store, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const volume2 = welcome.volumes[ui.layer];
  if (layer === void 0 || volume2 === void 0) return null;
  const curves2 = layer.look.transfer_function;
  return /* @__PURE__ */ k("div", { class: "look-panel" }, /* @__PURE__ */ k(LayerChoice, { ...props }), isEditable(curves2) ? /* @__PURE__ */ k(Editor, { key: ui.layer, ...props, curves: curves2, look: layer.look, volume: volume2 }) : /* @__PURE__ */ k($, null, /* @__PURE__ */ k("p", null, TEXT5.table), /* @__PURE__ */ k(GlobalOpacity, { ...props })));
}
function LayerChoice({ store, ui }) {
  const { layers } = store.state;
  if (layers.length < 2) return null;
  return /* @__PURE__ */ k(
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
  const { store, engine, ui, welcome, curves: curves2, look, volume: volume2 } = props;
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
  const usualWidth = volume2.robust_range[1] - volume2.robust_range[0] || 1;
  const path = ["layers", ui.layer, "look", "transfer_function"];
  const done2 = () => {
    base.current = null;
    store.settle();
  };
  const latest = () => {
    const now = store.state.layers[ui.layer]?.look.transfer_function;
    return now !== void 0 && isEditable(now) ? now : curves2;
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
  const showPoints = () => setZoom(around(spanOf(curves2.opacity, curves2.color), whole));
  const typeValue = () => value.current?.querySelector("input[type=number]")?.select();
  const chosenIndex = (kind2, length2) => selected?.kind === kind2 && selected.index < length2 ? selected.index : null;
  const opacityIndex = chosenIndex("opacity", curves2.opacity.length);
  const colorIndex = chosenIndex("color", curves2.color.length);
  const reset = async () => {
    try {
      const first = await lookAsChosen(engine, welcome, ui.layer, look.name);
      if (first === null) ui.announce(TEXT5.gone);
      else store.change([set(first.transfer_function, ...path)]);
    } catch (problem) {
      ui.problem(problem);
    }
  };
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    CurvePlot,
    {
      label: TEXT5.curve,
      what: TEXT5.opacity,
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
      onDone: done2,
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
      onDone: done2,
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
      onDone: done2,
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
    TEXT5.addOpacity
  ), /* @__PURE__ */ k(
    Button,
    {
      onClick: () => {
        const added2 = withPointBeside(curves2.color, colorIndex ?? widestGap(curves2.color), seen);
        setColor(added2.curve, added2.index);
        done2();
      }
    },
    TEXT5.addColor
  )), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    NamedNumber,
    {
      shown: TEXT5.seen,
      label: TEXT5.from,
      value: rounded(seen[0], seen[1] - seen[0]),
      onValue: (low) => low < seen[1] && setZoom([low, seen[1]]),
      onDone: () => {
      }
    }
  ), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k(Button, { label: TEXT5.nearer, onClick: () => setZoom(zoomed(seen, 1.5, middle(seen), whole)) }, "+"), /* @__PURE__ */ k(Button, { label: TEXT5.farther, onClick: () => setZoom(zoomed(seen, 1 / 1.5, middle(seen), whole)) }, "−")), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => setZoom(usual) }, TEXT5.usual), /* @__PURE__ */ k(Button, { onClick: () => setZoom(whole) }, TEXT5.all), /* @__PURE__ */ k(Button, { onClick: showPoints }, TEXT5.points)), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(CheckField, { label: TEXT5.log, checked: isLog, onCheck: setLog }), /* @__PURE__ */ k(CheckField, { label: TEXT5.magnified, checked: isMagnified, onCheck: setMagnified })), /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT5.hint), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k(
    RelativeSlider,
    {
      label: `${TEXT5.width} ×`,
      neutral: 1,
      amount: (position) => MAX_WIDTH ** position,
      position: (amount) => Math.log(amount) / Math.log(MAX_WIDTH),
      onAmount: (amount) => amount > 0 && setAll((before) => widened(before, amount), "width"),
      onDone: done2
    }
  ), /* @__PURE__ */ k(
    RelativeSlider,
    {
      label: TEXT5.opacities,
      neutral: 1,
      amount: (position) => MAX_OPACITY ** position,
      position: (amount) => Math.log(amount) / Math.log(MAX_OPACITY),
      onAmount: (amount) => amount >= 0 && setAll((before) => withOpacities(before, amount), "opacities"),
      onDone: done2
    }
  ), /* @__PURE__ */ k(GlobalOpacity, { ...props }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => once((before) => ({ ...before, opacity: mirrored(before.opacity) })) }, TEXT5.mirrorOpacity), /* @__PURE__ */ k(Button, { onClick: () => once((before) => ({ ...before, color: mirrored(before.color) })) }, TEXT5.mirrorColor), /* @__PURE__ */ k(Button, { onClick: () => void reset() }, TEXT5.reset(look.name))), /* @__PURE__ */ k(GradientEditor, { ...props, latest: () => latest().gradient_opacity ?? [] }));
}
function GlobalOpacity({ store, ui }) {
  const opacity = store.state.layers[ui.layer]?.opacity ?? 1;
  return /* @__PURE__ */ k(
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
  const gaps = curve.slice(1).map((point2, k3) => (point2[0] ?? 0) - (curve[k3]?.[0] ?? 0));
  return gaps.length === 0 ? 0 : gaps.indexOf(Math.max(...gaps));
}

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
var NOTHING = { opacity: 0, tint: 0, scan: 1 };
var USUAL = { opacity: LABEL_OPACITY, tint: 0, scan: 0 };
function shownLabels(labels, isShown, hidden) {
  return labelRows(labels).flatMap(({ number: number2, look, opacity, isShown: before }) => {
    if (before === isShown(number2)) return [];
    const now = { opacity, tint: look.tint ?? 0, scan: look.scan ?? (opacity > 0 ? 0 : 1) };
    const next = before ? NOTHING : hidden.get(number2) ?? USUAL;
    if (before) hidden.set(number2, now);
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
var TEXT6 = WORDS.labelsPanel;
var MAX_ROWS = 150;
var FILTERED_FROM = 9;
function LabelsPanel({ store }) {
  const [filter, setFilter] = d2("");
  const hidden = w2(() => /* @__PURE__ */ new Map(), [store]);
  const labels = store.state.labels;
  if (labels === null) return /* @__PURE__ */ k("p", { class: "dim" }, TEXT6.none);
  const all = labelRows(labels.labels);
  const rows = labelRows(labels.labels, filter);
  const show = (isShown) => store.change(shownLabels(store.state.labels?.labels ?? {}, isShown, hidden));
  const inRows = new Set(rows.map(({ number: number2 }) => number2));
  const isOnShown = new Map(all.map(({ number: number2, isShown }) => [number2, isShown]));
  const others = (number2) => isOnShown.get(number2) ?? false;
  return /* @__PURE__ */ k("div", { class: "look-panel" }, all.length >= FILTERED_FROM && /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, TEXT6.filter), /* @__PURE__ */ k(
    "input",
    {
      type: "search",
      class: "look-grow",
      value: filter,
      onInput: (event) => setFilter(event.currentTarget.value)
    }
  )), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(Button, { onClick: () => show((number2) => inRows.has(number2) || others(number2)) }, TEXT6.showAll), /* @__PURE__ */ k(Button, { onClick: () => show((number2) => !inRows.has(number2) && others(number2)) }, TEXT6.hideAll), /* @__PURE__ */ k("span", { class: "dim" }, TEXT6.count(all.filter(({ isShown }) => isShown).length, all.length))), rows.length === 0 && /* @__PURE__ */ k("p", { class: "dim" }, TEXT6.empty), /* @__PURE__ */ k("ul", { class: "look-list", "aria-label": "Labels" }, rows.slice(0, MAX_ROWS).map(({ number: number2, name, look, opacity, isShown }) => /* @__PURE__ */ k("li", { key: number2, class: "look-label" }, /* @__PURE__ */ k(
    "input",
    {
      type: "checkbox",
      "aria-label": TEXT6.shown(name),
      checked: isShown,
      onChange: (event) => {
        const on = event.currentTarget.checked;
        show((other) => other === number2 ? on : others(other));
      }
    }
  ), /* @__PURE__ */ k(
    ColorField,
    {
      label: TEXT6.color(name),
      value: hexColor(look.color, namedColor),
      onColor: (hex) => store.change([set(hex, "labels", "labels", number2, "color")], `colour of label ${number2}`),
      onDone: () => store.settle()
    }
  ), /* @__PURE__ */ k("span", { class: "look-grow look-name", title: `${name} (${number2})` }, name), /* @__PURE__ */ k(
    Button,
    {
      label: TEXT6.soloThis(name),
      pressed: all.length > 1 && isSoloLabel(all, number2),
      onClick: () => show((other) => isSoloLabel(all, number2) || other === number2)
    },
    TEXT6.solo
  ), /* @__PURE__ */ k(
    SliderField,
    {
      label: TEXT6.opacity(name),
      shown: "",
      min: 0,
      max: 1,
      step: 0.01,
      value: opacity,
      onValue: (value) => store.change([set(value, "labels", "labels", number2, "opacity")], `opacity of label ${number2}`),
      onDone: () => store.settle()
    }
  )))), rows.length > MAX_ROWS && /* @__PURE__ */ k("p", { class: "dim" }, TEXT6.more(rows.length - MAX_ROWS)), /* @__PURE__ */ k(
    CheckField,
    {
      label: TEXT6.smooth,
      checked: labels.smooth,
      onCheck: (on) => store.change([set(on, "labels", "smooth")])
    }
  ));
}

// src/view/look/layers_panel.tsx
var TEXT7 = WORDS.layersPanel;
function LayersPanel({ store, ui }) {
  const { layers, geometry } = store.state;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("ul", { class: "look-list", "aria-label": "Layers" }, layers.map((layer, index) => /* @__PURE__ */ k("li", { key: index, class: "look-layer", "data-chosen": index === ui.layer && layers.length > 1 }, /* @__PURE__ */ k("div", { class: "row look-nowrap" }, /* @__PURE__ */ k(
    "input",
    {
      type: "checkbox",
      "aria-label": TEXT7.shown(layer.name),
      title: TEXT7.shown(layer.name),
      checked: layer.visible,
      onChange: (event) => store.change([set(event.currentTarget.checked, "layers", index, "visible")])
    }
  ), /* @__PURE__ */ k(Ramp, { layer }), /* @__PURE__ */ k(
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
  ), layers.length > 1 && /* @__PURE__ */ k(
    Button,
    {
      label: TEXT7.soloThis(layer.name),
      pressed: isSolo(layers, index),
      onClick: () => store.change(soloLayer(layers, index))
    },
    TEXT7.solo
  )), /* @__PURE__ */ k(
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
  ), layers.length > 1 && /* @__PURE__ */ k("label", { class: "row look-check" }, /* @__PURE__ */ k(
    "input",
    {
      type: "radio",
      name: "look-layer",
      "aria-label": TEXT7.editThis(layer.name),
      checked: index === ui.layer,
      onChange: () => ui.setLayer(index)
    }
  ), /* @__PURE__ */ k("span", null, TEXT7.edit), /* @__PURE__ */ k("span", { class: "dim" }, TEXT7.look(layer.look.name)))))), geometry.length > 0 && /* @__PURE__ */ k("ul", { class: "look-list", "aria-label": "Geometry" }, geometry.map(({ kind: kind2, name, count, visible }, index) => /* @__PURE__ */ k("li", { key: index }, /* @__PURE__ */ k(
    CheckField,
    {
      label: name,
      note: `${kind2} · ${count}`,
      checked: visible,
      onCheck: (on) => store.change([set(on, "geometry", index, "visible")])
    }
  )))));
}
function Ramp({ layer }) {
  const curves2 = layer.look.transfer_function;
  if (!isEditable(curves2)) return /* @__PURE__ */ k("span", { class: "chip" });
  const [low, high] = spanOf(curves2.color);
  const stops = curves2.color.map((point2) => `${hexOf(point2)} ${100 * (point2[0] - low) / (high - low || 1)}%`);
  const first = curves2.color[0];
  const background = stops.length > 1 ? `linear-gradient(90deg, ${stops.join(", ")})` : first && hexOf(first);
  return /* @__PURE__ */ k("span", { class: "chip look-chip", style: { background } });
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
function nameOf(composite2) {
  return typeof composite2 === "string" ? composite2 : Object.keys(composite2)[0] ?? "over";
}
function numberOf(composite2, field) {
  return typeof composite2 === "string" ? null : composite2[nameOf(composite2)]?.[field] ?? null;
}
function withNumber(composite2, field, value) {
  const name = nameOf(composite2);
  const before = typeof composite2 === "string" ? {} : composite2[name] ?? {};
  return { [name]: { ...before, [field]: value } };
}
function compositeNamed(name, isoValue) {
  return name === "first-hit" ? { "first-hit": { iso_value: isoValue } } : name;
}

// src/view/look/light_pad.tsx
var TEXT8 = WORDS.lightPad;
var SIZE_PX = 96;
var RADIUS_PX = 40;
function LightPad({ direction, latest, onDirection, onDone }) {
  const isDragging = T2(false);
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
    if (isDragging.current) onDone();
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
      "aria-label": TEXT8.pad,
      "aria-valuemin": -180,
      "aria-valuemax": 180,
      "aria-valuenow": Math.round(azimuth),
      "aria-valuetext": TEXT8.text(azimuth, elevation),
      "aria-description": TEXT8.keys,
      onPointerDown: (event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        isDragging.current = true;
        point2(event);
      },
      onPointerMove: (event) => {
        if (isDragging.current) point2(event);
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
      }
    },
    /* @__PURE__ */ k("circle", { class: "look-ball", r: RADIUS_PX }),
    /* @__PURE__ */ k("path", { class: "look-grid", d: `M${-RADIUS_PX} 0 H${RADIUS_PX} M0 ${-RADIUS_PX} V${RADIUS_PX}` }),
    /* @__PURE__ */ k("circle", { class: "look-spot", cx: spot.x, cy: spot.y, r: 6, "data-behind": direction[2] < 0 })
  ), /* @__PURE__ */ k("div", { class: "look-grow look-angles" }, /* @__PURE__ */ k(
    Angle,
    {
      label: TEXT8.azimuth,
      value: azimuth,
      most: 180,
      onValue: (angle) => set2(directionOf([angle, elevation])),
      onDone
    }
  ), /* @__PURE__ */ k(
    Angle,
    {
      label: TEXT8.elevation,
      value: elevation,
      most: 90,
      onValue: (angle) => set2(directionOf([azimuth, angle])),
      onDone
    }
  )));
}
function Angle(props) {
  const { label, value, most, onValue, onDone } = props;
  return /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("span", { "aria-hidden": "true" }, label), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k("span", { "aria-hidden": "true" }, TEXT8.degrees));
}
function wrapped(degrees) {
  return ((degrees + 180) % 360 + 360) % 360 - 180;
}

// src/view/look/light_panel.tsx
var TEXT9 = WORDS.lightPanel;
var SMOOTHING = [0.5, 1.25];
var SMOOTH = 0.8;
var WATER = 2059e-8;
function LightPanel(props) {
  return /* @__PURE__ */ k("div", { class: "look-panel" }, /* @__PURE__ */ k(Operator, { ...props }), /* @__PURE__ */ k(LayerChoice, { ...props }), /* @__PURE__ */ k(LightFields, { ...props }), /* @__PURE__ */ k(Rest, { ...props }));
}
function Operator({ store, ui, welcome }) {
  const { render: render2, layers, labels } = store.state;
  const volume2 = welcome.volumes[ui.layer];
  const name = nameOf(render2.composite);
  const isOverOnly = layers.filter((layer) => layer.visible).length > 1 || labels !== null;
  const look = layers[ui.layer]?.look;
  const [low, high] = volume2?.range ?? [0, 1];
  const surface = () => {
    const usual = volume2?.robust_range ?? [0, 1];
    return look === void 0 ? (low + high) / 2 : rounded(surfaceValue(look.transfer_function, usual), high - low);
  };
  const number2 = (field, value, gesture) => store.change([set(withNumber(render2.composite, field, value), "render", "composite")], gesture);
  const slider = (label, field, value, min, max, unit3 = "", beyond = {}) => /* @__PURE__ */ k(
    SliderField,
    {
      label,
      unit: unit3,
      min,
      max,
      value,
      ...beyond,
      onValue: (next) => number2(field, next, `${name} ${field}`),
      onDone: () => store.settle()
    }
  );
  const optional = (label, field, first, min, max, unit3 = "") => {
    const value = numberOf(render2.composite, field);
    return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
      CheckField,
      {
        label: TEXT9.automatic(label),
        checked: value === null,
        onCheck: (on) => number2(field, on ? null : first)
      }
    ), value !== null && slider(label, field, value, min, max, unit3, { least: -Infinity, most: Infinity }));
  };
  const unit2 = volume2?.value_unit ?? "";
  const attenuation = unit2 === "HU" ? WATER : 3 / ((high - low || 1) * longestSide(volume2?.bounds));
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
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
  ), isOverOnly && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT9.overOnly), name === "first-hit" && slider(TEXT9.iso, "iso_value", numberOf(render2.composite, "iso_value") ?? surface(), low, high, unit2), name === "local-maximum" && optional(TEXT9.threshold, "threshold", surface(), low, high, unit2), name === "depth-shaded-maximum" && slider(TEXT9.strength, "strength", numberOf(render2.composite, "strength") ?? DIMMING, 0, 1), name === "x-ray" && optional(TEXT9.clear, "clear", low, low, high, unit2), name === "x-ray" && optional(TEXT9.attenuation, "attenuation", attenuation, attenuation / 100, 5 * attenuation));
}
function LightFields({ store, engine, ui, welcome }) {
  const { state: state2 } = store;
  const { shading: shading2, path } = shadingOf(state2, ui.layer);
  const look = state2.layers[ui.layer]?.look;
  const kept = T2(null);
  if (shading2 !== null) kept.current = shading2;
  const name = nameOf(state2.render.composite);
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
  const resetButton = /* @__PURE__ */ k(Button, { onClick: () => void reset() }, TEXT9.reset);
  const head = /* @__PURE__ */ k($, null, /* @__PURE__ */ k(CheckField, { label: TEXT9.shading, checked: shading2 !== null, onCheck: toggle }), !isShaded && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT9.unshaded), state2.shading !== "look" && state2.layers.length > 1 && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT9.all));
  if (shading2 === null) {
    return /* @__PURE__ */ k($, null, head, resetButton);
  }
  const change = (field, value) => store.change([set(value, ...path, field)], `light ${field}`);
  const done2 = () => store.settle();
  const slider = (label, field, min, max, more = {}) => /* @__PURE__ */ k(
    SliderField,
    {
      key: field,
      label,
      min,
      max,
      value: shading2[field] ?? min,
      ...more,
      onValue: (value) => change(field, value),
      onDone: done2
    }
  );
  const lights = lightsOf(shading2);
  const first = lights[0];
  const latest = () => (lightsOf(shadingOf(store.state, ui.layer).shading ?? shading2)[0] ?? first).direction;
  const setDirection = (direction) => change("lights", [{ ...first, direction }, ...lights.slice(1)]);
  const isSmooth = shading2.gradient_smoothing > 0;
  const side = longestSide(welcome.volumes[ui.layer]?.bounds);
  return /* @__PURE__ */ k($, null, head, slider(TEXT9.exposure, "exposure", 0, 3, { most: 100, step: 0.01 }), slider(TEXT9.ambient, "ambient", 0, 1, { most: 10, step: 0.01 }), slider(TEXT9.diffuse, "diffuse", 0, 2, { most: 10, step: 0.01 }), slider(TEXT9.specular, "specular", 0, 1, { most: 10, step: 0.01 }), slider(TEXT9.power, "specular_power", 1, 100, { most: 1e3, step: 1 }), slider(TEXT9.shoulder, "shoulder", 0, 1, { step: 0.01 }), slider(TEXT9.occlusion, "ambient_occlusion", 0, 1, { step: 0.01 }), shading2.ambient_occlusion > 0 && /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    CheckField,
    {
      label: TEXT9.automatic(TEXT9.reach),
      checked: shading2.occlusion_radius === null,
      onCheck: (on) => store.change([set(on ? null : side / 10, ...path, "occlusion_radius")])
    }
  ), shading2.occlusion_radius !== null && slider(TEXT9.radius, "occlusion_radius", side / 500, side / 2, {
    unit: welcome.volumes[ui.layer]?.unit ?? ""
  })), slider(TEXT9.shadow, "shadow", 0, 1, { step: 0.01 }), first["frame"] === "world" && /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT9.world), /* @__PURE__ */ k(LightPad, { direction: first.direction, latest, onDirection: setDirection, onDone: done2 }), /* @__PURE__ */ k(
    CheckField,
    {
      label: TEXT9.smoothingOn,
      checked: isSmooth,
      onCheck: (on) => store.change([set(on ? SMOOTH : 0, ...path, "gradient_smoothing")])
    }
  ), isSmooth ? slider(TEXT9.smoothing, "gradient_smoothing", ...SMOOTHING, { unit: "voxels", step: 0.01 }) : slider(TEXT9.offset, "gradient_offset", 0.01, 4, { unit: "voxels", step: 0.01 }), resetButton);
}
function Rest({ store, welcome }) {
  const { render: render2, background } = store.state;
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    SelectField,
    {
      label: TEXT9.kernel,
      value: render2.kernel,
      options: welcome.kernels.map((value) => ({ value, text: KERNEL_NAMES[value] ?? value })),
      onChoice: (value) => store.change([set(value, "render", "kernel")])
    }
  ), /* @__PURE__ */ k("div", { class: "field" }, /* @__PURE__ */ k("span", { "aria-hidden": "true" }, TEXT9.background), /* @__PURE__ */ k(
    ColorField,
    {
      label: TEXT9.background,
      value: hexColor(background, namedColor),
      onColor: (hex) => store.change([set(hex, "background")], "background"),
      onDone: () => store.settle()
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
function zoomed2(camera, factor) {
  if (camera.parallel_scale !== void 0) return { ...camera, parallel_scale: camera.parallel_scale / factor };
  const away = sub(camera.position, camera.focal_point);
  return { ...camera, position: add(camera.focal_point, scaled(away, 1 / factor)) };
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

// src/view/look/own_presets_fields.tsx
var TEXT10 = WORDS.ownPresetsFields;
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
  return /* @__PURE__ */ k("details", { class: "look-details" }, /* @__PURE__ */ k("summary", null, TEXT10.title), /* @__PURE__ */ k(
    "form",
    {
      class: "look-panel",
      onSubmit: (event) => {
        event.preventDefault();
        void save();
      }
    },
    /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, TEXT10.name), /* @__PURE__ */ k(
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
    /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { type: "submit", class: "button" }, TEXT10.save), chosen2 !== void 0 && /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
      Button,
      {
        label: `${TEXT10.rename} ${chosen2.name}`,
        onClick: () => {
          const wanted = checked();
          if (wanted === null || !attempt(() => renamePreset(chosen2.name, wanted))) return;
          setName("");
          rename(wanted);
        }
      },
      TEXT10.rename
    ), /* @__PURE__ */ k(
      Button,
      {
        label: `${TEXT10.remove} ${chosen2.name}`,
        onClick: () => attempt(() => dropPreset(chosen2.name)) && ui.announce(TEXT10.removed(chosen2.name))
      },
      TEXT10.remove
    ))),
    /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
      Button,
      {
        onClick: () => ui.download(`${layer.look.name || "look"}.json`, lookText(layer.look), "application/json")
      },
      TEXT10.export
    ), /* @__PURE__ */ k("label", { class: "button look-file" }, TEXT10.import, /* @__PURE__ */ k(
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
    if (this.urls.has(name) || this.reasons.has(name) || this.wanted.includes(name) || name === this.drawing) return;
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
  /** Forgets all pictures; each is drawn anew when it is seen. */
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
var TEXT11 = WORDS.presetTiles;
function PresetTiles({ label, tiles, selected, pictures, onChoose }) {
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
  return /* @__PURE__ */ k("div", { class: "look-tiles", role: "listbox", "aria-label": label, ref: list2 }, tiles.map(({ name, description, picture }, index) => {
    const address = picture ?? pictures.get(name);
    const reason = pictures.reason(name);
    const about = reason === void 0 ? description : `${description} ${TEXT11.noPicture}: ${reason}`;
    return /* @__PURE__ */ k(
      "div",
      {
        key: name,
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
        onKeyDown: (event) => onKeyDown(event, index)
      },
      address ? /* @__PURE__ */ k("img", { src: address, alt: "", width: 96, height: 96 }) : /* @__PURE__ */ k("span", { class: "look-blank" }, reason !== void 0 && TEXT11.noPicture),
      /* @__PURE__ */ k("span", { class: "look-name" }, name)
    );
  }));
}

// src/view/look/preset_search.ts
function matching(presets, search) {
  const words = search.toLowerCase().split(/[\s_-]+/).filter((word) => word !== "");
  const has = (text2) => words.every((word) => text2.toLowerCase().includes(word));
  const found = presets.filter(({ name, description }) => has(`${name} ${description}`));
  return words.length === 0 ? found : [...found.filter(({ name }) => has(name)), ...found.filter(({ name }) => !has(name))];
}

// src/view/look/presets_panel.tsx
var TEXT12 = WORDS.presetsPanel;
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
  const take2 = (look, composite2) => {
    store.change(chosen(store.state, ui.layer, look, composite2));
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
  return /* @__PURE__ */ k("div", { class: "look-panel" }, /* @__PURE__ */ k(LayerChoice, { ...props }), /* @__PURE__ */ k("label", { class: "field" }, /* @__PURE__ */ k("span", null, TEXT12.search), /* @__PURE__ */ k(
    "input",
    {
      type: "search",
      class: "look-grow",
      value: search,
      onInput: (event) => setSearch(event.currentTarget.value)
    }
  )), ownTiles.length > 0 && /* @__PURE__ */ k($, null, /* @__PURE__ */ k("h3", null, TEXT12.own), /* @__PURE__ */ k(
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
  )), fitting.length > 0 && /* @__PURE__ */ k(PresetTiles, { ...grid, label: TEXT12.fitting, tiles: fitting }), rest.length > 0 && /* @__PURE__ */ k(
    "details",
    {
      class: "look-details",
      open: showsAll || search !== "",
      onToggle: (event) => search === "" && setShowsAll(event.currentTarget.open)
    },
    /* @__PURE__ */ k("summary", null, TEXT12.all(rest.length)),
    (showsAll || search !== "") && /* @__PURE__ */ k(PresetTiles, { ...grid, label: TEXT12.all(rest.length), tiles: rest })
  ), found.length + ownTiles.length === 0 && /* @__PURE__ */ k("p", { class: "dim" }, TEXT12.none), store.state.layers.length > 1 && layer.look.composite !== "over" && /* @__PURE__ */ k("p", { class: "look-small" }, TEXT12.alone), isOld && /* @__PURE__ */ k($, null, /* @__PURE__ */ k("p", { class: "dim look-small" }, TEXT12.old), /* @__PURE__ */ k(Button, { onClick: drawAnew }, TEXT12.redraw)), /* @__PURE__ */ k(OwnPresets, { ...props, own, onOwn: setOwn, onTake: take2 }));
}
function looksAlike(a3, b) {
  const [one, other] = [axesOf(a3), axesOf(b)];
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
var TEXT13 = WORDS.timeBar;
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
  return /* @__PURE__ */ k("div", { class: "look-time", role: "group", "aria-label": TEXT13.title }, /* @__PURE__ */ k(Button, { label: TEXT13.before, onClick: () => step(-1) }, "‹"), /* @__PURE__ */ k(Button, { pressed: isPlaying, onClick: toggle }, isPlaying ? TEXT13.pause : TEXT13.play), /* @__PURE__ */ k(Button, { label: TEXT13.next, onClick: () => step(1) }, "›"), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k("output", { class: "look-count" }, TEXT13.of(time, count)), /* @__PURE__ */ k("label", { class: "row" }, /* @__PURE__ */ k(
    NumberField,
    {
      label: TEXT13.rate,
      min: 0.2,
      max: MAX_RATE,
      step: 1,
      value: rate,
      onValue: setRate,
      onDone: () => {
      }
    }
  ), /* @__PURE__ */ k("span", { class: "dim", "aria-hidden": "true" }, TEXT13.perSecond)), /* @__PURE__ */ k(CheckField, { label: TEXT13.repeat, checked: repeats, onCheck: setRepeats }));
}

// src/view/look/window_drag.ts
var TEXT14 = WORDS.windowDrag;
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
var look_default = '.look-panel { display: grid; gap: 8px; min-width: 0 }\n.look-panel > *, .look-details > *, .look-list > * { min-width: 0 }\n.look-grow { flex: 1 1 0; min-width: 0 }\n.look-nowrap { flex-wrap: nowrap }\n.look-small { font-size: 12px }\n.look-check { min-height: 24px; flex-wrap: nowrap }\n.look-check > span { min-width: 0 }\n.look-panel .field > span:first-child, .field.look-slider > span:first-child { flex: 0 0 96px }\n.look-slider input[type="number"] { flex: 0 0 96px; width: 96px }\n.field small { margin-left: 4px; font-size: 11px; opacity: .8 }\n.look-plot { display: block; width: 100%; touch-action: pan-y; user-select: none; overflow: visible }\n.look-grid { stroke: var(--line); stroke-width: 1; opacity: .55 }\n.look-tick { fill: var(--dim); font-size: 11px }\n.look-counts { fill: var(--text); fill-opacity: .22 }\n.look-line { fill: none; stroke: var(--text); stroke-width: 1.5 }\n.look-line-under { fill: none; stroke: var(--panel); stroke-width: 4 }\n.look-handle { cursor: grab; touch-action: none }\n.wavesplat .look-handle:focus, .wavesplat .look-mark:focus, .look-pad:focus:not(:focus-visible) { outline: none }\n.look-handle:active { cursor: grabbing }\n.look-reach { fill: transparent; stroke: none }\n.look-dot { fill: var(--panel); stroke: var(--text); stroke-width: 2 }\n.look-handle[data-selected="true"] .look-dot { fill: var(--accent); stroke-width: 2.5 }\n.look-handle:focus-visible .look-reach { stroke: var(--focus); stroke-width: 2 }\n.look-mark { cursor: pointer }\n.look-mark path { fill: var(--accent); stroke: var(--panel) }\n.look-mark:focus-visible .look-reach { stroke: var(--focus); stroke-width: 2 }\n.look-ramp { stroke: var(--line) }\n.look-point { border: 1px solid var(--line); border-radius: var(--radius); display: grid; gap: 6px; margin: 0; padding: 4px 8px 8px; min-width: 0 }\n.look-point legend { color: var(--dim); font-size: 12px; padding: 0 4px }\n.look-details { border-top: 1px solid var(--line); padding-top: 6px }\n.look-details > summary { cursor: pointer; min-height: 24px; margin-bottom: 6px }\n.look-details > * + * { margin-top: 6px }\n.look-tiles { display: grid; grid-template-columns: repeat(auto-fill, 98px); gap: 6px; justify-content: space-between }\n.look-tile { display: grid; gap: 2px; border: 1px solid var(--line); border-radius: 4px; cursor: pointer; overflow: hidden; align-content: start }\n.look-tile:hover { border-color: var(--accent) }\n.look-tile[aria-selected="true"] { border-color: var(--accent); box-shadow: 0 0 0 2px var(--accent) }\n.look-tile[aria-selected="true"] .look-name { background: var(--accent); color: var(--accent-text) }\n.look-tile img, .look-blank { display: block; width: 96px; height: 96px; background: #000 }\n.look-blank { background: var(--raised); color: var(--dim); font-size: 12px; padding: 36px 0; text-align: center }\n.look-tile .look-name { padding: 1px 4px 3px; font-size: 12px; line-height: 1.25; overflow-wrap: anywhere }\n.look-name { min-width: 0; overflow: hidden; text-overflow: ellipsis }\n.wavesplat ul.look-list { list-style: none; margin: 0; padding: 0; display: grid; gap: 6px; max-height: 420px; overflow-y: auto }\n.look-layer { display: grid; gap: 4px; padding: 6px; border: 1px solid var(--line); border-radius: var(--radius) }\n.look-layer[data-chosen="true"] { border-color: var(--accent) }\n.look-chip { width: 30px }\n.look-label { display: flex; flex-wrap: wrap; align-items: center; gap: 2px 6px }\n.look-label > .look-name { white-space: nowrap }\n.look-label > .look-slider { flex: 1 0 100%; padding-left: 30px }\n.look-pad { flex: none; cursor: crosshair; touch-action: none; border-radius: var(--radius) }\n.look-ball { fill: var(--raised); stroke: var(--line) }\n.look-spot { fill: var(--accent); stroke: var(--text); stroke-width: 2 }\n.look-spot[data-behind="true"] { fill: none }\n.look-angles { display: grid; gap: 6px }\n.look-angles .row > span:first-child { flex: 0 0 92px; color: var(--dim) }\n.look-time { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 8px; width: 100%; padding: 5px 10px; background: var(--glass); box-shadow: var(--lift); border-radius: var(--radius) }\n.look-time input[type="range"] { flex: 1 1 120px }\n.look-time input[type="number"] { width: 56px }\n.look-count { font-variant-numeric: tabular-nums; min-width: 62px }\n.look-file { position: relative; display: inline-flex; align-items: center }\n.look-file:focus-within { outline: 2px solid var(--focus); outline-offset: 1px }\n.look-why { color: var(--danger) }\n@media (pointer: coarse) { circle.look-reach { r: 22px } }\n@media (forced-colors: active) { .look-ramp, .look-dot, .look-spot { forced-color-adjust: none } }\n.look-named { display: inline-flex; align-items: center; gap: 4px }\n\n';

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
var TEXT15 = WORDS.about;
function AboutPanel({ welcome, store, ui }) {
  const notes = [...new Set(Object.values(ui.frames).flatMap((frame) => frame.notes))];
  return /* @__PURE__ */ k($, null, welcome.volumes.map((volume2, n2) => /* @__PURE__ */ k("section", { key: n2, class: "about" }, /* @__PURE__ */ k("h3", null, store.state.layers[n2]?.name ?? volume2.name), /* @__PURE__ */ k("dl", null, facts(volume2).map(([name, text2]) => [/* @__PURE__ */ k("dt", { key: name }, name), /* @__PURE__ */ k("dd", { key: text2 }, text2)])), /* @__PURE__ */ k("h4", null, TEXT15.notes), /* @__PURE__ */ k(Notes, { of: volume2.notes }))), notes.length > 0 && /* @__PURE__ */ k("section", { class: "about" }, /* @__PURE__ */ k("h3", null, TEXT15.picture), /* @__PURE__ */ k(Notes, { of: notes })));
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
    [TEXT15.kind, TEXT15.kinds[volume2.kind] ?? volume2.kind],
    [TEXT15.samples, `${shape.join(" × ")}, ${volume2.dtype}`],
    [TEXT15.spacing, isEven ? `${shortNumber(spacing[0], 4)} ${unit2 ?? ""}`.trim() : length2(spacing, decimals + 2)],
    [TEXT15.size, length2(size, decimals)],
    [TEXT15.values, `${numberText(range[0])} to ${numberText(range[1])} ${value_unit}`.trim()],
    [TEXT15.axes, orientation === null ? TEXT15.noAxes : TEXT15.axesOf(orientation)],
    ...volume2.n_times > 1 ? [[TEXT15.times, String(volume2.n_times)]] : []
  ];
}

// src/view/fields.tsx
function NumberField2(props) {
  const { onInput, onSettle, ...others } = props;
  return /* @__PURE__ */ k(SliderField, { ...others, least: -Infinity, most: Infinity, onValue: onInput, onDone: onSettle });
}
function Choice(props) {
  const { label, value, options, onChoose } = props;
  return /* @__PURE__ */ k(SelectField, { ...{ label, value }, options: options.map(([name, text2]) => ({ value: name, text: text2 })), onChoice: onChoose });
}
function Switch(props) {
  return /* @__PURE__ */ k(CheckField, { label: props.label, checked: props.on, onCheck: props.onToggle });
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
var placeOfBox = (clips, kind2) => clips.findIndex((clip2) => kind2 in clip2 && !isIndexed(boxOf(clip2)));
function boxOf(clip2) {
  return "keep" in clip2 ? clip2.keep : "cut_out" in clip2 ? clip2.cut_out : null;
}
var isIndexed = (box2) => box2?.space === "index";

// src/view/cut_panel.tsx
var TEXT16 = WORDS.cut;
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
      label: TEXT16.handles,
      on: view.overlays.crop_box,
      onToggle: (on) => store.change([set(on, "view", "overlays", "crop_box")])
    }
  ), ["keep", "cut_out"].map((kind2) => {
    const place = placeOfBox(clip2, kind2);
    const found = clip2[place];
    const box2 = found === void 0 ? null : boxOf(found);
    return /* @__PURE__ */ k("fieldset", { key: kind2 }, /* @__PURE__ */ k("legend", null, TEXT16[kind2]), box2 === null ? /* @__PURE__ */ k(
      "button",
      {
        class: "button",
        onClick: () => add2({ [kind2]: kind2 === "keep" ? whole : corner(whole) })
      },
      kind2 === "keep" ? TEXT16.crop : TEXT16.cut
    ) : /* @__PURE__ */ k($, null, /* @__PURE__ */ k(BoxNumbers, { ...props, kind: kind2, place, box: box2 }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => store.change([set({ [kind2]: whole }, "clip", place)]) }, TEXT16.reset), /* @__PURE__ */ k("button", { class: "button", onClick: () => remove(place) }, TEXT16.remove))));
  }), /* @__PURE__ */ k("fieldset", null, /* @__PURE__ */ k("legend", null, TEXT16.planes), clip2.map(
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
    TEXT16.add
  )));
}
function corner(box2) {
  const middle2 = (axis) => ((box2.lower[axis] ?? 0) + (box2.upper[axis] ?? 0)) / 2;
  return { ...box2, lower: [box2.lower[0], middle2(1), middle2(2)], upper: [middle2(0), box2.upper[1], box2.upper[2]] };
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
        NumberField2,
        {
          key: `${name}${side}`,
          decimals: decimalsOf(spacing[a3] ?? 1),
          label: side === "lower" ? TEXT16.from(name) : TEXT16.to(name),
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
    NumberField2,
    {
      decimals: decimalsOf(Math.min(...welcome.volumes[0]?.spacing ?? [1])),
      label: TEXT16.plane(number2),
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
  ), /* @__PURE__ */ k("div", { class: "row" }, AXES.map((name, a3) => /* @__PURE__ */ k("label", { key: name, class: "row" }, TEXT16.normal(name), /* @__PURE__ */ k(
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
  )))), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => change({ ...plane, normal: scaled(plane.normal, -1) }) }, TEXT16.flip), /* @__PURE__ */ k("button", { class: "button", onClick: onRemove }, TEXT16.remove)));
}

// src/view/help.tsx
function Help({ onClose }) {
  const dialog = T2(null);
  A2(() => {
    dialog.current?.showModal();
  }, []);
  return /* @__PURE__ */ k("dialog", { ref: dialog, "aria-labelledby": "help-title", onClose }, /* @__PURE__ */ k("h2", { id: "help-title" }, "Keys and gestures"), /* @__PURE__ */ k("p", { class: "dim" }, "Keys act in the focused view; in slices arrows move the crosshair."), /* @__PURE__ */ k("table", null, /* @__PURE__ */ k("caption", { class: "hidden" }, "Mouse and touch"), /* @__PURE__ */ k("tbody", null, GESTURES.map(([gesture, what]) => /* @__PURE__ */ k("tr", { key: gesture }, /* @__PURE__ */ k("th", { scope: "row" }, gesture), /* @__PURE__ */ k("td", null, what))))), /* @__PURE__ */ k("table", null, /* @__PURE__ */ k("caption", { class: "hidden" }, "Keys"), /* @__PURE__ */ k("tbody", null, KEYS.map(({ shown, text: text2 }) => /* @__PURE__ */ k("tr", { key: shown }, /* @__PURE__ */ k("th", { scope: "row" }, /* @__PURE__ */ k("kbd", null, shown)), /* @__PURE__ */ k("td", null, text2))))), /* @__PURE__ */ k("form", { method: "dialog" }, /* @__PURE__ */ k("button", { class: "button" }, "Close")));
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
  const { label, text: text2, value, range, x: x2, y: y3, color: color2, round, onDrag, onKey, onEnd, onDouble } = props;
  const down = (event) => {
    event.stopPropagation();
    const element = event.currentTarget;
    element.setPointerCapture(event.pointerId);
    element.focus({ preventScroll: true });
    const box2 = element.ownerSVGElement?.getBoundingClientRect();
    let [px2, py] = [event.clientX, event.clientY];
    const move = (moved) => {
      onDrag(moved.clientX - (box2?.left ?? 0), moved.clientY - (box2?.top ?? 0), moved.clientX - px2, moved.clientY - py);
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
  return /* @__PURE__ */ k(
    "g",
    {
      "data-handle": true,
      role: "slider",
      tabindex: 0,
      "aria-label": label,
      "aria-valuenow": Number(value.toFixed(3)),
      "aria-valuemin": Number(range[0].toFixed(3)),
      "aria-valuemax": Number(range[1].toFixed(3)),
      "aria-valuetext": text2,
      transform: `translate(${x2} ${y3})`,
      onPointerDown: down,
      onKeyDown: onKey,
      onKeyUp: onEnd,
      onDblClick: onDouble
    },
    /* @__PURE__ */ k("circle", { r: "13", fill: "transparent", stroke: "none" }),
    round ? /* @__PURE__ */ k("circle", { r: "5", fill: "#000", stroke: color2, "stroke-width": "2" }) : /* @__PURE__ */ k("rect", { x: "-5", y: "-5", width: "10", height: "10", fill: color2, stroke: "#000", "stroke-width": "1" })
  );
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

// src/view/slices/measures.tsx
var COLOR = "#7df0ff";
function measured(measure, unit2) {
  return measure.kind === "distance" ? `${shortNumber(distance(measure.points), 4)} ${unit2}` : `${angleDeg(measure.points).toFixed(1)}°`;
}
function Drawn(props) {
  const { store, welcome, ui, placed: placed2, moved, isNear } = props;
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const pending = ui.points.map(placed2);
  return /* @__PURE__ */ k("g", null, store.state.view.measures.map((measure, n2) => {
    const places = measure.points.map(placed2);
    if (!isNear(measure.points) || places.some((place) => place === null)) return null;
    const points = places;
    const middle2 = points[measure.kind === "angle" ? 1 : 0];
    const text2 = measured(measure, unit2);
    return /* @__PURE__ */ k("g", { key: n2 }, /* @__PURE__ */ k("path", { d: `M${points.map(({ x: x2, y: y3 }) => `${x2} ${y3}`).join("L")}`, fill: "none", stroke: COLOR, "stroke-width": "1.5" }), /* @__PURE__ */ k("text", { x: middle2.x + 10, y: middle2.y - 8 }, text2), points.map(({ x: x2, y: y3 }, k3) => {
      const change = (to, gesture) => store.change([set(to, "view", "measures", n2, "points", k3)], gesture);
      const now = () => store.state.view.measures[n2]?.points[k3] ?? measure.points[k3];
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
  }), pending.map((place, k3) => place && /* @__PURE__ */ k("circle", { key: k3, cx: place.x, cy: place.y, r: "4", fill: COLOR, stroke: "#000" })));
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
function MeasurePanel({ store, welcome, ui }) {
  const { measures } = store.state.view;
  const unit2 = welcome.volumes[0]?.unit ?? "units";
  const csv = () => ["kind,value,unit,points", ...measures.map((one) => {
    const [value, of] = measured(one, unit2).replace("°", " degree").split(" ");
    return `${one.kind},${value},${of},"${one.points.map((point2) => point2.join(" ")).join("; ")}"`;
  })].join("\n");
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("div", { class: "row" }, ["distance", "angle"].map((tool) => /* @__PURE__ */ k(
    "button",
    {
      key: tool,
      class: "button",
      "aria-pressed": ui.tool === tool,
      onClick: () => ui.setTool(ui.tool === tool ? "turn" : tool)
    },
    tool === "distance" ? "Distance" : "Angle"
  )), /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      onClick: () => {
        const { crosshair } = store.state.view.slices;
        ui.addPoint(crosshair);
      },
      disabled: ui.tool !== "distance" && ui.tool !== "angle"
    },
    "Point at the crosshair"
  )), ui.points.length > 0 && /* @__PURE__ */ k("p", { class: "dim" }, `${ui.points.length} of ${ui.tool === "angle" ? 3 : 2} points`), measures.length === 0 ? /* @__PURE__ */ k("p", { class: "dim" }, "Choose one, then click in a view.") : /* @__PURE__ */ k("ol", null, measures.map((one, n2) => /* @__PURE__ */ k("li", { key: n2 }, /* @__PURE__ */ k("span", { class: "row" }, measured(one, unit2), /* @__PURE__ */ k(
    "button",
    {
      class: "icon-button",
      "aria-label": `Delete measure ${n2 + 1}`,
      onClick: () => store.change([{ op: "remove", path: `/view/measures/${n2}` }])
    },
    "×"
  )), /* @__PURE__ */ k("span", { class: "dim" }, one.points.map((point2) => placeText(point2, welcome)).join(" – "))))), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", disabled: measures.length === 0, onClick: () => store.change([set([], "view", "measures")]) }, "Delete all"), /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      disabled: measures.length === 0,
      onClick: () => ui.download("measures.csv", csv(), "text/csv")
    },
    "Save as CSV"
  )));
}

// src/view/overlay3d/box_handles.tsx
var NAMES = ["x", "y", "z"];
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
  const points = corners(box2).map((corner2) => project(camera, size, corner2));
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
    const name = `${what}, ${NAMES[face.axis]} ${face.side === "lower" ? "from" : "to"}`;
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
          const before = now();
          const axis = UNITS[face.axis];
          const way = alongAxis(camera, size, faceCenter(before, face), axis, dx, dy);
          moveFace(face, before[face.side][face.axis] + way, "face");
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
  ));
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
  const flat = (point2) => `${(dot(point2, right) * HALF).toFixed(2)} ${(-dot(point2, up) * HALF).toFixed(2)}`;
  const seen = SIDES2.map((side, n2) => ({ ...side, name: welcome.axis_ends[n2] ?? "", towards: dot(side.outward, back) })).filter(({ towards }) => towards > 0.02).sort((a3, b) => a3.towards - b.towards);
  return /* @__PURE__ */ k("g", { transform: `translate(${width - MARGIN2} ${MARGIN2})` }, seen.map(({ outward, view, name, towards }) => {
    const axis = outward.findIndex((one) => one !== 0);
    const corner2 = (a3, b) => {
      const point2 = [...outward];
      point2[(axis + 1) % 3] = a3;
      point2[(axis + 2) % 3] = b;
      return point2;
    };
    const outline2 = [corner2(1, 1), corner2(1, -1), corner2(-1, -1), corner2(-1, 1)].map(flat).join("L");
    const target = welcome.standard_views[view];
    const go = () => {
      if (target !== void 0) showFrom(props, target);
    };
    const shade = Math.round(38 + 70 * towards);
    return /* @__PURE__ */ k(
      "g",
      {
        key: view,
        "data-handle": true,
        role: "button",
        tabindex: -1,
        "aria-label": `${name}, from the ${view}`,
        onClick: go,
        onPointerDown: (event) => event.stopPropagation(),
        style: { cursor: "pointer" }
      },
      /* @__PURE__ */ k("path", { d: `M${outline2}Z`, fill: `rgb(${shade},${shade},${shade})`, stroke: "#cfd6e0", "stroke-width": "1" }),
      towards > 0.3 && /* @__PURE__ */ k(
        "text",
        {
          x: dot(outward, right) * HALF,
          y: -dot(outward, up) * HALF + 5,
          "text-anchor": "middle",
          style: { strokeWidth: 0, fontWeight: 600 }
        },
        name
      )
    );
  }));
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
    const before = now();
    change({ ...before, point: add(before.point, scaled(unit(before.normal), way)) }, gesture);
  };
  const tilt = (axis, angle, gesture) => {
    const before = now();
    change({ ...before, normal: turnedAbout(unit(before.normal), axis, angle) }, gesture);
  };
  return /* @__PURE__ */ k("g", { stroke: COLOR2, fill: "none" }, square.every((corner2) => corner2 !== null) && /* @__PURE__ */ k("path", { d: `M${square.map((corner2) => `${corner2?.x} ${corner2?.y}`).join("L")}Z`, "stroke-width": "1.3", fill: COLOR2, "fill-opacity": "0.08" }), tip !== null && /* @__PURE__ */ k("path", { d: `M${at2.x} ${at2.y}L${tip.x} ${tip.y}`, "stroke-width": "2" }), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k(Measures3d, { ...props, camera }), overlays.letters && /* @__PURE__ */ k(EdgeLetters, { ...props, camera }), overlays.scale_bar && /* @__PURE__ */ k(ScaleBar, { ...props, camera }), overlays.cube && /* @__PURE__ */ k(Cube, { ...props, camera, width: size.width })), overlays.color_bar && /* @__PURE__ */ k(ColorBar, { ...props }), overlays.legend && /* @__PURE__ */ k(Legend, { ...props }));
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
function Legend({ store }) {
  const { labels, layers } = store.state;
  const rows = Object.entries(labels?.labels ?? {}).filter(([, look]) => (look.opacity ?? 0.8) > 0 || (look.tint ?? 0) > 0).map(([number2, look]) => ({ name: look.name || number2, color: cssColor(look.color) }));
  if (layers.length > 1 && compositeName(store.state.render.composite) !== "first-hit") {
    rows.push(...layers.filter(({ visible }) => visible).map((layer) => ({ name: layer.name, color: brightest(layer.look.transfer_function) })));
  }
  if (rows.length === 0) return null;
  return /* @__PURE__ */ k("ul", { class: "corner legend", "aria-label": "Legend" }, rows.slice(0, 24).map(({ name, color: color2 }) => /* @__PURE__ */ k("li", { key: name }, /* @__PURE__ */ k("span", { class: "chip", style: { background: color2 } }), " ", name)));
}
function cssColor(color2) {
  return typeof color2 === "string" ? color2 : `rgb(${color2.slice(0, 3).map((one) => Math.round(255 * one)).join()})`;
}
function brightest(curves2) {
  const points = curves2.color ?? [];
  const sum = (point2) => point2[1] + point2[2] + point2[3];
  const best = points.reduce((a3, b) => a3 === null || sum(b) > sum(a3) ? b : a3, null);
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
  const box2 = T2(null);
  const canvas = T2(null);
  const [size, setSize] = d2({ width: 0, height: 0 });
  const [hint, setHint] = d2(false);
  const latest = T2(props);
  latest.current = props;
  const sizeNow = T2(size);
  sizeNow.current = size;
  const frame = ui.frames[view];
  useSize(box2, props, setSize);
  useFrames(canvas, latest);
  F2(() => {
    const element = box2.current;
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
    const stop = new AbortController();
    const listeners = {
      pointerdown: down,
      pointermove: move,
      pointerup: up,
      pointercancel: cancel,
      pointerleave: leave,
      wheel,
      keydown: key,
      keyup: keyUp,
      contextmenu: menu
    };
    for (const [name, listener] of Object.entries(listeners)) {
      element.addEventListener(name, listener, { passive: false, signal: stop.signal });
    }
    return () => stop.abort();
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
      onPointerDown: () => setHint(false)
    },
    /* @__PURE__ */ k("canvas", { ref: canvas, role: "img", "aria-label": label, style: { transform: moved } }),
    frame !== void 0 && size.width > 0 && children?.(frame, size),
    hint && /* @__PURE__ */ k("p", { class: "hint" }, "Click first, or hold Ctrl, to magnify with the wheel")
  );
}
function useSize(box2, { engine, view }, setSize) {
  A2(() => {
    const element = box2.current;
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
      const moved = rolled(zoomed2(panned(camera(), dx2, dy2, size.height), factor), angle);
      move(moved, "pinch");
      return;
    }
    if (gesture.phase === "start") return;
    const { what, dx, dy } = gesture;
    if (what === "window" || what === "main" && ui.tool === "window") windowDrag(props, dx, dy);
    else if (what === "pan") move(panned(camera(), dx, dy, size.height), "pan");
    else if (what === "zoom") move(zoomed2(camera(), Math.exp(-2 * dy / size.height)), "zoom");
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
      case "fit":
        void fit(props, size);
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
      onWheel: ({ factor }) => {
        move(zoomed2(camera(), factor), "wheel");
        settleSoon(store);
      },
      onHover: (place, size) => ui.probe(place && store.state.geometry.length > 0 ? () => shapeAt(props, place, size) : null),
      transform: (frame, size) => instant(frame, camera(), size)
    },
    (frame, size) => /* @__PURE__ */ k(SceneOverlay, { ...props, frame, size })
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
var placed = (x2, y3, { width, height }) => ({ x: x2, y: y3, width: Math.round(width), height: Math.round(height) });
async function shapeAt({ engine, welcome }, { x: x2, y: y3 }, size) {
  const { shape } = await engine.ask("shape", placed(x2 / size.width, y3 / size.height, size));
  return shape === null ? "" : `${shape.text} at ${placeText(shape.point, welcome)}`;
}
async function pick(props, x2, y3, size) {
  const { engine, store, ui } = props;
  try {
    const { point: point2 } = await engine.ask("pick", placed(x2, y3, size));
    if (point2 === null) {
      ui.announce("Nothing is seen there");
      return;
    }
    if (ui.tool === "distance" || ui.tool === "angle") ui.addPoint(point2);
    else store.change([set(point2, "view", "slices", "crosshair")]);
  } catch (problem) {
    ui.problem(problem);
  }
}
function instant(frame, camera, size) {
  const before = frame.camera;
  if (before === void 0 || before === camera) return "";
  const [old, now] = [axesOf(before), axesOf(camera)];
  if (dot(old.back, now.back) < 1 - 1e-9 || before.view_angle !== camera.view_angle) return "";
  const at2 = (seen, point2) => project(seen, size, point2);
  const beside = add(before.focal_point, old.right);
  const [a3, b] = [at2(before, before.focal_point), at2(before, beside)];
  const [A3, B3] = [at2(camera, before.focal_point), at2(camera, beside)];
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
var TEXT17 = WORDS.settings;
var FIRST_ANGLE = 30;
function SettingsPanel(props) {
  const { store, figures, onFigures } = props;
  const { view, render: render2, camera } = store.state;
  const isNamed = typeof render2.quality === "string";
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT17.rest,
      value: isNamed ? render2.quality : "own",
      options: [...QUALITIES.map((name) => [name, name]), ...isNamed ? [] : [["own", TEXT17.custom]]],
      onChoose: (value) => value !== "own" && store.change([set(value, "render", "quality")])
    }
  ), /* @__PURE__ */ k(
    Choice,
    {
      label: TEXT17.moving,
      value: view.quality.moving,
      options: Object.entries(TEXT17.movings),
      onChoose: (value) => store.change([set(value, "view", "quality", "moving")])
    }
  ), /* @__PURE__ */ k(
    Switch,
    {
      label: TEXT17.perspective,
      on: camera.view_angle !== void 0,
      onToggle: (on) => store.change([set(withLens(camera, on ? FIRST_ANGLE : void 0), "camera")])
    }
  ), camera.view_angle !== void 0 && /* @__PURE__ */ k(
    NumberField2,
    {
      label: TEXT17.angle,
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
      label: TEXT17.theme,
      value: view.interface.theme,
      options: Object.entries(TEXT17.themes),
      onChoose: (value) => store.change([set(value, "view", "interface", "theme")])
    }
  ), /* @__PURE__ */ k("fieldset", null, /* @__PURE__ */ k("legend", null, TEXT17.over), OVERLAYS.map((name) => /* @__PURE__ */ k(
    Switch,
    {
      key: name,
      label: TEXT17.overlays[name],
      on: view.overlays[name],
      onToggle: (on) => store.change([set(on, "view", "overlays", name)])
    }
  )), /* @__PURE__ */ k(Switch, { label: TEXT17.figures, on: figures, onToggle: onFigures })));
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
      ui.announce(`${name} is in the field below`);
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
  ), abort !== null && /* @__PURE__ */ k("button", { class: "button", onClick: () => abort.abort() }, "Cancel")), part !== null && /* @__PURE__ */ k("progress", { "aria-label": "Drawing the picture", max: 1, value: part }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("python", (found) => copy(found, "The Python program")) }, "Copy as Python"), /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("command", (found) => copy(found, "The command")) }, "Copy as command"), ui.host === "page" && /* @__PURE__ */ k("button", { class: "button", onClick: () => void link() }, "Copy link")), text2 !== "" && /* @__PURE__ */ k("textarea", { "aria-label": "What was copied", readOnly: true, rows: 5, value: text2, onFocus: (event) => event.currentTarget.select() }), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("state", (found, name) => ui.download(name, found, "application/json")) }, "Save state"), /* @__PURE__ */ k("label", { class: "button" }, "Open state", /* @__PURE__ */ k(
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
  )), /* @__PURE__ */ k("button", { class: "button", onClick: () => void code("html", (found, name) => ui.download(name, found, "text/html")) }, "Save page (HTML)")));
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
var TEXT18 = WORDS.panels;
var PANELS = ["presets", "function", "layers", "labels", "light", "cut", "slices", "measure", "share", "settings"];
function openPanel(panels) {
  return [...PANELS, "about"].find((name) => name === panels.at(-1)) ?? null;
}
function Rail({ panels, open, onPanel, children }) {
  return /* @__PURE__ */ k("nav", { class: "rail float", "aria-label": TEXT18.title }, panels.map((name) => /* @__PURE__ */ k(
    "button",
    {
      key: name,
      class: "rail-button",
      "data-opens": name,
      "aria-expanded": name === open,
      title: WORDS.sheets[name],
      onClick: () => onPanel(name === open ? null : name)
    },
    /* @__PURE__ */ k(Icon, { name }),
    /* @__PURE__ */ k("span", null, TEXT18[name])
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
    /* @__PURE__ */ k("header", { class: "sheet-head" }, /* @__PURE__ */ k("h2", null, title), /* @__PURE__ */ k("button", { class: "icon-button", "aria-label": TEXT18.close(title), onClick: close }, /* @__PURE__ */ k(Icon, { name: "close" }))),
    /* @__PURE__ */ k("div", { class: "body", tabIndex: -1 }, children)
  );
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
    const found = store.state.clip[place];
    return (found === void 0 ? null : boxOf(found)) ?? box2;
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

// src/view/slices/slice_pane.tsx
var PANE_COLORS = { z: "#ff6b6b", y: "#6bd46b", x: "#6ba8ff" };
var BODY = { z: "Axial", y: "Coronal", x: "Sagittal" };
var nameOf2 = ({ welcome }, pane) => welcome.volumes[0]?.is_anatomical ? BODY[pane] : pane;
var COARSE2 = 10;
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
    const volume2 = welcome.volumes[0];
    const now = slices().window ?? frame()?.slice?.window;
    if (volume2 === void 0 || !now) return;
    const span = volume2.robust_range[1] - volume2.robust_range[0] || 1;
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
  return /* @__PURE__ */ k(
    Viewport,
    {
      ...props,
      view: pane,
      label: `${nameOf2(props, pane)} slice at ${position}`,
      onGesture,
      onAction,
      onWheel: ({ factor, steps, ctrl }) => {
        if (ctrl) zoom(factor);
        else scroll(-steps, "wheel slice");
        settleSoon(store);
      },
      onHover: (place, size) => probe(props, place === null ? null : sliceFrame(frame(), size), place)
    },
    (shown, size) => /* @__PURE__ */ k(SliceOverlay, { ...props, frame: shown, size })
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
  return /* @__PURE__ */ k($, null, /* @__PURE__ */ k("svg", { class: "over", "aria-hidden": false }, overlays.crosshair && othersOf(pane).map((other) => /* @__PURE__ */ k(CrosshairLine, { key: other, ...props, on, other })), overlays.crop_box && /* @__PURE__ */ k(CropOnSlice, { ...props, on }), /* @__PURE__ */ k(MeasuresOnSlice, { ...props, on }), overlays.letters && letters !== null && /* @__PURE__ */ k("g", { "aria-hidden": "true", "text-anchor": "middle" }, /* @__PURE__ */ k("text", { class: "at-left", x: 14, y: size.height / 2 }, letters.left), /* @__PURE__ */ k("text", { x: size.width - 14, y: size.height / 2 }, letters.right), /* @__PURE__ */ k("text", { class: "at-top", x: size.width / 2, y: 18 }, letters.top), /* @__PURE__ */ k("text", { class: "at-bottom", x: size.width / 2, y: size.height - 8 }, letters.bottom)), overlays.scale_bar && /* @__PURE__ */ k("g", { "aria-hidden": "true", class: "at-corner" }, /* @__PURE__ */ k("path", { d: `M12 ${size.height - 14}h${bar / perCss}`, stroke: "#000", "stroke-width": "5" }), /* @__PURE__ */ k("path", { d: `M12 ${size.height - 14}h${bar / perCss}`, stroke: "#fff", "stroke-width": "2.5" }), /* @__PURE__ */ k("text", { x: 12, y: size.height - 20 }, `${bar} ${unit2}`))), /* @__PURE__ */ k("div", { class: "corner", style: { color: PANE_COLORS[pane] } }, `${nameOf2(props, pane)}${isTilted ? ", tilted" : ""}
${shortNumber(geometry.position, 4)} ${unit2}`, slices.thickness > 0 ? `
${slices.slab} of ${shortNumber(slices.thickness)} ${unit2}` : ""), geometry.window && /* @__PURE__ */ k("div", { class: "corner right" }, `L ${shortNumber(level, 4)}
W ${shortNumber(width, 4)}`));
}
function CrosshairLine(props) {
  const { store, on, other, welcome } = props;
  const { size } = on;
  const normal = normalOf(store.state, other);
  const line = lineOf(on, normal);
  if (line === null) return null;
  const at2 = placeOf(on, store.state.view.slices.crosshair);
  const reach = size.width + size.height;
  const color2 = PANE_COLORS[other];
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
  return /* @__PURE__ */ k("g", { stroke: color2, fill: "none" }, /* @__PURE__ */ k(
    "path",
    {
      d: `M${at2.x - line.dx * reach} ${at2.y - line.dy * reach}L${at2.x + line.dx * reach} ${at2.y + line.dy * reach}`,
      "stroke-width": "1.2",
      opacity: "0.85"
    }
  ), /* @__PURE__ */ k(
    Handle2,
    {
      label: `${nameOf2(props, other)} plane`,
      text: `${nameOf2(props, other)} plane at ${shortNumber(position, 4)}`,
      value: position,
      range,
      x: at2.x - line.dx * far * 0.55,
      y: at2.y - line.dy * far * 0.55,
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
      label: `Tilt the ${nameOf2(props, other)} plane`,
      text: `Tilt of the ${nameOf2(props, other)} plane`,
      value: Math.atan2(line.dy, line.dx) * 180 / Math.PI,
      range: [-180, 180],
      x: at2.x + line.dx * far,
      y: at2.y + line.dy * far,
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
function probe({ engine, ui, welcome }, on, place) {
  if (on === null || place === null) {
    ui.probe(null);
    return;
  }
  const point2 = worldAt(on, place.x, place.y);
  ui.probe(async () => {
    const { values, label } = await engine.ask("probe", { point: point2 });
    const shown = values.map(
      (value, n2) => value === null ? "outside" : `${shortNumber(value, 5)} ${welcome.volumes[n2]?.value_unit ?? ""}`.trim()
    );
    return `${shown.join(", ")}${label === null ? "" : ` · ${label.name}`} at ${placeText(point2, welcome)}`;
  });
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
  const names = Object.entries(welcome.window_names);
  const named = names.find(([, [l3, w3]]) => slices.window?.[0] === l3 && slices.window[1] === w3)?.[0];
  return /* @__PURE__ */ k($, null, AXES3.map((name, axis) => /* @__PURE__ */ k(
    NumberField2,
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
    NumberField2,
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
  ), info?.value_unit === "HU" && /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k(
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
  ), /* @__PURE__ */ k(
    NumberField2,
    {
      label: "Zoom",
      value: slices.zoom,
      min: 0.2,
      max: 20,
      onInput: (value) => store.change([set(Math.min(Math.max(value, 0.1), 100), "view", "slices", "zoom")], "zoom"),
      onSettle: settle
    }
  ), /* @__PURE__ */ k("div", { class: "row" }, /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      onClick: () => {
        const middle2 = [0, 1, 2].map((a3) => ((lower[a3] ?? 0) + (upper[a3] ?? 0)) / 2);
        store.change([set(middle2, "view", "slices", "crosshair")]);
      }
    },
    "Crosshair to the middle"
  ), /* @__PURE__ */ k("button", { class: "button", onClick: () => void pick(props, 0.5, 0.5, ui.frames["3d"] ?? { width: 512, height: 512 }) }, "Crosshair to what is seen"), /* @__PURE__ */ k(
    "button",
    {
      class: "button",
      disabled: slices.window === void 0,
      onClick: () => store.change([{ op: "remove", path: "/view/slices/window" }])
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
var TEXT19 = WORDS.toolbar;
var LAYOUTS = ["3d", "one-and-three", "two-by-two", "single"];
var VIEWS = ["front", "back", "left", "right", "top", "bottom"];
var TOOLS = ["turn", "window", "distance", "angle"];
function Toolbar(props) {
  const { store, welcome, ui, isAbout, onAbout, onFit } = props;
  const { layout } = store.state.view;
  const names = store.state.layers.map(({ name }) => name).join(", ");
  const setLayout = (name) => {
    const main = name === "single" ? layout.main === "3d" ? "z" : layout.main : "3d";
    store.change([set({ name, main }, "view", "layout")]);
  };
  const hasScene = layout.name !== "single" || layout.main === "3d";
  return /* @__PURE__ */ k("header", { class: "toolbar" }, /* @__PURE__ */ k("h1", { class: "group float title-group" }, /* @__PURE__ */ k("button", { class: "title", "data-opens": "about", "aria-expanded": isAbout, "aria-label": WORDS.about.open(names), title: names, onClick: onAbout }, names)), /* @__PURE__ */ k("div", { class: "group float" }, /* @__PURE__ */ k(Radios, { label: WORDS.layouts.title, names: LAYOUTS, value: layout.name, textOf: (name) => WORDS.layouts[name], iconOf: (name) => name, onChoice: setLayout }), layout.name === "single" && /* @__PURE__ */ k("label", null, /* @__PURE__ */ k("span", { class: "hidden" }, WORDS.layouts.slice), /* @__PURE__ */ k("select", { value: layout.main, onChange: (event) => store.change([set(event.currentTarget.value, "view", "layout", "main")]) }, PANES.map((pane) => /* @__PURE__ */ k("option", { key: pane, value: pane, selected: pane === layout.main }, nameOf2({ welcome }, pane)))))), /* @__PURE__ */ k(Group, { label: TEXT19.history }, /* @__PURE__ */ k(IconButton, { icon: "undo", label: TEXT19.undo, shortcut: "Ctrl Z", disabled: !store.canUndo, onClick: () => store.undo() }), /* @__PURE__ */ k(IconButton, { icon: "redo", label: TEXT19.redo, shortcut: "Ctrl Shift Z", disabled: !store.canRedo, onClick: () => store.redo() })), /* @__PURE__ */ k("div", { class: "group float" }, /* @__PURE__ */ k(Radios, { label: TEXT19.tools, names: TOOLS, value: ui.tool, textOf: (tool) => TEXT19[tool], iconOf: (tool) => tool, onChoice: (tool) => ui.setTool(tool) })), hasScene && /* @__PURE__ */ k(Group, { label: TEXT19.views, more: "standard-views" }, VIEWS.map((view, n2) => /* @__PURE__ */ k(
    "button",
    {
      key: view,
      class: "icon-button",
      title: `${TEXT19.from(view)} (${n2 + 1})`,
      "aria-label": TEXT19.lettered(letterOf(view, welcome.axis_ends), view),
      onClick: () => {
        const camera = welcome.standard_views[view];
        if (camera !== void 0) showFrom(props, camera);
      }
    },
    letterOf(view, welcome.axis_ends)
  )), /* @__PURE__ */ k(IconButton, { icon: "fit", label: TEXT19.fit, shortcut: "0", onClick: onFit })));
}
function Group({ label, more = "", children }) {
  return /* @__PURE__ */ k("div", { class: `group float ${more}`, role: "group", "aria-label": label }, children);
}
function IconButton({ icon, label, shortcut, disabled = false, onClick }) {
  const title = shortcut === void 0 ? label : `${label} (${shortcut})`;
  return /* @__PURE__ */ k("button", { class: "icon-button", title, "aria-label": label, disabled, onClick: () => onClick() }, /* @__PURE__ */ k(Icon, { name: icon }));
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
  presets: PresetsPanel,
  function: FunctionPanel,
  layers: LayersPanel,
  labels: LabelsPanel,
  light: LightPanel,
  cut: CutPanel,
  slices: SlicesPanel,
  measure: MeasurePanel,
  share: SharePanel
};
function Page({ app, ...part }) {
  const { store, ui, welcome } = part;
  const { layout, interface: shown } = store.state.view;
  const panels = PANELS.filter((name) => name !== "labels" || store.state.labels !== null);
  const opened = openPanel(shown.panels);
  const open = opened === "labels" && store.state.labels === null ? null : opened;
  const onPanel = (name) => store.change([set(name === null ? [] : [name], "view", "interface", "panels")]);
  const theme = themeOf(store.state);
  const hasTimes = welcome.volumes.some((volume2) => volume2.n_times > 1);
  return /* @__PURE__ */ k(
    "div",
    {
      class: "wavesplat",
      "data-theme": theme,
      "data-sheet": open !== null,
      "data-times": hasTimes,
      onKeyDown: app.onKey,
      onDragOver: (event) => event.preventDefault(),
      onDrop: (event) => {
        event.preventDefault();
        const file = event.dataTransfer?.files[0];
        if (file !== void 0) void openState(part, file);
      }
    },
    /* @__PURE__ */ k(Toolbar, { ...part, isAbout: open === "about", onAbout: () => onPanel(open === "about" ? null : "about"), onFit: () => void fit(part, ui.frames["3d"] ?? { width: 4, height: 3 }) }),
    /* @__PURE__ */ k("main", { class: "views", "data-layout": layout.name }, (layout.name !== "single" || layout.main === "3d") && /* @__PURE__ */ k(SceneView, { ...part }), (layout.name === "one-and-three" || layout.name === "two-by-two") && PANES.map((pane) => /* @__PURE__ */ k(SlicePane, { key: pane, ...part, pane })), layout.name === "single" && layout.main !== "3d" && /* @__PURE__ */ k(SlicePane, { key: layout.main, ...part, pane: layout.main })),
    /* @__PURE__ */ k(Rail, { panels, open, onPanel }, /* @__PURE__ */ k("button", { class: "rail-button", title: theme === "dark" ? WORDS.toolbar.light : WORDS.toolbar.dark, onClick: () => store.change([set(theme === "dark" ? "light" : "dark", "view", "interface", "theme")]) }, /* @__PURE__ */ k(Icon, { name: "dark" }), /* @__PURE__ */ k("span", null, WORDS.toolbar.theme_short)), /* @__PURE__ */ k("button", { class: "rail-button", title: `${WORDS.toolbar.help} (?)`, onClick: () => app.onHelp(true) }, /* @__PURE__ */ k(Icon, { name: "help" }), /* @__PURE__ */ k("span", null, WORDS.toolbar.help_short))),
    open !== null && /* @__PURE__ */ k(Sheet, { key: open, name: open, onClose: () => onPanel(null) }, /* @__PURE__ */ k(Body, { ...part, app, name: open })),
    /* @__PURE__ */ k("footer", { class: "bottom" }, hasTimes && /* @__PURE__ */ k(TimeBar, { ...part }), /* @__PURE__ */ k(Status, { ...part, connection: app.connection, figures: app.figures })),
    /* @__PURE__ */ k("p", { class: "hidden", role: "status", "aria-live": "polite" }, app.said),
    app.problem !== null && /* @__PURE__ */ k(ProblemCard, { problem: app.problem, onClose: app.onProblemClosed }),
    app.help && /* @__PURE__ */ k(Help, { onClose: () => app.onHelp(false) })
  );
}
function Body({ app, name, ...part }) {
  if (name === "settings") return /* @__PURE__ */ k(SettingsPanel, { ...part, figures: app.figures, onFigures: app.onFigures });
  const Panel = BODIES[name];
  return /* @__PURE__ */ k(Panel, { ...part });
}

// src/view/style.css
var style_default = '/* Sizes: --rail, --bar and --foot are what the rail, the tools above and the bar of times below take from the picture. */\n:host { display: block; contain: content }\n.mount { height: 100%; container-type: size }\n.wavesplat {\n  --bg: #0b0d10; --panel: #15191f; --raised: #232a33; --line: #39424e; --text: #e8ebf0; --dim: #a9b3c0;\n  --accent: #6cb2ff; --accent-text: #08131f; --focus: #ffd166; --danger: #ff8f8f;\n  --gap: 8px; --radius: 8px; --rail: 72px; --bar: 52px; --foot: 0px; --sheet: 344px;\n  --glass: #161a21eb; --lift: 0 0 0 1px #ffffff14, 0 6px 24px #0009;\n  box-sizing: border-box; position: relative; width: 100%; height: 100%; overflow: hidden; background: var(--bg); color: var(--text);\n  font: 13px/1.4 system-ui, "Segoe UI", Roboto, sans-serif; font-variant-numeric: tabular-nums; color-scheme: dark;\n}\n.wavesplat[data-theme="light"] {\n  --bg: #e7eaee; --panel: #fff; --raised: #eceff3; --line: #8a93a0; --text: #161a20; --dim: #4b5563;\n  --accent: #0a5cb8; --accent-text: #fff; --focus: #b45309; --danger: #b42318;\n  --glass: #fcfdfef2; --lift: 0 0 0 1px #0000001f, 0 6px 24px #0005; color-scheme: light;\n}\n.wavesplat[data-times="true"] { --foot: 56px }\n.wavesplat *, .wavesplat *::before { box-sizing: border-box }\n.wavesplat :focus-visible { outline: 2px solid var(--focus); outline-offset: 1px }\n.wavesplat h2, .wavesplat h3, .wavesplat p { margin: 0; font-size: inherit; font-weight: 600 }\n.wavesplat p { font-weight: 400 }\n.wavesplat button, .wavesplat select, .wavesplat input, .wavesplat textarea { font: inherit; color: inherit }\n.wavesplat input[type="range"] { accent-color: var(--accent); min-width: 0; flex: 1; height: 24px; margin: 0 }\n.wavesplat input[type="checkbox"], .wavesplat input[type="radio"] { accent-color: var(--accent); width: 18px; height: 18px; margin: 3px }\n.wavesplat input[type="color"] { width: 34px; height: 26px; padding: 1px; border: 1px solid var(--line); border-radius: 6px; background: none }\n.wavesplat input[type="number"], .wavesplat input[type="text"], .wavesplat input[type="search"], .wavesplat select, .wavesplat textarea {\n  background: var(--raised); border: 1px solid var(--line); border-radius: 6px; padding: 2px 7px; min-height: 28px; min-width: 0;\n}\n.wavesplat input[type="number"] { width: 96px; appearance: textfield; text-align: right }\n.wavesplat input[type="number"]::-webkit-inner-spin-button { display: none }\n.button {\n  background: var(--raised); border: 1px solid var(--line); border-radius: 6px; padding: 3px 10px; min-height: 28px; cursor: pointer;\n}\n.button:hover { border-color: var(--accent) }\n.icon-button:hover, .rail-button:hover, .title:hover, .title[aria-expanded="true"] { background: var(--raised) }\n.button:disabled, .icon-button:disabled { opacity: .45; cursor: default }\n.button[aria-pressed="true"], .icon-button[aria-pressed="true"], .icon-button[aria-checked="true"], .rail-button[aria-expanded="true"] {\n  background: var(--accent); color: var(--accent-text); border-color: var(--accent);\n}\n.icon-button {\n  display: inline-grid; place-items: center; min-width: 32px; height: 32px; padding: 0 6px; border: 0; border-radius: 6px;\n  background: none; cursor: pointer; flex: none;\n}\n.icon-button svg, .rail-button svg { width: 18px; height: 18px; fill: none; stroke: currentColor; stroke-width: 1.5; stroke-linecap: round; stroke-linejoin: round }\n.row { display: flex; flex-wrap: wrap; align-items: center; gap: 6px }\n.field { display: flex; align-items: center; gap: 6px; min-width: 0 }\n.field > span:first-child { flex: 0 0 112px; color: var(--dim) }\n.spring { flex: 1 }\n.float { background: var(--glass); box-shadow: var(--lift); border-radius: var(--radius) }\n.toolbar { position: absolute; z-index: 3; left: calc(var(--rail) + 8px); right: 104px; top: 8px; display: flex; align-items: center; gap: var(--gap); pointer-events: none }\n.toolbar > * { pointer-events: auto }\n.toolbar .group { display: flex; align-items: center; gap: 1px; padding: 3px; min-height: 38px }\n.toolbar .title-group { min-width: 0; margin: 0; flex: 0 1 auto }\n.radios { display: flex; gap: 1px }\n.wavesplat .title { border: 0; border-radius: 6px; background: none; height: 32px; padding: 0 10px; cursor: pointer; font-size: 13px; font-weight: 600; max-width: 220px; overflow: hidden; text-overflow: ellipsis; white-space: nowrap }\n.rail { position: absolute; z-index: 3; left: 8px; top: 8px; bottom: 8px; width: 64px; padding: 4px; display: flex; flex-direction: column; gap: 1px; overflow: auto; scrollbar-width: none }\n.rail-button {\n  display: grid; justify-items: center; align-content: center; gap: 2px; width: 100%; min-height: 46px; padding: 3px 0; border: 0; border-radius: 6px;\n  background: none; cursor: pointer; flex: none;\n}\n.wavesplat .rail-button { font-size: 11px; line-height: 1.1 }\n.sheet { position: absolute; z-index: 3; left: calc(var(--rail) + 8px); top: 54px; max-height: calc(100% - 62px - var(--foot)); width: var(--sheet); display: flex; flex-direction: column; overflow: hidden }\n.sheet-head { display: flex; align-items: center; justify-content: space-between; padding: 5px 6px 5px 14px; flex: none }\n.wavesplat .sheet-head h2 { font-size: 13px }\n.sheet > .body { display: grid; gap: 8px; padding: 4px 14px 14px; overflow-y: auto; overflow-x: hidden; min-height: 0; align-content: start }\n.sheet > .body:focus-visible { outline-offset: -2px }\n.views { position: absolute; inset: 0; display: grid; gap: 2px; background: var(--line) }\n.views[data-layout="3d"], .views[data-layout="single"] { grid-template: 1fr / 1fr }\n.views[data-layout="one-and-three"] { grid-template: repeat(3, minmax(0, 1fr)) / minmax(0, 2fr) minmax(0, 1fr) }\n.views[data-layout="one-and-three"] > :first-child { grid-row: 1 / 4 }\n.views[data-layout="two-by-two"] { grid-template: repeat(2, minmax(0, 1fr)) / repeat(2, minmax(0, 1fr)) }\n/* Several views make room for the sheet, which lies over the picture where there is but one. */\n.wavesplat[data-sheet="true"] .views:not([data-layout="3d"], [data-layout="single"]) { left: calc(var(--rail) + var(--sheet) + 12px) }\n.wavesplat[data-sheet="false"] .views > :first-child, .wavesplat[data-sheet="false"] .views[data-layout="two-by-two"] > :nth-child(3),\n.views[data-layout="3d"] > *, .views[data-layout="single"] > * { --left: var(--rail) }\n.views > :first-child, .views > :nth-child(2) { --top: var(--bar) }\n.views > :last-child, .views[data-layout="one-and-three"] > :first-child, .views[data-layout="two-by-two"] > :nth-child(3) { --bottom: var(--foot) }\n.viewport { --left: 0px; --top: 0px; --bottom: 0px; position: relative; overflow: hidden; background: #000; min-width: 0; min-height: 0; touch-action: none; user-select: none; color: #fff }\n.viewport:focus-visible { outline-offset: -2px }\n.viewport canvas { position: absolute; inset: 0; width: 100%; height: 100%; display: block; transform-origin: 0 0 }\n.viewport svg.over { position: absolute; inset: 0; width: 100%; height: 100%; overflow: hidden; pointer-events: none }\n.viewport svg.over [data-handle] { pointer-events: auto; cursor: grab }\n.viewport svg.over text { fill: #fff; paint-order: stroke; stroke: #000; stroke-width: 3px; stroke-linejoin: round; font-size: 13px }\n.viewport .corner { position: absolute; left: calc(8px + var(--left)); top: calc(6px + var(--top)); font-size: 12px; text-shadow: 0 0 3px #000; pointer-events: none; white-space: pre-line }\n.viewport .corner.right { left: auto; right: 8px; text-align: right }\n.viewport .corner.low { top: auto; bottom: calc(6px + var(--bottom)) }\n.over .at-left { transform: translateX(var(--left)) }\n.over .at-top { transform: translateY(var(--top)) }\n.over .at-bottom { transform: translateY(calc(-1 * var(--bottom))) }\n.over .at-corner { transform: translate(var(--left), calc(-1 * var(--bottom))) }\n.hint { position: absolute; left: 50%; bottom: 12%; transform: translateX(-50%); background: #000c; padding: 6px 12px; border-radius: var(--radius) }\n.bottom { position: absolute; z-index: 2; left: calc(var(--rail) + 8px); right: 8px; bottom: 8px; display: flex; flex-direction: column; align-items: flex-end; gap: 6px; pointer-events: none }\n.bottom > * { pointer-events: auto }\n.status { display: flex; flex-wrap: wrap; justify-content: flex-end; gap: 4px 6px; order: -1 }\n.status > * { background: var(--glass); box-shadow: var(--lift); border-radius: var(--radius); padding: 3px 10px; font-size: 12px }\n.status > [role="note"] { animation: noted 1s 9s forwards }\n@keyframes noted { to { opacity: 0; visibility: hidden } }\n.alert { position: absolute; left: 50%; top: 60px; transform: translateX(-50%); max-width: min(560px, 92%); z-index: 5; background: var(--panel); border: 1px solid var(--danger); border-radius: var(--radius); padding: 10px 14px; display: grid; gap: 6px }\n.opening { position: absolute; inset: 0; display: grid; place-content: center; gap: 10px; padding: 24px; text-align: center }\n.opening progress { width: 260px; accent-color: var(--accent) }\n.dim { color: var(--dim) }\n.hidden { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap }\n.wavesplat dialog { background: var(--panel); color: var(--text); border: 1px solid var(--line); border-radius: var(--radius); padding: 16px 20px; max-width: min(640px, 94vw); max-height: 86vh; overflow: auto }\n.wavesplat dialog::backdrop { background: #0008 }\n.wavesplat table { border-collapse: collapse; width: 100% }\n.wavesplat th, .wavesplat td { text-align: left; padding: 3px 12px 3px 0; vertical-align: top; font-weight: 400 }\n.wavesplat kbd { background: var(--raised); border-radius: 3px; padding: 0 6px; font: inherit }\n.chip { width: 18px; height: 18px; border-radius: 3px; border: 1px solid var(--line); flex: none }\n@container (max-width: 1000px) {\n  .standard-views { display: none !important }\n}\n@container (max-height: 620px) {\n  .wavesplat { --rail: 52px }\n  .rail { width: 40px; padding: 2px; left: 6px }\n  .rail-button { min-height: 28px }\n  .rail-button > span { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap }\n}\n/* A phone: tools in one row above, the rail below, and a sheet from below that leaves the picture 60 % of the height. */\n@container (max-width: 600px) {\n  .wavesplat { --rail: 0px; display: grid; grid-template: minmax(0, 1fr) auto auto / minmax(0, 1fr) }\n  .views, .wavesplat[data-sheet="true"] .views:not([data-layout="3d"], [data-layout="single"]) { position: relative; left: 0; grid-area: 1 / 1 }\n  .views[data-layout="one-and-three"] { grid-template: minmax(0, 2fr) minmax(0, 1fr) / repeat(3, minmax(0, 1fr)) }\n  .views[data-layout="one-and-three"] > :first-child { grid-row: auto; grid-column: 1 / 4 }\n  .toolbar { left: 6px; right: 6px; top: 6px; gap: 4px; overflow-x: auto; scrollbar-width: none }\n  .title-group { display: none !important }\n  .sheet { position: relative; left: 0; top: 0; width: auto; grid-area: 2 / 1; max-height: 31cqh; border-radius: 12px 12px 0 0 }\n  .rail { position: relative; left: 0; top: 0; bottom: 0; width: auto; grid-area: 3 / 1; flex-direction: row; border-radius: 0; padding: 2px 4px }\n  .rail .spring { display: none }\n  .rail-button { width: auto; min-width: 52px }\n  .bottom { position: relative; left: 0; right: 0; bottom: 0; grid-area: 1 / 1; align-self: end; padding: 6px }\n}\n@media (pointer: coarse) {\n  .icon-button, .button { min-width: 44px; min-height: 44px }\n}\n@media (forced-colors: active) {\n  .icon-button[aria-pressed="true"], .icon-button[aria-checked="true"], .button[aria-pressed="true"] { forced-color-adjust: none; background: Highlight; color: HighlightText }\n}\n.wavesplat fieldset { border: 1px solid var(--line); border-radius: var(--radius); margin: 0; padding: 6px 10px 10px; display: grid; gap: 6px; min-width: 0 }\n.wavesplat legend { padding: 0 4px; color: var(--dim) }\n.wavesplat ol, .wavesplat ul { margin: 0; padding-left: 20px }\n.viewport .legend { top: calc(8px + var(--top)); left: calc(8px + var(--left)); list-style: none; padding: 0; display: grid; gap: 3px }\n.viewport .legend li { display: flex; gap: 6px; align-items: center }\n.viewport .color-bar { display: grid; justify-items: end; gap: 3px; bottom: calc(44px + var(--bottom)) }\n.viewport .color-bar .ramp { width: 14px; height: 150px; border: 1px solid #fff8 }\n.about { display: grid; gap: 6px }\n.about dl { display: grid; grid-template-columns: auto 1fr; gap: 3px 14px; margin: 0 }\n.about dt { color: var(--dim) }\n.about dd { margin: 0; overflow-wrap: anywhere }\n.about h4 { margin: 4px 0 0; font-weight: 600; font-size: 12px; color: var(--dim) }\n.wavesplat .about ul { padding-left: 16px; display: grid; gap: 4px }\n';

// src/view/app.tsx
var ANNOUNCED_MS = 1e3;
var PROBE_MS = 40;
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
  probed = "";
  probeTimer;
  help = false;
  figures = false;
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
      const { fingerprint, state: state2 } = await fromLink(this.host.link);
      if (fingerprint !== welcome.fingerprint) throw new Error("The link is of other data than is open here");
      const text2 = JSON.stringify(parseViewerState(state2));
      const { state: checked } = await this.engine.ask("open_state", { text: text2 });
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
    addPoint(point2) {
      app.addPoint(point2);
    },
    get layer() {
      return Math.min(app.layer, (app.store?.state.layers.length ?? 1) - 1);
    },
    setLayer(layer) {
      app.layer = layer;
      app.schedule();
    },
    get probed() {
      return app.probed;
    },
    probe(ask) {
      clearTimeout(app.probeTimer);
      const tell = (text2) => {
        if (app.probed !== text2) app.schedule();
        app.probed = text2;
      };
      const timer = setTimeout(() => {
        ask?.().then((text2) => app.probeTimer === timer && tell(text2), () => void 0);
      }, PROBE_MS);
      app.probeTimer = timer;
      if (ask === null) tell("");
    },
    announce(text2) {
      app.announce(text2);
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
  addPoint(point2) {
    const kind2 = this.tool === "angle" ? "angle" : "distance";
    const points = [...this.points, point2];
    if (points.length < (kind2 === "angle" ? 3 : 2)) {
      this.points = points;
    } else {
      this.points = [];
      if (isMeasure(points)) this.store?.change([set({ kind: kind2, points }, "view", "measures", "-")]);
    }
    this.schedule();
  }
  announce(text2) {
    clearTimeout(this.sayTimer);
    const wait = Math.max(0, this.lastSaid + ANNOUNCED_MS - performance.now());
    this.sayTimer = setTimeout(() => {
      this.said = text2;
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
  draw() {
    const { store, welcome } = this;
    if (store === null || welcome === null) {
      Q(
        /* @__PURE__ */ k("div", { class: "wavesplat", "data-theme": surrounding() }, /* @__PURE__ */ k(Opening, { connection: this.connection, problem: this.failure })),
        this.mount
      );
      return;
    }
    const part = { store, engine: this.engine, welcome, ui: this.ui };
    Q(/* @__PURE__ */ k(Page, { ...part, app: this.shown() }), this.mount);
  }
  shown() {
    return {
      connection: this.connection,
      problem: this.problem,
      help: this.help,
      figures: this.figures,
      said: this.said,
      onKey: this.onKey,
      onHelp: (on) => {
        this.help = on;
        this.schedule();
      },
      onFigures: (on) => {
        this.figures = on;
        this.schedule();
      },
      onProblemClosed: () => {
        this.problem = null;
        this.schedule();
      }
    };
  }
};

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
