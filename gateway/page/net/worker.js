// SPDX-License-Identifier: Apache-2.0
import { Hub } from "./hub.js";

const hub = new Hub(new URL("../api/", self.location).href);
self.onconnect = (event) => hub.add(event.ports[0]);
