// Types of the npm package `@wavesplat/viewer`: the module that anywidget loads (https://anywidget.dev/en/afm/).

/** The widget's model in the notebook: messages to Python and back. */
export interface WidgetModel {
  send(content: unknown, callbacks?: unknown, buffers?: ArrayBuffer[] | ArrayBufferView[]): void;
  on(event: "msg:custom", listener: (content: unknown, buffers: unknown[]) => void): void;
  on(event: "comm_live_update", listener: (model: unknown) => void): void;
  off(event: "msg:custom", listener: (content: unknown, buffers: unknown[]) => void): void;
  off(event: "comm_live_update", listener: (model: unknown) => void): void;
  get(name: string): unknown;
}

declare const viewer: {
  /** Shows the viewer in an element, with the pictures that the model's Python draws; gives what takes it away again. */
  render(context: { readonly model: WidgetModel; readonly el: HTMLElement }): () => void;
};
export default viewer;
