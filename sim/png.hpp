// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/expected.hpp"

namespace asip::sim {

inline constexpr int kPngWidth = 1200;  // pixels

/// Draws an SVG document into a PNG file, by the program rsvg-convert (Debian package librsvg2-bin), and
/// waits for its end. Errors: that is not installed, or the file cannot be written.
Expected<void> save_as_png(const std::string& svg, const std::string& file);

}  // namespace asip::sim
