// SPDX-License-Identifier: Apache-2.0
// Does not compile: see CMakeLists.txt.
#include "asip/Flash.h"

asip::FlashText name() {
    return ASIP_NAME("Lüfter");
}
