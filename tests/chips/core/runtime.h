// SPDX-License-Identifier: Apache-2.0
#pragma once

// Called with a stack and nothing else: fills the memory and runs the sketch.
[[noreturn]] void startProgram();

// Clocks, pins, timer: before any object is made. Each chip has its own.
void startChip();

// Whatever the chip has no interrupt for.
void betweenLoops();

[[noreturn]] void stopForGood();
