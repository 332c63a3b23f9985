// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::cli {

/// A stopped terminal (Ctrl-S) or a sleeping reader makes the program stand in write(), where it handles no
/// signal. From now on a SIGINT or SIGTERM that is not handled within two seconds ends it with 128 + signal.
/// After the handlers are set up.
void end_when_stuck();
/// The signal was handled.
void not_stuck();

}  // namespace asip::cli
