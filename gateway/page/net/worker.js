import { Hub } from "./hub.js";

const { protocol, host, pathname } = self.location;
const base = pathname.replace(/net\/worker\.js$/, "");
const hub = new Hub(`${protocol === "https:" ? "wss:" : "ws:"}//${host}${base}api/stream`);
self.onconnect = (event) => hub.add(event.ports[0]);
