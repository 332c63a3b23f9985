// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::cli {

/// A terminal that was stopped (Ctrl-S), and a reader that sleeps, take no output: the program stands in
/// write(), where it handles no signal. From now on a SIGINT or SIGTERM that the program does not
/// handle within two seconds ends the process, with status 128 + signal. After what handles these signals has
/// been set up.
void end_when_stuck();
/// The signal was handled.
void not_stuck();

}  // namespace asip::cli
