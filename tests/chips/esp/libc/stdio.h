// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stddef.h>
extern "C" int snprintf(char* text, size_t size, const char* format, ...)
    __attribute__((format(printf, 3, 4)));
