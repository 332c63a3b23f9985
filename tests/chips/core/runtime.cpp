// SPDX-License-Identifier: Apache-2.0
// What the compiler and the linker expect of a C++ program that has no operating system.
#include "runtime.h"

#include <Arduino.h>

typedef void (*Constructor)();
extern "C" {
extern uint32_t ramImage[], dataStart[], dataEnd[], bssStart[], bssEnd[];
extern const Constructor constructorsStart[], constructorsEnd[];

void* __dso_handle;
void __cxa_pure_virtual() {
    stopForGood();
}
int __cxa_atexit(void (*)(void*), void*, void*) {
    return 0;
}
}

void stopForGood() {
    for (;;) {
    }
}

void startProgram() {
    const uint32_t* from = ramImage;
    for (uint32_t* to = dataStart; to != dataEnd; ++to)
        *to = *from++;
    for (uint32_t* to = bssStart; to != bssEnd; ++to)
        *to = 0;
    startChip();
    for (const Constructor* next = constructorsStart; next != constructorsEnd; ++next)
        (*next)();
    setup();
    for (;;) {
        loop();
        betweenLoops();
    }
}
