// The script of the page that `wavesplat view` opens.

import { openPage } from "./hosts/page.ts";

const element = document.getElementById("viewer");
if (element !== null) openPage(element);
