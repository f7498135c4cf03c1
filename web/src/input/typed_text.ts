// The text that is typed into a field and not yet taken: the key Escape puts back the text before it.

type Field = EventTarget & { value: string };

export class TypedText {
  private before: { readonly field: Field; readonly text: string } | null = null;

  constructor(root: EventTarget) {
    root.addEventListener("beforeinput", ({ target }) => {
      this.before ??= { field: target as Field, text: (target as Field).value };
    });
    for (const end of ["change", "focusout"]) root.addEventListener(end, () => (this.before = null));
  }

  /** Whether something was typed into the field that has the focus, and the field has not taken it. */
  get isWaiting(): boolean {
    return this.before !== null;
  }

  /** Puts back the text before; returns whether there was one. */
  takeBack(): boolean {
    if (this.before === null) return false;
    const { field, text } = this.before;
    this.before = null;
    field.value = text;
    return field.dispatchEvent(new Event("input", { bubbles: true }));
  }
}
