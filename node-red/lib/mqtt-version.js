// SPDX-License-Identifier: Apache-2.0
// Which version of MQTT the next attempt at a broker speaks: 5, or 3.1.1 where the broker knows no other. Pure; tests/vectors/mqtt_version.json binds
// it to the C++ client.
//
// An attempt fails by `version` (the broker says so), `closed` (it closes the connection before it answers), `silent` (it answers
// nothing), or by anything else. A broker that is just going down closes connections, too, so two of them count; one that hangs is silent,
// so one that took MQTT 5 before is not suspected. Where 3.1.1 fails in the same way the version was not the reason.
'use strict';

const CLOSED_UNTIL_311 = 2;
const SILENT_UNTIL_311 = 1;

class VersionChoice {
  refused = false;

  took = false;

  closed = 0; // in a row, with MQTT 5

  silent = 0;

  get v5() { return !this.refused && this.closed < CLOSED_UNTIL_311 && this.silent < SILENT_UNTIL_311; }

  // Whether the same broker is to be tried again, before the next one of the list.
  get suspected() { return this.closed > 0; }

  accepted() {
    this.took = this.v5;
    this.closed = 0;
    this.silent = 0;
  }

  failed(how, triedV5) {
    this.refused = this.refused || how === 'version';
    this.closed = how === 'closed' && triedV5 ? this.closed + 1 : 0;
    this.silent = how === 'silent' && triedV5 && !this.took ? this.silent + 1 : 0;
  }
}

module.exports = { VersionChoice };
