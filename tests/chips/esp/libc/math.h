// SPDX-License-Identifier: Apache-2.0
#pragma once
#define M_PI 3.14159265358979323846
extern "C" {
double atan2(double y, double x);
double pow(double base, double exponent);
}
