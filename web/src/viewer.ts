// The exports of the bundle: the page's start, and the module that anywidget loads.

import { openPage } from "./hosts/page.ts";
import { render } from "./hosts/widget.ts";

export { openPage };
export default { render };
