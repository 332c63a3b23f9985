// SPDX-License-Identifier: Apache-2.0
// The ASIP library. A sketch includes this, one of <AsipFastSerial.h> and <AsipSerial.h> (which carries
// the line) and the headers of its services:
//
//   #include <Asip.h>
//   #include <AsipFastSerial.h>
//
//   void setup() { asip::board.begin(ASIP_NAME("Hello")); }
//   void loop() { asip::board.run(); }
#pragma once

#include "asip/Board.h"
#include "asip/Error.h"
#include "asip/Line.h"
#include "asip/Out.h"
#include "asip/Request.h"
#include "asip/Service.h"
