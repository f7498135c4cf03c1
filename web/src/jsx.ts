// The JSX factory: elements become `h(type, props, ...children)`, which is shorter than the automatic runtime's calls.

export { Fragment, h } from "preact";
