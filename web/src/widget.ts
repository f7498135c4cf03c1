// The module that anywidget loads.

import { render } from "./hosts/widget.ts";

export default { render };
