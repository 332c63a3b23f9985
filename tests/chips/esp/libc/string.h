// SPDX-License-Identifier: Apache-2.0
// As much of a C library's headers as the library and its examples use: the compiler for the ESP8266 comes
// without.
#pragma once
#include <stddef.h>
extern "C" {
size_t strlen(const char* text);
int strcmp(const char* one, const char* other);
int memcmp(const void* one, const void* other, size_t size);
void* memcpy(void* to, const void* from, size_t size);
void* memmove(void* to, const void* from, size_t size);
void* memset(void* to, int value, size_t size);
}
