// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/property/property.hpp"

namespace asip::links {

/// A contact at pin 2; a level of 1 is on.
inline property::Property contact(const char* klass = "button") {
    property::Property pin;
    pin.id = "io/2";
    pin.kind = property::Kind::kBinarySensor;
    pin.name = "contact";
    pin.service = "io";
    pin.choices = {{"off", 0}, {"on", 1}};
    pin.read = property::Place{"io", "/digital/2", false};
    pin.meaning.klass = klass;
    return pin;
}

}  // namespace asip::links
