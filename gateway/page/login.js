// SPDX-License-Identifier: Apache-2.0
// Between the address of a log-in and the page: goes on by itself, or asks. The part behind # is not sent to the gateway.
const go = document.getElementById("go");
go.href += location.hash;
if (go.dataset.atOnce !== undefined) location.replace(go.href);
