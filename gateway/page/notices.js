// SPDX-License-Identifier: Apache-2.0
// Phones show notices of a service worker alone. It keeps nothing and answers no request.
self.addEventListener("notificationclick", (event) => {
  event.notification.close();
  event.waitUntil(self.clients.matchAll({ type: "window", includeUncontrolled: true }).then(([page]) => {
    page?.postMessage("lost");
    return page ? page.focus() : self.clients.openWindow("./#/?state=lost");
  }));
});
