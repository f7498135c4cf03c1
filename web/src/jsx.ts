// What elements become in the bundle: `h(type, props, ...children)`, which is shorter than the automatic runtime's calls.

export { Fragment, h } from "preact";
