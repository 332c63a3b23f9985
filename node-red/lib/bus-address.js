// SPDX-License-Identifier: Apache-2.0
// Where a bus is: an address, or a credentials file.
'use strict';

const fs = require('node:fs');

// The options of a file that `asipctl secure` made.
function readCredentials(path) {
  const text = fs.readFileSync(path, 'utf8').replace(/^\uFEFF/, '');
  const values = {};
  let inside = false;
  for (const raw of text.split(/\r?\n/)) {
    const line = raw.trim();
    if (inside || line.startsWith('-----BEGIN ')) inside = !line.startsWith('-----END ');
    else if (line && !line.startsWith('#')) {
      const equals = line.indexOf('=');
      if (equals < 0) throw new Error(`${path}: expected NAME = VALUE`);
      values[line.slice(0, equals).trim()] = line.slice(equals + 1).trim();
    }
  }
  for (const name of ['broker', 'user', 'password']) if (!values[name]) throw new Error(`${path}: the line ${name} = ... is missing`);
  return { brokers: values.broker, user: values.user, password: values.password, root: values['topic-root'], ca: text.includes('BEGIN CERTIFICATE') ? text : undefined };
}

// HOST, HOST:PORT, mqtt://HOST or mqtts://HOST -> an address for mqtt.js.
function addressOf(broker, secure) {
  const parts = /^(?:(mqtts?|tcp|ssl):\/\/)?(\[[^\]]+\]|[^:/@\s]+)(?::(\d+))?\/?$/.exec(broker.trim());
  if (!parts || (parts[3] && !(parts[3] > 0 && parts[3] < 65536))) throw new Error(`broker "${broker.replace(/\/\/.*@/, '//...@')}" is not HOST, HOST:PORT or mqtt://HOST:PORT`);
  const tls = parts[1] ? ['mqtts', 'ssl'].includes(parts[1]) : secure;
  return `${tls ? 'mqtts' : 'mqtt'}://${parts[2]}:${parts[3] || (tls ? 8883 : 1883)}`;
}

// What may be wrong with a password that a broker refuses; tests/vectors/passwords.json binds it to the C++ client.
function passwordHint(password) {
  if (!password) return '';
  if (/[\r\n]/.test(password)) return ' (the password has a line end)';
  if (/[ \t]$/.test(password)) return ' (the password ends with a blank)';
  if (/^[ \t]/.test(password)) return ' (the password begins with a blank)';
  return password.includes('\uFFFD') ? ' (the password is no UTF-8: was it written as Latin-1?)' : '';
}

module.exports = { addressOf, passwordHint, readCredentials };
