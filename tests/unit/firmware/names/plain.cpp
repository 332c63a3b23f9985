// SPDX-License-Identifier: Apache-2.0
#include "asip/Flash.h"

asip::FlashText name() {
    return ASIP_NAME("Fan 2 (left)");
}
